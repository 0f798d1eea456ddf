// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The ten header lines of an .nl file, in its words (Gay, "Writing .nl files", table 2).
#include <vector>

#include "ncp/ampl/nl_tokens.hpp"

namespace perp::ncp::ampl {

struct NlHeader {
  bool binary = false;
  std::vector<int> options;  ///< of line 1: their number first; for the .sol file
  double tolerance = 0;      ///< given back there too if options[2] is 3
  int n_var = 0, n_con = 0, n_obj = 0;
  int n_lcon = 0;  ///< logical constraints
  int nonlinear_con = 0, nonlinear_obj = 0;
  int n_cc = 0;                          ///< complementarity conditions
  int network_con = 0, network_var = 0;  ///< network constraints and linear arc variables
  int nonlinear_var_con = 0;             ///< variables nonlinear in constraints (those in both included)
  int nonlinear_var_obj = 0;             ///< nonlinear in objectives (those in both included)
  int nonlinear_var_both = -1;           ///< -1: an old header that does not say
  int n_func = 0;                        ///< imported functions
  int binary_var = 0, integer_var = 0;   ///< linear
  int integer_both = 0, integer_con = 0, integer_obj = 0;  ///< nonlinear integer variables
  int jacobian_nonzeros = 0, gradient_nonzeros = 0;
  int defined_both = 0, defined_con = 0, defined_obj = 0;  ///< defined variables used more than once
  int defined_con1 = 0, defined_obj1 = 0;                  ///< used in a single constraint or objective
  std::size_t body = 0;                                    ///< where the segments begin

  int defined_shared() const { return defined_both + defined_con + defined_obj; }
  int defined() const { return defined_shared() + defined_con1 + defined_obj1; }
};

/// Reads the header and leaves the cursor at the first segment. Sizes that `file_size` bytes cannot hold are refused.
NlHeader read_header(NlTokens& tokens, std::size_t file_size);

}  // namespace perp::ncp::ampl

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// .sol files, as AMPL reads them (Gay, "Hooking your solver to AMPL", 1997): the message, an "Options" block with the
/// header's options and the sizes, no dual values, x, and "objno 0 CODE". Text for text models, binary for binary ones.
#include <span>
#include <string>
#include <vector>

namespace perp::ncp::ampl {

struct SolFormat {
  bool binary = false;
  std::vector<int> options{3, 1, 1, 0};  ///< their number first
  double tolerance = 0;                  ///< written if options[2] is 3
  int n_con = 0;
  int n_var = 0;
};

/// The content of the file. `x` is empty or has n_var finite values.
std::string sol_text(const SolFormat& format, const std::string& message, std::span<const double> x, int code);

/// By lcp/io/output_file.hpp. Throws ModelError with the path and the reason.
void write_whole(const std::string& path, const std::string& content);

}  // namespace perp::ncp::ampl

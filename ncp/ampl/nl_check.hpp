// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A complete check of an .nl file, because AMPL's library trusts what it reads: a file that passes can be handed to
/// it. On the way everything is kept that the pairing needs.
#include <string>
#include <string_view>
#include <vector>

#include "ncp/ampl/nl_expression.hpp"
#include "ncp/ampl/nl_header.hpp"
#include "ncp/ampl/nl_tokens.hpp"

namespace perp::ncp::ampl {

/// The suffix of the rows whose polyhedron a variational inequality is over.
inline constexpr std::string_view polyhedron_suffix = "polyhedron";

/// lower <= variable or row <= upper; or the row complements a variable.
struct NlRange {
  double lower = 0, upper = 0;
  int complement = -1;      ///< row only: the variable it complements, 0-based; -1: none
  int bounds = 0;           ///< with it: 1 a finite lower bound of that variable counts, 2 an upper, 3 both, 0 none
  bool polyhedron = false;  ///< row only: of the polyhedron of a variational inequality, by its suffix
  Place place = 0;
};

/// Where in the file an expression begins, and the variable v for which it becomes 0 v + e.
struct NlAnchor {
  std::size_t offset = 0;
  int variable = 0;
};

struct NlModel {
  std::string file;
  NlHeader header;
  std::vector<NlRange> variables;
  std::vector<NlRange> rows;
  std::vector<double> start;                      ///< n_var
  std::vector<std::vector<int>> row_variables;    ///< of each row, those with a Jacobian entry
  std::vector<std::vector<double>> coefficients;  ///< of each of them in the row's linear part
  std::vector<int> column_start;                  ///< n_var + 1: of the Jacobian by columns, rows ascending
  std::vector<std::vector<Mention>> mentions;     ///< of each row's expression
  std::vector<std::vector<Mention>> definitions;  ///< of each defined variable

  NlGraph expressions;
  std::vector<NlAnchor> anchors;  ///< ascending; see segments()

  std::string at(Place place) const;
  /// The segments as AMPL's library is to read them. It counts its derivatives wrongly, up to a crash, where the first
  /// thing that could have one is a min, max or if that has none, and it loses that of a row that is a single variable.
  /// There the expression e becomes 0 v + e.
  std::string segments(std::string_view bytes) const;
  /// The rows whose expression depends on the defined variable `number`.
  std::vector<int> rows_using(int number) const;
};

/// Throws ModelError(bad_file) naming file, place and reason.
NlModel check_nl(const std::string& file, std::string_view bytes);

}  // namespace perp::ncp::ampl

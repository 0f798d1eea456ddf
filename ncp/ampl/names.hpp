// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Names from the .col and .row files beside an .nl file: one a line, in the order of the model.
#include <string>
#include <vector>

namespace perp::ncp::ampl {

class Names {
 public:
  Names() = default;
  /// Reads STUB.col and STUB.row; either may be absent or short.
  Names(const std::string& stub, int n_var, int n_con);

  std::string variable(int i) const;  ///< AMPL's _svar[i + 1] if the file has none
  std::string row(int i) const;       ///< _scon[i + 1]
  /// "a, b, c and 12 more"
  static std::string list(const std::vector<std::string>& names);
  /// Returns whether all variables and rows have a name of the files.
  bool complete() const { return complete_; }

 private:
  std::vector<std::string> variables_, rows_;
  bool complete_ = false;
};

}  // namespace perp::ncp::ampl

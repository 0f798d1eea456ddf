// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A model inside AMPL's solver library: the values and first derivatives of its rows. The library keeps global state
/// and ends the process over errors; nothing of either is seen here: one lock guards every call of it, its error jumps
/// are caught, what it prints is captured, and the floating-point environment is put back.
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace perp::ncp::ampl {

class AslProblem {
 public:
  /// What a file that passed check_nl() must still agree with when the library opens it.
  struct Sizes {
    int n_var = 0, n_con = 0, n_obj = 0, n_cc = 0, nonzeros = 0, defined = 0;
    bool binary = false;
  };
  /// STUB.nl, whose segments are `body`: they are read from memory, so that the library sees what was checked.
  /// Throws ModelError with the library's message.
  AslProblem(const std::string& stub, std::string_view body, const Sizes& sizes);
  AslProblem(const AslProblem&) = delete;
  AslProblem& operator=(const AslProblem&) = delete;
  ~AslProblem();

  /// c := c(x), n_con values. false: some row is not defined at x.
  bool values(const double* x, double* c) const;
  /// The nonzeros of c'(x) by columns, rows ascending. false: some row has no derivative at x.
  bool jacobian(const double* x, double* nonzeros) const;

  /// What `values` cannot say: evaluates the rows one by one.
  struct RowByRow {
    std::vector<char> defined;   ///< n_con
    std::vector<char> overflow;  ///< n_con: not defined because it was too large on the way, exp(800) for instance
    bool evaluated = true;       ///< false: a defined variable has no value, so that no row was evaluated
    int definition = -1;         ///< its number then
    bool definition_overflow = false;
  };
  RowByRow values_by_row(const double* x, double* c) const;
  /// As `jacobian`, for the rows marked only; the nonzeros of others stay.
  bool jacobian_of(const std::vector<char>& rows, const double* x, double* nonzeros) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace perp::ncp::ampl

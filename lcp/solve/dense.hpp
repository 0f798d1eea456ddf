// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A door for small dense problems that are solved often, such as a simulator's: no sparse copy, no classes of M, and
/// memory that is kept from problem to problem.
///
///     perp::lcp::DenseSolver solver;
///     const perp::lcp::Result& result = solver.solve(M, q, lower, upper);
#include "lcp/judge/result.hpp"
#include "lcp/pivoting/dense_pivoting.hpp"

namespace perp::lcp {

/// Solves MCP(lower, upper, M z + q) by block principal pivoting (lcp/pivoting/dense_pivoting.hpp). What that does not
/// solve, such as most problems whose M is no P-matrix, Auto does (lcp/solve/solve.hpp). Result::iterations counts
/// rounds. One thread at a time.
class DenseSolver {
 public:
  /// Any strides: matrices by rows are given as a Map with strides (1, n).
  using Matrix = Eigen::Ref<const Eigen::MatrixXd, 0, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>;

  /// Begins in the cell of the last solution, if it had as many variables. The result is valid until the next call.
  /// Throws std::invalid_argument for malformed input.
  const Result& solve(const Matrix& M, In q, In lower, In upper, const Limits& limits = {});
  /// Begins the next solve at the bounds.
  void forget() { cells_.clear(); }

 private:
  void take(const Matrix& M, In q, In lower, In upper, double tol);
  void enter();
  bool judged_solution(double tol);

  DenseMcp problem_;
  Cells cells_;
  DensePivoting pivoting_;
  Result result_;
};

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Feasible steps of least residual,
///     min_d  1/2 ||Phi + H d||^2 + nu/2 ||d||^2   over   l <= x + d <= u,
/// the subproblem of NE/SQP (Pang & Gabriel 1993); private to ncp/. H'H is not formed: with r = Phi + H d the
/// optimality conditions are the monotone affine MCP in (r, d)
///     r - H d - Phi = 0  (r free),    H'r + nu d  complementary to  d in [l - x, u - x],
/// with M = [I -H; H' nu I], in units of ||Phi||_inf. Lemke's path from the last step's cells is tried first, which
/// takes few pivots from a near point; then interior points, which take some 20 factorizations from anywhere.
#include <vector>

#include "lcp/lu/sparse_lu.hpp"
#include "ncp/reformulation/merit.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {

struct LeastSquaresStep {
  enum class End {
    Found,
    Failed,   ///< none of the solvers has come to its tolerance
    Stopped,  ///< interrupted, or past the deadline: go_on() says which
  };
  End end = End::Failed;
  Vec d{};           ///< feasible: x + d in the box
  double model = 0;  ///< Phi'H d <= -||H d||^2, a bound of theta'(x; d)
};

class LeastSquaresSteps {
 public:
  explicit LeastSquaresSteps(Run& run) : run_(run) {}

  /// Pre: x in the box; lin is of natural_min() there; nu >= 0.
  LeastSquaresStep solve(const Linearisation& lin, const Vec& x, double nu);

  int take_pivots() { return std::exchange(pivots_, 0); }

 private:
  Run& run_;
  std::vector<lcp::Cell> cells_;  // of the last solution
  int pivots_ = 0;
};

}  // namespace perp::ncp

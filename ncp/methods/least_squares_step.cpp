// SPDX-License-Identifier: Apache-2.0
#include "ncp/methods/least_squares_step.hpp"

#include <algorithm>

#include "lcp/iterative/interior_point.hpp"
#include "lcp/pivoting/lemke.hpp"
#include "ncp/path/newton_point.hpp"

namespace perp::ncp {
namespace {

/// M = [I -H; H' nu I], q = (-Phi, 0), everything in units of `unit`.
lcp::AffineMcp conditions(const Linearisation& lin, const Box& box, const Vec& x, double nu, double unit) {
  const Index n = x.size();
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(2 * (lin.H.nonZeros() + n)));
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 1.0);
    if (nu > 0) entries.emplace_back(static_cast<int>(n) + i, static_cast<int>(n) + i, nu);
  }
  for (Index j = 0; j < n; ++j)
    for (SpMat::InnerIterator it(lin.H, j); it; ++it) {
      if (it.value() == 0) continue;
      const int i = static_cast<int>(it.row());
      const int column = static_cast<int>(n + j);
      entries.emplace_back(i, column, -it.value());
      entries.emplace_back(column, i, it.value());
    }
  lcp::AffineMcp problem{.M = SpMat(2 * n, 2 * n), .q = Vec(2 * n), .box = Box::free(2 * n)};
  problem.M.setFromTriplets(entries.begin(), entries.end());
  problem.q << -lin.at.Phi / unit, Vec::Zero(n);
  problem.box.lower.tail(n) = (box.lower - x) / unit;
  problem.box.upper.tail(n) = (box.upper - x) / unit;
  return problem;
}

/// Lemke's path is followed for so many pivots: from a near point few are needed, and a long path costs more than
/// interior points do.
int path_pivots(Index n) { return 50 + static_cast<int>(std::min<Index>(n, 1000)); }

}  // namespace

LeastSquaresStep LeastSquaresSteps::solve(const Linearisation& lin, const Vec& x, double nu) {
  const Index n = x.size();
  const double size = lin.at.Phi.lpNorm<Eigen::Infinity>();
  const double unit = size > 0 ? size : 1;
  const lcp::AffineMcp problem = conditions(lin, run_.box(), x, nu, unit);
  const auto step_along = [&](const Vec& d) {
    LeastSquaresStep step{.end = LeastSquaresStep::End::Found, .d = lcp::project(run_.box(), x + unit * d) - x};
    step.model = lin.at.Phi.dot(lin.H * step.d);
    return step;
  };

  if (!finite(problem) || !lin.gradient.allFinite()) return {.end = LeastSquaresStep::End::Failed, .d = Vec::Zero(n)};
  lcp::LemkeOptions options;
  options.max_pivots = path_pivots(n);
  options.deadline = run_.deadline();
  options.interrupted = [this] { return run_.interrupted(); };
  if (cells_.size() == static_cast<std::size_t>(2 * n)) options.cells = cells_;
  Vec start(2 * n);
  start << lin.at.Phi / unit, -lin.gradient / unit;
  const lcp::PivotResult path = lcp::lemke(problem, start, options);
  pivots_ += path.pivots;
  run_.stats().factorizations += path.refactorizations;
  if (path.solved()) {
    cells_ = path.cells;
    return step_along(path.z.tail(n));
  }
  cells_.clear();

  start.tail(n).setZero();
  const lcp::Limits limits{.tol = subproblem_tol(problem), .deadline = run_.deadline(), .interrupted = [this] {
                             return run_.interrupted();
                           }};
  const lcp::Result interior = lcp::interior_point(problem, start, {}, limits);
  run_.stats().factorizations += interior.factorizations;
  if (interior.status == Status::Interrupted || interior.status == Status::TimeLimit)
    return {.end = LeastSquaresStep::End::Stopped};
  LeastSquaresStep step = step_along(interior.z.tail(n));
  if (!interior.accepted()) step.end = LeastSquaresStep::End::Failed;
  return step;
}

}  // namespace perp::ncp

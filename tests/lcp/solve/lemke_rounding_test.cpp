// SPDX-License-Identifier: Apache-2.0
/// Lemke's method on linear programs whose numbers are so large that the tolerance is near the rounding of the rows.
#include <gtest/gtest.h>

#include <cmath>

#include "lcp/judge/judge.hpp"
#include "lcp/solve/solve.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::Random;

/// min c'x, A x = b, x >= 0, with an optimal x of integers of size 10^6, degenerate as primal and dual; rows of A have
/// sizes of 0.1 to 100.
AffineMcp large_numbers(Random& random) {
  const Index m = random.integer(5, 30), n = m + random.integer(5, 30);
  Dense A = (random.normals(m, n) * 2).array().round();
  for (Index i = 0; i < m; ++i) A.row(i) *= std::pow(10.0, std::round(random.normals(1)[0] / 2));
  Vec x = (random.normals(n).cwiseMax(0) * 1e6).array().round();
  Vec slack = random.normals(n).cwiseMax(0);
  for (Index i = 0; i < n; ++i) {
    if (i % 3 == 0) x[i] = 0;
    if (x[i] > 0 || i % 2 == 0) slack[i] = 0;
  }
  Dense M = Dense::Zero(n + m, n + m);
  M.topRightCorner(n, m) = -A.transpose();
  M.bottomLeftCorner(m, n) = A;
  AffineMcp problem{M.sparseView(), Vec(n + m), Box::free(n + m)};
  problem.q << A.transpose() * random.normals(m) + slack, -A * x;
  problem.box.lower.head(n).setZero();
  return problem;
}

// The terms of a row are up to 1e8, and 1e-8 is their rounding. Catches an end that is judged by sums in doubles, which
// hide as much as they show, and Harris' tolerance, in equilibrated units, where the last cells are decided: 23 of 50
// then are not solved, beside 3.
TEST(LemkeRounding, TheLastDigitsAreThoseOfExactSums) {
  Random random(5);
  int solved = 0;
  for (int k = 0; k < 50; ++k) {
    const AffineMcp problem = large_numbers(random);
    Lemke lemke;
    lemke.options.start = LemkeStart::Ray;
    const Result result = solve(problem, Vec::Zero(problem.size()), lemke, Limits{.tol = 1e-8});
    solved += result.solved();
    EXPECT_EQ(result.solved(), judge(problem, result.z).natural <= 1e-8);
  }
  EXPECT_GE(solved, 40);
}

}  // namespace
}  // namespace perp::lcp

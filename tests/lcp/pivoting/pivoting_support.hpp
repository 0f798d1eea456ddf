// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the suites of the pivoting methods share: problems with known solutions.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "lcp/judge/judge.hpp"
#include "lcp/judge/result.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {

inline double norm_inf(const Vec& v) { return v.size() > 0 ? v.lpNorm<Eigen::Infinity>() : 0; }

/// Solved, and the independent judge agrees: `tol` is absolute.
inline void expect_solved(const AffineMcp& problem, const Result& result, const std::string& what, double tol = 2e-9) {
  EXPECT_EQ(result.status, Status::Solved) << what << ": " << result.message;
  if (!result.solved()) return;
  EXPECT_LE(support::violation(problem, result.z), tol) << what;
  EXPECT_EQ(result.residual, judge(problem, result.z).natural) << what;
}

/// The result says the truth about its point: in the box, residual as told, Solved only within the tolerance, and a
/// certificate that proves something.
inline void expect_honest(const AffineMcp& problem, const Result& result, const std::string& what) {
  ASSERT_EQ(result.z.size(), problem.size()) << what;
  EXPECT_EQ(result.z, project(problem.box, result.z)) << what << ": not in the box";
  if (result.solved()) {
    EXPECT_LE(support::violation(problem, result.z), 2e-9) << what;
  }
  if (result.status == Status::Infeasible && result.certificate.size() > 0) {
    EXPECT_TRUE(proves_infeasible(problem, result.certificate)) << what;
  }
  if (!result.solved()) {
    EXPECT_FALSE(result.message.empty()) << what;
  }
}

/// An affine MCP whose only solution (M is P) is planted; degenerate (F_i = 0 at a bound) with the given probability.
struct PlantedLinear {
  AffineMcp problem;
  Vec solution;
};
inline PlantedLinear plant(const SpMat& M, const Box& box, double degenerate, support::Random& random) {
  const Index n = M.rows();
  Vec z(n);
  Vec F(n);
  for (Index i = 0; i < n; ++i) {
    const bool lower = std::isfinite(box.lower[i]);
    const bool upper = std::isfinite(box.upper[i]);
    z[i] = random.normal();
    if (lower && upper)
      z[i] = box.lower[i] + random.uniform(0.1, 0.9) * (box.upper[i] - box.lower[i]);
    else if (lower)
      z[i] = box.lower[i] + random.uniform(0.1, 2);
    else if (upper)
      z[i] = box.upper[i] - random.uniform(0.1, 2);
    F[i] = 0;
    const double size = random.chance(degenerate) ? 0 : random.uniform(0.1, 2);
    if (lower && random.chance(0.4))
      z[i] = box.lower[i], F[i] = size;
    else if (upper && random.chance(0.5))
      z[i] = box.upper[i], F[i] = -size;
    if (lower && upper && box.lower[i] == box.upper[i]) z[i] = box.lower[i], F[i] = random.normal();
  }
  return {{M, F - M * z, box}, z};
}

/// Murty's right-hand side -(2^n, 2^n + 2^(n-1), ..., 2^n + ... + 2) with I + 2 (strict upper triangle): the
/// least-index and complementary pivoting methods take 2^n - 1 steps (Murty 1978).
inline AffineMcp murty_1978(Index n) {
  Vec q(n);
  double sum = 0;
  for (Index i = 0; i < n; ++i) q[i] = -(sum += std::ldexp(1, static_cast<int>(n - i)));
  return standard_lcp(SpMat(support::murty(n).transpose()), q);
}

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#include "lcp/judge/judge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lcp/solve/solve.hpp"

namespace perp::lcp {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();

AffineMcp diagonal(const Vec& d, Vec q) {
  SpMat M(d.size(), d.size());
  for (Index i = 0; i < d.size(); ++i) M.insert(i, i) = d[i];
  return standard_lcp(M, std::move(q));
}

AffineMcp dense(const Eigen::MatrixXd& M, Vec q, Box box) { return {M.sparseView(), std::move(q), std::move(box)}; }

// 1e17 + 1 - 1e17: plain sums lose the 1 in any order that adds it to 1e17 first. Catches a judge that sums in double.
TEST(Judge, SumsWithoutRounding) {
  Eigen::MatrixXd M(2, 2);
  M << 1e17, 1, 0, 1;
  const Vec z = Vec::Ones(2);
  const Judgement judgement = judge(dense(M, Eigen::Vector2d(-1e17, -1), Box::free(2)), z);
  EXPECT_EQ(judgement.F, Vec(Eigen::Vector2d(1, 0)));
  EXPECT_EQ(judgement.natural, 1);
  EXPECT_EQ(judgement.worst, 0);
  EXPECT_NEAR(judgement.accuracy.relative, 1 / 2e17, 1e-20);
  EXPECT_TRUE(judgement.accuracy.to_rounding);  // 1 <= 8 (2 + 2) eps 2e17
}

// r_0 = 64 eps t with n_0 = 1 is beyond 8 (1 + 2) eps t, though the norm of all rows hides it behind row 1's size.
// Catches a test by one global norm.
TEST(Judge, RoundingIsAskedOfEveryRow) {
  const AffineMcp problem =
      dense(Eigen::Vector2d(1, 1).asDiagonal().toDenseMatrix(), Eigen::Vector2d(-1, -1e30), Box::free(2));
  const auto at = [&](double first) { return judge(problem, Eigen::Vector2d(first, 1e30)).accuracy; };
  EXPECT_TRUE(at(1 + 16 * eps).to_rounding);
  EXPECT_FALSE(at(1 + 64 * eps).to_rounding);
  EXPECT_NEAR(at(1 + 64 * eps).relative, 32 * eps, eps);
  EXPECT_EQ(at(1 + 64 * eps).worst, 0);
}

// 0 z + 0: t_i = 0 and r_i = 0 is no residual at all; with q_i != 0 and z_i far from its bound r_i / t_i is 1.
TEST(Judge, EmptyRows) {
  const AffineMcp nothing = diagonal(Vec::Zero(1), Vec::Zero(1));
  EXPECT_EQ(judge(nothing, Vec::Ones(1)).accuracy.relative, 0);
  EXPECT_TRUE(judge(nothing, Vec::Ones(1)).accuracy.to_rounding);
  const Judgement constant = judge(diagonal(Vec::Zero(1), Vec::Ones(1)), Vec::Constant(1, 5));
  EXPECT_EQ(constant.natural, 1);
  EXPECT_EQ(constant.accuracy.relative, 1);
  EXPECT_FALSE(constant.accuracy.to_rounding);
}

TEST(Judge, WhatIsNotFiniteIsNoSolution) {
  const AffineMcp problem = diagonal(Vec::Constant(1, 1e300), Vec::Ones(1));
  EXPECT_EQ(judge(problem, Vec::Constant(1, 1e300)).natural, infinity);
  EXPECT_FALSE(judge(problem, Vec::Constant(1, 1e300)).accuracy.to_rounding);
  EXPECT_EQ(judge(problem, Vec::Constant(1, std::nan(""))).natural, infinity);
  EXPECT_THROW(judge(problem, Vec::Ones(2)), std::invalid_argument);
}

// The tolerance is absolute, whatever the size of q: at z = 0 the residual is 0.0009 and 0.5. Catches a test relative
// to 1 + ||q||, by every method.
TEST(Judge, HugeEntriesOfQExcuseNothing) {
  const struct { double huge, small, tol; } cases[] = {{1e9, -0.0009, 1e-8}, {1e12, -0.5, 1e-12}};
  for (const auto& [huge, small, tol] : cases) {
    const AffineMcp problem = diagonal(Vec::Ones(2), Eigen::Vector2d(huge, small));
    EXPECT_FALSE(solves(problem, Vec::Zero(2), 1e-4));
    for (const MethodEntry& entry : methods()) {
      const Result result = solve(problem, Vec::Zero(2), entry.method, {.tol = tol});
      EXPECT_EQ(result.solved(), judge(problem, result.z).natural <= tol) << entry.name;
      if (entry.name == "auto") {
        EXPECT_NEAR(result.z[1], -small, tol);
      }
    }
  }
}

// x_2 = 1e17 + 1 is no double: |F_2| >= 1 at every double x_2 next to it. Solved to 1e-8 cannot be said; that doubles
// end here can. Catches Solved by rounding, and NoProgress where nothing is left to gain.
TEST(Judge, SolvedToRounding) {
  Eigen::MatrixXd M(2, 2);
  M << 1, 0, 1, 1;
  const AffineMcp problem = dense(M, Eigen::Vector2d(1, -1e17), Box::free(2));
  for (const char* name : {"auto", "lemke", "principal-pivoting", "block-pivoting"}) {
    const auto entry = std::ranges::find(methods(), name, &MethodEntry::name);
    ASSERT_NE(entry, methods().end());
    const Result result = solve(problem, Vec::Zero(2), entry->method);
    EXPECT_EQ(result.status, Status::SolvedToRounding) << name << ": " << result.message;
    EXPECT_FALSE(result.solved());
    EXPECT_TRUE(result.accepted());
    EXPECT_EQ(result.residual, 1) << name;
  }
}

// z_1 - z_2 = 1/4 and z_2 - z_1 = 1/4 have no solution, but at z = (1e16, 1e16) both residuals are within the rounding
// of their terms. Catches SolvedToRounding bought by running off.
TEST(Judge, RunningOffIsNotSolvedToRounding) {
  Eigen::MatrixXd M(2, 2);
  M << 1, -1, -1, 1;
  const AffineMcp problem = dense(M, Eigen::Vector2d(-0.25, -0.25), Box::nonnegative(2));
  const Vec z = Vec::Constant(2, 1e16);
  EXPECT_TRUE(judge(problem, z).accuracy.to_rounding);
  EXPECT_EQ(judged(problem, z, {}, Status::Stalled, "ran off").status, Status::Stalled);
  M(1, 1) = 1 + eps;  // nonsingular by a rounding
  const AffineMcp nearly = dense(M, Eigen::Vector2d(-0.25, -0.25), Box::nonnegative(2));
  EXPECT_EQ(judged(nearly, 10 * z, {}, Status::Stalled, "ran off").status, Status::Stalled);
}

// Not granted to a point that is merely near: 1e-3 beside terms of 1 is no rounding.
TEST(Judge, NearIsNotSolvedToRounding) {
  const AffineMcp problem = diagonal(Vec::Ones(1), Vec::Constant(1, -1));
  const Result result = judged(problem, Vec::Constant(1, 1.001), {}, Status::Stalled, "stopped");
  EXPECT_EQ(result.status, Status::Stalled);
  EXPECT_EQ(result.message, "stopped");
  EXPECT_NEAR(result.residual, 1e-3, 1e-15);
  EXPECT_NEAR(result.relative, 1e-3 / 2.001, 1e-15);
}

// From a point with half of its digits, one factorization brings all of them: the system's solution is (1, 1).
TEST(Judge, RefinedHasAllDigits) {
  Eigen::MatrixXd M(2, 2);
  M << 1e8, 1, 1, 2;
  const AffineMcp problem = dense(M, Eigen::Vector2d(-1e8 - 1, -3), Box::nonnegative(2));
  const Vec z = refined(problem, Eigen::Vector2d(1 + 1e-9, 1 - 1e-8), 1e-9);
  EXPECT_EQ(judge(problem, z).natural, 0);
}

}  // namespace
}  // namespace perp::lcp

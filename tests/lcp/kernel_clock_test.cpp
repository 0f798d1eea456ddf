// SPDX-License-Identifier: Apache-2.0
#include "lcp/kernel_clock.hpp"

#include <gmock/gmock.h>

#include <thread>

#include "lcp/cholesky/cholesky.hpp"
#include "lcp/lu/sparse_lu.hpp"
#include "lcp/memory.hpp"
#include "lcp/solve/solve.hpp"

namespace perp::lcp {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

Deadline in(std::chrono::nanoseconds time) { return std::chrono::steady_clock::now() + time; }

/// Five points on an m x m grid, shifted. Factors have some 31 m^2 log2(m) entries (George 1973).
SpMat grid(Index m, double shift = 0.1) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](Index i, Index j, double v) {
    entries.emplace_back(static_cast<int>(i), static_cast<int>(j), v);
  };
  for (Index i = 0; i < m * m; ++i) {
    add(i, i, 4 + shift);
    if (i % m > 0) add(i, i - 1, -1), add(i - 1, i, -1);
    if (i >= m) add(i, i - m, -1), add(i - m, i, -1);
  }
  SpMat A(m * m, m * m);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

// 1e15 operations take hours on any machine, and 1e6 no time. Catches a clock that refuses, or begins, everything.
TEST(KernelClock, BeginsWhatFits) {
  KernelClock clock(in(1s));
  EXPECT_NO_THROW(clock.before(100, {.flops = 1e6}));
  EXPECT_THROW(clock.before(100000, {.flops = 1e15}), KernelTooLong);
  EXPECT_NO_THROW(KernelClock().before(100000, {.flops = 1e15}));
  EXPECT_NO_THROW(KernelClock(in(24h * 365 * 100)).before(100000, {.flops = 1e15}));
  EXPECT_NO_THROW(KernelClock(in(-1s)).before(10, {.flops = 1e3}));  // not worth a refusal
}

// What the first call took decides about the second, whatever the machine was taken for.
TEST(KernelClock, LearnsTheRate) {
  KernelClock clock(in(100s));
  const KernelCost cost{.flops = 1e9};
  clock.before(1000, cost);
  std::this_thread::sleep_for(50ms);
  clock.after(cost);
  EXPECT_GE(clock.longest(), 0.05);
  EXPECT_THROW(clock.before(1000, {.flops = 1e13}), KernelTooLong);  // 500 s
  try {
    clock.before(1000, {.flops = 1e13});
  } catch (const KernelTooLong& error) {
    EXPECT_THAT(error.what(), HasSubstr("a factorization of 1000 rows takes about "));
    EXPECT_THAT(error.what(), HasSubstr(" s are left"));
  }
}

TEST(KernelClock, RefusesWhatDoesNotFitInMemory) {
  EXPECT_THROW(KernelClock().before(100, {.bytes = 1e18}), NotEnoughMemory);
}

// A deadline that has passed: the analyses must give an estimate at all. Grids of 250,000 unknowns take 1e9 operations
// and more (UMFPACK, CHOLMOD), the dense block of KLU's 2e9 / 3.
TEST(KernelClock, EveryLibraryEstimates) {
  const SpMat A = grid(500);
  EXPECT_THROW((void)SparseLu(LuBackend::General, in(-1s)).factor(A), KernelTooLong);
  EXPECT_THROW((void)Cholesky(in(-1s)).factor(A), KernelTooLong);
  EXPECT_THROW((void)SparseLu(LuBackend::Auto, in(-1s)).factor(A), KernelTooLong);
  const SpMat dense = Eigen::MatrixXd(Eigen::MatrixXd::Random(1000, 1000)).sparseView();
  EXPECT_THROW((void)SparseLu(LuBackend::Klu, in(-1s)).factor(dense), KernelTooLong);
  EXPECT_THROW((void)SparseLu(LuBackend::General, in(-1s)).factor(dense), KernelTooLong);
  SparseLu in_time(LuBackend::General, in(1h));
  EXPECT_EQ(in_time.factor(A), LuStatus::Ok);
  EXPECT_GT(in_time.longest_call(), 0);
}

// The methods end with their best point, by name, and throw nothing.
TEST(KernelClock, MethodsEndInTime) {
  AffineMcp problem{.M = grid(400, 0), .q = Vec::Constant(160000, -1), .box = {}};
  problem.box = {Vec::Zero(160000), Vec::Constant(160000, infinity)};
  for (const Method& method : {Method(InteriorPoint{}), Method(BlockPivoting{}), Method(Lemke{})}) {
    SCOPED_TRACE(name(method));
    Result result;
    ASSERT_NO_THROW(result = solve(problem, Vec::Ones(160000), method, {.deadline = in(1ms)}));
    EXPECT_EQ(result.status, Status::TimeLimit) << result.message;
    EXPECT_EQ(result.z.size(), 160000);
  }
}

}  // namespace
}  // namespace perp::lcp

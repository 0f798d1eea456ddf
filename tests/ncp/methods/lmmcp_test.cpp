// SPDX-License-Identifier: Apache-2.0
#include "ncp/methods/lmmcp.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "collection/collection.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/matrices.hpp"

namespace perp::ncp {
namespace {

// Kojima & Shindo's and Josephy's problems from their published starts (Kanzow & Petra 2004 solve both from all).
// Catches a sign in one of the two parts of H: the convergence is lost.
TEST(Lmmcp, SolvesTheClassicsFast) {
  for (const char* name : {"kojshin", "josephy"}) {
    const collection::Problem given = collection::find(name)->make();
    for (const Vec& start : given.starts) {
      const Result result = solve(*given.mcp, start, Lmmcp{});
      EXPECT_TRUE(result.solved()) << name << ": " << result;
      EXPECT_LE(result.stats.iterations, 40) << name;
    }
  }
}

// The last steps to a regular solution: residuals r, r^2, ... Catches an H that is not of the function.
TEST(Lmmcp, ConvergesQuadratically) {
  const collection::Problem given = collection::find("josephy")->make();
  std::vector<Iteration> records;
  ASSERT_TRUE(solve(*given.mcp, given.starts[0], Lmmcp{.stop = {.tol = 1e-13}}, record(records)).solved());
  ASSERT_GE(records.size(), 4U);
  const double last = records[records.size() - 2].residual, before = records[records.size() - 3].residual;
  EXPECT_LE(last, 10 * before * before + 1e-13);
}

// Variables with a lower bound, an upper one, both, none, and fixed; M is strongly monotone, so that there is exactly
// one solution. Catches a product of the wrong bound.
TEST(Lmmcp, TakesEveryKindOfBounds) {
  const SpMat M =
      support::matrix({{4, 1, 0, -1, 0}, {-1, 5, 1, 0, 0}, {0, 1, 4, 0, 1}, {1, 0, 0, 3, 0}, {0, 0, 1, 0, 2}});
  const Box box{Vec{{0, -infinity, -1, -infinity, 2}}, Vec{{infinity, 1, 1, infinity, 2}}};
  for (const double size : {-8.0, -1.0, 1.0, 8.0}) {
    const auto mcp = make_affine_mcp({M, Vec{{size, -size, 2 * size, 1, size}}, box}, "bounds");
    const Result result = solve(*mcp, Vec::Ones(5), Lmmcp{});
    EXPECT_TRUE(result.solved()) << size << ": " << result;
  }
}

// Steps of the preprocessor are told apart in the records. Catches a second phase that never had one before it.
TEST(Lmmcp, BeginsWithThePreprocessor) {
  const collection::Problem given = collection::find("kojshin")->make();
  std::vector<Iteration> records;
  (void)solve(*given.mcp, given.starts[0], Lmmcp{}, record(records));
  EXPECT_GT(std::ranges::count(records, 'P', &Iteration::kind), 0);
}

// Billups' problem has a local minimum of every merit function near its start. Catches a run that claims more.
TEST(Lmmcp, EndsAtLocalMinima) {
  const collection::Problem given = collection::find("billups")->make();
  const Result result = solve(*given.mcp, given.starts[0], Lmmcp{});
  EXPECT_TRUE(result.solved() || result.status == Status::NoProgress || result.status == Status::IterationLimit)
      << result;
}

}  // namespace
}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/residual.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::nan;
using support::Random;
using support::vec;

double natural(double l, double u, double x, double F) {
  return residual(Box{vec({l}), vec({u})}, vec({x}), vec({F})).natural;
}

// |x - mid(l, x - F, u)| by hand, for every kind of interval, at and beside its bounds. Catches swapped bounds, a sign
// of F, and non-solutions that are judged solved: x = u with F > 0, x = l with F < 0, points outside the box.
TEST(Residual, ByHand) {
  EXPECT_EQ(natural(-infinity, infinity, 5, 0), 0);
  EXPECT_EQ(natural(-infinity, infinity, 5, -0.25), 0.25);
  EXPECT_EQ(natural(0, infinity, 0, 7), 0);
  EXPECT_EQ(natural(0, infinity, 0, -7), 7);
  EXPECT_EQ(natural(0, infinity, 2, 7), 2);
  EXPECT_EQ(natural(0, infinity, 7, 2), 2);
  EXPECT_EQ(natural(0, infinity, -1, 0), 1);
  EXPECT_EQ(natural(-infinity, 3, 3, -7), 0);
  EXPECT_EQ(natural(-infinity, 3, 3, 7), 7);
  EXPECT_EQ(natural(-infinity, 3, 1, -7), 2);
  EXPECT_EQ(natural(-infinity, 3, 4, 0), 1);
  EXPECT_EQ(natural(-1, 3, -1, 7), 0);
  EXPECT_EQ(natural(-1, 3, 3, -7), 0);
  EXPECT_EQ(natural(-1, 3, -1, -7), 4);  // to the other bound
  EXPECT_EQ(natural(-1, 3, 3, 7), 4);
  EXPECT_EQ(natural(2, 2, 2, 1e300), 0);  // F is free where l = u
  EXPECT_EQ(natural(2, 2, 5, -1e300), 3);
}

// Zero exactly at points that fulfil mcp.hpp's sign conditions, and in the box no larger than the conditions are
// violated. Random points in mixed boxes, half of them made solutions.
TEST(Residual, AgreesWithTheSignConditions) {
  Random random(1);
  int solutions = 0;
  for (int k = 0; k < 2000; ++k) {
    const Box box = support::mixed_box(4, random);
    const Vec x = lcp::project(box, random.normals(4));
    Vec F = random.normals(4);
    if (random.chance(0.5))
      for (Index i = 0; i < 4; ++i)
        F[i] = x[i] == box.lower[i] ? std::abs(F[i]) : x[i] == box.upper[i] ? -std::abs(F[i]) : 0;
    const double wrong = support::violation(box, x, F);
    solutions += wrong == 0;
    ASSERT_DOUBLE_EQ(residual(box, x, F).natural, wrong);
  }
  EXPECT_GT(solutions, 500);
  EXPECT_LT(solutions, 1500);
}

// x - (x - F) loses F beside a large x: x = 1e17 with F = 1 is no solution, nor is x = 1e9 with F = 5e-8. Catches a
// judge that calls every point with large variables solved.
TEST(Residual, SeesFBesideLargeVariables) {
  EXPECT_EQ(natural(-infinity, infinity, 1e17, 1), 1);
  EXPECT_EQ(natural(0, infinity, 1e9, 5e-8), 5e-8);
  EXPECT_EQ(natural(-infinity, 0, -1e9, -5e-8), 5e-8);
  EXPECT_EQ(natural(-1e17, 1e17, 1e16, -1e-3), 1e-3);
  EXPECT_EQ(natural(1e17, infinity, 1e17, 1), 0);
}

TEST(Residual, NamesTheWorstRow) {
  const Box box = Box::nonnegative(4);
  EXPECT_EQ(residual(box, vec({1, 1, 1, 1}), vec({0.1, -3, 2, 0})).worst, 1);
  EXPECT_EQ(residual(box, vec({0, 0, 0, 0}), vec({1, 1, 1, 1})).worst, 0);  // of a solution any
  EXPECT_EQ(residual(Box::free(0), Vec(0), Vec(0)).worst, -1);
  EXPECT_EQ(residual(Box::free(0), Vec(0), Vec(0)).natural, 0);
}

// Catches maxima that a NaN passes unseen (max(r, NaN) = r), which would call such a point solved.
TEST(Residual, IsInfiniteAtTheRowThatIsNotFinite) {
  const Box box = Box::nonnegative(3);
  for (const double bad : {nan, infinity, -infinity})
    for (Index i = 0; i < 3; ++i) {
      Vec F = Vec::Zero(3);
      F[i] = bad;
      const Residual r = residual(box, Vec::Zero(3), F);
      EXPECT_EQ(r.natural, infinity) << bad;
      EXPECT_EQ(r.worst, i) << bad;
      const Residual at_bad_x = residual(box, F, Vec::Zero(3));
      EXPECT_EQ(at_bad_x.natural, infinity) << bad;
      EXPECT_EQ(at_bad_x.worst, i) << bad;
    }
}

// ||x - mid(l, x, u)||_inf and the larger of ||min(x - l, F+)||_inf, ||min(u - x, F-)||_inf by hand.
TEST(Residual, TellsBoundsAndComplementarityApart) {
  const Box box{vec({0, -infinity, 0}), vec({infinity, 2, 4})};
  const Residual outside = residual(box, vec({-0.5, 5, 1}), vec({0, 0, 0}));
  EXPECT_EQ(outside.bounds, 3);
  EXPECT_EQ(outside.complementarity, 0);
  const Residual inside = residual(box, vec({2, 1, 1}), vec({0.5, -0.75, -8}));
  EXPECT_EQ(inside.bounds, 0);
  EXPECT_EQ(inside.complementarity, 3);  // min(4 - 1, 8)
  EXPECT_EQ(inside.natural, 3);
}

// Catches an undefined F whose output, all zeros, is judged.
TEST(Residual, IsInfiniteWhereFIsNotDefined) {
  Functions functions = support::scalar(
      0, infinity, [](double x) { return std::log(x); }, [](double x) { return 1 / x; });
  const auto log = make_mcp(functions);
  EXPECT_EQ(residual(*log, vec({1})).natural, 0);
  EXPECT_EQ(residual(*log, vec({0})).natural, infinity);
  EXPECT_EQ(residual(*log, vec({0})).worst, 0);
  EXPECT_EQ(residual(*log, vec({-1})).natural, infinity);

  functions.F = [](In, Out) { return false; };  // says so without marking a row
  const auto nowhere = make_mcp(functions);
  EXPECT_EQ(residual(*nowhere, vec({0})).natural, infinity);
  EXPECT_EQ(residual(*nowhere, vec({0})).worst, -1);
}

// Catches reading beyond the end of a vector of another length.
TEST(Residual, RefusesVectorsOfAnotherLength) {
  const Box box = Box::nonnegative(2);
  EXPECT_THROW(residual(box, vec({1, 2, 3}), vec({1, 2})), std::invalid_argument);
  EXPECT_THROW(residual(box, vec({1, 2}), vec({1})), std::invalid_argument);
  const auto mcp = make_mcp(support::billups());
  EXPECT_THROW(residual(*mcp, vec({1, 2})), std::invalid_argument);
}

}  // namespace
}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#include "lcp/box.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::nan;
using support::vec;
using testing::HasSubstr;

Box interval(double lower, double upper) { return {vec({lower}), vec({upper})}; }

// mid(l, z, u) by hand. Catches swapped bounds, and infinite bounds that act.
TEST(Box, ProjectsEveryKindOfInterval) {
  const Box box{vec({0, -infinity, -1, -infinity, 3, 0}), vec({infinity, 2, 1, infinity, 3, 5})};
  EXPECT_EQ(project(box, vec({-4, 7, -9, 1e300, 8, 2})), vec({0, 2, -1, 1e300, 3, 2}));
  EXPECT_EQ(project(box, vec({4, -7, 9, -1e300, -8, 6})), vec({4, -7, 1, -1e300, 3, 5}));
  EXPECT_EQ(project(box, vec({0, 2, 1, 0, 3, 5})), vec({0, 2, 1, 0, 3, 5}));
}

// Two functions of one formula. Catches that they part at bounds, at infinities, or where z is a NaN: a projection that
// turns a NaN into a bound makes a diverged iterate look like a point of the box.
TEST(Box, VectorAndComponentProjectionsAgree) {
  const double values[] = {-infinity, -1, -0.5, 0, 0.5, 1, infinity, nan};
  for (const double l : {-infinity, -1.0, 0.0})
    for (const double u : {0.0, 1.0, infinity})
      for (const double z : values) {
        // Of odd length, so that both Eigen's vector instructions and their scalar remainder are met.
        const Box box{Vec::Constant(5, l), Vec::Constant(5, u)};
        const Vec all = project(box, Vec::Constant(5, z));
        for (Index i = 0; i < 5; ++i) {
          const double one = project(box, i, z);
          EXPECT_TRUE(all[i] == one || (std::isnan(all[i]) && std::isnan(one))) << l << ' ' << u << ' ' << z;
          EXPECT_EQ(std::isnan(one), std::isnan(z)) << l << ' ' << u;
        }
      }
}

TEST(Box, FreeAndNonnegative) {
  EXPECT_EQ(Box::free(2).lower, vec({-infinity, -infinity}));
  EXPECT_EQ(Box::free(2).upper, vec({infinity, infinity}));
  EXPECT_EQ(Box::nonnegative(2).lower, vec({0, 0}));
  EXPECT_EQ(Box::nonnegative(2).upper, vec({infinity, infinity}));
  EXPECT_EQ(Box::nonnegative(0).size(), 0);
  EXPECT_EQ(Box::free(0).invalid(), std::nullopt);
}

// Catches a check by `lower > upper`, which lets NaN pass, and boxes whose only point is an infinity.
TEST(Box, RefusesWhatIsNoInterval) {
  for (const auto& [l, u] : {std::pair{1.0, 0.0},
                             {0.0, -1e-300},
                             {nan, 1.0},
                             {0.0, nan},
                             {nan, nan},
                             {infinity, infinity},
                             {-infinity, -infinity},
                             {infinity, -infinity},
                             {infinity, 0.0}})
    EXPECT_EQ(interval(l, u).first_invalid(), 0) << l << ' ' << u;
  for (const auto& [l, u] : {std::pair{0.0, 0.0},
                             {-0.0, 0.0},
                             {0.0, -0.0},
                             {-infinity, infinity},
                             {-infinity, -1e308},
                             {1e308, infinity},
                             {-1.0, 5e-324}})
    EXPECT_EQ(interval(l, u).first_invalid(), std::nullopt) << l << ' ' << u;
}

// The user has to find the entry: the message names its index and both values in full precision.
TEST(Box, SaysWhichIntervalIsWrong) {
  const Box box{vec({0, 0, 1.0000000000000002, 7}), vec({1, 1, 1, 5})};
  EXPECT_EQ(box.first_invalid(), 2);
  ASSERT_TRUE(box.invalid());
  EXPECT_THAT(*box.invalid(), HasSubstr("index 2 is [1.0000000000000002, 1]"));
  ASSERT_TRUE((Box{Vec::Zero(2), Vec::Zero(3)}.invalid()));
  EXPECT_THAT(*(Box{Vec::Zero(2), Vec::Zero(3)}.invalid()), HasSubstr("2 lower bounds and 3 upper bounds"));
}

TEST(Box, StateAtBoundsAndBetween) {
  const Box box = interval(0, 1);
  EXPECT_EQ(cell_of(box, 0, 0), Cell::Below);
  EXPECT_EQ(cell_of(box, 0, 1e-9), Cell::Inside);
  EXPECT_EQ(cell_of(box, 0, 1e-9, 1e-8), Cell::Below);
  EXPECT_EQ(cell_of(box, 0, -1), Cell::Below);
  EXPECT_EQ(cell_of(box, 0, 1), Cell::Above);
  EXPECT_EQ(cell_of(box, 0, 1 - 1e-9), Cell::Inside);
  EXPECT_EQ(cell_of(box, 0, 1 - 1e-9, 1e-8), Cell::Above);
  EXPECT_EQ(cell_of(box, 0, 2), Cell::Above);
  EXPECT_EQ(cell_of(Box::free(1), 0, 1e308, 1), Cell::Inside);
  EXPECT_EQ(cell_of(Box::free(1), 0, -1e308, 1), Cell::Inside);
  EXPECT_EQ(cell_of(interval(2, 2), 0, 7), Cell::Fixed);
}

// Catches that the lower bound wins because it is asked first: at the upper bound of an interval narrower than tol the
// sign of F to demand is the upper bound's.
TEST(Box, StateInANarrowIntervalIsTheNearerBound) {
  const Box box = interval(0, 1e-9);
  EXPECT_EQ(cell_of(box, 0, 0, 1e-6), Cell::Below);
  EXPECT_EQ(cell_of(box, 0, 1e-9, 1e-6), Cell::Above);
  EXPECT_EQ(cell_of(box, 0, 0.9e-9, 1e-6), Cell::Above);
  EXPECT_EQ(cell_of(box, 0, 0.1e-9, 1e-6), Cell::Below);
}

}  // namespace
}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
/// Performance and data profiles against an example worked out by hand.
#include "app/findings/profiles.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace perp::app::comparison {

// Beside the test's namespace, so that gtest finds it.
static void PrintTo(const Step& step, std::ostream* out) { *out << '(' << step.x << ", " << step.count << ')'; }
static bool operator==(const Step& a, const Step& b) { return a.x == b.x && a.count == b.count; }

namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double inf = std::numeric_limits<double>::infinity();

/// Five problems, three methods; method 1 and 2 tie on the second, nobody solves the fourth, method 3 fails twice.
///   p       1    2    3    4    5
///   t_1     2    3    8   inf   1      r_1 = 1  1  4  inf  1
///   t_2     4    3    2   inf  inf     r_2 = 2  1  1  inf inf
///   t_3     3   inf   2   inf   4      r_3 = 1.5 inf 1 inf 4
const Costs example{{2, 3, 8, inf, 1}, {4, 3, 2, inf, inf}, {3, inf, 2, inf, 4}};

/// Dolan & More 2002, eq. 2.1, by hand. Would catch: ties given to one method only, problems that nobody solved
/// dropped from the denominator, inf / inf counted as solved, < for <=.
TEST(Profiles, PerformanceByHand) {
  const auto rho = performance_profiles(example);
  ASSERT_EQ(rho.size(), 3U);
  EXPECT_THAT(rho[0].steps, ElementsAre(Step{1, 3}, Step{4, 4}));
  EXPECT_THAT(rho[1].steps, ElementsAre(Step{1, 2}, Step{2, 3}));
  EXPECT_THAT(rho[2].steps, ElementsAre(Step{1, 1}, Step{1.5, 2}, Step{4, 3}));
  EXPECT_EQ(rho[0].share(1), 3.0 / 5);
  EXPECT_EQ(rho[0].share(std::nextafter(4.0, 0)), 3.0 / 5);
  EXPECT_EQ(rho[0].share(4), 4.0 / 5);
  EXPECT_EQ(rho[0].share(inf), 4.0 / 5) << "the fourth problem stays in the denominator";
  EXPECT_EQ(rho[0].first() + rho[1].first() + rho[2].first(), 6U) << "four solved problems and two ties";
  EXPECT_EQ(rho[2].share(0.999), 0);
  EXPECT_EQ(rho[2].solved(), 3U);
}

/// More & Wild 2009, eq. 2.8, by hand, with n = 1, 0, 3, 9, 1. Would catch: units that are n_p, or multiplied.
TEST(Profiles, DataByHand) {
  const std::vector<double> unit{2, 1, 4, 10, 2};
  const auto d = data_profiles(example, unit);
  EXPECT_THAT(d[0].steps, ElementsAre(Step{0.5, 1}, Step{1, 2}, Step{2, 3}, Step{3, 4}));
  EXPECT_THAT(d[1].steps, ElementsAre(Step{0.5, 1}, Step{2, 2}, Step{3, 3}));
  EXPECT_THAT(d[2].steps, ElementsAre(Step{0.5, 1}, Step{1.5, 2}, Step{2, 3}));
  EXPECT_EQ(d[0].share(1.9), 2.0 / 5);
}

/// Would catch: divisions by nothing, curves of methods that solve nothing.
TEST(Profiles, NothingToShow) {
  EXPECT_THAT(performance_profiles({}), IsEmpty());
  const auto none = performance_profiles({{}, {}});
  ASSERT_EQ(none.size(), 2U);
  EXPECT_EQ(none[0].share(inf), 0);
  const auto failed = performance_profiles({{inf, inf}, {1, inf}});
  EXPECT_THAT(failed[0].steps, IsEmpty());
  EXPECT_EQ(failed[1].share(1), 0.5);
  EXPECT_EQ(performance_profiles({{5e-324, 1e308}})[0].share(1), 1) << "alone it is always the best";
}

/// Would catch: costs of 0, NaN or -1 that pass as ratios.
TEST(Profiles, RefusesCostsThatAreNone) {
  EXPECT_THROW(performance_profiles({{1, 0}}), std::invalid_argument);
  EXPECT_THROW(performance_profiles({{std::nan("")}}), std::invalid_argument);
  EXPECT_THROW(performance_profiles({{-1}}), std::invalid_argument);
  EXPECT_THROW(performance_profiles({{1, 2}, {1}}), std::invalid_argument);
  const std::vector<double> zero{0};
  EXPECT_THROW(data_profiles({{1}}, zero), std::invalid_argument);
  EXPECT_THROW(data_profiles({{1, 2}}, zero), std::invalid_argument);
}

/// On random costs, small integers so that ties are many: the definition, counted problem by problem; scaling a
/// problem's costs changes no performance profile; a method more can only lower the others' curves.
TEST(Profiles, AreTheirDefinition) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t methods = 1 + random() % 4;
    const std::size_t problems = random() % 7;
    Costs t(methods, std::vector<double>(problems));
    for (auto& row : t)
      for (double& cost : row) cost = random() % 4 == 0 ? inf : static_cast<double>(1 + random() % 5);
    const auto rho = performance_profiles(t);
    Costs scaled = t;
    for (std::size_t p = 0; p < problems; ++p)
      for (auto& row : scaled) row[p] *= std::ldexp(1.0, static_cast<int>(p) - 3);
    const auto rho_scaled = performance_profiles(scaled);
    Costs more = t;
    more.emplace_back(problems, 1.0);
    const auto rho_more = performance_profiles(more);
    for (const double tau : {0.5, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, inf})
      for (std::size_t s = 0; s < methods; ++s) {
        std::size_t within = 0;
        for (std::size_t p = 0; p < problems; ++p) {
          double least = inf;
          for (const auto& row : t) least = std::min(least, row[p]);
          if (t[s][p] < inf && t[s][p] <= tau * least) ++within;
        }
        EXPECT_EQ(rho[s].count(tau), within) << "tau " << tau;
        EXPECT_EQ(rho_scaled[s].count(tau), within);
        EXPECT_LE(rho_more[s].count(tau), within);
      }
  }
}

}  // namespace
}  // namespace perp::app::comparison

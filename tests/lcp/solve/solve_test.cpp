// SPDX-License-Identifier: Apache-2.0
// The methods as values, and Auto's choices.
#include "lcp/solve/solve.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <string>

#include "support/campaign.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::sparse;
using support::vec;
using testing::HasSubstr;

Result automatically(const AffineMcp& problem) { return solve(problem, Vec::Zero(problem.size())); }

/// M = I + 2 (strict upper triangle), or its transpose.
SpMat murty(Index n, bool upper) {
  Dense M = Dense::Identity(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < i; ++j) (upper ? M(j, i) : M(i, j)) = 2;
  return sparse(M);
}

TEST(Methods, NamesAreUniqueAndFound) {
  for (const MethodEntry& entry : methods()) {
    EXPECT_EQ(name(entry.method), entry.name);
    EXPECT_FALSE(entry.what.empty());
    EXPECT_FALSE(entry.reference.empty());
  }
  EXPECT_EQ(methods().size(), std::variant_size_v<Method> + 1) << "a method without an entry, or twice";  // least-index
  EXPECT_TRUE(std::holds_alternative<Auto>(methods().front().method));
}

/// y'F = -delta at most in the box, but y'F >= -r |y|_1 where min(F, z - l) and its like are -r at worst, and the part
/// of y'F that comes from z beyond the bounds is nothing: r >= delta / |y|_1.
double least_violation(const AffineMcp& p, const Vec& y) {
  double most = p.q.dot(y);
  const Vec a = p.M.transpose() * y;
  for (Index j = 0; j < a.size(); ++j) {
    const double bound = a[j] > 0 ? p.box.upper[j] : p.box.lower[j];
    if (std::isfinite(bound)) most += a[j] * bound;  // others are rounding: the certificate has been checked
  }
  return -most / y.lpNorm<1>();
}

// 4 x 2500 small problems of eight classes, degenerate, singular, infeasible and badly scaled ones included, by every
// method. Solved must be so by a judge that shares no code with the library's; Infeasible must not contradict a
// solution that another method found, and must prove itself by its certificate or by the exhaustive search. This is the
// test of false convergence, the worst fault a solver can have.
class Campaign : public testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Quarters, Campaign, testing::Range(1U, 5U));

TEST_P(Campaign, NoMethodClaimsWhatIsNotSo) {
  Random random(GetParam());
  std::map<std::string_view, int> solved;
  std::map<std::string_view, int> infeasible;
  for (int k = 0; k < 2500; ++k) {
    const AffineMcp p = support::campaign_problem(k, random);
    const Vec start = random.normals(p.size());
    // The check sums in long double: its own rounding is allowed for.
    const auto wrong = [&](const Vec& z) {
      const double rounding = 1e-18 * (p.M.cwiseAbs() * z.cwiseAbs() + p.q.cwiseAbs()).maxCoeff();
      return support::violation(p, z) > 1.01e-9 + rounding;
    };
    std::string_view has_solution;
    std::string_view has_none;
    double smallest = infinity;  // violation of the solutions
    double least = 0;            // violation that every point has, by a certificate
    for (const MethodEntry& entry : methods()) {
      // Nine of ten problems go to the cheap methods only.
      if (k % 10 != 0 && (entry.name == "enumeration" || entry.name == "auto")) continue;
      Method method = entry.method;
      if (auto* sor = std::get_if<ProjectedSor>(&method)) sor->max_sweeps = 300;  // it is the slow one
      const Result result = solve(p, start, method);
      SCOPED_TRACE("problem " + std::to_string(k) + ", " + std::string(entry.name) + ": " + result.message);
      ASSERT_EQ(result.z.size(), p.size());
      ASSERT_TRUE((result.z.array() >= p.box.lower.array()).all() && (result.z.array() <= p.box.upper.array()).all());
      if (result.solved()) {
        has_solution = entry.name;
        ++solved[entry.name];
        ASSERT_FALSE(wrong(result.z)) << support::violation(p, result.z);
        smallest = std::min(smallest, support::violation(p, result.z));
      } else {
        ASSERT_FALSE(result.message.empty()) << to_string(result.status);
      }
      if (result.status == Status::Infeasible) {
        has_none = entry.name;
        ++infeasible[entry.name];
        if (result.certificate.size() > 0) {
          ASSERT_TRUE(proves_infeasible(p, result.certificate));
          least = std::max(least, least_violation(p, result.certificate));
        } else {
          ASSERT_THAT(result.message, HasSubstr("cells"));
        }
      }
    }
    // Rows scaled by 1e-8 may be violated within the tolerance and provably so all the same.
    const bool badly_scaled = k % 8 == 5;
    ASSERT_TRUE(has_solution.empty() || has_none.empty() || (badly_scaled && smallest >= 0.5 * least))
        << "problem " << k << " is solved by " << has_solution << " to " << smallest << " and has no solution says "
        << has_none << ", every point being wrong by " << least;
  }
  for (const MethodEntry& entry : methods()) EXPECT_GT(solved[entry.name], 25) << entry.name;
  EXPECT_GT(solved["lemke"], 1250);
  EXPECT_GT(infeasible["lemke"], 25);
}

// Murty 1978: on these P-matrices Lemke's method and least-index rules take up to 2^n pivots; n = 120 is out of
// their reach. They are triangular, which Auto sees.
TEST(Auto, MurtysExponentialProblems) {
  const auto begin = std::chrono::steady_clock::now();
  for (const bool upper : {true, false}) {
    const Index n = 120;
    const Result result = automatically(standard_lcp(murty(n, upper), -Vec::Ones(n)));
    ASSERT_TRUE(result.solved()) << result.message;
    EXPECT_EQ(result.z, Vec::Unit(n, upper ? n - 1 : 0));
    EXPECT_THAT(result.message, HasSubstr("block-pivoting"));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20)) << "2^120 pivots would take longer";
}

/// Sixty times M and q: beyond the few rows that Lemke's method takes before anything is known of M.
AffineMcp sixty(const Dense& M, const Vec& q) {
  const Index n = q.size();
  Dense blocks = Dense::Zero(60 * n, 60 * n);
  for (Index k = 0; k < 60; ++k) blocks.block(k * n, k * n, n, n) = M;
  return standard_lcp(sparse(blocks), q.replicate(60, 1));
}

// The choice is told with its reason.
TEST(Auto, SaysWhatItChoseAndWhy) {
  EXPECT_THAT(automatically(sixty(Dense{{2, 1}, {1, 2}}, vec({-5, -6}))).message,
              testing::AllOf(HasSubstr("block-pivoting"), HasSubstr("H-matrix")));
  EXPECT_THAT(automatically(sixty(Dense{{0, 1}, {-1, 0}}, vec({-1, 2}))).message,
              testing::AllOf(HasSubstr("interior-point"), HasSubstr("positive semidefinite")));
  EXPECT_THAT(automatically(standard_lcp(matrix({{2, 1}, {1, 2}}), vec({-5, -6}))).message,
              HasSubstr("lemke with few pivots (n <= 100"));
  Random random(3);
  const Dense A = random.normals(120, 120);
  const AffineMcp unknown = standard_lcp(sparse(A.cwiseAbs() - 0.2 * Dense::Ones(120, 120)), random.normals(120));
  EXPECT_THAT(automatically(unknown).message, HasSubstr("copositive-plus and P-matrices"));
}

// Infeasible, whether provable by a certificate (copositive-plus M: Cottle, Pang & Stone 1992, theorem 4.4.13) or by
// looking at all cells only.
TEST(Auto, RecognisesProblemsWithoutSolution) {
  const Result copositive_plus = automatically(standard_lcp(matrix({{0, -1}, {1, 0}}), vec({-1, -1})));
  EXPECT_EQ(copositive_plus.status, Status::Infeasible) << copositive_plus.message;
  EXPECT_TRUE(proves_infeasible(standard_lcp(matrix({{0, -1}, {1, 0}}), vec({-1, -1})), copositive_plus.certificate));
  // Feasible (z = (1, 0)), but not complementary: 0 <= z_1 _|_ z_1 - z_2 + 1 > 0 forces z_1 = 0 or z_2 = z_1 + 1.
  const Result feasible = automatically(standard_lcp(matrix({{1, -1}, {1, -1}}), vec({-1, 0})));
  if (feasible.solved()) {
    EXPECT_LT(support::violation(standard_lcp(matrix({{1, -1}, {1, -1}}), vec({-1, 0})), feasible.z), 1e-9);
  } else {
    EXPECT_EQ(feasible.status, Status::Infeasible) << feasible.message;
  }
}

// Zero diagonal blocks: every covering vector's path ends on a ray at once (Cottle, Pang & Stone 1992, section 4.4);
// the missing-label paths of Lemke and Howson end in equilibria.
TEST(Auto, BimatrixGames) {
  Random random(4);
  for (int k = 0; k < 20; ++k) {
    const int m = random.integer(1, 20);
    const int n = random.integer(1, 20);
    Dense M = Dense::Zero(m + n, m + n);
    M.topRightCorner(m, n) = random.normals(m, n).cwiseAbs() + 0.1 * Dense::Ones(m, n);
    M.bottomLeftCorner(n, m) = random.normals(n, m).cwiseAbs() + 0.1 * Dense::Ones(n, m);
    const AffineMcp p = standard_lcp(sparse(M), -Vec::Ones(m + n));
    const Result game = lemke_howson(p, Vec::Zero(m + n), {.labels = 1});
    ASSERT_TRUE(game.solved()) << k << ": " << game.message;
    ASSERT_LT(support::violation(p, game.z), 1e-9);
    ASSERT_TRUE(automatically(p).solved()) << k;
  }
}

TEST(LemkeHowson, RefusesOtherBoxes) {
  AffineMcp p = standard_lcp(matrix({{0, 1}, {1, 0}}), vec({-1, -1}));
  p.box.upper[1] = 5;
  EXPECT_EQ(lemke_howson(p, Vec::Zero(2)).status, Status::NotApplicable);
  p.box = Box::free(2);
  EXPECT_EQ(lemke_howson(p, Vec::Zero(2)).status, Status::NotApplicable);
}

// Limits reach the method that runs. Catches a method called without them.
TEST(Methods, ObeyLimits) {
  Random random(5);
  const Index n = 60;
  const AffineMcp p = standard_lcp(sparse(random.normals(n, n)), random.normals(n));
  for (const MethodEntry& entry : methods()) {
    Limits limits;
    limits.interrupted = [] { return true; };
    const Status interrupted = solve(p, Vec::Zero(n), entry.method, limits).status;
    EXPECT_TRUE(interrupted == Status::Interrupted || interrupted == Status::NotApplicable)
        << entry.name << ' ' << to_string(interrupted);
    Limits late;
    late.deadline = std::chrono::steady_clock::now();
    const Status overdue = solve(p, Vec::Zero(n), entry.method, late).status;
    EXPECT_TRUE(overdue == Status::TimeLimit || overdue == Status::NotApplicable)
        << entry.name << ' ' << to_string(overdue);
    EXPECT_THROW(solve(p, Vec::Zero(n - 1), entry.method), std::invalid_argument) << entry.name;
  }
}

TEST(Methods, NothingToSolve) {
  for (const MethodEntry& entry : methods()) {
    const Result result = solve(standard_lcp(SpMat(0, 0), Vec(0)), Vec(0), entry.method);
    EXPECT_TRUE(result.solved()) << entry.name << ": " << result.message;
  }
}

}  // namespace
}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/autodiff.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <thread>

#include "ncp/analysis/verify.hpp"
#include "ncp/interval/enclosure.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::vec;
using testing::HasSubstr;
using testing::ThrowsMessage;

Box everywhere(Index n) { return {Vec::Constant(n, -infinity), Vec::Constant(n, infinity)}; }

// Kojima & Shindo 1986, as a template; support::kojima_shindo() has F and J by hand.
constexpr auto kojima_shindo = []<class T>(std::span<const T> x, std::span<T> F) {
  F[0] = 3 * x[0] * x[0] + 2 * x[0] * x[1] + 2 * x[1] * x[1] + x[2] + 3 * x[3] - 6;
  F[1] = 2 * x[0] * x[0] + x[0] + x[1] * x[1] + 10 * x[2] + 2 * x[3] - 2;
  F[2] = 3 * x[0] * x[0] + x[0] * x[1] + 2 * x[1] * x[1] + 2 * x[2] + 9 * x[3] - 9;
  F[3] = x[0] * x[0] + 3 * x[1] * x[1] + 2 * x[2] + 3 * x[3] - 3;
};

// Products and sums by hand and by dual numbers, at bounds and beside them. Catches a lane that belongs to another
// column.
TEST(Autodiff, AgreesWithDerivativesByHand) {
  const auto mine = make_autodiff_mcp(kojima_shindo, {.name = "kojima-shindo", .box = Box::nonnegative(4)});
  const auto theirs = make_mcp(support::kojima_shindo());
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform(-1, 3);
  for (int round = 0; round < 50; ++round) {
    Vec x(4), F(4), F_theirs(4);
    for (double& entry : x) entry = round == 0 ? 0 : uniform(engine);
    SpMat J = mine->jacobian_pattern(), J_theirs = theirs->jacobian_pattern();
    ASSERT_TRUE(mine->eval(x, F) && theirs->eval(x, F_theirs));
    ASSERT_TRUE(mine->jacobian(x, J) && theirs->jacobian(x, J_theirs));
    EXPECT_LE((F - F_theirs).lpNorm<Eigen::Infinity>(), 1e-13);
    EXPECT_LE((support::Dense(J) - support::Dense(J_theirs)).lpNorm<Eigen::Infinity>(), 1e-13);
  }
}

/// Every function once a row, of x_1 (in (0, 1)) and x_2 (above 1).
constexpr auto every_function = []<class T>(std::span<const T> x, std::span<T> F) {
  using std::abs, std::fabs, std::max, std::min, std::pow, std::exp, std::expm1, std::log, std::log1p, std::log10;
  using std::sin, std::cos, std::tan, std::asin, std::acos, std::atan, std::atan2, std::sqrt, std::floor, std::ceil;
  using std::sinh, std::cosh, std::tanh, std::asinh, std::acosh, std::atanh;
  const T& a = x[0];
  const T& b = x[1];
  const T all[] = {exp(a),          expm1(a),      log(a),         log1p(a),        log10(a),         sqrt(a),
                   sin(a),          cos(a),        tan(a),         asin(a),         acos(a),          atan(a),
                   sinh(a),         cosh(a),       tanh(a),        asinh(a),        acosh(b),         atanh(a),
                   abs(a - b),      abs(b - a),    pow(a, 2.5),    pow(a, 3),       pow(a, b),        pow(2.0, a),
                   atan2(a, b),     min(a, b),     max(a, b),      max(a * b, 0.0), min(1.0, a),      -a / b,
                   (a + b) * 2 / b, 1 / a - 3 + b, 2 - a * a - -b, floor(a) * b,    ceil(b) + fabs(a)};
  for (std::size_t i = 0; i < std::size(all); ++i) F[i] = all[i];
  for (std::size_t i = std::size(all); i < F.size(); ++i) F[i] = x[i];
};

// Against central differences of long steps (Richardson would say h^2 = 1e-10), every function. Catches a wrong rule,
// and a rule that Dual and double have for different functions.
TEST(Autodiff, KnowsEveryFunction) {
  constexpr Index n = 36;
  const auto mcp = make_autodiff_mcp(every_function, {.name = "all", .box = everywhere(n)});
  for (const auto& [a, b] : {std::pair(0.3, 1.7), {0.9, 4.2}, {0.05, 1.1}}) {
    Vec x = Vec::Constant(n, 0.5);
    x[0] = a;
    x[1] = b;
    const JacobianCheck check = check_jacobian(*mcp, x, 1e-5);
    EXPECT_TRUE(check.defined);
    EXPECT_FALSE(check.outside_pattern) << describe(*mcp, check, 0);
    EXPECT_LE(check.worst, 1e-6) << describe(*mcp, check, 0);
  }
}

// The enclosure comes from the same run, by other rules (ncp/interval): it has to hold the values and derivatives that
// double and Dual compute. Catches an Expression with another function than its name, and entries in another order.
TEST(Autodiff, EnclosuresHoldValuesAndDerivatives) {
  constexpr Index n = 36;
  const auto mcp = make_autodiff_mcp(every_function, {.name = "all", .box = everywhere(n)});
  ASSERT_NE(mcp->enclosure(), nullptr);
  Vec x = Vec::Constant(n, 0.5), F(n);
  x[0] = 0.3;
  x[1] = 1.7;
  SpMat J = mcp->jacobian_pattern();
  ASSERT_TRUE(mcp->eval(x, F) && mcp->jacobian(x, J));
  std::vector<Interval> X, rows(n), entries(lcp::at(J.nonZeros()));
  for (const double entry : x) X.emplace_back(entry - 1e-9, entry + 1e-9);
  std::vector<char> known(n);
  mcp->enclosure()->values(X, rows);
  mcp->enclosure()->jacobian(X, entries, known);
  for (Index i = 0; i < n; ++i) EXPECT_TRUE(rows[lcp::at(i)].contains(F[i])) << i;
  for (Index j = 0, k = 0; j < n; ++j)
    for (SpMat::InnerIterator it(J, j); it; ++it, ++k)
      EXPECT_TRUE(known[lcp::at(it.row())] == 0 || entries[lcp::at(k)].contains(it.value())) << it.row() << " " << j;
  EXPECT_EQ(std::ranges::count(known, 0), 2) << "floor and ceil have jumps";
}

// By looking at the rows: pattern, constant entries. Catches an entry that presolve would take for constant though it
// is not, and a pattern without an entry.
TEST(Autodiff, FindsThePatternAndWhatIsConstant) {
  const auto F = []<class T>(std::span<const T> x, std::span<T> f) {
    using std::exp;
    f[0] = 2 * (x[0] - x[2] / 4) + exp(x[1]);
    f[1] = x[0] * x[1] - x[1];
    f[2] = 7.0;
  };
  const auto mcp = make_autodiff_mcp(F, {.name = "p", .box = everywhere(3)});
  // By columns: (0,0) constant, (1,0) not; (0,1), (1,1) not; (0,2) constant.
  EXPECT_EQ(mcp->jacobian_pattern().nonZeros(), 5);
  EXPECT_EQ(mcp->linear_entries(), (std::vector<bool>{true, false, false, false, true}));
  EXPECT_FALSE(mcp->is_affine());
  EXPECT_EQ(mcp->jacobian_work().colours, 3);
}

// A tridiagonal affine problem written as a loop. Catches affine problems that the methods for them are not told of.
TEST(Autodiff, KnowsAffineProblems) {
  const auto F = []<class T>(std::span<const T> x, std::span<T> f) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      f[i] = 2 * x[i] - 1;
      if (i > 0) f[i] -= x[i - 1];
      if (i + 1 < x.size()) f[i] -= x[i + 1];
    }
  };
  const auto mcp = make_autodiff_mcp(F, {.name = "obstacle", .box = Box::nonnegative(40)});
  EXPECT_TRUE(mcp->is_affine());
  EXPECT_EQ(mcp->jacobian_pattern().nonZeros(), 118);
  EXPECT_EQ(mcp->jacobian_work().colours, 3);
  const auto affine = affine_part(*mcp);
  ASSERT_NE(affine, nullptr);
  EXPECT_EQ(affine->M.coeff(3, 4), -1);
  EXPECT_EQ(affine->q[3], -1);
}

// A branch on values has derivatives, but no pattern. Catches a pattern of one branch taken for that of all.
TEST(Autodiff, PromisesNothingOfFunctionsThatCompare) {
  const auto F = []<class T>(std::span<const T> x, std::span<T> f) {
    f[0] = x[0] > 1 ? x[1] * x[1] : x[0];
    f[1] = x[1];
  };
  const auto mcp = make_autodiff_mcp(F, {.name = "branch", .box = everywhere(2)});
  EXPECT_EQ(mcp->jacobian_pattern().nonZeros(), 4);
  EXPECT_EQ(mcp->enclosure(), nullptr);
  EXPECT_TRUE(mcp->linear_entries().empty());
  EXPECT_FALSE(mcp->is_affine());
  SpMat J = mcp->jacobian_pattern();
  ASSERT_TRUE(mcp->jacobian(vec({2, 3}), J));
  EXPECT_EQ(J.coeff(0, 1), 6);
  EXPECT_EQ(J.coeff(0, 0), 0);
  ASSERT_TRUE(mcp->jacobian(vec({0, 3}), J));
  EXPECT_EQ(J.coeff(0, 0), 1);
}

// log at 0 has no value, sqrt at 0 none for J; bool functions may say so themselves. Catches NaN taken for numbers, and
// columns without the singular term spoilt by 0 times infinity.
TEST(Autodiff, AtTheBorderOfTheDomain) {
  const auto F = []<class T>(std::span<const T> x, std::span<T> f) {
    using std::log, std::pow;
    f[0] = pow(x[0], 2.0) + pow(x[0], 0.0);
    f[1] = log(x[1]);
    return true;
  };
  const auto mcp = make_autodiff_mcp(F, {.name = "border", .box = Box::nonnegative(2)});
  SpMat J = mcp->jacobian_pattern();
  ASSERT_TRUE(mcp->jacobian(vec({0, 1}), J));
  EXPECT_EQ(J.coeff(0, 0), 0);
  EXPECT_EQ(J.coeff(1, 1), 1);
  const Result at_pole = solve(*mcp, vec({1, 0}), path());
  EXPECT_TRUE(at_pole.solved()) << at_pole.message;
  EXPECT_THAT(at_pole.notes, testing::ElementsAre(testing::HasSubstr("log(x[2]) in row F[2]: x[2] = 0 at the start")));
  const auto refusing = make_autodiff_mcp([](auto, auto) { return false; }, {.name = "no", .box = everywhere(1)});
  Vec f(1);
  EXPECT_FALSE(refusing->eval(vec({1}), f));
}

// exp(x) = 2 has one solution, and ranges prove it; exp(x) = -0.1 has none. Catches enclosures that verify() and
// no_solution() do not get.
TEST(Autodiff, ProofsWork) {
  const auto mcp = make_autodiff_mcp(
      [](auto x, auto f) {
        using std::exp;
        f[0] = exp(x[0]) - 2;
      },
      {.name = "exp", .box = everywhere(1)});
  Result result = solve(*mcp, vec({0}), path());
  ASSERT_TRUE(result.solved());
  EXPECT_NEAR(result.x[0], std::log(2.0), 1e-8);
  EXPECT_EQ(result.stats.J_colours, 1);
  EXPECT_GE(result.stats.J_F_evals, result.stats.J_evals - 1);
  EXPECT_TRUE(verify(*mcp, 1e-8, result).unique);
  const auto none = make_autodiff_mcp(
      [](auto x, auto f) {
        using std::exp;
        f[0] = exp(x[0]) + 0.1;
      },
      {.name = "none", .box = everywhere(1)});
  EXPECT_EQ(solve(*none, vec({0}), path()).status, Status::Infeasible);
}

// Two threads, each with its own problem. Catches seeds shared between problems.
TEST(Autodiff, TwoThreadsAtOnce) {
  Result results[2];
  const auto work = [&](int which) {
    for (int round = 0; round < 20; ++round) {
      const auto mcp = make_autodiff_mcp(kojima_shindo, {.name = "kojima-shindo", .box = Box::nonnegative(4)});
      results[which] = solve(*mcp, Vec::Ones(4), path());
    }
  };
  std::thread other(work, 1);
  work(0);
  other.join();
  ASSERT_TRUE(results[0].solved());
  EXPECT_EQ(results[0].x, results[1].x);
}

TEST(Autodiff, RefusesPartsThatDoNotFit) {
  EXPECT_THAT(
      ([] { make_autodiff_mcp(kojima_shindo, {.name = "k", .box = Box::nonnegative(4), .variable_names = {"a"}}); }),
      ThrowsMessage<std::invalid_argument>(HasSubstr("1 names for 4 variables")));
  EXPECT_THAT(
      ([] { make_autodiff_mcp(kojima_shindo, {.name = "k", .box = Box::nonnegative(4), .pattern = SpMat(3, 4)}); }),
      ThrowsMessage<std::invalid_argument>(HasSubstr("3 rows")));
}

}  // namespace
}  // namespace perp::ncp

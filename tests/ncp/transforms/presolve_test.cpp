// SPDX-License-Identifier: Apache-2.0
// Presolve against closed forms and, at random, against problems whose solutions are all known. Would catch a reduction
// that loses the solutions, one whose postsolve gives none, and a verdict of infeasibility over a solvable problem.
#include "ncp/transforms/presolve.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lcp/solve/enumeration.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/problem/residual.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using lcp::AffineMcp;
using support::Dense;
using support::matrix;
using support::Random;
using support::vec;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using Rows = std::initializer_list<std::initializer_list<double>>;

std::unique_ptr<Mcp> affine(Rows M, std::initializer_list<double> q, std::initializer_list<double> lower,
                            std::initializer_list<double> upper) {
  return make_affine_mcp({matrix(M), vec(q), {vec(lower), vec(upper)}}, "affine");
}
constexpr double inf = infinity;

Presolved presolved(const std::unique_ptr<Mcp>& mcp) { return presolve(*mcp, Vec::Zero(mcp->size())); }

// --- what is taken out, by hand ---

TEST(Presolve, LeavesAloneWhatItKnowsNothingOf) {
  const auto mcp = make_mcp(support::kojima_shindo());
  const Presolved p = presolve(*mcp, vec({-1, 2, 3, 4}));
  EXPECT_EQ(&p.problem(), mcp.get());
  EXPECT_EQ(p.start(), vec({0, 2, 3, 4}));
  EXPECT_EQ(p.postsolve(vec({1, 0, 3, 0})), vec({1, 0, 3, 0}));
  EXPECT_EQ(p.F_evals() + p.J_evals(), 0);
  EXPECT_THROW((void)p.postsolve(vec({1, 0, 3})), std::invalid_argument);
  EXPECT_THROW((void)p.reduce(vec({1, 0, 3})), std::invalid_argument);
}

// Fixed variables go without any declared linearity, and names, bounds and derivatives of the others are carried over.
TEST(Presolve, TakesFixedVariablesOut) {
  Functions functions = support::kojima_shindo();
  functions.variable_names = {"a", "b", "c", "d"};
  functions.equation_names = {"Fa", "Fb", "Fc", "Fd"};
  functions.box.lower[1] = functions.box.upper[1] = 0.25;
  const auto mcp = make_mcp(functions);
  const Presolved p = presolve(*mcp, Vec::Ones(4));
  EXPECT_EQ(p.counts().fixed, 1);
  ASSERT_EQ(p.problem().size(), 3);
  EXPECT_EQ(p.problem().variable_name(1), "c");
  EXPECT_EQ(p.problem().equation_name(2), "Fd");
  EXPECT_EQ(p.problem().name(), "kojima-shindo");
  EXPECT_EQ(describe(p.problem(), check_jacobian(p.problem(), vec({1, 2, 3}))), "");
  Vec full(4), part(3);
  ASSERT_TRUE(mcp->eval(vec({1, 0.25, 2, 3}), full));
  ASSERT_TRUE(p.problem().eval(vec({1, 2, 3}), part));
  EXPECT_EQ(part, vec({full[0], full[2], full[3]}));
  EXPECT_EQ(p.postsolve(vec({1, 2, 3})), vec({1, 0.25, 2, 3}));
  EXPECT_EQ(p.reduce(vec({5, 6, 7, 8})), vec({5, 7, 8}));
}

// F1 = 1 + x2 > 0 for x2 >= 0: x1 = 0, its bound. Then F2 = x2 - 3 alone: x2 = 3.
TEST(Presolve, ForcesBoundsAndFollowsUp) {
  const auto mcp = affine({{0, 1}, {1, 1}}, {1, -3}, {0, 0}, {inf, inf});
  const Presolved p = presolved(mcp);
  EXPECT_EQ(p.problem().size(), 0);
  EXPECT_EQ(p.counts().forced, 1);
  EXPECT_EQ(p.counts().singleton_rows, 1);
  EXPECT_EQ(p.postsolve(Vec(0)), vec({0, 3}));
}

// The equation 2 x2 - 6 = 0 of the free x1 sets x2 = 3, inside [0, 5], so that F2 has to be 0, by x1: x1 + x2 - 1 = 0.
// Would catch x1 being fixed with its row although it has another purpose.
TEST(Presolve, SingletonEquationsChangeThePairs) {
  const auto mcp = make_mcp([] {
    Functions f = support::dense(
        "pairs", {vec({-inf, 0, 0}), vec({inf, 5, inf})},
        [](const Vec& x) {
          return vec({2 * x[1] - 6, x[0] * x[0] * x[0] + x[1] - 4 + x[2], x[2] * x[2] - x[0] - x[2]});
        },
        [](const Vec& x) {
          Dense J(3, 3);
          J << 0, 2, 0, 3 * x[0] * x[0], 1, 1, -1, 0, 2 * x[2] - 1;
          return J;
        });
    f.linear_entries = {true, false, true, true, true, true, true, true, false};
    return f;
  }());
  const Presolved p = presolve(*mcp, vec({1, 1, 2}));
  ASSERT_THAT(p.infeasible(), IsEmpty());
  EXPECT_THAT(p.columns(), ElementsAre(0, 2));
  EXPECT_THAT(p.rows(), ElementsAre(1, 2));
  EXPECT_EQ(p.problem().equation_name(0), "F[2]");
  EXPECT_EQ(p.problem().variable_name(0), "x[1]");
  EXPECT_EQ(describe(p.problem(), check_jacobian(p.problem(), vec({2, 3}))), "");
  const Vec x = p.postsolve(vec({1, 0}));  // x1^3 = 1, x3 = 0: F3 = -1 < 0
  EXPECT_EQ(x, vec({1, 3, 0}));
  const Result r = solve(p.problem(), p.start(), SemismoothNewton{});
  ASSERT_TRUE(r.solved());
  EXPECT_LE(residual(*mcp, p.postsolve(r.x)).natural, 1e-7);
}

// 2 x2 - 10 = 0 sets x2 = 5, its bound: F2 <= 0 suffices there, and F2 = 0 need not have a solution. Stays.
TEST(Presolve, LeavesEquationsThatLeadToABound) {
  const auto mcp = affine({{0, 2}, {0, 0}}, {-10, -1}, {-inf, 0}, {inf, 5});
  const Presolved p = presolved(mcp);
  EXPECT_THAT(p.infeasible(), IsEmpty());
  EXPECT_EQ(p.counts().singleton_rows, 0);
  EXPECT_LE(residual(*mcp, p.postsolve(p.reduce(vec({7, 5})))).natural, 0);
}

// x1 occurs in F1 = 2 x1 - x2^3 alone: x1 = mid(0, x2^3 / 2, 3) afterwards.
TEST(Presolve, ComputesSingletonColumnsAfterwards) {
  Functions f = support::dense(
      "column", {vec({0, -inf}), vec({3, inf})},
      [](const Vec& x) {
        return vec({2 * x[0] - x[1] * x[1] * x[1], std::exp(x[1]) - 2});
      },
      [](const Vec& x) {
        Dense J(2, 2);
        J << 2, -3 * x[1] * x[1], 0, std::exp(x[1]);
        return J;
      });
  f.linear_entries = {true, true, false, false};
  const auto mcp = make_mcp(f);
  const Presolved p = presolve(*mcp, vec({1, 1}));
  EXPECT_THAT(p.columns(), ElementsAre(1));
  EXPECT_EQ(p.counts().singleton_columns, 1);
  EXPECT_NEAR(p.postsolve(vec({1.5}))[0], 1.5 * 1.5 * 1.5 / 2, 1e-15);
  EXPECT_EQ(p.postsolve(vec({2})), vec({3, 2}));
  EXPECT_EQ(p.postsolve(vec({-2})), vec({0, -2}));
}

// Munson's form of the side inequality x1 <= 7 (F2 = 7 - x1 - y >= 0 _|_ y >= 0), with x1 <= 5 anyway: y = 0 will do.
// Without that bound F2 may be negative, and y has to stay.
TEST(Presolve, DropsSideInequalitiesThatHold) {
  const auto holds = affine({{1, 0}, {-1, -1}}, {-9, 7}, {0, 0}, {5, inf});
  EXPECT_EQ(presolved(holds).postsolve(Vec(0)), vec({5, 0}));
  const auto may_not = affine({{1, 0, 1}, {-1, -1, 0}, {1, 0, 3}}, {-9, 7, 1}, {-2, 0, -inf}, {inf, inf, inf});
  EXPECT_EQ(presolved(may_not).problem().size(), 3);
}

// F1 = log(x2) - 1 with x2 fixed: affine, and constant, once x2 is known. x1 in [0, 1] goes to its lower bound.
TEST(Presolve, RowsBecomeAffineWhenTheirVariablesAreFixed) {
  Functions f = support::dense(
      "fixed", {vec({-2, -inf, -inf}), vec({1, inf, inf})},
      [](const Vec& x) {
        return vec({std::log(x[1]) - 1 + 0 * x[0], x[2] - 3, x[1] - std::exp(2)});
      },
      [](const Vec& x) {
        Dense J(3, 3);
        J << 0, 1 / x[1], 0, 0, 0, 1, 0, 1, 0;
        return J;
      });
  f.linear_entries = {true, true, true, false, true, true, true, true, true};
  const auto mcp = make_mcp(f);
  const Presolved p = presolve(*mcp, vec({1, 1, 1}));
  EXPECT_EQ(p.problem().size(), 0);
  EXPECT_LE((p.postsolve(Vec(0)) - vec({-2, std::exp(2), 3})).lpNorm<Eigen::Infinity>(), 1e-14);
}

// From a start of 1e12 the equation x1 = 1/3 is known to 1e-4 only until F is evaluated again.
TEST(Presolve, FarStartsLoseNoDigits) {
  const auto mcp = affine({{3, 0}, {1, 3}}, {-1, -1}, {-inf, -inf}, {inf, inf});
  const Presolved p = presolve(*mcp, Vec::Constant(2, 1e12));
  EXPECT_EQ(p.problem().size(), 0);
  EXPECT_LE(residual(*mcp, p.postsolve(Vec(0))).natural, 1e-15);
}

// The start x2 = 2 keeps the root of x1 - x2 in the domain; x1 = 1, which presolve finds, would leave it.
TEST(Presolve, DoesNotStartWhereFIsNotDefined) {
  Functions f = support::dense(
      "domain", Box::free(2),
      [](const Vec& x) {
        return vec({x[0] - 1, std::sqrt(x[0] - x[1]) - 1});
      },
      [](const Vec& x) {
        const double d = 0.5 / std::sqrt(x[0] - x[1]);
        Dense J(2, 2);
        J << 1, 0, d, -d;
        return J;
      });
  f.linear_entries = {true, false, true, false};
  const auto mcp = make_mcp(f);
  EXPECT_EQ(presolve(*mcp, vec({3, 2})).problem().size(), 2);
  EXPECT_EQ(presolve(*mcp, vec({3, 0})).problem().size(), 1);
}

// --- verdicts ---

std::string verdict(const std::unique_ptr<Mcp>& mcp) { return presolved(mcp).infeasible(); }

TEST(Presolve, SaysWhyThereIsNoSolution) {
  EXPECT_EQ(verdict(affine({{0, 0}, {0, 1}}, {-1, 0}, {0, 0}, {inf, inf})),
            "equation F[1] is -1 everywhere, but has to be at least 0, as variable x[1] has no upper bound");
  EXPECT_EQ(verdict(affine({{0, 1, 1}, {1, 0, 1}, {2, 1, 0}}, {2, 0, 0}, {-inf, 0, 0}, {inf, inf, inf})),
            "equation F[1] is at least 2 within the bounds, but has to be 0");
  EXPECT_EQ(verdict(affine({{0, 2}, {1, 1}}, {-14, 0}, {-inf, 0}, {inf, 5})),
            "equation F[1] makes x[2] = 7, but its upper bound is 5");
  EXPECT_EQ(verdict(affine({{1, 2}, {2, 4}}, {1, 5}, {-inf, -inf}, {inf, inf})),
            "equations F[1] and F[2] contradict each other: both have to be 0, but the second is 2 times the first "
            "plus 3");
  EXPECT_THAT(verdict(affine({{0, 1, 0}, {0, 1, 0}, {0, 0, 1}}, {-1, -3, 0}, {-inf, -inf, 0}, {inf, inf, inf})),
              AllOf(HasSubstr("F[2] is -2 where its variables have to be"), HasSubstr("has to be 0")));
}

// x1 + x2 = 1 and x3 = x1 - x2 + 4 with x >= 0, x3 <= 2: x3 >= 3. Only bounds that equations imply tell.
TEST(Presolve, ImpliedBoundsTellToo) {
  const auto mcp = affine({{0, 0, 0, 1, 1}, {0, 0, 0, 1, -1}, {0, 1, 1, 0, 0}, {1, 1, 0, 1, 0}, {1, 0, 1, 0, 1}},
                          {-1, 5, 1, 0, 0}, {-inf, -inf, 0, 0, 0}, {inf, inf, 9, inf, inf});
  EXPECT_THAT(verdict(mcp), HasSubstr("equation F[2] is at least"));
}

TEST(Presolve, NotesEquationsThatSayTheSame) {
  const Presolved p = presolved(affine({{1, 2}, {2, 4}}, {1, 2}, {-inf, -inf}, {inf, inf}));
  EXPECT_THAT(p.infeasible(), IsEmpty());
  EXPECT_THAT(p.notes(), ElementsAre("equations F[1] and F[2] say the same: the second is 2 times the first"));
}

// F2 = 2 F1 + 3 with F1 = 0 an equation: F2 = 3, x2 = 0, although x1 is unbounded.
TEST(Presolve, MultiplesOfEquationsHaveASign) {
  const auto mcp = affine({{1, 0, 1}, {2, 0, 2}, {0, 1, 1}}, {1, 5, -1}, {-inf, 0, -inf}, {inf, inf, inf});
  const Presolved p = presolved(mcp);
  EXPECT_EQ(p.counts().forced, 1);
  EXPECT_EQ(p.postsolve(Vec(0)), vec({-2, 0, 1}));
}

// Catches presolve believing flags that F contradicts, which would give wrong answers.
TEST(Presolve, RefusesFalsePromises) {
  Functions f = support::dense(
      "liar", Box::free(2),
      [](const Vec& x) {
        return vec({x[0] - 4, x[0] * x[0] + x[1]});
      },
      [](const Vec& x) {
        Dense J(2, 2);
        J << 1, 0, 2 * x[0], 1;
        return J;
      });
  f.linear_entries = std::vector<bool>(4, true);
  const auto mcp = make_mcp(f);
  EXPECT_THAT(
      [&] {
        (void)presolve(*mcp, vec({1, 1}));
      },
      testing::ThrowsMessage<std::invalid_argument>(
          AllOf(HasSubstr("liar"), HasSubstr("F[2] is not as linear as the problem declares"))));
}

/// Flags that do not fit the pattern, from a class of one's own.
struct Misfit final : Mcp {
  Box bounds = Box::nonnegative(2);
  SpMat J = dense_pattern(2);
  const Box& box() const override { return bounds; }
  const SpMat& jacobian_pattern() const override { return J; }
  bool eval(In, Out F) const override { return F.setZero(), true; }
  bool jacobian(In, SpMat&) const override { return true; }
  std::vector<bool> linear_entries() const override { return {true}; }
};
TEST(Presolve, RefusesFlagsThatDoNotFit) {
  const Misfit misfit;
  EXPECT_THROW((void)presolve(misfit, Vec::Zero(2)), std::invalid_argument);
}

// --- at random ---

/// Small integer data with many zeros, so that every reduction and degenerate case comes up.
AffineMcp random_affine(Index n, Random& random) {
  Dense M = Dense::Zero(n, n);
  const double density = random.uniform(0.1, 0.6);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      if (random.chance(density)) M(i, j) = random.integer(-3, 3);
  Vec q = Vec::NullaryExpr(n, [&] { return random.integer(-3, 3); });
  Box box = Box::free(n);
  for (Index i = 0; i < n; ++i) {
    const int kind = random.integer(0, 4);
    if (kind == 1 || kind == 3) box.lower[i] = random.integer(-3, 1);
    if (kind == 2) box.upper[i] = random.integer(-1, 3);
    if (kind == 3) box.upper[i] = box.lower[i] + random.integer(0, 4);
  }
  const auto last = static_cast<int>(n) - 1;
  if (n > 1 && random.chance(0.3)) {  // a multiple of a row
    const int i = random.integer(0, last), k = random.integer(0, last), t = random.integer(-2, 2);
    M.row(i) = t * M.row(k);
    if (random.chance(0.5)) q[i] = t * q[k];
  }
  return {support::sparse(M), q, box};
}

struct Tally {
  PresolveCounts counts{};
  int infeasible = 0, solvable = 0, solutions = 0;
  void add(const PresolveCounts& c) {
    counts.fixed += c.fixed;
    counts.forced += c.forced;
    counts.singleton_rows += c.singleton_rows;
    counts.singleton_columns += c.singleton_columns;
    counts.empty += c.empty;
  }
};

void check_affine(const AffineMcp& problem, const Mcp& mcp, Random& random, Tally& tally) {
  const Index n = mcp.size();
  const lcp::Solutions all = lcp::enumerate(problem);
  if (!all.complete) return;
  const Presolved p = presolve(mcp, 3 * random.normals(n));
  if (!p.infeasible().empty()) {
    ++tally.infeasible;
    EXPECT_TRUE(all.found.empty()) << p.infeasible() << "\nbut solved by " << all.found[0].z.transpose();
    return;
  }
  tally.add(p.counts());
  AffineMcp rest{.M = p.problem().jacobian_pattern(), .q = Vec::Zero(p.problem().size()), .box = p.problem().box()};
  ASSERT_TRUE(p.problem().eval(Vec::Zero(rest.size()), rest.q));
  ASSERT_TRUE(p.problem().jacobian(Vec::Zero(rest.size()), rest.M));
  rest.q = rest.q.unaryExpr([](double q) { return std::abs(q) < 1e-13 ? 0 : q; });  // rounding of what was put in
  const lcp::Solutions reduced = lcp::enumerate(rest);
  if (!reduced.complete) return;
  EXPECT_EQ(all.found.empty(), reduced.found.empty());
  tally.solvable += all.found.empty() ? 0 : 1;
  for (const lcp::Solution& s : reduced.found) {
    const Vec x = p.postsolve(s.z);
    EXPECT_LE(support::violation(problem, x), 1e-8 * (1 + x.lpNorm<Eigen::Infinity>()));
    EXPECT_LE(residual(mcp, x).natural, 1e-8 * (1 + x.lpNorm<Eigen::Infinity>()));
    ++tally.solutions;
  }
  for (const lcp::Solution& s : all.found)
    EXPECT_LE(residual(p.problem(), p.reduce(s.z)).natural, 1e-7 * (1 + s.z.lpNorm<Eigen::Infinity>()));
}

// All solutions of both problems are known by enumeration: the reduced one has some if and only if the problem has, all
// of them postsolve to solutions, all of the problem's solve what is left, and no verdict contradicts one.
TEST(PresolveAtRandom, KeepsTheSolutionsOfAffineProblems) {
  Random random(1);
  Tally tally;
  for (int trial = 0; trial < 6000 && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    const AffineMcp problem = random_affine(random.integer(1, 7), random);
    Functions functions = support::affine(problem);
    functions.affine = random.chance(0.7);
    if (!functions.affine)  // what is not declared is not known
      for (Index p = 0; p < functions.pattern.nonZeros(); ++p) functions.linear_entries.push_back(random.chance(0.8));
    check_affine(problem, *make_mcp(functions), random, tally);
  }
  EXPECT_GT(tally.counts.fixed, 200);
  EXPECT_GT(tally.counts.forced, 200);
  EXPECT_GT(tally.counts.singleton_rows, 200);
  EXPECT_GT(tally.counts.singleton_columns, 200);
  EXPECT_GT(tally.counts.empty, 50);
  EXPECT_GT(tally.infeasible, 200);
  EXPECT_GT(tally.solvable, 500);
  EXPECT_GT(tally.solutions, 500);
}

/// F(x) = M x + q + N g(x) with a curved g and q such that `solution` solves it, degenerate in places.
struct Planted {
  std::unique_ptr<Mcp> mcp;
  Vec solution;
};
Planted planted(Index n, Random& random) {
  const AffineMcp base = random_affine(n, random);
  const Dense M = base.M;
  Dense N = Dense::Zero(n, n);
  for (Index k = 0; k < n; ++k)
    if (random.chance(0.5)) N(random.integer(0, static_cast<int>(n) - 1), k) = random.integer(-2, 2);
  const auto g = [](const Vec& x) { return Vec(x.array() + x.array().sin()); };
  const auto dg = [](const Vec& x) { return Vec(1 + x.array().cos()); };
  const Box& box = base.box;
  Vec x(n), w = Vec::Zero(n);
  for (Index i = 0; i < n; ++i) {
    const bool lower = std::isfinite(box.lower[i]), upper = std::isfinite(box.upper[i]);
    const int where = random.integer(0, 2);
    x[i] = lcp::project(box, i, random.normal());
    if (where == 1 && lower) x[i] = box.lower[i];
    if (where == 2 && upper) x[i] = box.upper[i];
    const double size = random.chance(0.2) ? 0 : random.integer(1, 3);
    if (x[i] == box.lower[i]) w[i] = size;
    if (x[i] == box.upper[i]) w[i] = -size;
  }
  const Vec q = w - M * x - N * g(x);
  Functions f = support::dense(
      "planted", box, [=](const Vec& y) { return Vec(M * y + q + N * g(y)); },
      [=](const Vec& y) { return Dense(M + N * dg(y).asDiagonal()); });
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) f.linear_entries.push_back(N(i, j) == 0);
  return {make_mcp(std::move(f)), x};
}

// A planted solution is never declared impossible and solves what is left; what Newton's method finds for that
// postsolves to a solution of the problem.
TEST(PresolveAtRandom, KeepsTheSolutionsOfNonlinearProblems) {
  Random random(2);
  Tally tally;
  for (int trial = 0; trial < 3000 && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    const Index n = random.integer(1, 8);
    const Planted problem = planted(n, random);
    ASSERT_LE(residual(*problem.mcp, problem.solution).natural, 1e-13);
    const Presolved p = presolve(*problem.mcp, problem.solution + random.normals(n));
    ASSERT_EQ(p.infeasible(), "");
    tally.add(p.counts());
    EXPECT_LE(residual(p.problem(), p.reduce(problem.solution)).natural, 1e-9);
    const Result r = solve(p.problem(), p.start(), SemismoothNewton{.stop = {.tol = 1e-10, .max_iterations = 50}});
    if (!r.solved()) continue;
    const Vec x = p.postsolve(r.x);
    EXPECT_LE(residual(*problem.mcp, x).natural, 1e-9 * (1 + x.lpNorm<Eigen::Infinity>()));
    ++tally.solutions;
  }
  EXPECT_GT(tally.counts.forced, 200);
  EXPECT_GT(tally.counts.singleton_rows, 200);
  EXPECT_GT(tally.counts.singleton_columns, 200);
  EXPECT_GT(tally.solutions, 500);
}

// x_k = x_{k-1} + 1, paired in the worst order, and one row with all of them: linear time. Would catch sweeps over all
// rows for every variable (a minute here).
TEST(PresolveAtRandom, LongChainsTakeLinearTime) {
  const int n = 20000;
  support::Triplets entries;
  Vec q = Vec::Constant(n, -1);
  for (int i = 0; i + 1 < n; ++i) {
    const int k = n - 2 - i;  // F_i sets x_k
    entries.emplace_back(i, k, 1);
    if (k > 0) entries.emplace_back(i, k - 1, -1);
    entries.emplace_back(n - 1, k, 1);
  }
  entries.emplace_back(n - 1, n - 1, -1);
  const auto mcp = make_affine_mcp({support::from(n, entries), q, Box::free(n)}, "chain");
  const Presolved p = presolved(mcp);
  EXPECT_EQ(p.problem().size(), 0);
  const Vec x = p.postsolve(Vec(0));
  EXPECT_EQ(x[n - 2], n - 1);
  EXPECT_EQ(x[n - 1], 0.5 * n * (n - 1) - 1);
}

}  // namespace
}  // namespace perp::ncp

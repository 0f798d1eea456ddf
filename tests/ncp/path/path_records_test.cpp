// SPDX-License-Identifier: Apache-2.0
/// What PathSearch shows while it runs: the ways of its iterations, crash and restarts, in the user's problem.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "lcp/affine_mcp.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::Dense;
using support::Random;
using support::vec;

/// A record with copies of what it points to.
struct Kept {
  Iteration it;
  Vec x;
  std::optional<WayTaken> way;
};

Observer keep(std::vector<Kept>& kept) {
  return of_ways([&kept](const Iteration& it) {
    kept.push_back({it, *it.x, {}});
    if (it.way != nullptr) kept.back().way = *it.way;
    return Next::Continue;
  });
}

/// The point of the way at T, t = T t_end for the first time: ncp/run/observe.hpp.
Vec at(const WayTaken& way, double T) {
  const double t = T * way.kinks.back().t;
  std::size_t k = 1;
  while (k + 1 < way.kinks.size() && way.kinks[k].t < t) ++k;
  const lcp::Breakpoint& a = way.kinks[k - 1];
  const lcp::Breakpoint& b = way.kinks[k];
  const double share = b.t > a.t ? std::clamp((t - a.t) / (b.t - a.t), 0.0, 1.0) : 1;
  return a.x + share * (b.x - a.x);
}

/// The problem linearised at x, with the record's proximal term.
lcp::AffineMcp linearised(const Mcp& mcp, const Vec& x, double lambda) {
  Vec F(x.size());
  SpMat J = mcp.jacobian_pattern();
  EXPECT_TRUE(mcp.eval(x, F) && mcp.jacobian(x, J));
  SpMat identity(x.size(), x.size());
  identity.setIdentity();
  const SpMat M = J + lambda * identity;
  return {M, F - M * x, mcp.box()};
}

/// Every way of a run without chord steps: from the last iterate, to a solution of its linearised problem, through the
/// new iterate at T. Returns the number of ways along kinks.
int check_ways(const Mcp& mcp, const std::vector<Kept>& kept, const std::string& what) {
  int on_path = 0;
  for (std::size_t k = 1; k < kept.size(); ++k) {
    const Iteration& it = kept[k].it;
    // A watchdog's way is an older one, a gradient step follows none.
    EXPECT_TRUE(!kept[k].way || it.kind != 'G' || kept[k].way->T == 0);
    if (!kept[k].way || it.kind == 'W' || it.kind == 'G' || it.kind == 'R') continue;
    SCOPED_TRACE(what + ", record " + std::to_string(k) + ", kind " + it.kind);
    const WayTaken& way = *kept[k].way;
    const auto& kinks = way.kinks;
    if (kinks.size() < 2U) {
      ADD_FAILURE() << "a way of " << kinks.size() << " corners";
      continue;
    }
    const double size = 1 + kinks.back().x.norm();
    EXPECT_EQ(kinks.front().t, 0);
    EXPECT_EQ(way.T, it.step);
    EXPECT_LE((lcp::project(mcp.box(), kinks.front().x) - kept[k - 1].x).norm(), 1e-12 * size);
    EXPECT_LE((lcp::project(mcp.box(), at(way, way.T)) - kept[k].x).norm(), 1e-12 * size);
    if (it.linear == 'S') {
      EXPECT_NEAR(kinks.back().t, 1, 1e-9);
      const lcp::AffineMcp problem = linearised(mcp, kept[k - 1].x, it.prox);
      const double newton = support::violation(mcp.box(), lcp::project(mcp.box(), kinks.back().x),
                                               problem.M * lcp::project(mcp.box(), kinks.back().x) + problem.q);
      EXPECT_LE(newton, 1e-7 * (1 + problem.q.lpNorm<Eigen::Infinity>()));
    }
    on_path += way.on_path;
  }
  return on_path;
}

// Catches kinks of another iteration or of the perturbed start, a T that is not the accepted one, and ways whose end is
// no Newton point: pictures of something else than what happened.
TEST(PathRecords, WaysBeginAtTheIterateAndEndAtTheNewtonPoint) {
  Random random(1);
  for (const Searchtype search : {Searchtype::Path, Searchtype::Arc, Searchtype::Line})
    for (const bool nms : {true, false}) {
      PathSearch method{.search = search, .crash = {.on = false}, .chord_steps = 0};
      method.nms.on = nms;
      int on_path = 0;
      int backtracked = 0;
      const auto expect_ways = [&](const Mcp& mcp, const Vec& x0, const std::string& what) {
        std::vector<Kept> kept;
        solve(mcp, x0, method, keep(kept));
        on_path += check_ways(mcp, kept, what);
        for (const Kept& each : kept) backtracked += each.it.kind == 'B';
      };
      for (const bool josephy : {false, true})
        for (const Vec& x0 : support::kojima_shindo_starts())
          expect_ways(*make_mcp(support::kojima_shindo(josephy)), x0, josephy ? "josephy" : "kojima-shindo");
      for (int k = 0; k < 10; ++k) {
        const auto [functions, solution] = support::planted(8, 0.2, random);
        expect_ways(*make_mcp(functions), 5 * random.normals(8), "planted");
      }
      expect_ways(*make_mcp(support::nash10()), Vec::Constant(10, 100), "nash10");
      EXPECT_EQ(on_path > 0, search == Searchtype::Path) << on_path;
      EXPECT_GT(backtracked, 0);
    }
}

// From z^0 the way begins at the point x of the normal map with the least ||F + x - z||: 0 in every row whose bound F
// holds. Catches paths from other points of the same cell, whose r is larger.
TEST(PathRecords, TheFirstWayBeginsAtTheLeastNormalMapResidual) {
  Random random(3);
  int held = 0;
  for (int k = 0; k < 10; ++k) {
    const auto [functions, solution] = support::planted(8, 0, random);
    const auto mcp = make_mcp(functions);
    std::vector<Kept> kept;
    PathSearch method{.crash = {.on = false}};
    solve(*mcp, lcp::project(mcp->box(), -100 * Vec::Ones(8)), method, keep(kept));
    if (kept.size() < 2 || !kept[1].way || !kept[1].way->on_path) continue;
    const Vec& z = kept[0].x;
    const Vec& x = kept[1].way->kinks.front().x;
    Vec F(8);
    ASSERT_TRUE(mcp->eval(z, F));
    for (Index i = 0; i < 8; ++i) {
      const bool lower = z[i] == mcp->box().lower[i] && F[i] > 0;
      const bool upper = z[i] == mcp->box().upper[i] && F[i] < 0;
      EXPECT_NEAR(x[i], lower || upper ? z[i] - F[i] : z[i], 1e-9 * (1 + std::abs(F[i]))) << i;
      held += lower || upper;
    }
  }
  EXPECT_GT(held, 0);
}

// A watchdog's way is the one by which the last point that had passed a test was left. Catches the way of the Newton
// point that was refused.
TEST(PathRecords, WatchdogsSearchAlongAnEarlierWay) {
  const auto mcp = make_mcp(support::scalar(
      -infinity, infinity, [](double x) { return std::atan(x) + 0.3 * std::sin(3 * x); },
      [](double x) { return 1 / (1 + x * x) + 0.9 * std::cos(3 * x); }));
  PathSearch method{.crash = {.on = false}, .nms = {.memory = 1, .initial_reference_factor = 1}};
  method.chord_steps = 0;
  int watchdogs = 0;
  for (int start = 0; start < 30; ++start) {
    std::vector<Kept> kept;
    solve(*mcp, vec({-6 + 0.4 * start}), method, keep(kept));
    for (std::size_t k = 1; k < kept.size(); ++k) {
      if (kept[k].it.kind != 'W' || kept[k].it.step == 0) continue;
      ++watchdogs;
      ASSERT_TRUE(kept[k].way);
      const Vec from = kept[k].way->kinks.front().x;
      EXPECT_NE(from, kept[k - 1].x);
      EXPECT_TRUE(std::any_of(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(k) - 1,
                              [&](const Kept& earlier) { return (earlier.x - from).norm() < 1e-12; }));
      EXPECT_LE((at(*kept[k].way, kept[k].way->T) - kept[k].x).norm(), 1e-12);
    }
  }
  EXPECT_GT(watchdogs, 0);
}

// Chord steps go on from T = 1: the iterate is beyond the way's end then, and its merit less. Catches a way that is
// said to end where chord steps came to.
TEST(PathRecords, ChordStepsAreBeyondTheWay) {
  const auto mcp = make_mcp(support::kojima_shindo(true));
  std::vector<Kept> kept;
  const Result result = solve(*mcp, Vec::Zero(4), path({.crash = {.on = false}}), keep(kept));
  ASSERT_TRUE(result.solved());
  ASSERT_GT(result.stats.chord_steps, 0);
  int beyond = 0;
  for (const Kept& each : kept)
    if (each.way && each.way->T == 1)
      beyond += (lcp::project(mcp->box(), each.way->kinks.back().x) - each.x).norm() > 1e-12;
  EXPECT_EQ(beyond, result.stats.chord_steps);
}

// Catches crash steps counted as iterations, a merit that rises, changes and sizes of another step.
TEST(PathRecords, CrashStepsAreNoMajorIterations) {
  const auto mcp = make_mcp(support::obstacle(12));
  std::vector<Kept> kept;
  const Result result = solve(*mcp, Vec::Zero(144), path(), keep(kept));
  ASSERT_TRUE(result.solved());
  ASSERT_GE(kept.size(), 2U);
  EXPECT_TRUE(kept[0].it.crash);
  EXPECT_EQ(kept[0].it.kind, 'I');
  int steps = 0;
  for (std::size_t k = 1; k < kept.size() && kept[k].it.crash; ++k) {
    ++steps;
    const Iteration& it = kept[k].it;
    EXPECT_EQ(it.k, 0);
    EXPECT_EQ(it.kind, 'C');
    EXPECT_EQ(it.pivots, 0);
    EXPECT_GT(it.step, 0);
    EXPECT_LT(it.merit, kept[k - 1].it.merit);
    EXPECT_GE(it.changes, 0);
    EXPECT_LE(it.changes, 144);
    EXPECT_GT(it.inside, 0);
    EXPECT_LE(it.inside, 144);
    EXPECT_FALSE(kept[k].way);
  }
  EXPECT_GT(steps, 0);
  EXPECT_EQ(steps, result.stats.crash_iterations);
}

/// `f` and one more variable x_n, which occurs in F_n = 2 x_n - sum x_i^3 alone: presolve computes it afterwards.
Functions with_a_singleton_column(const Functions& f, long& evaluations) {
  const Index n = f.box.size();
  Box box = f.box;
  box.lower.conservativeResize(n + 1);
  box.upper.conservativeResize(n + 1);
  box.lower[n] = -lcp::infinity;
  box.upper[n] = lcp::infinity;
  Functions longer = support::dense(
      "longer", box,
      [f, n, &evaluations](const Vec& x) {
        ++evaluations;
        Vec F(n + 1);
        Vec there(n);
        f.F(x.head(n), there);
        F << there, 2 * x[n] - x.head(n).array().cube().sum();
        return F;
      },
      [f, n](const Vec& x) {
        SpMat there = f.pattern;
        f.J(x.head(n), there);
        Dense J = Dense::Zero(n + 1, n + 1);
        J.topLeftCorner(n, n) = there;
        J.row(n).head(n) = -3 * x.head(n).array().square();
        J(n, n) = 2;
        return J;
      });
  longer.linear_entries.assign(static_cast<std::size_t>((n + 1) * (n + 1)), false);
  std::fill(longer.linear_entries.end() - (n + 1), longer.linear_entries.end(), true);
  return longer;
}

// Of a record an observer gets the iterate, which takes two evaluations of F where a variable is computed afterwards.
// Catches the same for every kink of the paths, which nobody asked for.
TEST(PathRecords, KinksAreBroughtBackWhereTheyAreAskedForAlone) {
  Random random(5);
  int kinks = 0;
  for (int k = 0; k < 20; ++k) {
    long evaluations = 0;
    const auto mcp = make_mcp(with_a_singleton_column(support::planted(10, 0.5, random).functions, evaluations));
    const Vec start = 20 * random.normals(11);
    const PathSearch method{.crash = {.on = false}};
    (void)solve(*mcp, start, method);
    const long alone = std::exchange(evaluations, 0);
    std::vector<Iteration> records;
    (void)solve(*mcp, start, method, record(records));
    EXPECT_LE(evaluations, alone + 3 * static_cast<long>(records.size()));
    std::vector<Kept> kept;
    (void)solve(*mcp, start, method, keep(kept));
    for (const Kept& each : kept) {
      if (!each.way) continue;
      kinks += static_cast<int>(each.way->kinks.size());
      EXPECT_EQ(each.way->kinks.back().x.size(), 11);
    }
  }
  EXPECT_GT(kinks, 200);
}

// Catches a callback kept as a std::function that cannot be passed on, and a flag that copies lose.
TEST(PathRecords, AnObserverIsMadeOfAFunction) {
  int seen = 0;
  const std::function<Next(const Iteration&)> function = [&seen](const Iteration& it) {
    seen += it.way == nullptr;
    return Next::Continue;
  };
  const auto mcp = make_mcp(support::billups());
  (void)solve(*mcp, vec({0}), path(), function);
  EXPECT_GT(seen, 0);
  const Observer asked = of_ways(function);
  const Observer copy = all({{}, asked});
  EXPECT_TRUE(copy.ways);
  EXPECT_FALSE(Observer(function).ways);
}

// Pivots of the records sum up to those of the result, and so do kinds. Catches figures of the log that contradict
// those of the statistics.
TEST(PathRecords, AddUpToTheStatistics) {
  Random random(2);
  for (int k = 0; k < 20; ++k) {
    const auto [functions, solution] = support::planted(10, 0.5, random);
    const auto mcp = make_mcp(functions);
    std::vector<Iteration> records;
    const Result result = solve(*mcp, 20 * random.normals(10), path({}, 0), record(records));
    Stats sums;
    for (const Iteration& it : records) {
      sums.pivots += it.pivots;
      sums.gradient_steps += it.kind == 'G';
      sums.watchdogs += it.kind == 'W';
      sums.unchecked_steps += it.kind == 'D';
      sums.crash_iterations += it.kind == 'C';
    }
    EXPECT_EQ(sums.pivots, result.stats.pivots);
    EXPECT_EQ(sums.gradient_steps, result.stats.gradient_steps);
    EXPECT_EQ(sums.watchdogs, result.stats.watchdogs);
    EXPECT_EQ(sums.unchecked_steps, result.stats.unchecked_steps);
    EXPECT_EQ(sums.crash_iterations, result.stats.crash_iterations);
    EXPECT_EQ(records.back().J_evals, result.stats.J_evals);
    EXPECT_EQ(records.back().k, result.stats.iterations);
  }
}

/// Josephy's problem in the midst of what presolve takes out: x_1 fixed, F_3 = 2 x_3 - 3 a singleton row, x_7 = 0 by
/// the sign of F_7. With a slope of Josephy's equations by x_1 and x_3.
Functions presolvable() {
  const Functions inner = support::kojima_shindo(true);
  Functions functions;
  functions.name = "presolvable";
  functions.box = Box::nonnegative(7);
  functions.box.lower[0] = functions.box.upper[0] = 2;
  const std::vector<Index> places{1, 3, 4, 5};
  Dense pattern = Dense::Zero(7, 7);
  for (const Index i : places) {
    for (const Index j : places) pattern(i, j) = 1;
    pattern(i, 0) = pattern(i, 2) = 1;
  }
  pattern(0, 0) = pattern(0, 1) = pattern(2, 2) = pattern(6, 6) = pattern(6, 2) = 1;
  functions.pattern = support::sparse(pattern);
  functions.F = [F = inner.F, places](In x, Out out) {
    Vec z(4);
    Vec f(4);
    for (Index k = 0; k < 4; ++k) z[k] = x[places[static_cast<std::size_t>(k)]];
    F(z, f);
    for (Index k = 0; k < 4; ++k)
      out[places[static_cast<std::size_t>(k)]] = f[k] + (x[0] - 2) + (x[2] - 1.5);  // 0 at the solution
    out[0] = x[0] + x[1];
    out[2] = 2 * x[2] - 3;
    out[6] = 1 + x[2] + x[6];
    return true;
  };
  functions.J = [J = inner.J, places](In x, SpMat& out) {
    Vec z(4);
    SpMat inside = dense_pattern(4);
    for (Index k = 0; k < 4; ++k) z[k] = x[places[static_cast<std::size_t>(k)]];
    J(z, inside);
    for (Index k = 0; k < 4; ++k) {
      const Index i = places[static_cast<std::size_t>(k)];
      for (Index l = 0; l < 4; ++l) out.coeffRef(i, places[static_cast<std::size_t>(l)]) = inside.coeff(k, l);
      out.coeffRef(i, 0) = out.coeffRef(i, 2) = 1;
    }
    out.coeffRef(0, 0) = out.coeffRef(0, 1) = out.coeffRef(6, 6) = out.coeffRef(6, 2) = 1;
    out.coeffRef(2, 2) = 2;
    return true;
  };
  for (Index j = 0; j < 7; ++j)
    for (SpMat::InnerIterator e(functions.pattern, j); e; ++e)
      functions.linear_entries.push_back(e.row() == 0 || e.row() == 2 || e.row() == 6 || j == 0 || j == 2);
  return functions;
}

// Three of seven pairs go. Catches an x, a worst row, a way or a problem of the reduced numbering that the user's
// observer gets: wrong names in the log, evaluations of one problem at the points of another.
TEST(PathRecords, AreOfTheFullProblemWithPresolve) {
  const auto mcp = make_mcp(presolvable());
  ASSERT_TRUE(check_jacobian(*mcp, vec({2, 1, 2, 3, 4, 5, 6})).worst < 1e-6);
  for (const bool crash : {true, false})
    for (const double start : {0.0, 1.0, 100.0}) {
      PathSearch kernel{.chord_steps = 0};
      kernel.crash.on = crash;
      const Method method = path(kernel);
      std::vector<Kept> kept;
      const Result result = solve(*mcp, Vec::Constant(7, start), method, of_ways([&](const Iteration& it) {
        EXPECT_EQ(it.problem, mcp.get());
        return keep(kept)(it);
      }));
      ASSERT_TRUE(result.solved()) << result;
      EXPECT_EQ(result.stats.presolved, 3);
      EXPECT_LE((result.x - vec({2, std::sqrt(6) / 2, 1.5, 0, 0, 0.5, 0})).norm(), 1e-6) << result.x.transpose();
      EXPECT_LE(support::violation(*mcp, result.x), 1e-8);
      EXPECT_EQ(result.basis.size(), result.basis.empty() ? 0U : 7U);
      for (const Kept& each : kept) {
        ASSERT_EQ(each.x.size(), 7);
        const Residual judged = residual(*mcp, lcp::project(mcp->box(), each.x));
        EXPECT_NEAR(judged.natural, each.it.residual, 1e-12 * (1 + judged.natural));
        EXPECT_TRUE(judged.natural < 1e-10 || judged.worst == each.it.worst) << each.it.worst;
      }
      const int on_path = check_ways(*mcp, kept, "presolved");
      EXPECT_TRUE(crash || on_path > 0);
    }
}

// Attempts after the first say what they are, once. Catches restarts that cannot be told from iterations.
TEST(PathRecords, RestartsAreNamed) {
  const auto mcp = make_mcp(support::billups());
  std::vector<Iteration> records;
  const Result result = solve(*mcp, vec({0}), path(), record(records));
  ASSERT_TRUE(result.solved()) << result;
  ASSERT_GT(result.stats.restarts, 0);
  std::vector<std::string> attempts;
  int last = 0;
  for (const Iteration& it : records) {
    if (!it.attempt.empty()) attempts.push_back(it.attempt);
    EXPECT_GE(it.k, last) << "iterations count on";
    last = it.k;
  }
  EXPECT_GE(static_cast<int>(attempts.size()), result.stats.restarts);
  EXPECT_EQ(std::unique(attempts.begin(), attempts.end()), attempts.end());
  EXPECT_THAT(result.message, testing::HasSubstr("after a restart: little patience, then proximal escapes"));
}

}  // namespace
}  // namespace perp::ncp

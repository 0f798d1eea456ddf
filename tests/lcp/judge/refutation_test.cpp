// SPDX-License-Identifier: Apache-2.0
#include "lcp/judge/refutation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lcp/adversarial_support.hpp"
#include "lcp/exact_judge.hpp"
#include "lcp/solve/solve.hpp"

namespace perp::lcp {
namespace {

using adversarial::Rng;

/// Systems with a solution by construction: equations and inequalities of integer coefficients up to 1000, rows and
/// columns scaled by powers of two from 2^-40 to 2^40. Chains: row k has variables k and k - 1; trees: k and one before
/// it; parallel: multiples of a row, some of whose right-hand sides are rounded.
struct Planted {
  AffineMcp problem;
  Vec solution;
};

void scale(Rng& r, Planted& p) {
  const Index n = p.problem.size();
  Vec rows(n), columns(n);
  for (Index i = 0; i < n; ++i) {
    rows[i] = std::ldexp(1.0, r.integer(-40, 40));
    columns[i] = std::ldexp(1.0, r.integer(-40, 40));
  }
  p.problem.M = rows.asDiagonal() * p.problem.M * columns.asDiagonal();
  p.problem.q = p.problem.q.cwiseProduct(rows);
  p.problem.box.lower = p.problem.box.lower.cwiseQuotient(columns);
  p.problem.box.upper = p.problem.box.upper.cwiseQuotient(columns);
  p.solution = p.solution.cwiseQuotient(columns);
}

double coefficient(Rng& r) { return r.integer(1, 1000) * (r.chance(50) ? 1.0 : -1.0); }

/// x_0 = a / b, x_k = (c x_parent + d) / e, in rows of any place; a last variable of which two rows know.
Planted planted(Rng& r) {
  const Index n = r.integer(2, 40);
  const int kind = r.integer(0, 2);
  Planted p{{SpMat(n, n), Vec::Zero(n), Box::free(n)}, Vec::Zero(n)};
  std::vector<Eigen::Triplet<double>> entries;
  Vec& x = p.solution;
  for (Index k = 0; k < n; ++k) {
    const double a = coefficient(r);
    entries.emplace_back(k, k, a);
    if (kind == 2 && k > 0 && r.chance(40)) {  // a multiple of the row before, q as it comes
      entries.pop_back();
      const double t = r.integer(1, 9);
      for (const auto& e : std::vector(entries))
        if (e.row() == k - 1) entries.emplace_back(k, e.col(), t * e.value());
      p.problem.q[k] = t * p.problem.q[k - 1];
      x[k] = r.integer(-9, 9);
      continue;
    }
    const double d = r.integer(-1000, 1000);
    double rest = d;
    if (k > 0) {
      const Index parent = kind == 1 ? r.integer(0, static_cast<int>(k) - 1) : k - 1;
      const double c = coefficient(r);
      entries.emplace_back(k, parent, c);
      rest += c * x[parent];
    }
    p.problem.q[k] = d;
    x[k] = -rest / a;
    if (r.chance(20)) p.problem.box.lower[k] = x[k] - (r.chance(50) ? 0 : 1);
    if (r.chance(10)) p.problem.box.upper[k] = x[k] + 1;
  }
  p.problem.M.setFromTriplets(entries.begin(), entries.end());
  if (r.chance(50)) scale(r, p);
  return p;
}

// Exact solutions are next to these points: what rounding leaves of them excludes nothing above it. Catches a bound
// that is carried from row to row without the rounding of its steps, rows that are parallel to 1e-15 taken for
// parallel (90 of 3,756 such systems were "proven" to have no solution).
TEST(Refutation, NothingIsProvenOfPlantedSystems) {
  Rng r(20261128);
  int taken = 0;
  for (int k = 0; k < 4000; ++k) {
    const Planted p = planted(r);
    const double residual = exact::residual(p.problem, p.solution).get_d();
    if (!(residual <= 1e-9)) continue;
    ++taken;
    const Refutation found = refute(p.problem, Vec(), 1e-9);
    ASSERT_LT(found.tolerance, 1e-9) << k << ": " << residual;
  }
  EXPECT_GT(taken, 1000);
}

/// x_0 = 1/3 and x_k = x_{k-1} in a chain, and x_{n-1} = 1/3 + gap in the row of a variable that occurs nowhere.
AffineMcp broken_chain(Index n, double gap) {
  AffineMcp p{SpMat(n + 1, n + 1), Vec::Zero(n + 1), Box::free(n + 1)};
  std::vector<Eigen::Triplet<double>> entries{{0, 0, 3.0}, {static_cast<int>(n), static_cast<int>(n) - 1, 3.0}};
  p.q[0] = -1;
  p.q[n] = -1 - 3 * gap;
  for (Index k = 1; k < n; ++k) {
    entries.emplace_back(k, k, 1.0);
    entries.emplace_back(k, k - 1, -1.0);
  }
  p.M.setFromTriplets(entries.begin(), entries.end());
  return p;
}

// The residual of the best point is 3 gap / (2 + 3 (n - 1)): all rows miss by the same. Catches proofs that are lost
// with the false ones, and a bound beyond what a point has.
TEST(Refutation, BrokenChainsAreRefutedUpToTheirBestPoint) {
  for (const Index n : {2, 5, 40})
    for (const double gap : {1e-6, 1.0}) {
      const AffineMcp p = broken_chain(n, gap);
      const double best = 3 * gap / static_cast<double>(2 + 3 * (n - 1));
      const Refutation found = refute(p, Vec(), 1e-9);
      EXPECT_GE(found.tolerance, best / 2) << n;
      EXPECT_LE(found.tolerance, best * (1 + 1e-9)) << n;
      EXPECT_TRUE(holds(p, found));
      // The same is feasible to a larger tolerance.
      EXPECT_LT(refute(p, Vec(), 2 * best).tolerance, 2 * best);
    }
}

// x + 0.9 y = 1 and 3 x + 2.7 y = 4: as doubles the rows are not parallel, and the solution is far out; with 0.875 they
// are. Catches comparisons of rows to 1e-15.
TEST(Refutation, RowsAreParallelOnlyWhereTheyAreExactly) {
  const auto rows = [](double a) {
    AffineMcp p{SpMat(2, 2), Vec(2), Box::free(2)};
    p.M.insert(0, 0) = 1;
    p.M.insert(0, 1) = a;
    p.M.insert(1, 0) = 3;
    p.M.insert(1, 1) = 3 * a;
    p.q << -1, -4;
    return p;
  };
  AffineMcp nearly = rows(0.9);
  nearly.M.coeffRef(1, 1) = 2.7;
  EXPECT_EQ(refute(nearly, Vec(), 1e-9).tolerance, 0);
  const AffineMcp exactly = rows(0.875);
  const Refutation found = refute(exactly, Vec(), 1e-9);
  EXPECT_GT(found.tolerance, 0.2);  // 3 r + r >= 1
  EXPECT_LE(found.tolerance, 0.25);
  EXPECT_TRUE(holds(exactly, found));
}

/// The certificate with what it says enlarged, or multipliers of other signs.
std::vector<Refutation> altered(const Refutation& given) {
  std::vector<Refutation> out;
  const auto with = [&](auto change) {
    out.push_back(given);
    change(out.back());
  };
  with([](Refutation& c) { c.tolerance *= 1000; });
  with([](Refutation& c) {
    for (Multiplier& m : c.proof.y) m.high *= -1, m.low *= -1;
  });
  with([](Refutation& c) { c.proof.y.clear(); });
  return out;
}

// All methods on problems made to fool them: every Infeasible carries a certificate that holds, its tolerance is no
// more than the residual of any point tried (in rationals), and it does not survive a change. Catches a bound that some
// point undercuts, a certificate that anything passes.
TEST(Refutation, HoldsForEveryInfeasibleOfEveryMethod) {
  Rng r(7);
  int proofs = 0;
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    const adversarial::Problem problem = adversarial::make(seed);
    for (const MethodEntry& entry : methods()) {
      const Result result = solve(problem.mcp, problem.start, entry.method, {.tol = 1e-9});
      if (result.status != Status::Infeasible) continue;
      ++proofs;
      ASSERT_TRUE(result.refutation) << seed << ' ' << entry.name;
      ASSERT_TRUE(holds(problem.mcp, *result.refutation)) << seed << ' ' << entry.name;
      EXPECT_GE(result.refutation->tolerance, 1e-9);
      if (std::isinf(result.refutation->radius))
        for (int k = 0; k < 20; ++k) {
          Vec z = problem.start;
          for (Index i = 0; i < z.size(); ++i) z[i] += k == 0 ? 0 : std::ldexp(r.full(), r.integer(-3, 8));
          z = project(problem.mcp.box, z);
          ASSERT_GE(exact::residual(problem.mcp, z), mpq_class(result.refutation->tolerance)) << seed;
        }
      if (!result.refutation->proof.assumptions.empty()) continue;  // what is altered may not be needed
      for (const Refutation& other : altered(*result.refutation))
        EXPECT_FALSE(holds(problem.mcp, other)) << seed << ' ' << entry.name;
    }
  }
  EXPECT_GT(proofs, 100);
}

// x + y = 1 and x + y = 1 + gap for free x, y: below the tolerance there is no answer Infeasible, above it is one, by
// whichever method. Catches two methods that contradict each other at the edge.
TEST(Refutation, InfeasibleMeansTheTolerance) {
  for (const double gap : {1e-16, 1e-12, 1e-10, 1.9e-9, 2.1e-9, 1e-6}) {
    AffineMcp p{SpMat(2, 2), Vec(2), Box::free(2)};
    p.M.insert(0, 0) = 1;
    p.M.insert(0, 1) = 1;
    p.M.insert(1, 0) = 1;
    p.M.insert(1, 1) = 1;
    p.q << -1, -1 - gap;
    for (const MethodEntry& entry : methods()) {
      const Result result = solve(p, Vec::Zero(2), entry.method, {.tol = 1e-9});
      EXPECT_FALSE(gap < 2e-9 ? result.status == Status::Infeasible : result.accepted()) << entry.name << ' ' << gap;
    }
  }
}

}  // namespace
}  // namespace perp::lcp

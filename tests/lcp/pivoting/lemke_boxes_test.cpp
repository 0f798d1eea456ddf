// SPDX-License-Identifier: Apache-2.0
// Lemke's path on small problems with every kind of box, against enumeration; and a campaign over many classes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "lcp/pivoting/lemke.hpp"
#include "lcp/pivoting/lemke_support.hpp"
#include "support/campaign.hpp"

namespace perp::lcp {
namespace {

using support::campaign_problem;
using support::Dense;
using support::dense_p;
using support::Random;
using support::sparse;

/// All solutions of a small problem: every variable at its lower bound, its upper bound, or between with F_i = 0.
/// `complete` is false if a singular cell may hide some.
struct Enumeration {
  std::vector<Vec> solutions;
  bool complete = true;
  bool contains(const Vec& z, double tol) const {
    return std::any_of(solutions.begin(), solutions.end(),
                       [&](const Vec& s) { return (s - z).lpNorm<Eigen::Infinity>() <= tol * (1 + s.norm()); });
  }
};

Enumeration enumerate(const AffineMcp& p, double tol = 1e-9) {
  const Index n = p.size();
  const Dense M = p.M;
  Enumeration found;
  long cells = 1;
  for (Index i = 0; i < n; ++i) cells *= 3;
  for (long cell = 0; cell < cells; ++cell) {
    Vec z = Vec::Zero(n);
    std::vector<Index> between;
    bool possible = true;
    long digits = cell;
    for (Index i = 0; i < n && possible; ++i, digits /= 3) {
      const bool fixed = p.box.lower[i] == p.box.upper[i];
      if (digits % 3 == 0) {
        z[i] = p.box.lower[i];
        possible = std::isfinite(z[i]);
      } else if (digits % 3 == 1) {
        z[i] = p.box.upper[i];
        possible = std::isfinite(z[i]) && !fixed;
      } else {
        between.push_back(i);
        possible = !fixed;
      }
    }
    if (!possible) continue;
    if (!between.empty()) {
      const Vec rhs = -(p.q + M * z)(between);
      const Eigen::FullPivLU<Dense> lu(M(between, between));
      if (!lu.isInvertible()) {
        found.complete = false;
        continue;
      }
      z(between) = lu.solve(rhs);
    }
    const double scale = 1 + p.q.lpNorm<Eigen::Infinity>() + z.lpNorm<Eigen::Infinity>();
    if (support::violation(p, z) <= tol * scale && !found.contains(z, tol)) found.solutions.push_back(z);
  }
  return found;
}

Box random_bounded_box(Index n, Random& random) {
  Box box{random.normals(n), Vec(n)};
  for (Index i = 0; i < n; ++i) box.upper[i] = box.lower[i] + (random.chance(0.2) ? 0 : random.uniform(0.1, 2));
  return box;
}

// Every solution returned is one of the list, from the ray and from regular starts; for P-matrices one is always found
// and the list has one entry (the box form of Samelson, Thrall & Wesler 1958). Catches wrong columns and bounds for one
// kind of interval, and swapped signs at upper bounds.
TEST(LemkeBoxes, AgreesWithEnumeration) {
  Random random(1);
  int found = 0;
  int runs = 0;
  for (int k = 0; k < 400; ++k) {
    const Index n = random.integer(1, 5) + (k % 20 == 0);
    const bool p_matrix = random.chance(0.5);
    const AffineMcp p{p_matrix ? dense_p(n, random) : sparse(random.normals(n, n)), 2 * random.normals(n),
                      support::mixed_box(n, random)};
    const Enumeration all = enumerate(p);
    ASSERT_TRUE(all.complete);
    if (p_matrix) {
      ASSERT_EQ(all.solutions.size(), 1);
    }
    for (int start = 0; start < 4; ++start) {
      const PivotResult result = start == 0 ? lemke_ray(p) : lemke(p, 3 * random.normals(n));
      ++runs;
      found += result.solved();
      if (result.solved()) {
        ASSERT_TRUE(all.contains(result.z, 1e-7)) << "problem " << k << ", start " << start;
      }
      if (p_matrix) {
        ASSERT_EQ(to_string(result.end), "solved") << "problem " << k << ", start " << start;
      }
    }
  }
  EXPECT_GT(found, runs / 2);
}

// With bounded boxes the path from the ray cannot return to infinity: far out G(x) = (1 - t) r needs every x_i below
// its box, which is the primary ray. So every M is solved.
TEST(LemkeBoxes, BoundedBoxesAreSolvedForEveryMatrix) {
  Random random(2);
  for (int k = 0; k < 500; ++k) {
    const Index n = random.integer(1, 30);
    AffineMcp p{sparse(random.normals(n, n)), random.normals(n), random_bounded_box(n, random)};
    if (k % 5 == 1) p.M *= 0;
    if (k % 5 == 2) p.M = support::random_sparse(n, 2, random) * -1;
    if (k % 5 == 3) p.M = sparse(Dense(p.M).array().round());
    expect_solved(p, lemke_ray(p), "bounded");
    if (n <= 4 && k % 5 == 0) {
      ASSERT_TRUE(enumerate(p).contains(lemke_ray(p).z, 1e-7));
    }
  }
}

// A problem and its mirror image z -> -z (M, -q, [-u, -l]) have mirrored solutions; with a P-matrix the methods must
// agree. Catches an asymmetry between lower and upper bounds.
TEST(LemkeBoxes, MirrorImagesHaveMirroredSolutions) {
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    const Index n = random.integer(1, 15);
    const AffineMcp p{dense_p(n, random), random.normals(n), support::mixed_box(n, random)};
    const AffineMcp mirror{p.M, -p.q, {-p.box.upper, -p.box.lower}};
    const Vec x0 = random.normals(n);
    const PivotResult a = lemke(p, x0);
    const PivotResult b = lemke(mirror, -x0);
    const PivotResult c = lemke_ray(mirror);
    expect_solved(p, a);
    expect_solved(mirror, b);
    expect_solved(mirror, c);
    EXPECT_LT((a.z + b.z).norm(), 1e-7 * (1 + a.z.norm()));
    EXPECT_LT((a.z + c.z).norm(), 1e-7 * (1 + a.z.norm()));
  }
}

// Whatever the problem - degenerate, infeasible, of integers, badly scaled - an answer "solved" is one by the
// independent judge, and every run ends before the limit of pivots. P-matrices are all solved, but for those so badly
// scaled that M z cannot be evaluated to the tolerance; t = 1 is reached inaccurately by such problems only.
TEST(LemkeBoxes, SolvedMeansSolvedOnTenThousandProblems) {
  Random random(4);
  int solved = 0;
  int unsolvable_scales = 0;
  for (int k = 0; k < 10000; ++k) {
    const AffineMcp p = campaign_problem(k, random);
    LemkeOptions options = k % 3 ? from_ray() : LemkeOptions{};
    options.max_pivots = 5000;
    const PivotResult result = lemke(p, random.normals(p.size()), options);
    solved += result.solved();
    SCOPED_TRACE("problem " + std::to_string(k) + ": " + std::string(to_string(result.end)));
    if (result.solved()) {
      // The library judges in double precision: its rounding is allowed for.
      const double rounding = 1e-15 * (p.M.cwiseAbs() * result.z.cwiseAbs() + p.q.cwiseAbs()).maxCoeff();
      ASSERT_LE(support::violation(p, result.z), 1.01e-9 * (1 + p.q.lpNorm<Eigen::Infinity>()) + rounding);
    }
    ASSERT_NE(result.end, PivotEnd::PivotLimit);
    if (k % 8 == 1) {
      ASSERT_TRUE(result.solved());
    } else if (k % 8 == 4) {
      ASSERT_TRUE(result.solved() || result.end == PivotEnd::Inaccurate);
      unsolvable_scales += !result.solved();
    } else if (k % 8 != 5) {
      ASSERT_NE(result.end, PivotEnd::Inaccurate);
    }
  }
  EXPECT_GT(solved, 5000);
  EXPECT_LT(unsolvable_scales, 60) << "of 1250";
}

}  // namespace
}  // namespace perp::lcp

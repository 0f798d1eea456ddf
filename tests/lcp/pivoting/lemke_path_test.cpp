// SPDX-License-Identifier: Apache-2.0
// The piecewise-linear path itself: its breakpoints, its rays, and what a ray proves.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lcp/pivoting/lemke.hpp"
#include "lcp/pivoting/lemke_support.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::sparse;
using support::vec;

LemkeOptions with_path(LemkeStart start) {
  LemkeOptions options;
  options.start = start;
  options.keep_path = true;
  return options;
}

/// || G(x) - (1 - t) r || relative to the terms of G.
double path_error(const AffineMcp& p, const Vec& r, double t, const Vec& x) {
  const Vec z = project(p.box, x);
  const Vec terms = p.M.cwiseAbs() * z.cwiseAbs() + p.q.cwiseAbs() + x.cwiseAbs() + r.cwiseAbs() * (1 + std::abs(t));
  return (normal_map(p, x) - (1 - t) * r).lpNorm<Eigen::Infinity>() / (1 + terms.maxCoeff());
}

/// A problem of size n, alternately monotone, P and arbitrary, with a mixed box.
AffineMcp problem_of(int k, Index n, Random& random) {
  SpMat M = k % 3 == 0   ? support::psd_plus_skew(n, 1, random)
            : k % 3 == 1 ? support::h_plus(n, 2, random)
                         : sparse(random.normals(n, n));
  return {std::move(M), random.normals(n), support::mixed_box(n, random)};
}

// Every breakpoint satisfies G(x) = (1 - t) r, and so does the middle of two neighbours: G is linear between them, so
// they lie in one cell. Catches a basis that no longer represents the cells, a skipped kink, and drift.
TEST(LemkePath, BreakpointsLieOnThePathAndNeighboursInOneCell) {
  Random random(1);
  long kinks = 0;
  for (int k = 0; k < 120; ++k) {
    const Index n = random.integer(1, 40);
    const AffineMcp p = problem_of(k, n, random);
    const LemkeOptions options = with_path(k % 2 ? LemkeStart::Ray : LemkeStart::Regular);
    const PivotResult result = lemke(p, random.normals(n), options);
    ASSERT_FALSE(result.path.empty());
    ASSERT_EQ(result.path.front().t, 0);
    ASSERT_EQ(result.path.back().t, result.t);
    ASSERT_GE(static_cast<int>(result.path.size()), result.pivots + 1);
    const Vec r = normal_map(p, result.path.front().x);
    for (std::size_t b = 0; b < result.path.size(); ++b) {
      const Breakpoint& here = result.path[b];
      ASSERT_LT(path_error(p, r, here.t, here.x), 1e-9) << "problem " << k << ", breakpoint " << b;
      ASSERT_LE(here.t, 1);
      if (b == 0) continue;
      const Breakpoint& last = result.path[b - 1];
      ASSERT_LT(path_error(p, r, (last.t + here.t) / 2, (last.x + here.x) / 2), 1e-9)
          << "problem " << k << ", segment " << b;
    }
    ASSERT_LT(path_error(p, r, result.best_t, result.best_x), 1e-9) << "problem " << k;
    for (const Breakpoint& b : result.path) ASSERT_LE(b.t, result.best_t);
    kinks += result.pivots;
  }
  EXPECT_GT(kinks, 1000);
}

// Breakpoints by hand: F = 2 z - 4 on z >= 0 from x0 = -1, r = G(-1) = -5. Outside the box G = x - 4, which meets 0 at
// t = 1/5; inside G = 2 x - 4, which vanishes at 2.
TEST(LemkePath, OfOneUnknown) {
  LemkeOptions options = with_path(LemkeStart::Regular);
  options.perturbation = 0;
  const PivotResult result = lemke(standard_lcp(matrix({{2}}), vec({-4})), vec({-1}), options);
  ASSERT_EQ(result.path.size(), 3);
  EXPECT_EQ(result.path[0].x, vec({-1}));
  EXPECT_NEAR(result.path[1].t, 0.2, 1e-15);
  EXPECT_NEAR(result.path[1].x[0], 0, 1e-15);
  EXPECT_EQ(result.path[2].t, 1);
  EXPECT_NEAR(result.path[2].x[0], 2, 1e-15);
  EXPECT_EQ(result.pivots, 2);
}

// Without perturbation the path begins at the point given; with it, close to that point and in its cell.
TEST(LemkePath, BeginsAtTheStart) {
  Random random(2);
  for (int k = 0; k < 50; ++k) {
    const Index n = random.integer(1, 20);
    const AffineMcp p{support::h_plus(n, 2, random), random.normals(n), support::mixed_box(n, random)};
    Vec x0 = random.normals(n);
    if (k % 2) x0 = project(p.box, x0);  // many at their bounds
    LemkeOptions options = with_path(LemkeStart::Regular);
    const Vec moved = lemke(p, x0, options).path.front().x;
    EXPECT_LT((moved - x0).lpNorm<Eigen::Infinity>(), 1e-3);
    options.perturbation = 0;
    const PivotResult exact = lemke(p, x0, options);
    EXPECT_LT((exact.path.front().x - x0).lpNorm<Eigen::Infinity>(), 1e-15 * 8);
    expect_solved(p, exact);
  }
}

// A ray is one: x + s ray satisfies G = (1 - t(s)) r with t linear in s, however far. Those of arbitrary matrices.
TEST(LemkePath, RaysStayOnThePath) {
  Random random(3);
  int rays = 0;
  for (int k = 0; k < 300; ++k) {
    const Index n = random.integer(1, 12);
    const AffineMcp p{sparse(random.normals(n, n)), random.normals(n), support::mixed_box(n, random)};
    const PivotResult result = lemke(p, random.normals(n), with_path(k % 2 ? LemkeStart::Ray : LemkeStart::Regular));
    if (result.end != PivotEnd::Ray) {
      EXPECT_EQ(result.ray.size(), 0);
      continue;
    }
    ++rays;
    const Vec r = normal_map(p, result.path.front().x);
    const double length = result.ray.lpNorm<Eigen::Infinity>();
    ASSERT_GT(length, 0);
    for (const double s : {0.0, 1.0, 1e3, 1e6}) {
      const Vec x = result.x + s / length * result.ray;
      const Vec G = normal_map(p, x);
      const double t = 1 - G.dot(r) / r.squaredNorm();
      ASSERT_LT(path_error(p, r, t, x), 1e-9) << "problem " << k << " at " << s;
      ASSERT_LE(t, result.t + 1e-9 * (1 + s)) << "t cannot pass 1 on a ray";
    }
  }
  EXPECT_GT(rays, 50);
}

/// The direction of z far out on the ray.
Vec ray_of_z(const AffineMcp& p, const PivotResult& result) {
  const double far = 1e8 / result.ray.lpNorm<Eigen::Infinity>();
  return (project(p.box, result.x + 2 * far * result.ray) - project(p.box, result.x + far * result.ray)) / far;
}

// M copositive-plus (here positive semidefinite): if the method ends on a ray the problem has no feasible point, and
// the ray's z-part v proves it: v >= 0, M' v <= 0, q' v < 0, hence v' (M z + q) < 0 for every z >= 0 (Cottle, Pang &
// Stone 1992, section 4.4). Catches a ray claimed by mistake, and t = 1 "reached" by rounding far out on a true one.
void expect_certificate(const AffineMcp& p, const PivotResult& result, const char* what) {
  ASSERT_EQ(to_string(result.end), "ray") << what;
  Vec v = ray_of_z(p, result);
  v /= v.lpNorm<Eigen::Infinity>();
  const double scale = 1 + p.M.coeffs().cwiseAbs().maxCoeff();
  EXPECT_GT(v.minCoeff(), -1e-9) << what;
  EXPECT_LT((p.M.transpose() * v).maxCoeff(), 1e-8 * scale) << what;
  EXPECT_LT(p.q.dot(v), -1e-6) << what;
}

// Catches a proof that is asked for and not made, and one that is made and not asked for.
TEST(LemkePath, ARayIsCertifiedWhereThatIsAskedFor) {
  const AffineMcp p = standard_lcp(matrix({{0, -1}, {1, 0}}), vec({-1, -1}));
  for (const bool certify : {true, false}) {
    LemkeOptions options;
    options.start = LemkeStart::Ray;
    options.certify = certify;
    const PivotResult result = lemke(p, Vec::Zero(2), options);
    EXPECT_EQ(to_string(result.end), "ray");
    EXPECT_EQ(result.certificate.size(), certify ? 2 : 0);
  }
}

TEST(LemkePath, TheRayOfAnInfeasibleMonotoneProblemIsACertificate) {
  // F_1 = -z_2 - 1 < 0; and a linear program without a feasible point: x >= 2, -x >= -1.
  const AffineMcp skew = standard_lcp(matrix({{0, -1}, {1, 0}}), vec({-1, -1}));
  expect_certificate(skew, lemke_ray(skew), "skew");
  const AffineMcp program = standard_lcp(matrix({{0, -1, 1}, {1, 0, 0}, {-1, 0, 0}}), vec({1, -2, 1}));
  expect_certificate(program, lemke_ray(program), "linear program");

  Random random(4);
  for (int k = 0; k < 300; ++k) {
    const Index n = random.integer(2, 30);
    // v >= 0 with M' v = 0 and q' v < 0 is planted: M = P' (psd + skew) P with P v = 0.
    Vec v = random.normals(n).cwiseMax(0);
    v[random.integer(0, static_cast<int>(n) - 1)] = 1;
    const Dense P = Dense::Identity(n, n) - v * v.transpose() / v.squaredNorm();
    const Dense B = random.normals(n, n);
    const Dense S = random.normals(n, n);
    const AffineMcp p = standard_lcp(sparse(P * (B * B.transpose() + S - S.transpose()) * P), [&] {
      const Vec q = random.normals(n);
      return Vec(q - (q.dot(v) + random.uniform(0.1, 1)) / v.squaredNorm() * v);
    }());
    expect_certificate(p, lemke_ray(p), "planted");
    ASSERT_FALSE(HasFailure()) << k;
  }
}

// Integer data of linear programs: whatever is feasible is solved, whatever ends on a ray has its certificate. Every
// run ends one way or the other.
TEST(LemkePath, LinearProgramsAreSolvedOrProvedInfeasible) {
  Random random(5);
  int solved = 0;
  int rays = 0;
  for (int k = 0; k < 2000; ++k) {
    const Index m = random.integer(1, 8);
    const Index n = random.integer(1, 8);
    Dense M = Dense::Zero(m + n, m + n);
    M.bottomLeftCorner(m, n) = Dense::NullaryExpr(m, n, [&](Index, Index) { return random.integer(-2, 2); });
    M.topRightCorner(n, m) = -M.bottomLeftCorner(m, n).transpose();
    const Vec q = Vec::NullaryExpr(m + n, [&](Index) { return random.integer(-3, 3); });
    const AffineMcp p = standard_lcp(sparse(M), q);
    const PivotResult result = lemke_ray(p);
    if (result.solved()) {
      ++solved;
      ASSERT_LT(support::violation(p, result.z), 1e-8) << k;
    } else if (p.M.nonZeros() > 0) {
      ++rays;
      expect_certificate(p, result, "linear program");
      ASSERT_FALSE(HasFailure()) << k;
    }
  }
  EXPECT_GT(solved, 300);
  EXPECT_GT(rays, 300);
}

}  // namespace
}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#include "lcp/equilibrate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lcp/pivoting/lemke_support.hpp"

namespace perp::lcp {
namespace {

using support::matrix;
using support::Random;
using support::vec;

AffineMcp badly_scaled(Index n, Random& random) {
  const auto factors = [&] { return Vec(Vec::NullaryExpr(n, [&] { return std::pow(10, random.uniform(-6, 6)); })); };
  const Vec rows = factors();
  return {rows.asDiagonal() * support::h_plus(n, 2, random) * factors().asDiagonal(),
          rows.asDiagonal() * random.normals(n), support::mixed_box(n, random)};
}

// The rows and columns have a largest entry near one afterwards, and so has q.
TEST(Equilibrate, BringsTheLargestEntriesNearOne) {
  Random random(1);
  for (int k = 0; k < 100; ++k) {
    const AffineMcp p = badly_scaled(random.integer(1, 30), random);
    const AffineMcp scaled = equilibrate(p).apply(p);
    const Eigen::MatrixXd M = Eigen::MatrixXd(scaled.M).cwiseAbs();
    for (Index i = 0; i < p.size(); ++i) {
      EXPECT_NEAR(std::log2(M.row(i).maxCoeff()), 0, 2);
      EXPECT_NEAR(std::log2(M.col(i).maxCoeff()), 0, 2);
    }
    EXPECT_NEAR(std::log2(scaled.q.lpNorm<Eigen::Infinity>()), 0, 1);
  }
}

// The claim on which it all rests: x' = D^-1 z + E (x - z) gives G'(x') = E G(x), and the way back is the inverse.
TEST(Equilibrate, NormalMapsCorrespond) {
  Random random(2);
  for (int k = 0; k < 200; ++k) {
    const Index n = random.integer(1, 12);
    const AffineMcp p = badly_scaled(n, random);
    const Scaling s = equilibrate(p);
    const AffineMcp scaled = s.apply(p);
    const Vec x = 3 * random.normals(n);
    const Vec there = s.to_scaled(p.box, x);
    const Vec G = s.rows.cwiseProduct(normal_map(p, x));
    // Rounding is relative to the terms of G(x), the x that cancels in x - pi(x) among them.
    const Vec terms = scaled.M.cwiseAbs() * project(scaled.box, there).cwiseAbs() + scaled.q.cwiseAbs() +
                      s.rows.cwiseProduct(x.cwiseAbs() + project(p.box, x).cwiseAbs());
    EXPECT_LT((normal_map(scaled, there) - G).norm(), 1e-14 * (terms.norm() + there.norm() + G.norm()));
    // x' holds z' and E (x - z) in one number: what is rounded is relative to the larger.
    const Vec error = (s.to_original(scaled.box, there) - x).cwiseAbs();
    const Vec unit = s.columns.cwiseMax(s.rows.cwiseInverse());
    EXPECT_LE((error.array() - 1e-15 * (there.cwiseAbs().cwiseProduct(unit) + x.cwiseAbs()).array()).maxCoeff(), 0);
    EXPECT_LT((project(p.box, s.to_original(scaled.box, there)) - project(p.box, x)).norm(), 1e-15 * (1 + x.norm()));
  }
}

// Powers of two: the box and the matrix lose nothing, so that a bound is hit exactly in both units.
TEST(Equilibrate, RoundsNothing) {
  Random random(3);
  const AffineMcp p = badly_scaled(20, random);
  const Scaling s = equilibrate(p);
  const AffineMcp scaled = s.apply(p);
  for (const Vec* factors : {&s.rows, &s.columns})
    for (const double factor : *factors) EXPECT_EQ(std::exp2(std::round(std::log2(factor))), factor);
  const Scaling back{s.rows.cwiseInverse(), s.columns.cwiseInverse()};
  const AffineMcp again = back.apply(scaled);
  EXPECT_EQ(Eigen::MatrixXd(again.M), Eigen::MatrixXd(p.M));
  EXPECT_EQ(again.q, p.q);
  EXPECT_EQ(again.box.lower, p.box.lower);
  EXPECT_EQ(again.box.upper, p.box.upper);
}

// Nothing to scale by: empty rows, no rows, q = 0; and bounds that would overflow or merge.
TEST(Equilibrate, LeavesAloneWhatItCannotScale) {
  const auto is_valid = [](const AffineMcp& p) {
    const Scaling s = equilibrate(p);
    return s.rows.size() == p.size() && s.rows.allFinite() && s.columns.allFinite() && !s.apply(p).invalid();
  };
  EXPECT_TRUE(is_valid(standard_lcp(SpMat(2, 2), vec({0, 0}))));
  EXPECT_TRUE(is_valid(standard_lcp(SpMat(2, 2), vec({1e300, 1e-300}))));
  EXPECT_TRUE(is_valid({SpMat(0, 0), Vec(0), Box::free(0)}));
  AffineMcp far = standard_lcp(matrix({{1e200}}), vec({-1e-200}));
  far.box.lower[0] = 1e300;
  EXPECT_TRUE(is_valid(far));
  far.box = {vec({1e-300}), vec({2e-300})};
  far.M *= 1e-300;
  EXPECT_TRUE(is_valid(far));
}

}  // namespace
}  // namespace perp::lcp

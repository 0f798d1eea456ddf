// SPDX-License-Identifier: Apache-2.0
#include "contact/laws/polygon.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include "contact/laws/faceting_support.hpp"
#include "contact/refusal.hpp"
#include "support/matrices.hpp"

namespace perp::contact {
namespace {

using Matrix = Polygon::Matrix;

/// c_i'd_j = 1 for the two ends of side i, less elsewhere: both descriptions are of one polygon.
void expect_dual(const Polygon& p) {
  const Matrix S = p.normals().transpose() * p.vertices();
  for (Index i = 0; i < S.rows(); ++i)
    for (Index j = 0; j < S.cols(); ++j)
      if (j == i || j == (i + 1) % S.cols())
        EXPECT_NEAR(S(i, j), 1, 1e-13) << "edge " << i << ", vertex " << j;
      else
        EXPECT_LT(S(i, j), 1 - 1e-6) << "edge " << i << ", vertex " << j;
}

// Catches edges numbered against the vertices, and a rotation or radius that is applied to one description only.
TEST(Polygon, EdgesAndVerticesAreDual) {
  for (const int K : {3, 4, 5, 8, 17, 64}) {
    SCOPED_TRACE(K);
    expect_dual(Polygon::inscribed(K, 0.3));
    expect_dual(Polygon::circumscribed(K, -1.7));
  }
  std::mt19937 random(5);
  for (int k = 0; k < 50; ++k) expect_dual(random_polygon(random));
}

// The regular hexagon: inscribed, its apothem is cos(pi/6) = sqrt(3)/2; circumscribed, its radius 2/sqrt(3).
TEST(Polygon, RegularOnesTouchTheUnitCircle) {
  const Polygon inner = Polygon::inscribed(6, 0.1);
  const Polygon outer = Polygon::circumscribed(6, 0.1);
  for (Index j = 0; j < 6; ++j) {
    EXPECT_NEAR(inner.vertices().col(j).norm(), 1, 1e-15);
    EXPECT_NEAR(1 / inner.normals().col(j).norm(), std::sqrt(3.) / 2, 1e-15);
    EXPECT_NEAR(outer.vertices().col(j).norm(), 2 / std::sqrt(3.), 1e-15);
    EXPECT_NEAR(outer.normals().col(j).norm(), 1, 1e-15);
  }
  EXPECT_NEAR(std::atan2(inner.vertices()(1, 0), inner.vertices()(0, 0)), 0.1, 1e-15);
  EXPECT_NEAR(std::atan2(outer.normals()(1, 0), outer.normals()(0, 0)), 0.1, 1e-15);
}

// Corners may come in any order; the support function of A P at x is that of P at A'x.
TEST(Polygon, CornersInAnyOrderAndLinearMaps) {
  Matrix mixed(2, 4);
  mixed << 1, -1, 1, -2,  //
      1, 1, -1, -1;
  const Polygon p = Polygon::of_vertices(mixed);
  expect_dual(p);
  Matrix A(2, 2);
  A << 0.5, 1, 0, -2;
  const Polygon q = p.transformed(A);
  expect_dual(q);
  const Vec x = support::vec({0.3, -0.8});
  EXPECT_NEAR((q.vertices().transpose() * x).maxCoeff(), (p.vertices().transpose() * A.transpose() * x).maxCoeff(),
              1e-15);
  const Polygon half = Polygon::interval().transformed(Matrix::Constant(1, 1, 0.5));
  EXPECT_EQ(half.vertices()(0, 0), 0.5);
  EXPECT_EQ(half.normals()(0, 0), 2);
}

TEST(Polygon, RefusesWhatIsNone) {
  const auto refused = [](const Matrix& d, const char* why) {
    EXPECT_NE(test::refusal_of([&] { Polygon::of_vertices(d); }).find(why), std::string::npos) << why;
  };
  Matrix outside(2, 3);
  outside << 1, 2, 2, 0, 1, -1;
  refused(outside, "origin is not inside");
  Matrix boundary(2, 3);
  boundary << 1, -1, 0, 0, 0, 1;
  refused(boundary, "origin is not inside");
  Matrix dented(2, 4);
  dented << 1, 0.2, 0, -1, 0, 0.2, 1, -1;
  refused(dented, "not convex");
  Matrix flat(2, 5);
  flat << 1, 0, -1, -1, 1, 1, 1, 1, -1, -1;
  refused(flat, "not convex, or flat");
  Matrix nan = dented;
  nan(0, 2) = std::numeric_limits<double>::quiet_NaN();
  refused(nan, "vertex 3 is not finite");
  refused(Matrix::Zero(2, 2), "2 x 2");
  EXPECT_THROW(Polygon::inscribed(2), std::invalid_argument);
  EXPECT_THROW(Polygon::circumscribed(0), std::invalid_argument);
  EXPECT_THROW(Polygon::inscribed(5, std::numeric_limits<double>::infinity()), std::invalid_argument);
  EXPECT_THROW(Polygon::inscribed(5).transformed(Matrix::Zero(2, 2)), std::invalid_argument);
  EXPECT_THROW(Polygon::inscribed(5).transformed(Matrix::Identity(1, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace perp::contact

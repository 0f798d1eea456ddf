// SPDX-License-Identifier: Apache-2.0
#include "contact/laws/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "lcp/words.hpp"

namespace perp::contact {
namespace {

using Index = lcp::Index;
using Matrix = Polygon::Matrix;

void refuse(const std::string& why) { refuse_input("polygon: ", why); }

/// K points at equal angles on the circle of this radius.
Matrix on_circle(int K, double first, double radius) {
  if (K < 3) refuse(std::to_string(K) + " facets; a polygon has at least 3");
  if (!std::isfinite(first)) {
    refuse(text_of("the rotation is ", first));
  }
  Matrix points(2, K);
  for (int j = 0; j < K; ++j) {
    const double angle = first + 2 * std::numbers::pi * j / K;
    points(0, j) = radius * std::cos(angle);
    points(1, j) = radius * std::sin(angle);
  }
  return points;
}

/// A corner that lies less than this beyond the side through its neighbours, in units of P, is none.
constexpr double flat = 1e-12;

double cross(const Matrix& v, Index i, Index j) { return v(0, i) * v(1, j) - v(1, i) * v(0, j); }

}  // namespace

Polygon::Polygon(Matrix vertices, Matrix normals) : vertices_(std::move(vertices)), normals_(std::move(normals)) {}

Polygon Polygon::inscribed(int K, double rotation) {
  const double half = std::numbers::pi / K;
  return {on_circle(K, rotation, 1), on_circle(K, rotation + half, 1 / std::cos(half))};
}

Polygon Polygon::circumscribed(int K, double rotation) {
  const double half = std::numbers::pi / K;
  return {on_circle(K, rotation - half, 1 / std::cos(half)), on_circle(K, rotation, 1)};
}

Polygon Polygon::interval() {
  Matrix ends(1, 2);
  ends << 1, -1;
  return {ends, ends};
}

Polygon Polygon::of_vertices(const Matrix& vertices) {
  if (vertices.rows() != 2 || vertices.cols() < 3)
    refuse(text_of("the matrix of vertices is ", vertices.rows(), " x ", vertices.cols(), ", not 2 x K with K >= 3"));
  const Index K = vertices.cols();
  for (Index j = 0; j < K; ++j)
    if (!vertices.col(j).allFinite()) refuse("vertex " + std::to_string(j + 1) + " is not finite");
  std::vector<Index> order(static_cast<std::size_t>(K));
  std::iota(order.begin(), order.end(), Index{0});
  const auto angle = [&](Index j) { return std::atan2(vertices(1, j), vertices(0, j)); };
  std::stable_sort(order.begin(), order.end(), [&](Index i, Index j) { return angle(i) < angle(j); });
  Matrix sorted(2, K);
  for (Index k = 0; k < K; ++k) sorted.col(k) = vertices.col(order[static_cast<std::size_t>(k)]);
  const auto name = [&](Index k) { return "vertex " + std::to_string(order[static_cast<std::size_t>(k)] + 1); };

  Matrix normals(2, K);
  for (Index k = 0; k < K; ++k) {  // c'd_k = c'd_next = 1
    const Index next = (k + 1) % K;
    const double area = cross(sorted, k, next);  // twice that of the triangle (0, d_k, d_next)
    if (!(area > 0))
      refuse("the origin is not inside: seen from it, " + name(next) + " lies half a turn or more behind " + name(k) +
             ", or in the same direction");
    normals(0, k) = (sorted(1, next) - sorted(1, k)) / area;
    normals(1, k) = (sorted(0, k) - sorted(0, next)) / area;
  }
  for (Index k = 0; k < K; ++k)
    if (!(normals.col(k).dot(sorted.col((k + 2) % K)) < 1 - flat))
      refuse("not convex, or flat, at " + name((k + 1) % K));
  return {sorted, normals};
}

Polygon Polygon::transformed(const Matrix& A) const {
  const Index d = vertices_.rows();
  if (A.rows() != d || A.cols() != d) refuse(text_of("the map is ", A.rows(), " x ", A.cols(), ", not ", d, " x ", d));
  const double determinant = d == 1 ? A(0, 0) : A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0);
  if (!A.allFinite() || !(std::abs(determinant) > 0)) refuse("the map is singular or not finite");
  if (d == 1) return {A * vertices_, normals_ / determinant};
  return of_vertices(A * vertices_);
}

}  // namespace perp::contact

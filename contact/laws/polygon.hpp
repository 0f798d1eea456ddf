// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Friction polygons. A contact with the polygon P, a convex polygon about the origin of the plane (T1, T2), has the
/// law
///     r_N >= 0,  r_T in mu r_N P,   -u_T in N_{mu r_N P}(r_T)
/// in place of Coulomb's disk |r_T| <= mu r_N. P is written in two ways,
///     P = conv{d_1, .., d_K} = {x : c_i'x <= 1, i = 1 .. K},
/// by its vertices d_j (inner faceting) or by the normals c_i of its edges (outer faceting). In two dimensions P is an
/// interval, and the interval [-1, 1] is Coulomb's law itself: K = 2.
///
/// Regular polygons bracket the disk: inscribed, |d_j| = 1, P lies cos(pi / K) inside it; circumscribed, |c_i| = 1, its
/// vertices lie 1 / cos(pi / K) outside it. Both are wrong by O(1 / K^2).
#include <vector>

#include "lcp/types.hpp"

namespace perp::contact {

class Polygon {
 public:
  using Matrix = Eigen::MatrixXd;

  /// The regular polygon of K >= 3 vertices on the unit circle, the first at the angle `rotation` [rad] from T1.
  static Polygon inscribed(int K, double rotation = 0);
  /// The regular polygon of K >= 3 edges that touch the unit circle, the first with its normal at `rotation` [rad].
  static Polygon circumscribed(int K, double rotation = 0);
  /// [-1, 1], the friction of a plane problem.
  static Polygon interval();
  /// Any convex polygon of K >= 3 corners with the origin inside; `vertices` is 2 x K, in any order. Two rows are the
  /// coordinates along T1 and T2. Throws std::invalid_argument where a corner is not one (the polygon is not strictly
  /// convex there), or the origin is not inside.
  static Polygon of_vertices(const Matrix& vertices);

  /// { A x : x in P }: anisotropic friction, such as A = diag(1, 0.3). Throws std::invalid_argument if A is not of P's
  /// dimension, not finite, or singular.
  Polygon transformed(const Matrix& A) const;

  int dimension() const { return static_cast<int>(vertices_.rows()); }  ///< of the plane: 1 or 2
  const Matrix& vertices() const { return vertices_; }                  ///< d_j, counterclockwise
  const Matrix& normals() const { return normals_; }                    ///< c_i; edge i joins d_i and d_{i+1}

 private:
  Polygon(Matrix vertices, Matrix normals);
  Matrix vertices_;
  Matrix normals_;
};

/// Polygons of more facets are the disk to rounding of a picture, and problems of their own size: the most by name.
inline constexpr int most_facets = 1000;

/// The polygons of a problem's contacts: one for all of them, or one for each.
using Polygons = std::vector<Polygon>;

}  // namespace perp::contact

// SPDX-License-Identifier: Apache-2.0
/// The Fischer-Burmeister function of the second-order cone (Fukushima, Luo & Tseng, SIAM J. Optim. 12 (2001) 436):
///     Phi = x + y - (x o x + y o y)^(1/2),   x = r,   y = uhat = u + |u_T| e_N,
/// with the Jordan product x o y = (x.y, x_N y_T + y_N x_T); K is its own dual where mu = 1.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "contact/classics/classics.hpp"
#include "contact/model/unit_cone.hpp"

namespace perp::contact {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// The smaller eigenvalue of (x o x + y o y)^(1/2) is taken as at least this part of the larger one where its inverse
/// is asked for: an element of the generalised Jacobian at the border, up to that.
constexpr double least_eigenvalue = 1e-9;

/// L_x: x o s = L_x s.
Matrix3d arrow(const Vector3d& x) {
  Matrix3d L = x[0] * Matrix3d::Identity();
  L.topRightCorner<1, 2>() = x.tail<2>().transpose();
  L.bottomLeftCorner<2, 1>() = x.tail<2>();
  return L;
}

/// z = (x o x + y o y)^(1/2) by its eigenvalues, with the direction n of its tangential part.
struct Root {
  double small = 0;
  double large = 0;
  Vector2d n = Vector2d::Zero();

  Vector3d value() const {
    Vector3d z;
    z << (large + small) / 2, (large - small) / 2 * n;
    return z;
  }
};

/// The squares of the eigenvalues, as sums of squares: the smaller one is |x|^2 + |y|^2 - 2 |x_N x_T + y_N y_T|, which
/// has lost its digits near the border of the cone.
Root root_of_squares(const Vector3d& x, const Vector3d& y) {
  const Vector2d w = x[0] * x.tail<2>() + y[0] * y.tail<2>();
  Root root;
  if (w.norm() > 0) root.n = w / w.norm();
  const Vector2d across(-root.n[1], root.n[0]);
  double small = 0;
  double large = 0;
  for (const Vector3d* v : {&x, &y}) {
    const Vector2d v_T = v->tail<2>();
    const double along = root.n.dot(v_T);
    const double rest = w.norm() > 0 ? std::pow(across.dot(v_T), 2) : v_T.squaredNorm();
    small += std::pow((*v)[0] - along, 2) + rest;
    large += std::pow((*v)[0] + along, 2) + rest;
  }
  root.small = std::sqrt(small);
  root.large = std::sqrt(large);
  return root;
}

NewtonRows fischer_burmeister_rows(const Vector3d& r, const Vector3d& u) {
  const Vector3d x = r;
  const Vector3d y = corrected(u);
  const Root root = root_of_squares(x, y);
  NewtonRows out;
  out.c = root.value() - x - y;
  Matrix3d by_x = Matrix3d::Identity();
  Matrix3d by_y = Matrix3d::Identity();
  if (root.large > 0) {
    Root floored = root;
    floored.small = std::max(root.small, least_eigenvalue * root.large);
    const Matrix3d inverse = arrow(floored.value()).inverse();
    by_x -= inverse * arrow(x);
    by_y -= inverse * arrow(y);
  } else {  // x = y = 0: the element for x = y inside of the cone
    by_x *= 1 - std::sqrt(0.5);
    by_y *= 1 - std::sqrt(0.5);
  }
  out.A = by_x;
  out.B = by_y * corrected_slope(u);
  return out;
}

}  // namespace

void describe(FischerBurmeisterNewton& m, Fields& f) { describe(m.newton, f); }

RowsOf equation(const Scaled& /*problem*/, const FischerBurmeisterNewton& /*method*/) {
  return [](std::size_t /*a*/, const Vector3d& r, const Vector3d& u) { return fischer_burmeister_rows(r, u); };
}

}  // namespace perp::contact

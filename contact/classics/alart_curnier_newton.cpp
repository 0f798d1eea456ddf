// SPDX-License-Identifier: Apache-2.0
/// Alart & Curnier's equation and its kin, by Newton's method with a line search.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "contact/classics/classics.hpp"
#include "contact/model/unit_cone.hpp"

namespace perp::contact {
namespace {

using Eigen::Matrix2d;
using Eigen::RowVector2d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Function = AlartCurnierNewton::Function;

/// min(r_N / rho, u_N), the normal row that all of them have: Phi / rho.
void set_normal_row(const Vector3d& r, const Vector3d& u, double rho, NewtonRows& out) {
  const bool closed = r[0] - rho * u[0] > 0;
  out.A(0, 0) = closed ? 0 : 1 / rho;
  out.B(0, 0) = closed ? 1 : 0;
  out.c[0] = closed ? -u[0] : -r[0] / rho;
}

/// max(R, |y|) r_T = R y, R = (r_N - rho_N u_N)+, y = r_T - rho_T u_T. Divided by rho_T max(R, |y|) of the point, as
/// the equation has the square of an impulse.
NewtonRows hueeber_rows(const Vector3d& r, const Vector3d& u, double rho_N, double rho_T) {
  NewtonRows out;
  set_normal_row(r, u, rho_N, out);
  const Vector2d r_T = r.tail<2>();
  const Vector2d y = r_T - rho_T * u.tail<2>();
  const double R = std::max(0.0, r[0] - rho_N * u[0]);
  const double length = y.norm();
  const double weight = rho_T * std::max(R, length);
  if (!(weight > 0)) {  // an open contact whose tangential impulse is zero
    out.A.bottomRightCorner<2, 2>() = Matrix2d::Identity() / rho_T;
    out.c.tail<2>() = -r_T / rho_T;
    return out;
  }
  const Matrix2d I = Matrix2d::Identity();
  Vector2d by_R = -y;      // d Phi / d R
  Matrix2d by_y = -R * I;  // d Phi / d y
  if (length > R)
    by_y += r_T * (y / length).transpose();
  else
    by_R += r_T;
  if (R > 0) {
    out.A.bottomLeftCorner<2, 1>() = by_R / weight;
    out.B.bottomLeftCorner<2, 1>() = -rho_N * by_R / weight;
  }
  out.A.bottomRightCorner<2, 2>() = (std::max(R, length) * I + by_y) / weight;
  out.B.bottomRightCorner<2, 2>() = -rho_T * by_y / weight;
  out.c.tail<2>() = -(std::max(R, length) * r_T - R * y) / weight;
  return out;
}

/// (63): min(|u_T|, r_N - |r_T|) and |u_1 r_2 - u_2 r_1| + max(0, u_1 r_1), with mu = 1. In 2D u_1 r_1 has the second
/// row's place in the plane: the first row, and min(|u_T|, r_N - |r_T|).
NewtonRows xuewen_rows(int size, const Vector3d& r, const Vector3d& u, double rho_N) {
  NewtonRows out;
  set_normal_row(r, u, rho_N, out);
  if (size == 1) return out;
  const RowVector2d along_u = tangential_direction(u).transpose();
  const RowVector2d along_r = tangential_direction(r).transpose();
  const double speed = u.tail<2>().norm();
  const double margin = r[0] - r.tail<2>().norm();
  if (speed <= margin) {
    out.B.block<1, 2>(1, 1) = along_u;
    out.c[1] = -speed;
  } else {
    out.A(1, 0) = 1;
    out.A.block<1, 2>(1, 1) = -along_r;
    out.c[1] = -margin;
  }
  if (size == 2) return out;
  const double cross = u[1] * r[2] - u[2] * r[1];
  const double sign = cross < 0 ? -1 : 1;
  const double positive = u[1] * r[1] > 0 ? 1 : 0;
  out.A.block<1, 2>(2, 1) << -sign * u[2] + positive * u[1], sign * u[1];
  out.B.block<1, 2>(2, 1) << sign * r[2] + positive * r[1], -sign * r[1];
  out.c[2] = -std::abs(cross) - std::max(0.0, u[1] * r[1]);
  return out;
}

}  // namespace

void describe(AlartCurnierNewton& m, Fields& f) {
  using enum Function;
  f.choice("function", &m.function,
           {{"standard", Standard}, {"jean-moreau", JeanMoreau}, {"hueeber", Hueeber}, {"xuewen", Xuewen}},
           "the equation");
  describe(m.newton, f);
}

RowsOfContacts<5> rolling_equation(const Scaled& problem, const AlartCurnierNewton& method) {
  if (method.function != Function::Standard && method.function != Function::JeanMoreau)
    throw std::invalid_argument("alart-curnier: of rolling friction the functions are standard and jean-moreau");
  const FrictionDisk radius =
      method.function == Function::Standard ? FrictionDisk::Augmented : FrictionDisk::JeanMoreau;
  return [&problem, radius, rho = NewtonWeights(problem)](std::size_t a, const ContactVector<5>& r,
                                                          const ContactVector<5>& u) {
    return alart_curnier_rows<5>(problem.blocks[a], r, u, rho.N[static_cast<Index>(a)], tangential_weights<5>(rho, a),
                                 radius);
  };
}

RowsOf equation(const Scaled& problem, const AlartCurnierNewton& method) {
  return [&problem, function = method.function, rho = NewtonWeights(problem)](std::size_t a, const Vector3d& r,
                                                                              const Vector3d& u) {
    const auto i = static_cast<Index>(a);
    const int size = problem.blocks[a].size;
    if (function == Function::Hueeber) return hueeber_rows(r, u, rho.N[i], rho.T[i]);
    if (function == Function::Xuewen) return xuewen_rows(size, r, u, rho.N[i]);
    return alart_curnier_rows(size, r, u, rho.N[i], rho.T[i],
                              function == Function::Standard ? FrictionDisk::Augmented : FrictionDisk::JeanMoreau);
  };
}

}  // namespace perp::contact

// SPDX-License-Identifier: Apache-2.0
#include "contact/classics/alart_curnier.hpp"

#include <algorithm>
#include <utility>

namespace perp::contact {
NewtonRows alart_curnier_rows(int size, const Eigen::Vector3d& r, const Eigen::Vector3d& u, double rho_N, double rho_T,
                              FrictionDisk disk) {
  NewtonRows out;
  const bool closed = r[0] - rho_N * u[0] > 0;
  if (closed) {
    out.B(0, 0) = 1;
    out.c[0] = -u[0];
  } else {
    out.A(0, 0) = 1 / rho_N;
    out.c[0] = -r[0] / rho_N;
  }
  const int tangents = size - 1;
  if (tangents == 0) return out;
  const bool augmented = disk == FrictionDisk::Augmented;
  const double radius = !closed ? 0 : augmented ? r[0] - rho_N * u[0] : std::max(0.0, r[0]);
  const Eigen::Vector2d y(r[1] - rho_T * u[1], tangents == 2 ? r[2] - rho_T * u[2] : 0);
  const double length = y.norm();
  if (closed && length <= radius) {  // sticks
    for (int i = 1; i <= tangents; ++i) {
      out.B(i, i) = 1;
      out.c[i] = -u[i];
    }
    return out;
  }
  const double beta = length > 0 ? radius / length : 0;
  const Eigen::Vector2d d = length > 0 ? Eigen::Vector2d(y / length) : Eigen::Vector2d::Zero();
  for (int i = 0; i < tangents; ++i) {
    for (int j = 0; j < tangents; ++j) {
      const double across = (i == j ? 1 : 0) - (length > 0 ? d[i] * d[j] : 0);
      out.A(i + 1, j + 1) = ((i == j ? 1 : 0) - beta * across) / rho_T;
      out.B(i + 1, j + 1) = beta * across;
    }
    if (radius > 0) out.A(i + 1, 0) = -d[i] / rho_T;
    if (radius > 0 && augmented) out.B(i + 1, 0) = d[i] * rho_N / rho_T;
    out.c[i + 1] = -(r[i + 1] - radius * d[i]) / rho_T;
  }
  return out;
}

AlartCurnier::AlartCurnier(const Scaled& problem, ContactSystem& system)
    : problem_(problem), rho_(problem), system_(system) {}

bool AlartCurnier::step(In r, In centre, double alpha, Vec& to) {
  const Vec u = problem_.W * r + problem_.q + alpha * (r - centre);
  const auto rows_of = [this](std::size_t a, const Eigen::Vector3d& r_a, const Eigen::Vector3d& u_a) {
    const auto i = static_cast<Index>(a);
    return alart_curnier_rows(problem_.blocks[a].size, r_a, u_a, rho_.N[i], rho_.T[i]);
  };
  NewtonSystem newton = newton_system(problem_, rows_of, r, u);
  for (ContactRows& rows : newton.rows) rows.A += alpha * rows.B;
  if (!system_.factor(newton.rows)) return false;
  Vec d;
  system_.solve(newton.c, d);
  if (!d.allFinite()) return false;
  to = r + d;
  return true;
}

}  // namespace perp::contact

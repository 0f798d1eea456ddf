// SPDX-License-Identifier: Apache-2.0
#include "contact/classics/alart_curnier.hpp"

#include <algorithm>
#include <utility>

namespace perp::contact {
namespace {

/// Rows of one disk of that radius, of the entries first, first + 1, .. of its contact.
template <int Size>
void set_disk_rows(int first, int count, double length, const Eigen::Vector2d& y, double radius, double rho_T,
                   const ContactVector<Size>& r, NewtonRowsOfSize<Size>& out) {
  const double beta = length > 0 ? radius / length : 0;
  const Eigen::Vector2d d = length > 0 ? Eigen::Vector2d(y / length) : Eigen::Vector2d::Zero();
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      const double across = (i == j ? 1 : 0) - (length > 0 ? d[i] * d[j] : 0);
      out.A(first + i, first + j) = ((i == j ? 1 : 0) - beta * across) / rho_T;
      out.B(first + i, first + j) = beta * across;
    }
    if (radius > 0) out.A(first + i, 0) = -d[i] / rho_T;
    out.c[first + i] = -(r[first + i] - radius * d[i]) / rho_T;
  }
}

}  // namespace

template <int Size>
NewtonRowsOfSize<Size> alart_curnier_rows(const Scaled::Block& block, const ContactVector<Size>& r,
                                          const ContactVector<Size>& u, double rho_N,
                                          const std::array<double, disks<Size>>& rho_T, FrictionDisk radius) {
  NewtonRowsOfSize<Size> out;
  const bool closed = r[0] - rho_N * u[0] > 0;
  if (closed) {
    out.B(0, 0) = 1;
    out.c[0] = -u[0];
  } else {
    out.A(0, 0) = 1 / rho_N;
    out.c[0] = -r[0] / rho_N;
  }
  const bool augmented = radius == FrictionDisk::Augmented;
  const double most = !closed ? 0 : augmented ? r[0] - rho_N * u[0] : std::max(0.0, r[0]);
  for (int j = 0; j < disks<Size>; ++j) {
    const int first = 1 + j * block.width;
    const int count = std::min(block.width, block.size - first);
    if (count <= 0) break;
    const double rho = rho_T[at(j)];
    const Eigen::Vector2d y(r[first] - rho * u[first], count == 2 ? r[first + 1] - rho * u[first + 1] : 0);
    const double length = y.norm();
    if (closed && length <= most) {  // sticks
      for (int i = first; i < first + count; ++i) {
        out.B(i, i) = 1;
        out.c[i] = -u[i];
      }
      continue;
    }
    set_disk_rows(first, count, length, y, most, rho, r, out);
    if (most > 0 && augmented)
      for (int i = 0; i < count; ++i) out.B(first + i, 0) = -rho_N * out.A(first + i, 0);
  }
  return out;
}

template NewtonRowsOfSize<3> alart_curnier_rows<3>(const Scaled::Block&, const ContactVector<3>&,
                                                   const ContactVector<3>&, double, const std::array<double, 1>&,
                                                   FrictionDisk);
template NewtonRowsOfSize<5> alart_curnier_rows<5>(const Scaled::Block&, const ContactVector<5>&,
                                                   const ContactVector<5>&, double, const std::array<double, 2>&,
                                                   FrictionDisk);

template <int Size>
AlartCurnierOf<Size>::AlartCurnierOf(const Scaled& problem, ContactSystemOf<Size>& system, FrictionDisk radius)
    : problem_(problem), rho_(problem), system_(system), radius_(radius) {}

template <int Size>
bool AlartCurnierOf<Size>::step(In r, In centre, double alpha, Vec& to) {
  const Vec u = problem_.W * r + problem_.q + alpha * (r - centre);
  const auto rows_of = [this](std::size_t a, const ContactVector<Size>& r_a, const ContactVector<Size>& u_a) {
    return alart_curnier_rows<Size>(problem_.blocks[a], r_a, u_a, rho_.N[static_cast<Index>(a)],
                                    tangential_weights<Size>(rho_, a), radius_);
  };
  NewtonSystemOf<Size> newton = newton_system<Size>(problem_, rows_of, r, u);
  for (RowsOfSize<Size>& rows : newton.rows) rows.A += alpha * rows.B;
  if (!system_.factor(newton.rows)) return false;
  Vec d;
  system_.solve(newton.c, d);
  if (!d.allFinite()) return false;
  to = r + d;
  return true;
}

template class AlartCurnierOf<3>;
template class AlartCurnierOf<5>;

}  // namespace perp::contact

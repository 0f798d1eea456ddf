// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Newton's method on the equation of Alart & Curnier, in the coordinates of contact/model/scaling.hpp (mu = 1):
///     r_N = max(0, r_N - rho_N u_N),   r_T = P_disk(r_N+)(r_T - rho_T u_T),   u = W r + q + alpha (r - centre),
/// contact by contact, rho_N = 1 / W_NN, rho_T = 1 / mean(W_TT), an element of the generalised Jacobian each step and
/// no line search (Alart & Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991) 353, with the radius r_N+ of Jean &
/// Moreau). alpha > 0 makes it the proximal problem of `centre`: regular where W is not.
///
/// Fast near a solution and without a guarantee elsewhere: the last digits of a homotopy.
#include <array>

#include "contact/classics/newton.hpp"
#include "contact/model/contact_system.hpp"
#include "contact/model/scaling.hpp"

namespace perp::contact {

/// The radius of the friction disk.
enum class FrictionDisk {
  JeanMoreau,  ///< r_N+
  Augmented    ///< (r_N - rho_N u_N)+, Alart & Curnier's own: lecture, (53)
};

/// rho_T of each disk of contact a.
template <int Size>
std::array<double, disks<Size>> tangential_weights(const NewtonWeights& rho, std::size_t a) {
  const auto i = static_cast<Index>(a);
  if constexpr (disks<Size> == 1)
    return {rho.T[i]};
  else
    return {rho.T[i], rho.R[i]};
}

/// Phi / rho of one contact; lecture, (57)-(58). Each disk has its rho_T.
template <int Size>
NewtonRowsOfSize<Size> alart_curnier_rows(const Scaled::Block& block, const ContactVector<Size>& r,
                                          const ContactVector<Size>& u, double rho_N,
                                          const std::array<double, disks<Size>>& rho_T,
                                          FrictionDisk radius = FrictionDisk::JeanMoreau);
inline NewtonRows alart_curnier_rows(int size, const Eigen::Vector3d& r, const Eigen::Vector3d& u, double rho_N,
                                     double rho_T, FrictionDisk radius = FrictionDisk::JeanMoreau) {
  return alart_curnier_rows<3>({.size = size}, r, u, rho_N, {rho_T}, radius);
}

template <int Size>
class AlartCurnierOf {
 public:
  /// Both outlive *this. The factors of `system`, which is the problem's, are overwritten each step.
  AlartCurnierOf(const Scaled& problem, ContactSystemOf<Size>& system, FrictionDisk radius = FrictionDisk::JeanMoreau);

  /// r + dr, the full Newton step from r; false if the matrix is singular or dr not finite.
  bool step(In r, In centre, double alpha, Vec& to);

 private:
  const Scaled& problem_;
  NewtonWeights rho_;
  ContactSystemOf<Size>& system_;
  FrictionDisk radius_;
};
using AlartCurnier = AlartCurnierOf<3>;

}  // namespace perp::contact

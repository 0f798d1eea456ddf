// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Interior-point homotopy on Glocker's NCP (contact/laws/glocker.hpp, encoding A, the normalised disk row), reduced to
/// the impulses.
///
/// Of one contact with friction, in the coordinates of contact/model/scaling.hpp (mu = 1): impulse r = (r_N, r_T),
/// multipliers kappa_i of the facets e_i (three in 3D, e_i = +1, -1 in 2D) and kappa_D of the disk (3D only), and
///     u_N - w_N = 0,   u_T + sum e_i kappa_i + (2/g) r_T kappa_D = 0,
///     sigma_i = r_N - e_i.r_T + eps kappa_i = w_i,   sigma_D = g - |r_T|^2 / g = w_D,
///     r_N w_N = kappa_i w_i = kappa_D w_D = tau -> 0,   g = (r_N + sqrt(r_N^2 + 4 delta^2)) / 2,
/// delta = delta_share tau and eps = eps_share tau. In a Newton step kappa and w belong to their contact alone; they
/// are eliminated (Schur complement), and what is left is a system of contact/model/contact_system.hpp:
///     (W + diag(B_a)) dr = rhs.
/// With two disks, each has facets and a row of its own, with the same r_N and g (docs/contact/rolling.md).
/// Predictor and corrector are those of contact/cones/predictor_corrector.hpp, step lengths as in
/// ncp/methods/interior_point.hpp, without any search on the residual.
#include <vector>

#include "contact/model/contact_system.hpp"
#include "contact/model/scaling.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace perp::contact {

struct HomotopyOptions {
  double delta_share = 0.1;                  ///< delta = delta_share tau, not below 1e-13
  double eps_share = 0.1;                    ///< eps = eps_share tau: fixes kappa up to a common constant
  double least_centring = 1e-4;              ///< sigma at least
  double to_boundary = 0.9;                  ///< share of the way to the boundary
  double neighbourhood = 1e-4;               ///< least product over the mean
  lcp::LuBackend lu = lcp::LuBackend::Auto;  ///< by the entries of the matrix
};

struct HomotopyIteration {
  int k = 0;
  double tau = 0;
  double step = 0;
  double sigma = 0;
};

/// The run, step by step: the caller judges r after each.
template <int Size = 3>
class Homotopy {
 public:
  /// From r_N = 1, r_T = 0, kappa = 1. `problem` and `system` as for AlartCurnier.
  Homotopy(const Scaled& problem, ContactSystemOf<Size>& system, const HomotopyOptions& options = {});
  ~Homotopy();
  Homotopy(const Homotopy&) = delete;
  Homotopy& operator=(const Homotopy&) = delete;

  /// One predictor-corrector step. False: the matrix is singular, or nothing is finite.
  bool step();

  const Vec& r() const { return r_; }
  const Vec& u() const { return u_; }  ///< W~ r~ + q~
  const HomotopyIteration& last() const { return last_; }

  struct Direction;
  // Called by predictor_corrector().
  Direction direction(double target, const Direction* affine);
  double reach(const Direction& d) const;
  double mean_after(const Direction& d, double alpha) const;

 private:
  struct Pairs;
  struct Side;
  struct Contact;
  void parameters();
  void spread();
  double mean() const;
  template <class Take>
  void for_pairs(const Direction& d, const Take& take) const;
  bool assemble();
  double shortened(const Direction& d, double alpha) const;

  const Scaled& problem_;
  HomotopyOptions options_;
  double tau_ = 1, delta_ = 0.1, eps_ = 0.1;
  Vec r_, u_;
  std::vector<Contact> contacts_;
  Index products_ = 0;
  ContactSystemOf<Size>& system_;
  HomotopyIteration last_;
  double last_step_ = 1;
};

}  // namespace perp::contact

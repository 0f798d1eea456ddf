// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Douglas and Rachford's splitting of Coulomb's law, in the coordinates of contact/model/scaling.hpp: with
/// y = W r + q + s e_N in K, y _|_ r in K, the openings s = |y_T| of the iterate itself, and R of one number rho a
/// contact,
///     (W + R) x = y + R r - q - s e_N,   r+ = P_K(x' - R^-1 y),   y+ = y + R (r+ - x'),
/// x' = l x + (1 - l) r over-relaxed. With s fixed this is ADMM on the second-order cone problem of these openings
/// (Boyd et al., Found. Trends Mach. Learn. 3 (2011) 1), which converges for every monotone W. Here the openings follow
/// as they come: Cadoux' fixed point without solving for each s. One factorization serves all steps, and each takes as
/// long as a solve with it. Where impulses are not unique r goes round in the kernel of W for long, while y, and with
/// it s, is there early. Private to contact/.
#include <vector>

#include "contact/model/contact_system.hpp"
#include "contact/model/scaling.hpp"

namespace perp::contact {

class Splitting {
 public:
  /// From r and y in the interior of K. Problem and system outlive *this; nobody else factors with `system` between
  /// factor() and the last step.
  Splitting(const Scaled& problem, ContactSystem& system, Vec r, Vec y);

  /// The matrix's factors; false: there are none.
  bool factor();
  /// Pre: factor().
  void step();
  /// To be called after each lot of steps, of the same number. Where r goes round, goes on from the mean of the steps
  /// since the last such restart, or of the last lots, if its natural map is less than half (Applegate, Hinder, Lu &
  /// Lubin, Math. Program. 201 (2023) 133). Where the last two lots changed r - R^-1 y in nearly the same direction,
  /// goes on along it to the limit of the geometric series, or ten times as far as the last.
  void accelerate();

  const Vec& r() const { return r_; }
  const Vec& y() const { return y_; }
  Vec openings() const;  ///< |y_T|, one a contact

 private:
  Vec state() const;
  void set(std::size_t contact, const Eigen::Vector3d& w);
  void set_all(const Vec& w);
  bool restart();
  void extrapolate();

  const Scaled& problem_;
  ContactSystem& system_;
  Vec r_;
  Vec y_;
  std::vector<double> rho_{};
  Vec sum_{};  // of the states of the steps since the last restart
  int summed_ = 0;
  int lots_ = 0;
  Vec last_state_{};
  Vec last_change_{};
  int echoes_ = 0;  // changes yet to be left out
  Vec right_{};
  Vec x_{};
};

}  // namespace perp::contact

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Contacts whose friction disks have given radii theta: r_N >= 0, |r_T| <= theta, with
///     0 <= u_N _|_ r_N >= 0,   -u_T in the normal cone of the disk at r_T,
/// for symmetric W the minimum of r'W r / 2 + q.r (lecture, (77)-(79)), by sweeps of projected Gauss-Seidel. Private to
/// contact/classics.
#include <vector>

#include "contact/classics/local_problem.hpp"
#include "contact/model/scaling.hpp"

namespace perp::contact {

class MovingImpulses;
class Trial;

/// Which impulses a sweep moves; the others are given.
enum class CylinderPart { Both, Normal, Tangential };

struct CylinderLimits {
  int sweeps = 1000;
  double change = 0;  ///< of r in one sweep, where the sweeps end
};

class CylinderSweeps {
 public:
  CylinderSweeps(Trial& trial, const Scaled& problem);
  /// Updates r and u = W r + q; `theta` one a contact. Ends early if the run is over.
  void solve(CylinderPart part, const Vec& theta, const CylinderLimits& limits, Vec& r, Vec& u);

 private:
  double sweep(CylinderPart part, const Vec& theta, const Vec& r, MovingImpulses& moving) const;

  Trial& trial_;
  const Scaled& problem_;
  std::vector<LocalProblem<3>> contacts_;
  std::vector<double> rho_T_;  // 1 / |W_TT|
};

/// r_N+ of every contact.
Vec disk_radii(const Scaled& problem, const Vec& r);

}  // namespace perp::contact

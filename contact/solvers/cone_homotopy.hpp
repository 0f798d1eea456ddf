// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Coulomb's law from the associated one. The path of the associated law (contact/cones/cone_path.hpp, s = 0) cannot
/// turn back. If all contacts stick, its end obeys Coulomb's law as well. If some slip, Douglas and Rachford's
/// splitting (contact/cones/splitting.hpp) finds their openings, and a path with these openings leads to Coulomb's law.
/// Newton steps on Alart & Curnier's equation find the last digits. Private to contact/.
#include "contact/classics/alart_curnier.hpp"
#include "contact/cones/cone_path.hpp"
#include "contact/cones/splitting.hpp"
#include "contact/solvers/newton_steps.hpp"
#include "contact/solvers/referee.hpp"

namespace perp::contact {

/// The path of the associated law.
struct AssociatedPath {
  int steps = 40;
  double end = 1e-9;         ///< tau at which it ends
  double newton_tau = 1e-4;  ///< tau at which Newton steps are tried first; again when tau has fallen by 100
  double real_slip = 200;    ///< slips above this times tau are real: Newton steps and small tau do not help
  double most_moving = 0.1;  ///< share of the contacts above which the pile collapses, and the splitting fails
};

/// Openings by the splitting, and the paths with them.
struct OpeningPaths {
  int steps = 4500;  ///< of the splitting: pile 1000, 33, mu = 0.4 needs more than 1,500
  int paths = 3;
  double map = 5e-4;        ///< natural map at which a path begins, or
  double change = 2e-3;     ///< relative change of the openings in two lots; a hundredth of both for the next path
  double start_share = 20;  ///< tau of a path's beginning over the natural map; it ends at a thousandth of it
};

class ConeHomotopy {
 public:
  /// All outlive *this; `system` is that of `newton`.
  ConeHomotopy(Referee& referee, const Scaled& problem, AlartCurnier& newton, ContactSystem& system);

  /// Runs the homotopy; returns whether the run is over.
  bool run();

 private:
  bool associated();
  bool openings();
  bool settle(Splitting& splitting, double change, double map);
  bool with_openings(const Splitting& splitting, double map);
  bool step();
  bool try_newton(const NewtonSteps& steps) { return newton_steps(referee_, problem_, newton_, path_.r(), steps); }
  bool moves() const;
  double gap() const { return (path_.slip() - path_.openings()).lpNorm<Eigen::Infinity>(); }

  Referee& referee_;
  const Scaled& problem_;
  AlartCurnier& newton_;
  ContactSystem& system_;
  ConePath path_;
};

}  // namespace perp::contact

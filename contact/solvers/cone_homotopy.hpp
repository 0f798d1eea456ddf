// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Coulomb's law from the associated one. The path of the associated law (contact/cones/cone_path.hpp, s = 0) cannot
/// turn back, and where all contacts stick its end obeys Coulomb's law as well. Where some slip, Coulomb's law is
/// solved in their region (contact/cones/region.hpp), in rounds: the path with the region's openings, and a region from
/// there. Where they do not solve it, openings by Douglas and Rachford's splitting (contact/cones/splitting.hpp)
/// lead to a path, and a region from its end. Where that fails a path with these contacts coupled leads from an earlier
/// point to Coulomb's law, or to more contacts that slip. Where it turns back: a path with all contacts coupled.
/// Cadoux' fixed point s = |u_T(s)| is apart: each s is a path from the last one's points, with Anderson's mixing of
/// two, and from points of each a path has the contacts coupled that slip at its end. Newton steps on Alart & Curnier's
/// equation are tried from the points for the last digits. Cadoux, Acary & Lemarechal (contact/classics/classics.hpp);
/// Anderson, J. ACM 12 (1965) 547. Private to contact/.
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contact/classics/alart_curnier.hpp"
#include "contact/cones/cone_path.hpp"
#include "contact/cones/splitting.hpp"
#include "contact/solvers/newton_steps.hpp"
#include "contact/solvers/referee.hpp"

namespace perp::contact {

class ConeHomotopy {
 public:
  /// All outlive *this; `system` is that of `newton`.
  ConeHomotopy(Referee& referee, const Scaled& problem, AlartCurnier& newton, ContactSystem& system, bool splitting);

  /// The paths without the fixed point; whether the run is over.
  bool run();
  /// s = |u_T(s)|, after run(); nothing where the pile collapses. Whether the run is over.
  bool fixed_point();

 private:
  bool associated();
  struct Regional {
    Vec r;         // of all contacts
    Vec openings;  // |u_T| in the region
    double tau = 0;
  };
  bool regions(int rounds, std::span<const double> first_stiffnesses);
  std::optional<Regional> late_region(std::span<const double> tries);
  bool split();
  bool settle(Splitting& splitting, double change, double map);
  bool with_openings(const Splitting& splitting, double map);
  std::optional<Regional> region(double stiffness);
  std::optional<Solution> solution_of(const Problem& region);
  bool reopen(const Regional& from, double map);
  std::vector<std::size_t> slipping() const;
  bool slips(double tau);
  bool all_coupled(const ConePath::Point& from);
  bool coupled(ConePath::Point from, int steps);
  bool follow_coupled(const ConePath::Point& from, int& steps);
  double other_slip() const;
  void couple_slips();
  bool follow(double until);
  bool step();
  bool try_newton(const NewtonSteps& steps) { return newton_steps(referee_, problem_, newton_, path_.r(), steps); }
  std::size_t last_above(double tau) const;
  bool moves() const;
  double gap() const { return (path_.slip() - path_.openings()).lpNorm<Eigen::Infinity>(); }

  Referee& referee_;
  const Scaled& problem_;
  AlartCurnier& newton_;
  ContactSystem& system_;
  const bool splitting_;
  bool refused_ = false;  // the first of the last regions
  ConePath path_;
  std::vector<char> coupled_;                               // contacts
  std::vector<std::pair<double, ConePath::Point>> points_;  // tau and where to come back to, tau falling
};

}  // namespace perp::contact

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// From the impulses of one step to those of the next: Newton's method on the equation of Alart & Curnier
/// (contact/classics/alart_curnier.hpp) with a proximal term of the iterate itself, each step as long as the natural
/// map asks for; where it fails sweeps of Gauss-Seidel while they contract, which come first after a step that they
/// solved, and Newton steps from where they come to. Where many contacts change their states both fail. Then a path
/// of Coulomb's law over the cones (contact/cones/cone_path.hpp), coupled at all contacts, that begins near the
/// impulses of the step before: some ten steps. Where it turns back, others, with other products.
///
/// Where contacts are redundant r is not unique: what W does not see, its kernel, is free. Newton's steps of least norm
/// carry r, step after step, onto the border of the cones, where the natural map has kinks in all directions. Therefore
/// the proximal term at contacts that stick is measured by the Hessian of the cones' barrier,
///     K = A + B (W + alpha D),   D_a the Hessian of -log det(r_a) / 2,   det(x) = x_N^2 - |x_T|^2,
/// and the first step of each problem has besides, in the kernel, the step to the least barrier
/// sum r_N / R - log det(r_a) / 2 of these contacts,
///     e - K^-1 (A + B W) e,   K e = alpha (J r_a / det(r_a) - e_N / R - D_a d_a),   J = diag(1, -1, -1):
/// r stays in the middle of its cones, and no larger than it needs to be, at the price of two solves.
///
/// What depends on W alone is kept while its entries are the same, and the factors of K while contacts keep their
/// states: a step costs a few triangular solves then. Where contacts slip K is another in each step, and the factors of
/// the last will do as long as refinement with them converges. Private to contact/.
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "contact/model/problem.hpp"
#include "contact/model/scaling.hpp"
#include "contact/solvers/solve.hpp"

namespace perp::contact {

class FollowSystem;
struct FollowStep;

class Follower {
 public:
  using Accept = std::function<bool(const Vec& r, Origin by)>;
  using Stop = std::function<bool()>;
  /// Counts in these, which outlive *this: of iterations the steps of paths over the cones.
  explicit Follower(Stats& stats);
  ~Follower();
  Follower(const Follower&) = delete;
  Follower& operator=(const Follower&) = delete;

  /// Makes this the problem, and returns it in its scaled units, where it stays until the next.
  const Scaled& take(const Problem& problem);
  /// Goes from r~ until `accept` says yes, which is asked of points with a small natural map; the point then. `stop` is
  /// asked before each factorization and some sweeps. Nothing where that, or failure, ends it first. Pre: take().
  std::optional<Vec> from(In r, const Accept& accept, const Stop& stop);
  /// The next step begins from r~, which solves this problem and which others have found. Pre: take().
  void remember(In r);

 private:
  struct NewtonSteps {
    int most = 1;
    bool first = false;  // r is the last solution
    bool held = false;   // those alone that need no new factors
  };
  bool attempt(Vec& r, const Accept& accept, const Stop& stop);
  bool newton(Vec& r, NewtonSteps steps, const Accept& accept, const Stop& stop);
  bool sweep(Vec& r, const Accept& accept, const Stop& stop);
  bool path(Vec& r, double tau, int last_factorization, const Accept& accept, const Stop& stop);
  bool paths(Vec& r, const Accept& accept, const Stop& stop);
  bool direction(In r, FollowStep& step, bool first, double margin);
  bool newton_step(Vec& x, double& last, bool first, const Stop& stop);
  bool held_step(Vec& x, double& last, bool first);

  Stats& stats_;
  std::unique_ptr<FollowSystem> kept_;
  std::vector<char> stuck_{};  // contacts of the last solution; a hint
  bool sweeps_first_ = false;
  bool paths_fail_ = false;  // in the last step that needed them
};

}  // namespace perp::contact

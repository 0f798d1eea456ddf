// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Moreau and Jean's time stepping for rigid bodies on fixed planes: impulses instead of forces, contact and impact
/// laws on velocities, events not located but stepped over. A step of h seconds, with v = (velocity of the centre of
/// mass, spin) of every body, x_k, v_k known:
///     M (v_{k+1} - v_k) = h F + H r,   x_{k+1} = x_k + h v_theta,   v_theta = theta v_{k+1} + (1 - theta) v_k
/// and at the contacts with g + gamma h U_N,k <= 0, a forecast of the gap,
///     u = U_{k+1} + e U_N,k e_N,   U = H'v,   K*_mu > u + mu |u_T| e_N  _|_  r in K_mu,
/// one contact::Problem a step; or with a polygon in place of K's disk. M, H and the gaps are those at x_k, F is that
/// at t_k + h / 2. A body's attitude turns by the rotation vector h omega_theta.
///
/// Energy. With the kinetic energy T, the potential V of gravity and the work W of the load along h v_theta,
///     T_{k+1} + V_{k+1} = T_k + V_k + W - friction - impacts - scheme
///     friction = -r_T.(U_T,k + U_T,k+1) / 2
///     impacts  = -r_N.(U_N,k + U_N,k+1) / 2
///     scheme   = (theta - 1/2) h F'(v_{k+1} - v_k),   F with gravity;
/// of turning bodies that are no balls `scheme` has also what the explicit turn of M costs. A mass m that meets a plane
/// with U_N loses (1 - e^2) m U_N^2 / 2; with mu = 0 and one e for all impacts = (1 - e) / (1 + e) r'W r / 2. Without
/// forces during the step impacts + friction >= 0 if e = 0, or mu = 0 and one e for all, or all contacts are those of
/// balls, one plane each. Else not: Newton's law with friction and e > 0 may create energy (Kane & Levinson 1985). With
/// forces T + V - W never grows for e = 0, theta = 1; without friction for 1/2 <= theta <= 1 / (1 + e) neither (Acary
/// 2016) but by O(h^2) where a body leaves a plane it has got into.
///
/// References: Moreau, in Nonsmooth Mechanics and Applications, 1988. Jean, Comput. Methods Appl. Mech. Engrg. 177
/// (1999) 235. Acary & Brogliato, Numerical Methods for Nonsmooth Dynamical Systems, 2008, ch. 10. Acary, lecture 3,
/// Aussois 2010, (1)-(5); ZAMM 96 (2016) 585. Kane & Levinson, Dynamics: Theory and Applications, 1985.
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "contact/model/problem.hpp"
#include "contact/model/residual.hpp"
#include "contact/scenes/rigid_bodies.hpp"
#include "contact/solvers/sequence.hpp"

namespace perp::contact {

/// A body that may touch planes with knobs: balls fixed in it, of any radius down to 0, a corner.
struct MovingBody {
  struct Knob {
    Vec3 at = Vec3::Zero();  ///< in body axes from the centre of mass [m]
    double radius = 0;       ///< [m]
  };
  double mass = 1;                   ///< [kg]
  Mat3 inertia = Mat3::Identity();   ///< J about the centre of mass in body axes [kg m^2]
  Vec3 centre = Vec3::Zero();        ///< x [m]
  Mat3 attitude = Mat3::Identity();  ///< rotation from body to world axes
  Vec3 velocity = Vec3::Zero();      ///< [m/s]
  Vec3 spin = Vec3::Zero();          ///< omega, world axes [1/s]
  bool turns = true;                 ///< false: omega = 0 is a bilateral constraint, and the body only slides
  std::vector<Knob> knobs{};

  static MovingBody ball(double mass, double radius);
  static MovingBody box(double mass, const Vec3& edges);
};

/// The half-space of n.(x - point) >= 0 is free.
struct Plane {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  ///< of length 1
  double mu = 0;                ///< [-]
  double e = 0;                 ///< Newton's coefficient of restitution, in [0, 1]
  double frame = 0;             ///< T1, T2 are those of contact_frame(n) turned about n by this angle [rad]
};

/// Coulomb's law, or that of a regular polygon: inscribed in the friction disk by its vertices (inner faceting), or
/// about it by its edges (outer). The first vertex, or normal, lies in T1.
struct FrictionLaw {
  enum class Kind { Coulomb, Inner, Outer };
  Kind kind = Kind::Coulomb;
  int facets = 0;  ///< K >= 3 of polygons
};
/// "exact", "inner:8".
std::string name(const FrictionLaw& law);

struct SteppingOptions {
  double h = 0.01;                   ///< [s]
  double theta = 0.5;                ///< in [1/2, 1]
  double gamma = 0.5;                ///< of the gap's forecast, in [0, 1]
  Vec3 gravity = Vec3(0, 0, -9.81);  ///< [m/s^2]
  FrictionLaw law{};
  double tol = 1e-10;      ///< of each contact problem: RunLimits::tol
  bool warm_start = true;  ///< from the last step's impulses, new contacts from 0; Coulomb's law alone
  /// Force at the centre of body i at the time t [N]; none if empty.
  std::function<Vec3(std::size_t i, double t)> load{};
};
/// Why the options make no sense, if they do not.
std::optional<std::string> invalid(const SteppingOptions& options);

/// [J]; see above.
struct Energy {
  double kinetic = 0;    ///< T_{k+1}
  double potential = 0;  ///< V_{k+1} = -sum m g.x
  double work = 0;       ///< of the load, in this step, and so are
  double friction = 0;
  double impacts = 0;
  double scheme = 0;
};

struct Touch {
  std::size_t body = 0, knob = 0, plane = 0;
  friend bool operator==(const Touch&, const Touch&) = default;
};

struct Step {
  double time = 0;               ///< t_{k+1} [s]
  bool solved = true;            ///< false: the bodies are where they were
  std::string message{};         ///< of what solved the contact problem, or failed to; empty without contacts
  long iterations = 0;           ///< Run::steps(), or pivots
  std::vector<Touch> touches{};  ///< its contacts
  Solution solution{};           ///< r, and u with e U_N,k in it
  Residual residual{};           ///< by Coulomb's law, whichever was asked for
  Energy energy{};
};

class MoreauJean {
 public:
  /// Throws std::invalid_argument naming body, plane or option and the value if a mass or J is not positive (definite),
  /// an attitude no rotation, a normal not of length 1, e not in [0, 1], mu < 0, or anything not finite.
  MoreauJean(std::vector<MovingBody> bodies, std::vector<Plane> planes, SteppingOptions options);

  Step step();

  double time() const { return time_; }
  const std::vector<MovingBody>& bodies() const { return bodies_; }
  double kinetic() const;
  double potential() const;
  /// Distance of a knob from a plane [m], < 0 inside.
  double gap(const Touch& touch) const;

 private:
  struct Scene;
  Vec loads() const;
  std::vector<Touch> forecast(const Vec& load) const;
  Scene scene(const std::vector<Touch>& touches, const Vec& load) const;
  std::vector<ContactKey> keys_of(const std::vector<Touch>& touches) const;
  bool solve(const Problem& problem, Step& step);
  void move(const Vec& v);
  Vec velocities() const;

  std::vector<MovingBody> bodies_;
  std::vector<Plane> planes_;
  SteppingOptions options_;
  double time_ = 0;
  long steps_ = 0;
  Sequence sequence_;
};

}  // namespace perp::contact

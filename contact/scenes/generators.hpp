// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Contact problems from mechanics, one time step each, of any size and the same for the same seed on every machine up
/// to rounding. Bodies rest, or fall, under gravity g = 9.81 m/s^2 along -z; a step of h seconds; densities of stone or
/// steel. Most have redundant contacts, four feet on a floor, so that W is singular and r not unique.
#include <span>
#include <string>
#include <string_view>

#include "contact/scenes/rigid_bodies.hpp"

namespace perp::contact {

/// Bodies in contact and the step they make.
struct Scene {
  std::string name{};
  RigidBodies bodies{};
  double step = 0.01;                ///< h [s]
  Vec3 gravity = Vec3(0, 0, -9.81);  ///< [m/s^2]

  Index contacts() const { return static_cast<Index>(bodies.contacts().size()); }
  /// condense() of its Global.
  Problem problem() const;
};

// All throw std::invalid_argument for a count below 1, sizes that are not positive, or mu < 0.

/// Boxes on top of each other, shifted at random by up to `shift` of their width: the stack leans, and stands while mu
/// and the shifts allow. Four contacts at the corners of each overlap.
struct BoxStack {
  int boxes = 10;
  double width = 1;     ///< [m]
  double height = 0.5;  ///< [m]
  double shift = 0.02;
  double mu = 0.5;
  double density = 2000;  ///< [kg/m^3]
  unsigned seed = 1;
};
Scene make_scene(const BoxStack& options);

/// Spheres poured one after another into a box with a floor and four walls. Each falls at a random place and rolls down
/// until it rests. Radii are uniform in [0.8, 1] `radius`. A sphere has about three contacts. The weight of later
/// spheres may move it again. With mu = 0.9 nearly nothing moves, and with mu = 0.2 half of the contacts slip. Near mu
/// = 0.4, piles of 800 contacts and more are about to collapse, and are hard problems.
struct Spheres {
  int spheres = 50;
  double radius = 0.05;  ///< [m]
  double width = 0;      ///< of the box [m]; 0: as wide as the pile will be high
  double mu = 0.6;
  double density = 7800;
  unsigned seed = 1;
};
Scene make_scene(const Spheres& options);

/// A semicircular arch of wedges between the radii, on two fixed springers: four contacts a joint. It stands while
/// friction suffices and a thrust line fits into it: thickness / mean radius above 0.1075 (Milankovitch 1907).
struct Arch {
  int voussoirs = 9;
  double radius = 2;       ///< mean [m]
  double thickness = 0.5;  ///< [m]
  double depth = 0.8;      ///< [m]
  double mu = 0.7;
  double density = 2400;
};
Scene make_scene(const Arch& options);

/// A chain of links between two fixed points, hanging in its discrete catenary: every joint transmits the tension
///     T_k = (tension, (k - n / 2)) m g,   k = 0 .. n,
/// along its normal, r_N = h |T_k|, r_T = 0. With two points a joint, which halve it, contacts are redundant.
struct Chain {
  int links = 20;
  double length = 0.2;  ///< of a link [m]
  double tension = 8;   ///< horizontal, in weights of a link
  int points = 1;       ///< of contact a joint: 1 or 2
  double mu = 0.3;
  double density = 7800;
};
Scene make_scene(const Chain& options);

/// A wall of bricks in running bond on the floor: every brick rests on two halves, and touches its neighbours in the
/// course at the head joints: four contacts each, 8 redundant ones a brick and more.
struct Wall {
  int courses = 4;
  int bricks = 4;  ///< a course; odd courses have one less
  double mu = 0.6;
  double density = 1800;
};
Scene make_scene(const Wall& options);

/// A row of boxes down a plane of this slope, touching each other: four contacts each with the plane, and with the
/// next. Below atan(mu) they stay; above they slide with h g (sin - mu cos). All slip or stick at once: near the angle
/// of friction a degenerate problem.
struct Incline {
  int boxes = 5;
  double angle = 0.45;  ///< [rad], in [0, pi / 2)
  double mu = 0.5;      ///< with the plane; between the boxes 0.3
  double size = 0.4;    ///< [m]
  double density = 1000;
};
Scene make_scene(const Incline& options);

struct GeneratorEntry {
  std::string_view name;  ///< "stack", "spheres", "arch", "chain", "wall", "incline"
  std::string_view what;  ///< one line
  Scene (*make)(Index contacts, unsigned seed);
};
/// Returns all generators. They make about as many contacts as asked for: up to the contacts of one body, and for
/// spheres within some per cent.
std::span<const GeneratorEntry> generators();
/// Makes the scene of this name. Throws std::invalid_argument if the name is unknown, and then lists the known ones, or
/// if contacts < 1.
Scene make_scene(std::string_view name, Index contacts, unsigned seed = 1);

}  // namespace perp::contact

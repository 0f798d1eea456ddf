// SPDX-License-Identifier: Apache-2.0
#include "contact/scenes/generators.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <vector>

#include "contact/scenes/random.hpp"
#include "lcp/memory.hpp"
#include "lcp/words.hpp"

namespace perp::contact {
namespace {

void require(bool condition, const char* scene, const char* what, double value) {
  if (condition) return;
  refuse_input(scene, ": ", what, " is ", value);
}
void require_count(const char* scene, const char* what, int value, int least = 1) {
  require(value >= least, scene, what, value);
}
void require_positive(const char* scene, const char* what, double value) {
  require(value > 0 && std::isfinite(value), scene, what, value);
}
void require_friction(const char* scene, double mu) { require(mu >= 0 && std::isfinite(mu), scene, "mu", mu); }

Index add_box(RigidBodies& bodies, const Vec3& centre, const Vec3& edges, double density) {
  const double mass = density * edges.prod();
  return bodies.add({.mass = mass, .inertia = RigidBodies::box_inertia(mass, edges), .centre = centre});
}

/// Contacts at the corners of the rectangle p + [0, 1] e + [0, 1] f.
void touch_rectangle(RigidBodies& bodies, RigidBodies::Contact contact, const Vec3& p, const Vec3& e, const Vec3& f) {
  for (const auto& [i, j] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
    contact.point = p + i * e + j * f;
    bodies.touch(contact);
  }
}

}  // namespace

Problem Scene::problem() const { return condense(bodies.global(step, gravity), bodies.mu(), 3, name); }

Scene make_scene(const BoxStack& o) {
  require_count("stack", "the number of boxes", o.boxes);
  require_positive("stack", "the width", o.width);
  require_positive("stack", "the height", o.height);
  require_positive("stack", "the density", o.density);
  require(o.shift >= 0 && o.shift < 0.5, "stack", "the shift", o.shift);
  require_friction("stack", o.mu);
  Scene scene{.name = "stack-" + std::to_string(o.boxes)};
  Random random(o.seed);
  const Vec3 edges(o.width, o.width, o.height);
  Vec3 below(0, 0, 0);
  Index lower = ground;
  for (int k = 0; k < o.boxes; ++k) {
    const double reach = k == 0 ? 0 : o.shift * o.width;
    const double dx = reach * random.uniform(-1, 1);
    const double dy = reach * random.uniform(-1, 1);
    const Vec3 centre(below[0] + dx, below[1] + dy, (k + 0.5) * o.height);
    const Index box = add_box(scene.bodies, centre, edges, o.density);
    const Vec3 low(std::max(centre[0], below[0]) - o.width / 2, std::max(centre[1], below[1]) - o.width / 2,
                   k * o.height);
    touch_rectangle(scene.bodies, {.a = box, .b = lower, .mu = o.mu}, low, (o.width - std::abs(dx)) * Vec3::UnitX(),
                    (o.width - std::abs(dy)) * Vec3::UnitY());
    below = centre;
    lower = box;
  }
  return scene;
}

namespace {

/// A convex polygon's area, centroid and second moments about it, in the plane (x, z).
struct Section {
  double area = 0, x = 0, z = 0, xx = 0, zz = 0, xz = 0;
};
Section section(const std::vector<std::array<double, 2>>& corners) {
  Section s;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto& [x0, z0] = corners[i];
    const auto& [x1, z1] = corners[(i + 1) % corners.size()];
    const double cross = x0 * z1 - x1 * z0;
    s.area += cross / 2;
    s.x += (x0 + x1) * cross / 6;
    s.z += (z0 + z1) * cross / 6;
    s.xx += (x0 * x0 + x0 * x1 + x1 * x1) * cross / 12;
    s.zz += (z0 * z0 + z0 * z1 + z1 * z1) * cross / 12;
    s.xz += (x0 * z1 + 2 * x0 * z0 + 2 * x1 * z1 + x1 * z0) * cross / 24;
  }
  s.x /= s.area;
  s.z /= s.area;
  s.xx -= s.area * s.x * s.x;
  s.zz -= s.area * s.z * s.z;
  s.xz -= s.area * s.x * s.z;
  return s;
}

}  // namespace

Scene make_scene(const Arch& o) {
  require_count("arch", "the number of voussoirs", o.voussoirs, 2);
  require_positive("arch", "the radius", o.radius);
  require_positive("arch", "the depth", o.depth);
  require_positive("arch", "the density", o.density);
  require(o.thickness > 0 && o.thickness < 2 * o.radius, "arch", "the thickness", o.thickness);
  require_friction("arch", o.mu);
  Scene scene{.name = "arch-" + std::to_string(o.voussoirs)};
  const double inner = o.radius - o.thickness / 2;
  const double outer = o.radius + o.thickness / 2;
  const auto angle = [&o](int k) { return std::numbers::pi * k / o.voussoirs; };
  for (int k = 0; k < o.voussoirs; ++k) {
    const double a = angle(k);
    const double b = angle(k + 1);
    const Section s = section({{inner * std::cos(a), inner * std::sin(a)},
                               {outer * std::cos(a), outer * std::sin(a)},
                               {outer * std::cos(b), outer * std::sin(b)},
                               {inner * std::cos(b), inner * std::sin(b)}});
    const double sheet = o.density * o.depth;
    const double mass = sheet * s.area;
    const double across = mass * o.depth * o.depth / 12;
    Mat3 J = Mat3::Zero();
    J(0, 0) = sheet * s.zz + across;
    J(1, 1) = sheet * (s.xx + s.zz);
    J(2, 2) = sheet * s.xx + across;
    J(0, 2) = J(2, 0) = -sheet * s.xz;
    scene.bodies.add({.mass = mass, .inertia = J, .centre = Vec3(s.x, 0, s.z)});
  }
  for (int k = 0; k <= o.voussoirs; ++k) {
    const Vec3 out(std::cos(angle(k)), 0, std::sin(angle(k)));
    const Vec3 along(-std::sin(angle(k)), 0, std::cos(angle(k)));  // to the next voussoir
    const Index next = k < o.voussoirs ? k : ground;
    touch_rectangle(scene.bodies, {.a = next, .b = k - 1, .normal = along.normalized(), .mu = o.mu},
                    inner * out - o.depth / 2 * Vec3::UnitY(), o.thickness * out, o.depth * Vec3::UnitY());
  }
  return scene;
}

Scene make_scene(const Chain& o) {
  require_count("chain", "the number of links", o.links);
  require_positive("chain", "the length of a link", o.length);
  require_positive("chain", "the tension", o.tension);
  require_positive("chain", "the density", o.density);
  require(o.points == 1 || o.points == 2, "chain", "the number of points a joint", o.points);
  require_friction("chain", o.mu);
  Scene scene{.name = "chain-" + std::to_string(o.links)};
  const Vec3 edges(o.length, 0.4 * o.length, 0.2 * o.length);
  const double mass = o.density * edges.prod();
  const auto tension = [&o](int k) { return Vec3(o.tension, 0, k - o.links / 2.); };
  std::vector<Vec3> joints{Vec3::Zero()};
  for (int k = 0; k < o.links; ++k) {  // moments about the centre vanish for a link along T_k + T_k+1
    const Vec3 along = (tension(k) + tension(k + 1)).normalized();
    Mat3 axes;
    axes << along, Vec3::UnitY(), along.cross(Vec3::UnitY());
    const Mat3 J = axes * RigidBodies::box_inertia(mass, edges) * axes.transpose();
    scene.bodies.add(
        {.mass = mass, .inertia = (J + J.transpose()) / 2, .centre = joints.back() + o.length / 2 * along});
    joints.emplace_back(joints.back() + o.length * along);
  }
  for (int k = 0; k <= o.links; ++k) {
    // The joint pulls the link before it along T_k and the one behind it back.
    const Vec3 pull = tension(k).normalized();
    RigidBodies::Contact joint{.a = k - 1, .b = k < o.links ? k : ground, .normal = pull, .mu = o.mu};
    for (int i = 0; i < o.points; ++i) {
      joint.point = joints[static_cast<std::size_t>(k)];
      if (o.points == 2) joint.point[1] = (i == 0 ? -0.15 : 0.15) * o.length;
      scene.bodies.touch(joint);
    }
  }
  return scene;
}

Scene make_scene(const Wall& o) {
  require_count("wall", "the number of courses", o.courses);
  require_count("wall", "the number of bricks a course", o.bricks, 2);
  require_positive("wall", "the density", o.density);
  require_friction("wall", o.mu);
  Scene scene{.name = "wall-" + std::to_string(o.courses) + "x" + std::to_string(o.bricks)};
  const Vec3 edges(0.24, 0.115, 0.071);
  const Vec3 back(0, edges[1], 0);
  std::vector<Index> below;
  for (int c = 0; c < o.courses; ++c) {
    const bool odd = c % 2 == 1;
    std::vector<Index> course;
    for (int k = 0; k < o.bricks - (odd ? 1 : 0); ++k) {
      const double left = (k + (odd ? 0.5 : 0)) * edges[0];
      const Vec3 corner(left, 0, c * edges[2]);
      const Index brick = add_box(scene.bodies, corner + edges / 2, edges, o.density);
      // A brick of an odd course lies on the halves of bricks k and k + 1; of an even one on k - 1 and k.
      for (int half = 0; half < 2; ++half) {
        const int under = odd ? k + half : k - 1 + half;
        const bool floor = c == 0;
        if (floor && half == 1) continue;
        if (!floor && (under < 0 || under >= static_cast<int>(below.size()))) continue;
        touch_rectangle(scene.bodies,
                        {.a = brick, .b = floor ? ground : below[static_cast<std::size_t>(under)], .mu = o.mu},
                        corner + (floor ? 0 : half * edges[0] / 2) * Vec3::UnitX(),
                        (floor ? edges[0] : edges[0] / 2) * Vec3::UnitX(), back);
      }
      if (k > 0)
        touch_rectangle(scene.bodies, {.a = brick, .b = course.back(), .normal = Vec3::UnitX(), .mu = o.mu}, corner,
                        back, edges[2] * Vec3::UnitZ());
      course.push_back(brick);
    }
    below = course;
  }
  return scene;
}

Scene make_scene(const Incline& o) {
  require_count("incline", "the number of boxes", o.boxes);
  require_positive("incline", "the size", o.size);
  require_positive("incline", "the density", o.density);
  require(o.angle >= 0 && o.angle < std::numbers::pi / 2, "incline", "the angle", o.angle);
  require_friction("incline", o.mu);
  Scene scene{.name = "incline-" + std::to_string(o.boxes)};
  const Vec3 down(std::cos(o.angle), 0, -std::sin(o.angle));
  const Vec3 normal(std::sin(o.angle), 0, std::cos(o.angle));
  const Vec3 half = o.size / 2 * Vec3::UnitY();
  const Vec3 edge = o.size * Vec3::UnitY();
  Index before = ground;
  for (int k = 0; k < o.boxes; ++k) {
    const Vec3 corner = k * o.size * down - half;  // the upper end on the plane
    const Vec3 centre = (k + 0.5) * o.size * down + o.size / 2 * normal;
    const Index box = add_box(scene.bodies, centre, Vec3::Constant(o.size), o.density);  // a cube: J is isotropic
    touch_rectangle(scene.bodies, {.a = box, .b = ground, .normal = normal.normalized(), .mu = o.mu}, corner,
                    o.size * down, edge);
    if (before != ground)
      touch_rectangle(scene.bodies, {.a = box, .b = before, .normal = down.normalized(), .mu = 0.3}, corner, edge,
                      o.size * normal);
    before = box;
  }
  return scene;
}

namespace {

int per(Index contacts, double each, int least = 1) {
  return std::max(least, static_cast<int>(std::lround(static_cast<double>(contacts) / each)));
}

Scene stack_of(Index contacts, unsigned seed) { return make_scene(BoxStack{.boxes = per(contacts, 4), .seed = seed}); }
/// Contacts a sphere: fewer in small piles, of which more lies on the floor; measured.
Scene spheres_of(Index contacts, unsigned seed) {
  const double each = 2.45 + 0.11 * std::log10(static_cast<double>(contacts));
  return make_scene(Spheres{.spheres = per(contacts, each), .seed = seed});
}
Scene arch_of(Index contacts, unsigned) { return make_scene(Arch{.voussoirs = per(contacts - 4, 4, 2)}); }
Scene chain_of(Index contacts, unsigned) {
  return make_scene(Chain{.links = per(contacts - 2, 2), .tension = 0.4 * per(contacts - 2, 2), .points = 2});
}
/// About as many courses as bricks in one: a course of s bricks has 8 (s - 1) contacts below and 4 (s - 1) or 4 (s - 2)
/// beside; the lowest 4 s below.
Scene wall_of(Index contacts, unsigned) {
  const auto n = static_cast<double>(contacts);
  const int side = std::max(2, static_cast<int>(std::lround(std::sqrt(n / 12) + 0.7)));
  const double course = 8 * (side - 1) + 4 * (side - 1.5);
  const double first = 8 * (side - 1) - 4 * side;  // what the lowest course has less
  return make_scene(Wall{.courses = std::max(1, static_cast<int>(std::lround((n + first) / course))), .bricks = side});
}
Scene incline_of(Index contacts, unsigned) { return make_scene(Incline{.boxes = per(contacts + 4, 8)}); }

}  // namespace

std::span<const GeneratorEntry> generators() {
  static const std::array table{
      GeneratorEntry{"stack", "boxes on top of each other, shifted at random", stack_of},
      GeneratorEntry{"spheres", "spheres poured into a box", spheres_of},
      GeneratorEntry{"arch", "a semicircular masonry arch", arch_of},
      GeneratorEntry{"chain", "a hanging chain, two points of contact a joint", chain_of},
      GeneratorEntry{"wall", "a wall of bricks in running bond", wall_of},
      GeneratorEntry{"incline", "boxes on an incline near the angle of friction", incline_of},
  };
  return table;
}

Scene make_scene(std::string_view name, Index contacts, unsigned seed) {
  require(contacts >= 1, "generators", "the number of contacts", static_cast<double>(contacts));
  constexpr double contact_bytes = 200;  // at least: its point and frame, and a column of W
  lcp::require_memory(contact_bytes * static_cast<double>(contacts), "the contacts");
  std::ostringstream known;
  for (const GeneratorEntry& entry : generators()) {
    if (entry.name == name) return entry.make(contacts, seed);
    known << (known.tellp() > 0 ? ", " : "") << entry.name;
  }
  refuse_input("generators: there is no ", name, "; there are ", known.str());
}

}  // namespace perp::contact

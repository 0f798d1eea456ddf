// SPDX-License-Identifier: Apache-2.0
/// Spheres poured into a box.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <vector>

#include "contact/scenes/generators.hpp"
#include "contact/scenes/random.hpp"
#include "lcp/types.hpp"
#include "lcp/words.hpp"

namespace perp::contact {
namespace {

/// How far a ball goes, in radii, before its neighbours are looked up again; cells are as much larger than a contact.
/// Then it may be pushed no farther than `pushed` by one step.
constexpr double stale = 0.2;
constexpr double pushed = 0.8;
/// A ball rests where it sinks by less than this part of a step down: on slopes of 0.6 degrees.
constexpr double least_sinking = 1e-4;
/// Squares of distances beyond those of touching, rounding included.
constexpr double beyond = 1 + 1e-14;
/// Of pushing out of what is in the way after a step.
constexpr int most_sweeps = 60;
/// Obstacles are looked for so many steps around; a ball that has gone less than this part of it met no others.
constexpr double nearby_steps = 16;
constexpr double surely_nearby = 0.99;

struct Ball {
  Vec3 centre;
  double radius;
};

/// What a ball may meet: balls, and the floor and walls of a box. Components are written out, which is all the time
/// that making a pile takes.
class Obstacles {
 public:
  /// Those that this ball may meet before it has gone farther than `far`.
  void find(const Ball& ball, double far, const std::vector<Ball>& close, double width) {
    balls_.clear();
    for (const Ball& other : close) {
      const double touching = ball.radius + other.radius;
      const double reach = touching + far;
      if ((ball.centre - other.centre).squaredNorm() > reach * reach) continue;
      balls_.push_back({other.centre[0], other.centre[1], other.centre[2], touching, beyond * touching * touching});
    }
    least_ = ball.radius;
    most_ = width - ball.radius;
    const double sideways =
        std::min(ball.centre.head<2>().minCoeff() - least_, most_ - ball.centre.head<2>().maxCoeff());
    box_ = std::min(sideways, ball.centre[2] - least_) < far;
  }

  /// Pushes the ball out of all of them, sweep after sweep. False: it still overlaps something.
  bool push_out(Ball& ball) {
    double x = ball.centre[0];
    double y = ball.centre[1];
    double z = ball.centre[2];
    const double small = 1e-9 * ball.radius;
    double way = 0;
    double moved = lcp::infinity;
    for (int sweep = 0; sweep < most_sweeps && moved > small; ++sweep) {
      moved = 0;
      for (const Fixed& other : balls_) {
        const double dx = x - other.x;
        const double dy = y - other.y;
        const double dz = z - other.z;
        const double square = dx * dx + dy * dy + dz * dz;
        if (square > other.beyond) continue;                  // needs no root
        const double distance = Eigen::numext::sqrt(square);  // std::sqrt may call, which costs the registers
        const double overlap = other.touching - distance;
        if (overlap <= 0) continue;
        const double share = overlap / distance;
        x += share * dx;
        y += share * dy;
        z += share * dz;
        way += overlap;
        moved = overlap > moved ? overlap : moved;
      }
      if (!box_ || (x >= least_ && x <= most_ && y >= least_ && y <= most_ && z >= least_)) continue;
      const Vec3 outside(x, y, z);
      x = std::clamp(x, least_, most_);
      y = std::clamp(y, least_, most_);
      z = std::max(z, least_);
      const double by_box = (Vec3(x, y, z) - outside).norm();
      way += by_box;
      moved = std::max(moved, by_box);
    }
    ball.centre = Vec3(x, y, z);
    way_ = way;
    return moved <= small;
  }
  /// How far the last push_out() has moved it, from one of them to the next.
  double way() const { return way_; }

 private:
  struct Fixed {
    double x, y, z;
    double touching;  // distance, and the square of one beyond it
    double beyond;
  };

  std::vector<Fixed> balls_;
  double least_ = 0;  // of x and y, of z
  double most_ = 0;   // of x and y
  bool box_ = true;   // may floor or walls be met?
  double way_ = 0;
};

/// The balls at rest, found by their places.
class Pile {
 public:
  Pile(double largest, double width) : cell_((2 + stale) * largest), width_(width) {}

  void add(const Ball& ball) {
    cells_[key(ball.centre)].push_back(balls_.size());
    balls_.push_back(ball);
    top_ = std::max(top_, ball.centre[2] + ball.radius);
  }
  const std::vector<Ball>& balls() const { return balls_; }
  double top() const { return top_; }

  /// All that a ball at x, or stale radii from it, may touch, and some more.
  void near(const Vec3& x, std::vector<std::size_t>& found) const {
    found.clear();
    const auto at = place(x);
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j)
        for (int k = -1; k <= 1; ++k) {
          const auto cell = cells_.find(hash({at[0] + i, at[1] + j, at[2] + k}));
          if (cell != cells_.end()) found.insert(found.end(), cell->second.begin(), cell->second.end());
        }
  }

  /// The balls of these that one at x may meet before it looks again, side by side in memory.
  void reachable(const Vec3& x, std::vector<std::size_t>& found, std::vector<Ball>& close) const {
    near(x, found);
    close.clear();
    const double reach = cell_ + pushed * cell_ / (2 + stale);
    for (const std::size_t i : found)
      if ((balls_[i].centre - x).squaredNorm() <= reach * reach) close.push_back(balls_[i]);
  }

  /// Pushes the ball, which has just gone down by `step`, out of the floor, the walls and the balls `close` by. False:
  /// it still overlaps something. Most balls go no farther than a few steps: then those within them are all that it can
  /// meet, and the sweeps are the same bit by bit.
  bool push_out(Ball& ball, double step, const std::vector<Ball>& close, Obstacles& obstacles) const {
    const Ball start = ball;
    obstacles.find(ball, nearby_steps * step, close, width_);
    const bool fits = obstacles.push_out(ball);
    if (obstacles.way() <= surely_nearby * nearby_steps * step) return fits;
    ball = start;
    obstacles.find(ball, lcp::infinity, close, width_);
    return obstacles.push_out(ball);
  }

 private:
  using Place = std::array<long long, 3>;
  static long long hash(const Place& p) { return (p[0] * 2097152 + p[1]) * 2097152 + p[2]; }
  Place place(const Vec3& x) const {
    return {std::llround(std::floor(x[0] / cell_)), std::llround(std::floor(x[1] / cell_)),
            std::llround(std::floor(x[2] / cell_))};
  }
  long long key(const Vec3& x) const { return hash(place(x)); }

  double cell_;
  double width_;
  double top_ = 0;
  std::vector<Ball> balls_;
  std::unordered_map<long long, std::vector<std::size_t>> cells_;
};

/// Small steps down, each followed by pushing out of what is in the way: the ball falls, and rolls along what it meets.
/// Steps are halved when it does not sink any more.
void settle(const Pile& pile, Ball& ball) {
  std::vector<std::size_t> found;
  std::vector<Ball> close;
  Obstacles obstacles;
  Vec3 looked_at = ball.centre;
  pile.reachable(ball.centre, found, close);
  double step = 0.2 * ball.radius;
  for (int k = 0; k < 20000 && step > 1e-7 * ball.radius; ++k) {
    if ((ball.centre - looked_at).norm() > stale * ball.radius) {
      pile.reachable(ball.centre, found, close);
      looked_at = ball.centre;
    }
    Ball next = ball;
    next.centre[2] -= step;
    const bool fits = pile.push_out(next, step, close, obstacles);
    if (!fits || ball.centre[2] - next.centre[2] < least_sinking * step)
      step /= 2;
    else
      ball = next;
  }
}

}  // namespace

Scene make_scene(const Spheres& o) {
  const auto require = [](bool condition, const char* what, double value) {
    if (condition) return;
    refuse_input("spheres: ", what, " is ", value);
  };
  require(o.spheres >= 1, "the number of spheres", o.spheres);
  require(o.radius > 0 && std::isfinite(o.radius), "the radius", o.radius);
  require(o.width == 0 || o.width >= 2 * o.radius, "the width of the box", o.width);
  require(o.density > 0 && std::isfinite(o.density), "the density", o.density);
  require(o.mu >= 0 && std::isfinite(o.mu), "mu", o.mu);
  const double width = o.width > 0 ? o.width : 2 * o.radius * std::max(1.5, 0.95 * std::cbrt(o.spheres));

  Scene scene{.name = "spheres-" + std::to_string(o.spheres)};
  Random random(o.seed);
  Pile pile(o.radius, width);
  for (int k = 0; k < o.spheres; ++k) {
    const double radius = o.radius * random.uniform(0.8, 1);
    const double x = random.uniform(radius, width - radius);
    const double y = random.uniform(radius, width - radius);
    Ball ball{Vec3(x, y, pile.top() + radius), radius};
    settle(pile, ball);
    pile.add(ball);
    const double mass = o.density * 4 / 3 * std::numbers::pi * std::pow(radius, 3);
    scene.bodies.add({.mass = mass, .inertia = RigidBodies::sphere_inertia(mass, radius), .centre = ball.centre});
  }

  const double gap = 1e-4 * o.radius;  // what counts as touching
  std::vector<std::size_t> close;
  for (std::size_t a = 0; a < pile.balls().size(); ++a) {
    const Ball& ball = pile.balls()[a];
    const auto index = static_cast<Index>(a);
    const auto wall = [&](double distance, const Vec3& inward) {
      if (distance <= ball.radius + gap)
        scene.bodies.touch(
            {.a = index, .b = ground, .point = ball.centre - distance * inward, .normal = inward, .mu = o.mu});
    };
    wall(ball.centre[2], Vec3::UnitZ());
    wall(ball.centre[0], Vec3::UnitX());
    wall(width - ball.centre[0], -Vec3::UnitX());
    wall(ball.centre[1], Vec3::UnitY());
    wall(width - ball.centre[1], -Vec3::UnitY());
    pile.near(ball.centre, close);
    std::sort(close.begin(), close.end());
    for (const std::size_t b : close) {
      if (b >= a) break;
      const Ball& other = pile.balls()[b];
      const Vec3 apart = ball.centre - other.centre;
      if (apart.norm() > ball.radius + other.radius + gap) continue;
      const Vec3 normal = apart.normalized();
      scene.bodies.touch({.a = index,
                          .b = static_cast<Index>(b),
                          .point = other.centre + other.radius * normal,
                          .normal = normal,
                          .mu = o.mu});
    }
  }
  return scene;
}

}  // namespace perp::contact

// SPDX-License-Identifier: Apache-2.0
#include "contact/scenes/moreau_jean.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/solvers/run.hpp"
#include "lcp/words.hpp"

namespace perp::contact {
namespace {

[[noreturn]] void refuse(const std::string& why) { refuse_input("time stepping: ", why); }

void check(const MovingBody& body, std::size_t i) {
  const bool finite = body.inertia.allFinite() && body.centre.allFinite() && body.velocity.allFinite() &&
                      body.spin.allFinite() && std::isfinite(body.mass) && body.attitude.allFinite();
  if (!finite || !(body.mass > 0))
    refuse(text_of("body ", i, " has the mass ", body.mass, ", or a part is not finite"));
  if (Eigen::LLT<Mat3>(body.inertia).info() != Eigen::Success)
    refuse(text_of("the inertia of body ", i, " is not positive definite"));
  const Mat3 deviation = body.attitude.transpose() * body.attitude - Mat3::Identity();
  if (!(deviation.norm() < 1e-8 && body.attitude.determinant() > 0))
    refuse(text_of("the attitude of body ", i, " is no rotation: its determinant is ", body.attitude.determinant()));
  if (!body.turns && body.spin != Vec3::Zero()) refuse(text_of("body ", i, " cannot turn, but spins"));
  for (const MovingBody::Knob& knob : body.knobs)
    if (!knob.at.allFinite() || !(knob.radius >= 0) || !std::isfinite(knob.radius))
      refuse(text_of("a knob of body ", i, " has the radius ", knob.radius, ", or its place is not finite"));
}

void check(const Plane& plane, std::size_t i) {
  if (!(std::abs(plane.normal.norm() - 1) < 1e-12) || !plane.point.allFinite() || !std::isfinite(plane.frame))
    refuse(text_of("the normal of plane ", i, " has the length ", plane.normal.norm(), ", or a part is not finite"));
  if (!(plane.mu >= 0) || !std::isfinite(plane.mu)) refuse(text_of("mu of plane ", i, " is ", plane.mu, ", not >= 0"));
  if (!(plane.e >= 0 && plane.e <= 1)) refuse(text_of("e of plane ", i, " is ", plane.e, ", not in [0, 1]"));
}

Mat3 rotation(const Vec3& turn) {
  const double angle = turn.norm();
  return angle > 0 ? Mat3(Eigen::AngleAxisd(angle, turn / angle)) : Mat3::Identity();
}

Vec3 arm(const MovingBody& body, std::size_t knob) { return body.attitude * body.knobs[knob].at; }

Mat3 world_inertia(const MovingBody& body) { return body.attitude * body.inertia * body.attitude.transpose(); }

/// Turns (T1, T2) of contact j, so that r, u are in the planes' frames: H Q.
SpMat turn_frames(const std::vector<double>& angles) {
  std::vector<Eigen::Triplet<double, int>> entries;
  for (std::size_t j = 0; j < angles.size(); ++j) {
    const int at = 3 * static_cast<int>(j);
    const double c = std::cos(angles[j]);
    const double s = std::sin(angles[j]);
    entries.emplace_back(at, at, 1);
    entries.emplace_back(at + 1, at + 1, c);
    entries.emplace_back(at + 2, at + 1, s);
    entries.emplace_back(at + 1, at + 2, -s);
    entries.emplace_back(at + 2, at + 2, c);
  }
  const auto n = static_cast<Index>(3 * angles.size());
  SpMat Q(n, n);
  Q.setFromTriplets(entries.begin(), entries.end());
  return Q;
}

}  // namespace

/// Bodies and contacts at x_k, with the load.
struct MoreauJean::Scene {
  Global global;
  Vec mu;
};

MovingBody MovingBody::ball(double mass, double radius) {
  return {.mass = mass, .inertia = RigidBodies::sphere_inertia(mass, radius), .knobs = {{.radius = radius}}};
}

MovingBody MovingBody::box(double mass, const Vec3& edges) {
  MovingBody box{.mass = mass, .inertia = RigidBodies::box_inertia(mass, edges)};
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 sign((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5, (corner & 4) != 0 ? 0.5 : -0.5);
    box.knobs.push_back({.at = edges.cwiseProduct(sign)});
  }
  return box;
}

std::string name(const FrictionLaw& law) {
  if (law.kind == FrictionLaw::Kind::Coulomb) return "exact";
  return text_of(law.kind == FrictionLaw::Kind::Inner ? "inner:" : "outer:", law.facets);
}

std::optional<std::string> invalid(const SteppingOptions& options) {
  if (!(options.h > 0) || !std::isfinite(options.h)) return text_of("h is ", options.h, " s; it must be positive");
  if (!(options.theta >= 0.5 && options.theta <= 1))
    return text_of("theta is ", options.theta, "; it must be in [1/2, 1]");
  if (!(options.gamma >= 0 && options.gamma <= 1)) return text_of("gamma is ", options.gamma, "; it must be in [0, 1]");
  if (!options.gravity.allFinite()) return "gravity is not finite";
  if (!(options.tol > 0)) return text_of("tol is ", options.tol, "; it must be positive");
  if (options.law.kind != FrictionLaw::Kind::Coulomb && options.law.facets < 3)
    return text_of("a polygon of ", options.law.facets, " facets; it must have at least 3");
  return std::nullopt;
}

MoreauJean::MoreauJean(std::vector<MovingBody> bodies, std::vector<Plane> planes, SteppingOptions options)
    : bodies_(std::move(bodies)), planes_(std::move(planes)), options_(std::move(options)) {
  if (const auto why = invalid(options_)) refuse(*why);
  for (std::size_t i = 0; i < bodies_.size(); ++i) check(bodies_[i], i);
  for (std::size_t i = 0; i < planes_.size(); ++i) check(planes_[i], i);
  const bool exact = options_.law.kind == FrictionLaw::Kind::Coulomb;
  sequence_ = Sequence({.variant = exact ? Variant{} : variant_of(name(options_.law)),
                        .limits = {.tol = options_.tol},
                        .warm = options_.warm_start});
}

double MoreauJean::kinetic() const {
  double sum = 0;
  for (const MovingBody& body : bodies_)
    sum += 0.5 * (body.mass * body.velocity.squaredNorm() + body.spin.dot(world_inertia(body) * body.spin));
  return sum;
}

double MoreauJean::potential() const {
  double sum = 0;
  for (const MovingBody& body : bodies_) sum -= body.mass * options_.gravity.dot(body.centre);
  return sum;
}

double MoreauJean::gap(const Touch& touch) const {
  const MovingBody& body = bodies_.at(touch.body);
  const Plane& plane = planes_.at(touch.plane);
  return plane.normal.dot(body.centre + arm(body, touch.knob) - plane.point) - body.knobs.at(touch.knob).radius;
}

Vec MoreauJean::velocities() const {
  Vec v(6 * static_cast<Index>(bodies_.size()));
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    v.segment<6>(6 * static_cast<Index>(i)) << bodies_[i].velocity, bodies_[i].spin;
  return v;
}

/// h F of the load at the middle of the step, and no moments.
Vec MoreauJean::loads() const {
  Vec load = Vec::Zero(6 * static_cast<Index>(bodies_.size()));
  const double t = time_ + 0.5 * options_.h;
  for (std::size_t i = 0; options_.load && i < bodies_.size(); ++i)
    load.segment<3>(6 * static_cast<Index>(i)) = options_.h * options_.load(i, t);
  if (!load.allFinite()) refuse(text_of("the load at t = ", t, " s is not finite"));
  return load;
}

/// The contacts whose gap would have closed after gamma h, or is below what rounding and tolerances leave of a body at
/// rest: a thousandth of the way on which the forces would push it into the plane in a step.
std::vector<Touch> MoreauJean::forecast(const Vec& load) const {
  std::vector<Touch> touches;
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    for (std::size_t knob = 0; knob < bodies_[i].knobs.size(); ++knob)
      for (std::size_t j = 0; j < planes_.size(); ++j) {
        const MovingBody& body = bodies_[i];
        const Vec3& n = planes_[j].normal;
        const Vec3 lever = arm(body, knob) - body.knobs[knob].radius * n;
        const double U_N = n.dot(body.velocity + body.spin.cross(lever));
        const Touch touch{.body = i, .knob = knob, .plane = j};
        const Vec3 push = options_.h * options_.gravity + load.segment<3>(6 * static_cast<Index>(i)) / body.mass;
        const double slack = 1e-3 * options_.h * std::max(0.0, -n.dot(push));
        if (gap(touch) + options_.gamma * options_.h * U_N <= slack) touches.push_back(touch);
      }
  return touches;
}

MoreauJean::Scene MoreauJean::scene(const std::vector<Touch>& touches, const Vec& load) const {
  RigidBodies rigid;
  for (const MovingBody& body : bodies_)
    rigid.add({.mass = body.mass,
               .inertia = world_inertia(body),
               .centre = body.centre,
               .velocity = body.velocity,
               .spin = body.spin});
  std::vector<double> angles;
  for (const Touch& touch : touches) {
    const MovingBody& body = bodies_[touch.body];
    const Plane& plane = planes_[touch.plane];
    const double radius = body.knobs[touch.knob].radius;
    rigid.touch({.a = static_cast<Index>(touch.body),
                 .b = ground,
                 .point = body.centre + arm(body, touch.knob) - radius * plane.normal,
                 .normal = plane.normal,
                 .mu = plane.mu});
    angles.push_back(plane.frame);
  }
  Scene scene{.global = rigid.global(options_.h, options_.gravity), .mu = rigid.mu()};
  Global& global = scene.global;
  global.f += load;
  global.H = SpMat(global.H * turn_frames(angles));

  const Vec U = global.H.transpose() * velocities();
  for (std::size_t j = 0; j < touches.size(); ++j) {
    const Index N = 3 * static_cast<Index>(j);
    global.w[N] = planes_[touches[j].plane].e * U[N];
  }
  std::vector<Eigen::Triplet<double, int>> fixed;
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    for (int axis = 3; axis < 6 && !bodies_[i].turns; ++axis)
      fixed.emplace_back(6 * static_cast<int>(i) + axis, static_cast<int>(fixed.size()), 1);
  global.G = SpMat(global.f.size(), static_cast<Index>(fixed.size()));
  global.G.setFromTriplets(fixed.begin(), fixed.end());
  global.b = Vec::Zero(global.G.cols());
  return scene;
}

/// The number of body, knob and plane.
std::vector<ContactKey> MoreauJean::keys_of(const std::vector<Touch>& touches) const {
  std::size_t knobs = 1;
  for (const MovingBody& body : bodies_) knobs = std::max(knobs, body.knobs.size());
  std::vector<ContactKey> keys;
  for (const Touch& touch : touches) keys.push_back((touch.body * knobs + touch.knob) * planes_.size() + touch.plane);
  return keys;
}

bool MoreauJean::solve(const Problem& problem, Step& step) {
  Run run = sequence_.step(problem, keys_of(step.touches));
  step.message = std::move(run.message);
  step.iterations = run.steps();
  step.solution = std::move(run.solution);
  step.residual = run.residual;
  return run.solved;
}

/// Poses from v_theta, velocities from v.
void MoreauJean::move(const Vec& v) {
  const double theta = options_.theta;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    MovingBody& body = bodies_[i];
    const Vec3 velocity = v.segment<3>(6 * static_cast<Index>(i));
    const Vec3 spin = body.turns ? Vec3(v.segment<3>(6 * static_cast<Index>(i) + 3)) : Vec3::Zero();
    body.centre += options_.h * (theta * velocity + (1 - theta) * body.velocity);
    const Vec3 turn = options_.h * (theta * spin + (1 - theta) * body.spin);
    body.attitude = Eigen::Quaterniond(rotation(turn) * body.attitude).normalized().toRotationMatrix();
    body.velocity = velocity;
    body.spin = spin;
  }
}

Step MoreauJean::step() {
  const double h = options_.h;
  const double theta = options_.theta;
  const Vec load = loads();
  Step step{.time = time_, .touches = forecast(load)};
  const Scene at = scene(step.touches, load);
  if (!step.touches.empty()) {
    step.solved = solve(condense(at.global, at.mu), step);
    if (!step.solved) return step;
  }

  // M v = H r + f; where a body does not turn lambda takes up the moments.
  const Vec v_k = velocities();
  Vec v = at.global.f;
  if (!step.touches.empty()) v += at.global.H * step.solution.r;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Index b = 6 * static_cast<Index>(i);
    v.segment<3>(b) /= bodies_[i].mass;
    v.segment<3>(b + 3) =
        bodies_[i].turns ? Vec3(world_inertia(bodies_[i]).llt().solve(Vec3(v.segment<3>(b + 3)))) : Vec3::Zero();
  }

  Energy& energy = step.energy;
  const double before = kinetic() + potential();
  const Vec U = at.global.H.transpose() * (0.5 * (v_k + v));
  for (Index j = 0; j < static_cast<Index>(step.touches.size()); ++j) {
    energy.impacts -= step.solution.r[3 * j] * U[3 * j];
    energy.friction -= step.solution.r.segment<2>(3 * j + 1).dot(U.segment<2>(3 * j + 1));
  }
  energy.work = load.dot(theta * v + (1 - theta) * v_k);
  move(v);
  time_ = h * static_cast<double>(++steps_);
  step.time = time_;
  energy.kinetic = kinetic();
  energy.potential = potential();
  energy.scheme = before + energy.work - energy.friction - energy.impacts - energy.kinetic - energy.potential;
  return step;
}

}  // namespace perp::contact

// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/follow_system.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "contact/model/unit_cone.hpp"
#include "contact/model/units.hpp"

namespace perp::contact {
namespace {

using Block = Eigen::Matrix3d;
using Eigen::Vector3d;

/// alpha; D where contacts do not stick, which are held more; the largest |D| and the least distance from the border,
/// as a part of the largest impulse, of what D is taken at.
constexpr double follow_alpha = 1e-10;
constexpr double follow_hold = 1e3;
constexpr double largest_metric = 1e4;
constexpr double least_margin = 1e-3;
/// Solutions with K are refined to those without alpha, until the residual is this.
constexpr double follow_refined = 1e-9;
/// Factors of other rows will do if what is left then is this part of the right side.
constexpr double kept_refined = 1e-2;

/// R; parts of the step to the least barrier.
constexpr double centring_size = 10;
constexpr std::array centring_steps{1.0, 0.5, 0.25, 0.1};

bool same_rows(const std::vector<ContactRows>& a, const std::vector<ContactRows>& b) {
  return std::ranges::equal(a, b, [](const ContactRows& x, const ContactRows& y) { return x.A == y.A && x.B == y.B; });
}

bool sticks(const ContactRows& rows, int size) {
  return rows.A.topLeftCorner(size, size).isZero(0) && rows.B.topLeftCorner(size, size).isIdentity(0);
}

/// The gradient of log det(x) / 2.
Vector3d inward(const Vector3d& x) { return Vector3d(x[0], -x[1], -x[2]) / cone_det(x); }

/// The Hessian of -log det(x) / 2.
Block barrier_metric(const Vector3d& x) {
  const Vector3d g = inward(x);
  Block H = 2 * g * g.transpose();
  H.diagonal() -= Vector3d(1, -1, -1) / cone_det(x);
  return H / std::max(1.0, H.norm() / largest_metric);
}

}  // namespace

State state_of(const ContactRows& rows, int size) {
  if (rows.B.isZero(0)) return State::Open;
  return sticks(rows, size) ? State::Stick : State::Slip;
}

FollowSystem::FollowSystem(const Problem& of, const FollowSystem* before)
    : W_(of.W),
      mu_(of.mu),
      problem_(scaled(of)),
      system_(system_of(problem_, before)),
      rho_(problem_),
      weight_(problem_.impulse / Units::of(of.W, of.q).impulse) {}

ContactSystem FollowSystem::system_of(const Scaled& problem, const FollowSystem* before) {
  const bool shared = before != nullptr && problem.W.parts() == nullptr && before->problem_.W.parts() == nullptr;
  return shared ? ContactSystem(problem, before->system_) : ContactSystem(problem);
}

bool FollowSystem::is_of(const Problem& other) const {
  return other.mu.size() == mu_.size() && other.mu == mu_ && other.W.same_as(W_);
}

/// The units of q are those of the problem.
void FollowSystem::take(const Problem& of) {
  const Units units = Units::of(of.W, of.q);
  problem_.impulse = units.impulse * weight_;
  for (Index k = 0; k < problem_.size(); ++k) problem_.q[k] = weight_[k] * of.q[problem_.rows[at(k)]] / units.velocity;
}

ContactSystem& FollowSystem::give() {
  rows_.clear();
  return system_;
}

/// The impulse of a contact as a part of the largest, not on the border of the cone.
Vector3d FollowSystem::inside(In r, std::size_t a) const {
  Vector3d x = problem_.blocks[a].of(r) / largest_;
  x[0] = std::max(x[0], x.tail<2>().norm() + least_margin);
  return x;
}

/// (A + B W) d = c, as far as that is in reach with the factors of K; whether what is left is a small part of c.
/// Residuals are those of the equation itself: what rounding has taken from a solution comes back with what alpha has.
bool FollowSystem::solve(In r, FollowStep& step, bool centred) {
  // Where couplings ask for factors of the whole matrix that do not come to be, there are none.
  std::vector<ContactRows> rows = std::exchange(rows_, {});
  system_.solve_once(step.c, step.d);
  if (!step.d.allFinite()) return false;
  if (centred && !centre(r, step, step.d)) return false;
  const double size = refine(
      step.c, follow_refined, [&](const Vec& x) { return product(problem_, step.rows, x); },
      [&](const Vec& rest, Vec& dx) { system_.solve_once(rest, dx); }, step.d);
  rows_ = std::move(rows);
  return size <= std::max(follow_refined, kept_refined * step.c.lpNorm<Eigen::Infinity>());
}

/// Adds the step to the least barrier of the contacts that stick, or a part of it that leads there. False: there are no
/// factors any more.
bool FollowSystem::centre(In r, const FollowStep& step, Vec& d) {
  std::vector<std::size_t> sticking;
  Vec inwards = Vec::Zero(r.size());
  for (std::size_t a = 0; a < step.rows.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    if (!sticks(step.rows[a], block.size)) continue;
    sticking.push_back(a);
    const Vector3d down = largest_ / centring_size * Vector3d::UnitX();
    const Vector3d g = largest_ * follow_alpha * (inward(inside(r, a)) - down - metric_[a] * block.of(d) / largest_);
    inwards.segment(block.first, block.size) = g.head(block.size);
  }
  if (sticking.empty()) return true;
  Vec e;
  Vec seen;
  system_.solve_once(inwards, e);
  if (!e.allFinite()) return false;
  system_.solve_once(product(problem_, step.rows, e), seen);
  e -= seen;
  if (!e.allFinite()) return false;
  const Vec to = r + d;
  const auto barrier = [&](double t) {
    double sum = 0;
    for (const std::size_t a : sticking) {
      const Vector3d x = problem_.blocks[a].of(to) + t * problem_.blocks[a].of(e);
      const double det = cone_det(x);
      if (!(x[0] > 0 && det > 0)) return lcp::infinity;
      sum += x[0] / centring_size - std::log(det) / 2;
    }
    return sum;
  };
  double least = barrier(0);
  double length = 0;
  for (const double t : centring_steps) {
    const double now = barrier(t);
    if (!(now < least)) continue;
    least = now;
    length = t;
  }
  d += length * e;
  return true;
}

/// The factors of K.
bool FollowSystem::factor(In r, const FollowStep& step, int& factorizations) {
  if (!rows_.empty() && same_rows(rows_, step.rows)) return true;
  rows_.clear();
  metric_.assign(step.rows.size(), follow_hold * Block::Identity());
  largest_ = std::max(r.lpNorm<Eigen::Infinity>(), 1e-300);
  std::vector<ContactRows> rows = step.rows;
  for (std::size_t a = 0; a < rows.size(); ++a) {
    if (sticks(rows[a], problem_.blocks[a].size)) metric_[a] = barrier_metric(inside(r, a));
    rows[a].A += follow_alpha * rows[a].B * metric_[a];
  }
  ++factorizations;
  if (!system_.factor(rows)) return false;
  rows_ = step.rows;
  return true;
}

}  // namespace perp::contact

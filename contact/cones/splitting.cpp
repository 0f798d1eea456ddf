// SPDX-License-Identifier: Apache-2.0
#include "contact/cones/splitting.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/model/unit_cone.hpp"

namespace perp::contact {
namespace {

constexpr double split_relaxation = 1.6;
/// rho of a contact is this over the geometric mean of its own normal impulse and the largest of all: what a step may
/// change is then alike at contacts that carry the pile and at those that carry nothing.
constexpr double split_weight = 0.7;
constexpr double least_carried = 1e-3;   // of the largest
constexpr double split_parallel = 0.95;  // cosine of successive changes
constexpr double longest_jump = 10;      // changes
constexpr double restart_share = 0.5;
constexpr int most_lots_of_mean = 4;

}  // namespace

Splitting::Splitting(const Scaled& problem, ContactSystem& system, Vec r, Vec y)
    : problem_(problem), system_(system), r_(std::move(r)), y_(std::move(y)) {
  const double largest = std::max(1.0, r_.lpNorm<Eigen::Infinity>());
  for (const Scaled::Block& block : problem.blocks)
    rho_.push_back(split_weight / std::sqrt(largest * std::max(r_[block.first], least_carried * largest)));
}

bool Splitting::factor() {
  std::vector<Eigen::Matrix3d> R;
  std::vector<Eigen::Matrix3d> inverse;
  for (const double rho : rho_) {
    R.emplace_back(rho * Eigen::Matrix3d::Identity());
    inverse.emplace_back(Eigen::Matrix3d::Identity() / rho);
  }
  return system_.factor(R, inverse);
}

void Splitting::step() {
  right_ = y_ - problem_.q;
  for (std::size_t a = 0; a < rho_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    right_.segment(block.first, block.size) += rho_[a] * r_.segment(block.first, block.size);
    right_[block.first] -= block.of(y_).tail<2>().norm();
  }
  system_.solve_once(right_, x_);
  for (std::size_t a = 0; a < rho_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    const Eigen::Vector3d x = split_relaxation * block.of(x_) + (1 - split_relaxation) * block.of(r_);
    set(a, x - block.of(y_) / rho_[a]);
  }
  sum_ = summed_ == 0 ? state() : Vec(sum_ + state());
  ++summed_;
}

void Splitting::accelerate() {
  if (!restart()) return extrapolate();
  last_state_.resize(0);
  last_change_.resize(0);
  echoes_ = 0;
}

/// From the mean, if that is nearer to a solution.
bool Splitting::restart() {
  if (summed_ == 0) return false;
  const Vec r = r_;
  const Vec y = y_;
  set_all(sum_ / summed_);
  const bool nearer = natural_map(problem_, r_) < restart_share * natural_map(problem_, r);
  if (!nearer) {
    r_ = r;
    y_ = y;
  }
  if (!nearer && ++lots_ < most_lots_of_mean) return false;
  summed_ = 0;
  lots_ = 0;
  return nearer;
}

/// r and y of w = r - R^-1 y: its parts in K and in -K.
void Splitting::set(std::size_t contact, const Eigen::Vector3d& w) {
  const Scaled::Block& block = problem_.blocks[contact];
  const Eigen::Vector3d r = project_onto_unit_cone(w);
  r_.segment(block.first, block.size) = r.head(block.size);
  y_.segment(block.first, block.size) = (rho_[contact] * (r - w)).head(block.size);
}

void Splitting::set_all(const Vec& w) {
  for (std::size_t a = 0; a < rho_.size(); ++a) set(a, problem_.blocks[a].of(w));
}

Vec Splitting::state() const {
  Vec w = r_;
  for (std::size_t a = 0; a < rho_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    w.segment(block.first, block.size) -= y_.segment(block.first, block.size) / rho_[a];
  }
  return w;
}

/// Not from the two changes after an extrapolation: the first of them is its echo.
void Splitting::extrapolate() {
  Vec now = state();
  Vec change;
  if (last_state_.size() > 0) change = now - last_state_;
  last_state_ = now;
  if (echoes_ > 0) {
    --echoes_;
    return;
  }
  std::swap(change, last_change_);
  if (change.size() == 0) return;
  const double length = last_change_.norm();
  const double before = change.norm();
  if (!(last_change_.dot(change) > split_parallel * length * before)) return;
  const double ratio = length / before;
  now += (ratio < 1 ? std::min(longest_jump, ratio / (1 - ratio)) : longest_jump) * last_change_;
  set_all(now);
  last_state_ = state();
  last_change_.resize(0);
  echoes_ = 1;
}

Vec Splitting::openings() const {
  Vec s(static_cast<Index>(problem_.blocks.size()));
  for (std::size_t a = 0; a < problem_.blocks.size(); ++a)
    s[static_cast<Index>(a)] = problem_.blocks[a].of(y_).tail<2>().norm();
  return s;
}

}  // namespace perp::contact

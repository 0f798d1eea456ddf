// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/follow.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/classics/alart_curnier.hpp"
#include "contact/classics/gauss_seidel.hpp"

namespace perp::contact {
/// alpha of W + alpha I; Newton steps are ended by so many in a row without a natural map below `decrease` times the
/// least. Of the lengths 1, 1/2, .. the first that brings it below `follow_decrease` times the last counts, else the
/// best.
struct FollowSteps {
  double alpha;
  int patience;
  double decrease;
};

namespace {

constexpr FollowSteps first_steps{1e-10, 3, 0.9};
constexpr FollowSteps last_steps{1e-6, 3, 0.9};
/// After failures in a row so many steps are left to others, one more each time.
constexpr int most_pauses = 8;
constexpr int follow_steps = 10;
constexpr double follow_decrease = 0.9;
constexpr int follow_halvings = 5;
/// Below this natural map rounding decides about lengths: steps are full.
constexpr double follow_near = 1e-6;

/// Sweeps are judged so many at a time, and ended unless r changes less by this factor than in the lot before.
constexpr int follow_sweeps = 100;
constexpr int follow_lot = 4;
constexpr double follow_contraction = 0.5;

/// KLU up to so many rows of W and entries in each, as in the homotopy.
constexpr Index follow_klu_rows = 2000;
constexpr Index follow_klu_entries = 60;

bool same_matrix(const SpMat& a, const SpMat& b) {
  return a.rows() == b.rows() && a.nonZeros() == b.nonZeros() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.outerSize() + 1, b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr()) &&
         std::equal(a.valuePtr(), a.valuePtr() + a.nonZeros(), b.valuePtr());
}

}  // namespace

bool Follower::factor(const SpMat& K) {
  const bool klu = K.rows() <= follow_klu_rows && K.nonZeros() <= follow_klu_entries * K.rows();
  if (klu != klu_) {
    klu_ = klu;
    lu_ = lcp::SparseLu(klu ? lcp::LuBackend::Klu : lcp::LuBackend::General);
    factored_.resize(0, 0);
  }
  if (factored_.size() > 0 && same_matrix(K, factored_)) return true;
  factored_.resize(0, 0);
  ++factorizations_;
  if (!lu_.try_factor(K)) return false;
  factored_ = K;
  return true;
}

/// The full Newton step from r.
bool Follower::direction(const Scaled& problem, const NewtonWeights& rho, In r, double alpha, Vec& d) {
  const Vec u = problem.W * r + problem.q;
  const auto rows_of = [&](std::size_t a, const Eigen::Vector3d& r_a, const Eigen::Vector3d& u_a) {
    const auto i = static_cast<Index>(a);
    return alart_curnier_rows(problem.blocks[a].size, r_a, u_a, rho.N[i], rho.T[i]);
  };
  const NewtonSystem system = newton_system(problem, rows_of, r, u);
  SpMat K = problem.W.matrix();
  contact_matrix(problem, system.rows, alpha, K);
  if (!factor(K)) return false;
  d.resize(r.size());
  lu_.solve(system.c, d);
  ++steps_;
  return d.allFinite();
}

/// Sweeps of Gauss-Seidel while they contract; whether r is accepted then.
bool Follower::sweep(const Scaled& problem, Vec& r, const Accept& accept) {
  const GaussSeidel method(problem);
  Vec u = problem.W * r + problem.q;
  double before = lcp::infinity;  // change of r in the last lot
  for (int k = 0; k < follow_sweeps; k += follow_lot) {
    const Vec last = r;
    for (int i = 0; i < follow_lot; ++i) method.sweep(r, u);
    sweeps_ += follow_lot;
    if (accept(r)) return true;
    const double change = (r - last).norm();
    if (!(change <= follow_contraction * before)) return false;
    before = change;
  }
  return false;
}

/// Newton steps with this alpha from r, which becomes the best point met; whether it is accepted.
bool Follower::newton(const Scaled& problem, Vec& r, const FollowSteps& steps, const Accept& accept, const Stop& stop) {
  const NewtonWeights rho(problem);
  Vec x = r;
  double last = natural_map(problem, x);
  double lowest = last;
  Vec d;
  for (int k = 0, since = 0; k < follow_steps && since < steps.patience; ++k) {
    if (stop() || !direction(problem, rho, x, steps.alpha, d)) return false;
    double least = lcp::infinity;
    Vec to = x;
    if (last <= follow_near) least = natural_map(problem, to += d);
    for (int i = 0; last > follow_near && i <= follow_halvings && !(least <= follow_decrease * last); ++i, d *= 0.5) {
      const Vec trial = x + d;
      const double now = natural_map(problem, trial);
      if (!(now < least)) continue;
      least = now;
      to = trial;
    }
    if (!std::isfinite(least)) return false;
    x = to;
    last = least;
    if (accept(x)) {
      r = x;
      return true;
    }
    ++since;
    if (last > steps.decrease * lowest) continue;
    lowest = last;
    r = x;
    since = 0;
  }
  return false;
}

/// What solved the last step comes first.
bool Follower::attempt(const Scaled& problem, Vec& r, const Accept& accept, const Stop& stop) {
  const auto by_sweeps = [&] {
    Vec swept = r;
    if (!sweep(problem, swept, accept)) return false;
    r = std::move(swept);
    return true;
  };
  if (sweeps_first_ && by_sweeps()) return true;
  sweeps_first_ = false;
  if (newton(problem, r, first_steps, accept, stop)) return true;
  sweeps_first_ = by_sweeps();
  return sweeps_first_ || newton(problem, r, last_steps, accept, stop);
}

std::optional<Vec> Follower::from(const Scaled& problem, In start, const Accept& accept, const Stop& stop) {
  Vec r = start;
  if (accept(r)) return r;
  if (pause_ > 0) {
    --pause_;
    return std::nullopt;
  }
  if (attempt(problem, r, accept, stop)) {
    failures_ = 0;
    return r;
  }
  pause_ = std::min(failures_++, most_pauses);
  return std::nullopt;
}

}  // namespace perp::contact

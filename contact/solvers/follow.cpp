// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/follow.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "contact/classics/alart_curnier.hpp"
#include "contact/classics/gauss_seidel.hpp"
#include "contact/cones/cone_path.hpp"
#include "contact/model/contact_system.hpp"
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
/// Solutions with K are refined to those without alpha while the residual falls: so often, to this, by this.
constexpr int follow_refinements = 3;
constexpr double follow_refined = 1e-9;
constexpr double follow_refinement_gain = 0.25;
/// R; parts of the step to the least barrier.
constexpr double centring_size = 10;
constexpr std::array centring_steps{1.0, 0.5, 0.25, 0.1};

/// A contact that stuck in the last step, below this speed, with its impulse so near the border of its cone, as a part
/// of the largest, is taken to stick in the first Newton step: the equation does not tell there.
constexpr double at_rest = 1e-6;
constexpr double on_border = 1e-6;
/// Impulses below this part of the largest are what a method has left of an open contact's. They begin with 0: else the
/// contact is open in one Newton step and closed in the next, and sweeps bring it down slowly.
constexpr double carries_nothing = 1e-6;

/// Newton steps are ended by `follow_patience` in a row without a natural map below `follow_decrease` times the least.
/// Of the lengths 1, 1/2, .. the first that brings it below `follow_decrease` times the last counts, else the best;
/// below `follow_near` steps are full: the states of contacts near others decide there, and settle by themselves.
constexpr int follow_steps = 10;
constexpr int follow_patience = 3;
constexpr double follow_decrease = 0.9;
constexpr int follow_halvings = 5;
constexpr double follow_near = 1e-4;
/// Steps that end other methods go on beyond their number, to so many, while each brings the map down so far.
constexpr int most_last_steps = 6;
constexpr double last_step_decrease = 0.1;
/// Points above this natural map, in units of the largest impulse where that is above 1, are not judged.
constexpr double worth_judging = 1e-5;

/// Sweeps are judged so many at a time, and ended unless r changes less by this factor than in the lot before: by
/// `settled_contraction` below `settled_map`, where the rest of the way costs less than to begin again. Contacts have
/// their states where points are judged, and Newton steps, so many, are tried where sweeps would need more lots than
/// this to `swept_map`; again when the map has fallen so far.
constexpr int follow_sweeps = 400;
constexpr int follow_lot = 4;
constexpr double follow_contraction = 0.5;
constexpr double settled_map = 1e-4;
constexpr double settled_contraction = 0.9;
constexpr int swept_newton = 3;
constexpr double few_lots = 3;
constexpr double swept_map = 1e-8;
constexpr double newton_again = 0.01;

/// Paths over the cones: their first products, in units of the natural map times the largest impulse; the steps of one,
/// factorizations of all, which are those of two cold starts, and the least product; so many steps below this length in
/// a row say that one turns back. Newton steps, so many, are tried below this natural map, and again as from sweeps. Of
/// matrices with more rows LU takes too long.
constexpr std::array path_starts{10.0, 1e3, 1e5, 0.1};
constexpr int most_path_steps = 25;
constexpr long most_path_factorizations = 60;
constexpr double path_end = 1e-10;
constexpr double path_turning_step = 0.1;
constexpr int path_turning_steps = 2;
constexpr int path_newton = 3;
constexpr double path_newton_map = 1e-4;
constexpr Index most_path_rows = 6000;

bool same_rows(const std::vector<ContactRows>& a, const std::vector<ContactRows>& b) {
  return std::ranges::equal(a, b, [](const ContactRows& x, const ContactRows& y) { return x.A == y.A && x.B == y.B; });
}

bool sticks(const ContactRows& rows, int size) {
  return rows.A.topLeftCorner(size, size).isZero(0) && rows.B.topLeftCorner(size, size).isIdentity(0);
}

NewtonRows sticking_rows(int size, const Vector3d& u) {
  NewtonRows rows;
  rows.B.topLeftCorner(size, size).setIdentity();
  rows.c = -u;
  return rows;
}

/// Negative outside of the cone and on its border.
double determinant(const Vector3d& x) {
  const double length = x.tail<2>().norm();
  return x[0] > 0 ? (x[0] - length) * (x[0] + length) : -1;
}

bool may_be_solved(double map, In r) { return map <= worth_judging * std::max(1.0, r.lpNorm<Eigen::Infinity>()); }

/// Lots of sweeps that bring the map down to what is mostly judged a solution, each of them by this factor; from
/// a point that has been refused there, to a tenth.
double lots_left(double map, In r, double contraction) {
  const double wanted = std::min(swept_map * std::max(1.0, r.lpNorm<Eigen::Infinity>()), map / 10);
  return contraction < 1 ? std::log(map / wanted) / -std::log(contraction) : lcp::infinity;
}

Vector3d reflected(const Vector3d& x) { return {x[0], -x[1], -x[2]}; }

/// The gradient of log det(x) / 2.
Vector3d inward(const Vector3d& x) { return reflected(x) / determinant(x); }

/// The Hessian of -log det(x) / 2.
Block barrier_metric(const Vector3d& x) {
  const Vector3d g = inward(x);
  Block H = 2 * g * g.transpose();
  H.diagonal() -= Vector3d(1, -1, -1) / determinant(x);
  return H / std::max(1.0, H.norm() / largest_metric);
}

void open_what_carries_nothing(const Scaled& problem, Vec& r) {
  const double largest = r.lpNorm<Eigen::Infinity>();
  for (const Scaled::Block& block : problem.blocks)
    if (block.of(r).norm() <= carries_nothing * largest) r.segment(block.first, block.size).setZero();
}

}  // namespace

/// What is kept while W and friction are the same, and the factors of the last matrix.
struct Follower::Kept {
  Kept(const Problem& of, const Kept* before)
      : W(of.W),
        mu(of.mu),
        problem(scaled(of)),
        system(system_of(problem, before)),
        rho(problem),
        weight(problem.impulse / Units::of(of.W, of.q).impulse) {}

  /// With the analysis of the last, which is made again where the pattern is another.
  static ContactSystem system_of(const Scaled& problem, const Kept* before) {
    const bool shared = before != nullptr && problem.W.parts() == nullptr && before->problem.W.parts() == nullptr;
    return shared ? ContactSystem(problem, before->system) : ContactSystem(problem);
  }
  bool is_of(const Problem& other) const {
    return other.mu.size() == mu.size() && other.mu == mu && other.W.same_as(W);
  }
  /// The units of q are those of the problem.
  void take(const Problem& of) {
    const Units units = Units::of(of.W, of.q);
    problem.impulse = units.impulse * weight;
    for (Index k = 0; k < problem.size(); ++k) problem.q[k] = weight[k] * of.q[problem.rows[at(k)]] / units.velocity;
  }
  Vector3d inside(In r, std::size_t a) const;
  void solve(NewtonStep& step);
  void centre(In r, const NewtonStep& step, Vec& d);
  Vec linear_part(const std::vector<ContactRows>& of, const Vec& x) const;

  Delassus W;
  Vec mu;
  Scaled problem;
  ContactSystem system;
  NewtonWeights rho;
  Vec weight;                       // of the impulses: 1, mu, mu
  std::vector<ContactRows> rows{};  // A and B of the factors; none: there are none
  std::vector<Block> metric{};      // D
  double largest = 1;               // impulse at D
};

struct Follower::NewtonStep {
  std::vector<ContactRows> rows{};  // A and B
  Vec c{};
  Vec d{};
};

Follower::Follower() = default;
Follower::~Follower() = default;

const Scaled& Follower::take(const Problem& problem) {
  if (kept_ && kept_->is_of(problem))
    kept_->take(problem);
  else
    kept_ = std::make_unique<Kept>(problem, kept_.get());
  return kept_->problem;
}

/// The impulse of a contact as a part of the largest, not on the border of the cone.
Vector3d Follower::Kept::inside(In r, std::size_t a) const {
  Vector3d x = problem.blocks[a].of(r) / largest;
  x[0] = std::max(x[0], x.tail<2>().norm() + least_margin);
  return x;
}

/// (A + B W) x.
Vec Follower::Kept::linear_part(const std::vector<ContactRows>& of, const Vec& x) const {
  const Vec Wx = problem.W * x;
  Vec out(x.size());
  for (std::size_t a = 0; a < of.size(); ++a) {
    const Scaled::Block& block = problem.blocks[a];
    const Vector3d part = of[a].A * block.of(x) + of[a].B * block.of(Wx);
    out.segment(block.first, block.size) = part.head(block.size);
  }
  return out;
}

/// (A + B W) d = c, as far as that is in reach with the factors of K.
void Follower::Kept::solve(NewtonStep& step) {
  system.solve(step.c, step.d);
  Vec rest = step.c - linear_part(step.rows, step.d);
  double size = rest.lpNorm<Eigen::Infinity>();
  Vec more;
  for (int k = 0; k < follow_refinements && size > follow_refined; ++k) {
    system.solve(rest, more);
    more += step.d;
    rest = step.c - linear_part(step.rows, more);
    const double now = rest.lpNorm<Eigen::Infinity>();
    if (!(now <= follow_refinement_gain * size)) return;
    size = now;
    step.d = more;
  }
}

/// Adds the step to the least barrier of the contacts that stick, or a part of it that leads there.
void Follower::Kept::centre(In r, const NewtonStep& step, Vec& d) {
  std::vector<std::size_t> sticking;
  Vec inwards = Vec::Zero(r.size());
  for (std::size_t a = 0; a < step.rows.size(); ++a) {
    const Scaled::Block& block = problem.blocks[a];
    if (!sticks(step.rows[a], block.size)) continue;
    sticking.push_back(a);
    const Vector3d down = largest / centring_size * Vector3d::UnitX();
    const Vector3d g = largest * follow_alpha * (inward(inside(r, a)) - down - metric[a] * block.of(d) / largest);
    inwards.segment(block.first, block.size) = g.head(block.size);
  }
  if (sticking.empty()) return;
  Vec e;
  Vec seen;
  system.solve(inwards, e);
  system.solve(linear_part(step.rows, e), seen);
  e -= seen;
  if (!e.allFinite()) return;
  const Vec to = r + d;
  const auto barrier = [&](double t) {
    double sum = 0;
    for (const std::size_t a : sticking) {
      const Vector3d x = problem.blocks[a].of(to) + t * problem.blocks[a].of(e);
      const double det = determinant(x);
      if (!(det > 0)) return lcp::infinity;
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
}

/// The factors of K.
bool Follower::factor(In r, const NewtonStep& step) {
  Kept& kept = *kept_;
  if (!kept.rows.empty() && same_rows(kept.rows, step.rows)) return true;
  kept.rows.clear();
  kept.metric.assign(step.rows.size(), follow_hold * Block::Identity());
  kept.largest = std::max(r.lpNorm<Eigen::Infinity>(), 1e-300);
  std::vector<ContactRows> rows = step.rows;
  for (std::size_t a = 0; a < rows.size(); ++a) {
    if (sticks(rows[a], kept.problem.blocks[a].size)) kept.metric[a] = barrier_metric(kept.inside(r, a));
    rows[a].A += follow_alpha * rows[a].B * kept.metric[a];
  }
  ++factorizations_;
  if (!kept.system.factor(rows)) return false;
  kept.rows = step.rows;
  return true;
}

/// The full Newton step from r.
bool Follower::direction(In r, NewtonStep& step, bool first) {
  Kept& kept = *kept_;
  const double largest = r.lpNorm<Eigen::Infinity>();
  const auto rows_of = [&](std::size_t a, const Vector3d& r_a, const Vector3d& u_a) {
    const auto i = static_cast<Index>(a);
    const bool border = r_a[0] - r_a.tail<2>().norm() <= on_border * largest;
    const bool stuck = a < stuck_.size() && stuck_[a] != 0 && r_a[0] > 0;
    if (first && border && stuck) return sticking_rows(kept.problem.blocks[a].size, u_a);
    return alart_curnier_rows(kept.problem.blocks[a].size, r_a, u_a, kept.rho.N[i], kept.rho.T[i]);
  };
  NewtonSystem system = newton_system(kept.problem, rows_of, r, kept.problem.W * r + kept.problem.q);
  step.rows = std::move(system.rows);
  step.c = std::move(system.c);
  if (!factor(r, step)) return false;
  kept.solve(step);
  ++steps_;
  return step.d.allFinite();
}

/// Sweeps of Gauss-Seidel while they contract, and Newton steps where contacts have their states; whether r is accepted
/// then.
bool Follower::sweep(Vec& r, const Accept& accept, const Stop& stop) {
  const Scaled& problem = kept_->problem;
  const GaussSeidel method(problem);
  Vec u = problem.W * r + problem.q;
  double before = lcp::infinity;  // change of r in the last lot
  double newton_below = worth_judging;
  for (int k = 0; k < follow_sweeps; k += follow_lot) {
    if (stop()) return false;
    const Vec last = r;
    for (int i = 0; i < follow_lot; ++i) method.sweep(r, u);
    sweeps_ += follow_lot;
    const double map = natural_map(problem, r);
    if (may_be_solved(map, r) && accept(r)) {
      by_ = Origin::Sweeps;
      return true;
    }
    const double change = (r - last).norm();
    if (k > 0 && map <= newton_below && lots_left(map, r, change / before) > few_lots) {
      newton_below = newton_again * map;
      Vec to = r;
      if (newton(to, swept_newton, false, accept, stop)) {
        r = std::move(to);
        return true;
      }
    }
    if (!(change <= (map <= settled_map ? settled_contraction : follow_contraction) * before)) return false;
    before = change;
  }
  return false;
}

/// So many Newton steps from r, which becomes the best point met; whether it is accepted. `first`: r is the last
/// solution. Others may be some more.
bool Follower::newton(Vec& r, int most, bool first, const Accept& accept, const Stop& stop) {
  const Scaled& problem = kept_->problem;
  Vec x = r;
  double last = natural_map(problem, x);
  double lowest = last;
  NewtonStep step;
  for (int k = 0, since = 0; k < most && since < follow_patience; ++k) {
    if (stop() || !direction(x, step, first && k == 0)) return false;
    if (first && k == 0) kept_->centre(x, step, step.d);
    const double enough = last <= follow_near ? lcp::infinity : follow_decrease * last;
    double least = lcp::infinity;
    Vec to = x;
    for (int i = 0; i <= follow_halvings && !(least < enough); ++i, step.d *= 0.5) {
      const Vec trial = x + step.d;
      const double now = natural_map(problem, trial);
      if (!(now < least)) continue;
      least = now;
      to = trial;
    }
    if (!std::isfinite(least)) return false;
    x = std::move(to);
    const double before = std::exchange(last, least);
    if (may_be_solved(last, x) && accept(x)) {
      r = x;
      by_ = Origin::Newton;
      return true;
    }
    if (!first && k + 1 == most && most < most_last_steps && last <= last_step_decrease * before) ++most;
    ++since;
    if (last > follow_decrease * lowest) continue;
    lowest = last;
    r = x;
    since = 0;
  }
  return false;
}

/// The path of Coulomb's law over the cones from near r, with this product; whether r, a point of it, is accepted.
bool Follower::path(Vec& r, double tau, long last_factorization, const Accept& accept, const Stop& stop) {
  Kept& kept = *kept_;
  ConePath path(kept.problem, kept.system);
  const std::size_t contacts = kept.problem.blocks.size();
  path.couple(path.near(r, Vec::Zero(static_cast<Index>(contacts)), tau), std::vector<char>(contacts, 1));
  double newton_below = path_newton_map;
  for (int k = 0, turning = 0; k < most_path_steps && turning < path_turning_steps && path.tau() > path_end; ++k) {
    if (stop() || factorizations_ >= last_factorization) return false;
    kept.rows.clear();  // the factors are the path's
    ++factorizations_;
    ++path_steps_;
    if (!path.step()) return false;
    turning = path.last_step() < path_turning_step ? turning + 1 : 0;
    const double map = natural_map(kept.problem, path.r());
    r = path.r();
    if (may_be_solved(map, r) && accept(r)) {
      by_ = Origin::Cones;
      return true;
    }
    if (map > newton_below) continue;
    newton_below = newton_again * map;
    if (newton(r, path_newton, false, accept, stop)) return true;
  }
  return false;
}

/// From each of the starts; where none led to a solution in the last step that needed them, from the first alone.
bool Follower::paths(Vec& r, const Accept& accept, const Stop& stop) {
  const Scaled& problem = kept_->problem;
  if (problem.size() > most_path_rows) return false;
  const double unit = natural_map(problem, r) * std::max(1.0, r.lpNorm<Eigen::Infinity>());
  const std::size_t starts = paths_fail_ ? 1 : path_starts.size();
  const long last_factorization = factorizations_ + most_path_factorizations;
  for (std::size_t k = 0; k < starts; ++k) {
    Vec to = r;
    const bool found = path(to, path_starts[k] * unit, last_factorization, accept, stop);
    if (!found && stop()) return false;  // which says nothing of the paths
    paths_fail_ = !found;
    if (!found) continue;
    r = std::move(to);
    return true;
  }
  return false;
}

/// Sweeps first where they solved the last step, and the paths last.
bool Follower::attempt(Vec& r, const Accept& accept, const Stop& stop) {
  const Vec start = r;
  const auto by_sweeps = [&] {
    Vec to = r;
    const bool found = sweep(to, accept, stop);
    if (!found && stop()) return false;
    sweeps_first_ = found;
    if (found) r = std::move(to);
    return found;
  };
  const bool swept = sweeps_first_;
  if (swept && by_sweeps()) return true;
  if (newton(r, follow_steps, true, accept, stop)) return true;
  if (!(swept && r == start) && by_sweeps()) return true;
  r = start;
  return paths(r, accept, stop);
}

/// Which contacts stick at r, wherever in their cones.
void Follower::remember(In r) {
  const Scaled& problem = kept_->problem;
  const Vec u = problem.W * r + problem.q;
  const double largest = r.lpNorm<Eigen::Infinity>();
  stuck_.assign(problem.blocks.size(), 0);
  for (std::size_t a = 0; a < stuck_.size(); ++a) {
    const Scaled::Block& block = problem.blocks[a];
    stuck_[a] = block.of(u).norm() <= at_rest && r[block.first] > on_border * largest ? 1 : 0;
  }
}

std::optional<Vec> Follower::from(In start, const Accept& accept, const Stop& stop, lcp::Deadline deadline) {
  kept_->system.set_deadline(deadline);
  Vec r = start;
  by_ = Origin::WarmStart;
  if (natural_map(kept_->problem, r) <= worth_judging && accept(r)) return r;
  open_what_carries_nothing(kept_->problem, r);
  if (!attempt(r, accept, stop)) return std::nullopt;
  remember(r);
  return r;
}

}  // namespace perp::contact

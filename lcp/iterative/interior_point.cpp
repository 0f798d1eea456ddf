// SPDX-License-Identifier: Apache-2.0
#include "lcp/iterative/interior_point.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "lcp/iterative/scaled_mcp.hpp"
#include "lcp/iterative/shifted_system.hpp"
#include "lcp/judge/cell.hpp"
#include "lcp/judge/shared_options.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

/// Newton's direction is poor from such an accuracy on: residuals stay where they are.
constexpr double poor = 1e-5;

/// A finite bound of variable i: s = sign (z_i - at) with sign 1 at a lower bound, -1 at an upper one.
struct Bound {
  Index i;
  double sign;
  double at;
};

/// z, and the slack s and multiplier w of each bound; or a direction in them.
struct Iterate {
  Vec z, s, w;
};

/// Step lengths of the two groups of variables that linear programs have; equal for other problems.
using Lengths = std::array<double, 2>;

class Run {
 public:
  Run(const AffineMcp& problem, In start, const InteriorPoint& options, const Limits& limits)
      : problem_(problem),
        options_(options),
        limits_(limits),
        p_(problem),
        best_(problem, start),
        system_(p_.M, options.lu, limits.deadline),
        n_(p_.size()),
        delta_(options.proximal) {
    for (Index i = 0; i < n_; ++i) {
      if (p_.l[i] > -infinity) bounds_.push_back({i, 1, p_.l[i]});
      if (p_.u[i] < infinity) bounds_.push_back({i, -1, p_.u[i]});
    }
    pairs_ = static_cast<Index>(bounds_.size());
    find_groups();
  }

  Result run() {
    return within_limits([this] { return iterate(); },
                         [this](Status s, const std::string& why) { return end(s, why); });
  }

 private:
  Result iterate() {
    int short_steps = 0;
    first();
    for (;;) {
      finish();
      if (solves(problem_, best_.z(), limits_.tol)) return end(Status::Stalled, "");
      if (const auto stop = limits_.reached()) return end(*stop, "stopped between two steps");
      const bool over = k_ >= options_.max_iterations;
      if ((over || (k_ % 5 == 4 && diverges())) && infeasible()) return proven();
      if (over) return end(Status::IterationLimit, "the limit of iterations is reached");

      const LuStatus status = factor();
      if (status == LuStatus::OutOfMemory) return end(Status::OutOfMemory, "no memory for the factors of M + diag");
      if (status != LuStatus::Ok) return end(Status::Singular, "M + diag(w / s) is " + std::string(to_string(status)));
      const double mu = gap(x_);
      Iterate affine = direction(-x_.s.cwiseProduct(x_.w));
      if (accuracy_ > poor && !system_.by_lu() && system_.factor_by_lu() == LuStatus::Ok)
        affine = direction(-x_.s.cwiseProduct(x_.w));
      const double sigma = std::pow(std::max(0.0, gap(moved(affine, reach(affine)))) / std::max(mu, 1e-300), 3);
      const double target = mu * std::min(1.0, sigma);
      Vec c = target - (x_.s.cwiseProduct(x_.w) + affine.s.cwiseProduct(affine.w)).array();
      Iterate d = direction(c);
      if (least(reach(d)) < 0.1 && pairs_ > 0) {  // the corrector leads out of the interior: towards the centre instead
        const Vec centre = 0.5 * mu - x_.s.cwiseProduct(x_.w).array();
        const Iterate other = direction(centre);
        if (least(reach(other)) > least(reach(d))) c = centre, d = other;
      }
      correct(c, d, target);
      const Lengths alpha = length(d, mu);
      ++k_;
      last_step_ = d.z;
      x_ = moved(d, alpha);
      // A step leaves the share 1 - alpha of the residual, and what the proximal term makes.
      const bool stuck = residual().norm() > (1 - 0.5 * least(alpha)) * r_.norm();
      if (!linear_ && least(alpha) < 0.1) delta_ = std::min(10 * delta_, 1e2 * options_.proximal);
      if ((linear_ || least(alpha) > 0.5) && stuck) delta_ = std::max(0.1 * delta_, 1e-4 * options_.proximal);
      if (!x_.z.allFinite() || !x_.w.allFinite()) return end(Status::Stalled, "the iterates overflow");
      short_steps = least(alpha) < 1e-6 ? short_steps + 1 : 0;
      if (short_steps >= 3 || (pairs_ > 0 && gap(x_) < 1e-28)) {
        finish(true);
        if (infeasible()) return proven();
        return end(Status::Stalled, text_of("the steps have become short (", least(alpha), ") at mu = ", gap(x_),
                                            ", |M z + q - w + v| = ", residual().cwiseAbs().maxCoeff(),
                                            ", |z| = ", x_.z.cwiseAbs().maxCoeff(), " (scaled)"));
      }
    }
  }

  /// Linear programs: M_ij = 0 within {i: group 0} and within {i: group 1}. Then s of the one and w of the other group
  /// are the primal variables.
  void find_groups() {
    group_.assign(at(n_), 0);
    const Vec* signs = system_.signs();
    if (!signs) return;
    for (Index j = 0; j < n_; ++j)
      for (SpMat::InnerIterator it(p_.M, j); it; ++it)
        if (it.value() != 0 && (*signs)[it.row()] == (*signs)[j]) return;
    linear_ = true;
    for (Index i = 0; i < n_; ++i) group_[at(i)] = (*signs)[i] > 0 ? 0 : 1;
  }
  std::size_t group_of(Index p) const { return group_[at(bounds_[at(p)].i)]; }
  static double least(const Lengths& alpha) { return std::min(alpha[0], alpha[1]); }

  /// Mehrotra's start (1992, section 7): the least squares solution of the equations, as near to the bounds as they
  /// allow, moved inside.
  void first() {
    Vec bounded = Vec::Zero(n_), target = Vec::Zero(n_);
    for (const Bound& b : bounds_) bounded[b.i] += 1, target[b.i] += b.at;
    x_ = {.z = Vec::Zero(n_), .s = Vec::Ones(pairs_), .w = Vec::Ones(pairs_)};
    if (system_.factor(bounded.array() + delta_) == LuStatus::Ok) {
      if (!linear_) {
        (void)system_.solve(target - p_.q, x_.z);
      } else {
        for (const std::size_t g : {0U, 1U}) {
          Vec rhs(n_), z(n_);
          for (Index i = 0; i < n_; ++i) rhs[i] = group_[at(i)] == g ? target[i] : -p_.q[i];
          (void)system_.solve(rhs, z);
          for (Index i = 0; i < n_; ++i)
            if (group_[at(i)] == g) x_.z[i] = z[i];
        }
      }
    }
    const Vec F = p_.M * x_.z + p_.q;
    for (Index p = 0; p < pairs_; ++p) {
      const Bound& b = bounds_[at(p)];
      x_.s[p] = b.sign * (x_.z[b.i] - b.at);
      x_.w[p] = bounded[b.i] > 1 ? std::max(0.0, b.sign * F[b.i]) : b.sign * F[b.i];
    }
    Lengths shift{0, 0};
    each_value([&](double& value, std::size_t g, Index) { shift[g] = std::max(shift[g], -1.5 * value); });
    each_value([&](double& value, std::size_t g, Index) { value += shift[g]; });
    Lengths sum{0, 0};
    each_value([&](double& value, std::size_t g, Index) { sum[g] += value; });
    const double product = x_.s.dot(x_.w);
    const Lengths more{sum[1] > 0 && product > 0 ? product / (2 * sum[1]) : 1,
                       sum[0] > 0 && product > 0 ? product / (2 * sum[0]) : 1};
    each_value([&](double& value, std::size_t g, Index) { value += more[g]; });
  }

  /// f(value, its group, its bound) for all s and w.
  template <class F>
  void each_value(F f) {
    for (Index p = 0; p < pairs_; ++p) f(x_.s[p], group_of(p), p), f(x_.w[p], 1 - group_of(p), p);
  }

  /// Returns whether z is long, and the residual no smaller than half of what it was when this was asked before.
  bool diverges() {
    const double before = std::exchange(residual_, residual().norm());
    return residual_ > before / 2 && x_.z.cwiseAbs().maxCoeff() > 1e3;
  }

  /// F - w + v.
  Vec residual() const {
    Vec r = p_.M * x_.z + p_.q;
    for (Index p = 0; p < pairs_; ++p) r[bounds_[at(p)].i] -= bounds_[at(p)].sign * x_.w[p];
    return r;
  }
  double gap(const Iterate& x) const { return pairs_ > 0 ? x.s.dot(x.w) / static_cast<double>(pairs_) : 0; }

  /// M + diag(w / s) + delta I, and the residuals.
  LuStatus factor() {
    Vec theta = Vec::Zero(n_);
    stiff_.assign(at(n_), -1);
    Vec most = Vec::Ones(n_);
    for (Index p = 0; p < pairs_; ++p) {
      const Index i = bounds_[at(p)].i;
      const double ratio = x_.w[p] / x_.s[p];
      theta[i] += ratio;
      if (ratio > most[i]) most[i] = ratio, stiff_[at(i)] = p;
    }
    const LuStatus status = system_.factor(theta.array() + delta_);
    r_ = residual();
    slack_ = Vec(pairs_);
    for (Index p = 0; p < pairs_; ++p) {
      const Bound& b = bounds_[at(p)];
      slack_[p] = b.sign * (x_.z[b.i] - b.at) - x_.s[p];
    }
    return status;
  }

  /// Newton's direction that changes s w by c, to first order.
  Iterate direction(const Vec& c) {
    Vec rhs = -r_;
    for (Index p = 0; p < pairs_; ++p)
      rhs[bounds_[at(p)].i] += bounds_[at(p)].sign * (c[p] - x_.w[p] * slack_[p]) / x_.s[p];
    Iterate d{.z = Vec(n_), .s = Vec(pairs_), .w = Vec(pairs_)};
    accuracy_ = system_.solve(rhs, d.z);
    for (Index p = 0; p < pairs_; ++p) {
      const Bound& b = bounds_[at(p)];
      d.s[p] = b.sign * d.z[b.i] + slack_[p];
      d.w[p] = (c[p] - x_.w[p] * d.s[p]) / x_.s[p];
    }
    // A difference of large numbers if w / s is large. The equation of the row gives it with all digits.
    Vec row = p_.M * d.z + r_;
    for (Index p = 0; p < pairs_; ++p) row[bounds_[at(p)].i] -= bounds_[at(p)].sign * d.w[p];
    for (Index p = 0; p < pairs_; ++p) {
      const Bound& b = bounds_[at(p)];
      if (stiff_[at(b.i)] == p) d.w[p] += b.sign * row[b.i];
    }
    return d;
  }

  /// Multiple centrality correctors (Gondzio, Comput. Optim. Appl. 6 (1996) 137), more where a factorization takes many
  /// solves: they bring the products that a longer step would have near `target`.
  void correct(Vec& c, Iterate& d, double target) {
    if (pairs_ == 0) return;
    const int most = system_.dearness() > 30 ? 6 : 3;
    for (int k = 0; k < most; ++k) {
      const Lengths alpha = reach(d);
      if (least(alpha) >= 0.95) return;
      Lengths longer = alpha;
      for (double& a : longer) a = std::min(1.0, a + 0.1);
      const Iterate trial = moved(d, longer);
      Vec better = c;
      for (Index p = 0; p < pairs_; ++p) {
        const double product = trial.s[p] * trial.w[p];
        better[p] += std::max(std::clamp(product, 0.1 * target, 10 * target) - product, -10 * target);
      }
      const Iterate e = direction(better);
      const Lengths now = reach(e);
      if (now[0] + now[1] < alpha[0] + alpha[1] + 0.02) return;
      c = better, d = e;
    }
  }

  /// The longest steps to the boundary, at most one.
  Lengths reach(const Iterate& d) const {
    Lengths alpha{1, 1};
    for (Index p = 0; p < pairs_; ++p) {
      double& of_s = alpha[group_of(p)];
      double& of_w = alpha[1 - group_of(p)];
      if (d.s[p] < 0) of_s = std::min(of_s, -x_.s[p] / d.s[p]);
      if (d.w[p] < 0) of_w = std::min(of_w, -x_.w[p] / d.w[p]);
    }
    if (!linear_) alpha[0] = alpha[1] = least(alpha);
    return alpha;
  }

  Lengths length(const Iterate& d, double mu) const {
    Lengths alpha = reach(d);
    for (double& a : alpha) a = std::min(1.0, a * std::max(options_.to_boundary, 1 - std::max(mu, 1e-6)));
    if (pairs_ == 0) alpha = {1, 1};
    return alpha;
  }

  Iterate moved(const Iterate& d, const Lengths& alpha) const {
    Iterate x = x_;
    for (Index i = 0; i < n_; ++i) x.z[i] += alpha[group_[at(i)]] * d.z[i];
    for (Index p = 0; p < pairs_; ++p) {
      x.s[p] += alpha[group_of(p)] * d.s[p];
      x.w[p] += alpha[1 - group_of(p)] * d.w[p];
    }
    return x;
  }

  /// Where s < w says that a bound is active.
  Places places() const {
    Places places(at(n_), Place::Inside);
    Vec share = Vec::Zero(n_);  // of w in the bound that is kept
    for (Index p = 0; p < pairs_; ++p) {
      const Bound& b = bounds_[at(p)];
      if (x_.s[p] < x_.w[p] && x_.w[p] > share[b.i]) {
        places[at(b.i)] = b.sign > 0 ? Place::Lower : Place::Upper;
        share[b.i] = x_.w[p];
      }
    }
    return places;
  }

  /// Offers the iterate, and the point of the cell that it points to once that has come to rest.
  void finish(bool now = false) {
    best_.offer(p_.expand(x_.z));
    const Places places = this->places();
    const std::uint64_t key = key_of(places);
    const bool rest = key == last_key_ && gap(x_) < 1e-2 * polished_gap_;
    if ((rest || now || solves(problem_, best_.z(), limits_.tol)) && key != polished_key_ && n_ > 0) {
      polished_key_ = key;
      polished_gap_ = gap(x_);
      polish(places);
    }
    last_key_ = key;
  }

  /// Exchanges all violated places of a cell, as block pivoting does, while that halves the residual.
  void polish(Places places) {
    double last = infinity;
    for (int k = 0; k < 10; ++k) {
      Vec z = x_.z;
      for (Index i = 0; i < n_; ++i) {
        if (places[at(i)] == Place::Lower) z[i] = p_.l[i];
        if (places[at(i)] == Place::Upper) z[i] = p_.u[i];
      }
      descend(places, z, p_.q);
      if (solves(problem_, best_.z(), std::min(limits_.tol, 1e-13))) return;
      const Vec F = p_.M * z + p_.q;
      double wrong = 0;
      for (Index i = 0; i < n_; ++i) {
        Place& place = places[at(i)];
        const Place was = place;
        double by = 0;
        if (was == Place::Inside && z[i] < p_.l[i]) place = Place::Lower, by = p_.l[i] - z[i];
        if (was == Place::Inside && z[i] > p_.u[i]) place = Place::Upper, by = z[i] - p_.u[i];
        if (was == Place::Lower && F[i] < 0) place = Place::Inside, by = -F[i];
        if (was == Place::Upper && F[i] > 0) place = Place::Inside, by = F[i];
        if (by < 1e-15) place = was;
        wrong = std::max(wrong, by);
      }
      if (!(wrong < 0.5 * last)) return;
      last = wrong;
    }
  }

  /// Proximal steps for (M z + q)_I = 0, the others held: z_I -= (M_II + delta I)^-1 (M z + q)_I, while they help. With
  /// a tiny delta this is Newton's step with refinement; where M_II is singular but the equations consistent it goes
  /// to a solution nearby. Those held have a diagonal entry that leaves nothing of their change.
  void descend(const Places& places, Vec& z, const Vec& q) {
    constexpr double hold = 1e20;
    const auto inside = [&](Index i) { return places[at(i)] == Place::Inside; };
    for (const double delta : {1e-10, 1e-7}) {
      if (system_.factor(Vec::NullaryExpr(n_, [&](Index i) { return inside(i) ? delta : hold; })) != LuStatus::Ok)
        continue;
      Vec x = z;
      double last = infinity;
      for (int step = 0; step < 12; ++step) {
        Vec r = p_.M * x + q;
        for (Index i = 0; i < n_; ++i)
          if (!inside(i)) r[i] = 0;
        const double norm = r.cwiseAbs().maxCoeff();
        if (!(norm < 0.5 * last)) break;
        last = norm;
        z = x;
        if (&q == &p_.q) best_.offer(p_.expand(x));
        Vec dx(n_);
        (void)system_.solve(r, dx);
        for (Index i = 0; i < n_; ++i)
          if (inside(i)) x[i] -= dx[i];
        if (!x.allFinite()) break;
      }
      if (&q != &p_.q || last < 1e-12) return;
    }
  }

  /// Whether the direction in which z goes to infinity proves that there is no solution: for monotone M it tends to a d
  /// of the recession cone of the box with M'd = -M d, (M d)_i = 0 where d_i != 0. Proximal steps tend to one, too. Of
  /// linear programs each group alone may be one.
  bool infeasible() {
    const Places at_x = places();
    for (const Vec& d : {last_step_, x_.z})
      for (int part = linear_ ? 0 : 2; part < 3; ++part) {
        Vec y = d;
        for (Index i = 0; i < n_; ++i) {
          const bool wrong = (p_.l[i] > -infinity && y[i] < 0) || (p_.u[i] < infinity && y[i] > 0);
          if (wrong || group_[at(i)] == static_cast<std::size_t>(part)) y[i] = 0;
        }
        y /= std::max(y.cwiseAbs().maxCoeff(), 1e-300);
        if (!y.allFinite() || y.isZero(0)) continue;
        if (accept(y)) return true;
        for (const double small : {0.0, 1e-5, 1e-2}) {
          Vec z = y;
          Places places = at_x;
          for (Index i = 0; i < n_; ++i) {
            if (small > 0) places[at(i)] = std::abs(y[i]) < small ? Place::Lower : Place::Inside;
            if (places[at(i)] != Place::Inside) z[i] = 0;
          }
          if (!nearly_certifies(places, z)) continue;
          descend(places, z, Vec::Zero(n_));
          if (accept(z)) return true;
        }
      }
    return false;
  }

  /// Returns whether y'(M z + q - w) < 0 for all z and w of the problem, but for what a correction of y may change.
  bool nearly_certifies(const Places& places, const Vec& y) const {
    constexpr double small = 0.01;  // M is equilibrated, and |y| = 1
    const Vec r = p_.M * y;
    for (Index i = 0; i < n_; ++i)
      if (places[at(i)] == Place::Inside && std::abs(r[i]) > small) return false;
    const Vec g = p_.M.transpose() * y;
    double sum = p_.q.dot(y);
    for (Index i = 0; i < n_; ++i) {
      const double end = g[i] > 0 ? p_.u[i] : p_.l[i];
      if (std::isfinite(end)) sum += g[i] * end;
    }
    return sum < 0;
  }

  bool accept(const Vec& y) {
    Vec d = p_.expand_direction(y);
    const double size = d.size() > 0 ? d.cwiseAbs().maxCoeff() : 0;
    if (!(size > 0)) return false;
    certificate_ = exact_certificate(problem_, d / size, limits_.tol);
    return certificate_.size() > 0;
  }

  Result proven() {
    Result result = end(Status::Infeasible, "z diverges along a direction that proves that there is no solution");
    if (result.status == Status::Infeasible) result.certificate = certificate_;
    return result;
  }

  Result end(Status status, std::string message) {
    Result result = judged(problem_, best_.z(), limits_, status, std::move(message));
    result.iterations = k_;
    result.factorizations = system_.factorizations();
    return result;
  }

  const AffineMcp& problem_;
  const InteriorPoint& options_;
  const Limits& limits_;
  ScaledMcp p_;
  Best best_;
  ShiftedSystem system_;
  Index n_;
  double delta_;
  std::vector<Bound> bounds_;
  Index pairs_ = 0;
  std::vector<std::size_t> group_;  ///< of each variable
  bool linear_ = false;
  Iterate x_;
  Vec r_, slack_;               ///< residuals at x_: M z + q - w + v, and sign (z - at) - s
  std::vector<Index> stiff_;    ///< of each variable: its bound with the largest w / s, or -1 where that is below one
  double accuracy_ = 0;         ///< of the last direction: ShiftedSystem::solve()
  double residual_ = infinity;  ///< when it was last looked at
  std::uint64_t last_key_ = 0, polished_key_ = 0;
  double polished_gap_ = 0.1;
  Vec last_step_ = Vec::Zero(n_);
  Vec certificate_;
  long k_ = 0;
};

}  // namespace

void describe(InteriorPoint& m, Fields& f) {
  describe_iterations(m.max_iterations, f);
  f.add("interior_to_boundary", &m.to_boundary, strictly_between(0, 1),
        "largest step, as a share of the way to the boundary");
  f.add("interior_proximal", &m.proximal, strictly_between(0, 1),
        "weight of the proximal term, relative to the scaled M");
  describe_lu(m.lu, f);
}

Result interior_point(const AffineMcp& problem, In start, const InteriorPoint& options, const Limits& limits) {
  check_input("interior_point", problem, start, limits);
  refuse_invalid("interior_point", options);
  const bool nothing_free = (problem.box.lower.array() == problem.box.upper.array()).all();
  if (nothing_free) return judged(problem, problem.box.lower, limits, Status::Stalled, "every variable is fixed");
  return Run(problem, start, options, limits).run();
}

}  // namespace perp::lcp

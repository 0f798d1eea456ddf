// SPDX-License-Identifier: Apache-2.0
#include "lcp/iterative/interior_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "lcp/judge/cell.hpp"
#include "lcp/judge/shared_options.hpp"
#include "lcp/linalg/quasi_definite.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

/// Residual, relative to the right-hand side, to which the symmetric form has to solve.
constexpr double symmetric_accuracy = 1e-8;

/// The problem without its fixed variables, z_i = D_i x_i, every row times D_i / unit: entries of M up to one, q too.
class Scaled {
 public:
  explicit Scaled(const AffineMcp& problem) : problem_(problem) {
    const Box& box = problem.box;
    std::vector<int> place(at(problem.size()), -1);
    whole_ = project(box, Vec::Zero(problem.size()));
    for (Index i = 0; i < problem.size(); ++i)
      if (box.lower[i] != box.upper[i]) {
        place[at(i)] = static_cast<int>(kept_.size());
        kept_.push_back(i);
        whole_[i] = 0;
      }
    const Vec shifted = problem.q + problem.M * whole_;  // whole_: the fixed variables
    const auto n = static_cast<Index>(kept_.size());
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(at(problem.M.nonZeros() + n));
    for (Index j = 0; j < n; ++j) {
      entries.emplace_back(static_cast<int>(j), static_cast<int>(j), 0.0);
      for (SpMat::InnerIterator it(problem.M, kept_[at(j)]); it; ++it)
        if (place[at(it.row())] >= 0) entries.emplace_back(place[at(it.row())], static_cast<int>(j), it.value());
    }
    M = SpMat(n, n);
    M.setFromTriplets(entries.begin(), entries.end());
    equilibrate();
    q = Vec(n);
    for (Index k = 0; k < n; ++k) q[k] = D_[k] * shifted[kept_[at(k)]];
    const double size = n > 0 ? q.cwiseAbs().maxCoeff() : 0;
    unit_ = size > 0 && std::isfinite(size) ? size : 1;
    q /= unit_;
    l = Vec(n);
    u = Vec(n);
    for (Index k = 0; k < n; ++k) {
      l[k] = box.lower[kept_[at(k)]] / (D_[k] * unit_);
      u[k] = box.upper[kept_[at(k)]] / (D_[k] * unit_);
    }
  }

  Index size() const { return q.size(); }
  Vec reduce(In z) const {
    return Vec::NullaryExpr(size(), [&](Index k) { return z[kept_[at(k)]] / (D_[k] * unit_); });
  }
  Vec expand(const Vec& x) const {
    Vec z = whole_;
    for (Index k = 0; k < size(); ++k) z[kept_[at(k)]] = D_[k] * unit_ * x[k];
    return z;
  }
  /// A direction: zero at fixed variables.
  Vec expand_direction(const Vec& x) const {
    Vec d = Vec::Zero(problem_.size());
    for (Index k = 0; k < size(); ++k) d[kept_[at(k)]] = D_[k] * x[k];
    return d;
  }

  SpMat M;  ///< with a full diagonal in its pattern
  Vec q, l, u;

 private:
  /// D_i of powers of two such that the largest entry of row and column i is about one.
  void equilibrate() {
    const Index n = M.rows();
    D_ = Vec::Ones(n);
    for (int pass = 0; pass < 4; ++pass) {
      Vec largest = Vec::Zero(n);
      for (Index j = 0; j < n; ++j)
        for (SpMat::InnerIterator it(M, j); it; ++it) {
          largest[j] = std::max(largest[j], std::abs(it.value()));
          largest[it.row()] = std::max(largest[it.row()], std::abs(it.value()));
        }
      Vec factor = Vec::Ones(n);
      for (Index i = 0; i < n; ++i)
        if (largest[i] > 0) factor[i] = std::exp2(-std::round(std::log2(largest[i]) / 2));
      for (Index j = 0; j < n; ++j)
        for (SpMat::InnerIterator it(M, j); it; ++it) it.valueRef() *= factor[it.row()] * factor[j];
      D_ = D_.cwiseProduct(factor);
    }
  }

  const AffineMcp& problem_;
  std::vector<Index> kept_;
  Vec whole_;
  Vec D_;
  double unit_ = 1;
};

/// z with its slacks and multipliers; s = t = 1, w = v = 0 where there is no such bound.
struct Iterate {
  Vec z, s, w, t, v;
};
struct Direction {
  Vec z, w, v;
};

class Run {
 public:
  Run(const AffineMcp& problem, In start, const InteriorPoint& options, const Limits& limits)
      : problem_(problem),
        options_(options),
        limits_(limits),
        p_(problem),
        best_(problem, start),
        ldlt_(KernelClock(limits.deadline)),
        lu_(options.lu, limits.deadline),
        polish_lu_(options.lu, limits.deadline),
        K_(p_.M),
        n_(p_.size()) {
    const Vec x = p_.reduce(start);
    first(x);
  }

  Result run() {
    return within_limits([this] { return iterate(); },
                         [this](Status s, const std::string& why) { return end(s, why); });
  }

 private:
  Result iterate() {
    int short_steps = 0;
    for (;;) {
      finish();
      if (solves(problem_, best_.z(), limits_.tol)) return end(Status::Stalled, "");
      if (const auto stop = limits_.reached()) return end(*stop, "stopped between two steps");
      const bool over = k_ >= options_.max_iterations;
      if ((over || (k_ % 5 == 4 && diverges())) && infeasible()) return proven();
      if (over) return end(Status::IterationLimit, "the limit of iterations is reached");

      const LuStatus status = factor();
      if (status == LuStatus::OutOfMemory) return end(Status::OutOfMemory, "no memory for the factors of M + diag");
      if (status != LuStatus::Ok)
        return end(Status::Singular, "M + diag(w / s + v / t) is " + std::string(to_string(status)));
      const double mu = gap(x_);
      const Direction affine = direction(0, nullptr);
      const double sigma = std::pow(std::max(0.0, gap(moved(affine, reach(affine)))) / std::max(mu, 1e-300), 3);
      Direction d = direction(mu * std::min(1.0, sigma), &affine);
      double alpha = length(d, mu);
      if (alpha < 0.05 && pairs_ > 0) {  // the corrector may lead out of the neighbourhood: towards the centre instead
        d = direction(0.5 * mu, nullptr);
        alpha = length(d, mu);
      }
      ++k_;
      last_step_ = d.z;
      x_ = moved(d, alpha);
      if (!x_.z.allFinite() || !x_.w.allFinite() || !x_.v.allFinite())
        return end(Status::Stalled, "the iterates overflow");
      short_steps = alpha < 1e-6 ? short_steps + 1 : 0;
      if (short_steps >= 3 || (pairs_ > 0 && gap(x_) < 1e-28)) {
        finish(true);
        if (infeasible()) return proven();
        return end(Status::Stalled, text_of("the steps have become short (", alpha, ") at mu = ", gap(x_),
                                            ", |M z + q - w + v| = ", residual(x_).cwiseAbs().maxCoeff(),
                                            ", |z| = ", x_.z.cwiseAbs().maxCoeff(), " (scaled)"));
      }
    }
  }

  /// Whether z is long, and the residual no smaller than half of what it was when this was asked before.
  bool diverges() {
    const double before = std::exchange(residual_, residual(x_).norm());
    return residual_ > before / 2 && x_.z.cwiseAbs().maxCoeff() > 1e3;
  }

  bool below(Index i) const { return p_.l[i] > -infinity; }
  bool above(Index i) const { return p_.u[i] < infinity; }

  /// Inside by 1, or half of the interval; products s w, t v about one.
  void first(const Vec& x) {
    x_ = {.z = x, .s = Vec::Ones(n_), .w = Vec::Zero(n_), .t = Vec::Ones(n_), .v = Vec::Zero(n_)};
    for (Index i = 0; i < n_; ++i) {
      const double margin = below(i) && above(i) ? std::min(1.0, (p_.u[i] - p_.l[i]) / 2) : 1;
      if (below(i)) x_.z[i] = std::max(x_.z[i], p_.l[i] + margin);
      if (above(i)) x_.z[i] = std::min(x_.z[i], p_.u[i] - margin);
      if (below(i)) x_.s[i] = std::max(x_.z[i] - p_.l[i], margin);
      if (above(i)) x_.t[i] = std::max(p_.u[i] - x_.z[i], margin);
    }
    const Vec F = p_.M * x_.z + p_.q;
    for (Index i = 0; i < n_; ++i) {
      if (below(i)) x_.w[i] = std::max(1.0, F[i]) / std::min(1.0, x_.s[i]), ++pairs_;
      if (above(i)) x_.v[i] = std::max(1.0, -F[i]) / std::min(1.0, x_.t[i]), ++pairs_;
    }
    first_ratio_ = residual(x_).norm() / std::max(gap(x_), 1e-300);
  }

  Vec residual(const Iterate& x) const { return p_.M * x.z + p_.q - x.w + x.v; }
  double gap(const Iterate& x) const {
    return pairs_ > 0 ? (x.s.dot(x.w) + x.t.dot(x.v)) / static_cast<double>(pairs_) : 0;
  }

  LuStatus factor() {
    K_ = p_.M;
    for (Index i = 0; i < n_; ++i) {
      double theta = x_.w[i] / x_.s[i] + x_.v[i] / x_.t[i];
      if (!below(i) && !above(i)) theta = options_.proximal;
      K_.coeffRef(i, i) += theta;
    }
    ++factorizations_;
    if (symmetric_ && ldlt_.factor(K_)) return LuStatus::Ok;
    symmetric_ = false;
    const LuStatus status = lu_.factor(K_);
    usable_ = status == LuStatus::Ok;
    return status;
  }

  /// K z = rhs. Where the factors of the symmetric form are too poor, from here on by LU.
  void solve(const Vec& rhs, Vec& z) {
    if (symmetric_ && ldlt_.solve(K_, rhs, z, symmetric_accuracy)) return;
    if (symmetric_) {
      symmetric_ = false;
      ++factorizations_;
      usable_ = lu_.try_factor(K_);
    }
    if (usable_)
      lu_.solve_refined(rhs, z, 2);
    else  // every direction of this step
      z.setConstant(std::numeric_limits<double>::quiet_NaN());
  }

  /// Newton's direction towards s w = t v = target, with the second-order terms of `affine` if there is one.
  Direction direction(double target, const Direction* affine) {
    Vec c = Vec::Zero(n_);
    Vec e = Vec::Zero(n_);
    for (Index i = 0; i < n_; ++i) {
      if (below(i)) c[i] = target - x_.s[i] * x_.w[i] - (affine ? affine->z[i] * affine->w[i] : 0);
      if (above(i)) e[i] = target - x_.t[i] * x_.v[i] + (affine ? affine->z[i] * affine->v[i] : 0);
    }
    const Vec rhs = -residual(x_) + c.cwiseQuotient(x_.s) - e.cwiseQuotient(x_.t);
    Direction d{.z = Vec(n_), .w = Vec::Zero(n_), .v = Vec::Zero(n_)};
    solve(rhs, d.z);
    for (Index i = 0; i < n_; ++i) {
      if (below(i)) d.w[i] = (c[i] - x_.w[i] * d.z[i]) / x_.s[i];
      if (above(i)) d.v[i] = (e[i] + x_.v[i] * d.z[i]) / x_.t[i];
    }
    return d;
  }

  /// The longest step to the boundary, at most one.
  double reach(const Direction& d) const {
    double alpha = 1;
    const auto limit = [&](double value, double change) {
      if (change < 0) alpha = std::min(alpha, -value / change);
    };
    for (Index i = 0; i < n_; ++i) {
      if (below(i)) limit(x_.s[i], d.z[i]), limit(x_.w[i], d.w[i]);
      if (above(i)) limit(x_.t[i], -d.z[i]), limit(x_.v[i], d.v[i]);
    }
    return alpha;
  }

  Iterate moved(const Direction& d, double alpha) const {
    Iterate x = x_;
    x.z += alpha * d.z;
    x.w += alpha * d.w;
    x.v += alpha * d.v;
    for (Index i = 0; i < n_; ++i) {
      if (below(i)) x.s[i] += alpha * d.z[i];
      if (above(i)) x.t[i] -= alpha * d.z[i];
    }
    return x;
  }

  /// The longest step in the neighbourhood, down to a millionth of the one to the boundary.
  double length(const Direction& d, double mu) const {
    const double boundary = reach(d);
    double alpha =
        boundary >= 1 && mu < 1e-9 ? 1 - 1e-9 : std::min(1.0, boundary * std::max(options_.to_boundary, 1 - mu));
    if (pairs_ == 0) return 1;
    for (; alpha > 1e-9 * boundary; alpha *= 0.7)
      if (central(moved(d, alpha))) return alpha;
    return alpha;
  }

  bool central(const Iterate& x) const {
    const double mu = gap(x);
    if (!(mu > 0)) return false;
    for (Index i = 0; i < n_; ++i) {
      if (below(i) && !(x.s[i] > 0 && x.w[i] > 0 && x.s[i] * x.w[i] >= options_.gamma * mu)) return false;
      if (above(i) && !(x.t[i] > 0 && x.v[i] > 0 && x.t[i] * x.v[i] >= options_.gamma * mu)) return false;
    }
    const double rounding = 1e-14 * (1 + x.z.cwiseAbs().maxCoeff() + x.w.cwiseAbs().maxCoeff());
    return residual(x).norm() <= std::max(1e4 * std::max(first_ratio_, 1.0) * mu, rounding * static_cast<double>(n_));
  }

  /// Offers the iterate, and the point of the cell that it points to once that has come to rest.
  void finish(bool now = false) {
    best_.offer(p_.expand(x_.z));
    Places places(at(n_), Place::Inside);
    for (Index i = 0; i < n_; ++i) {
      if (below(i) && x_.s[i] < x_.w[i]) places[at(i)] = Place::Lower;
      if (above(i) && x_.t[i] < x_.v[i] && x_.v[i] > x_.w[i]) places[at(i)] = Place::Upper;
    }
    const std::uint64_t key = key_of(places);
    const bool rest = key == last_key_ && gap(x_) < 1e-3;
    if ((rest || now || solves(problem_, best_.z(), limits_.tol)) && key != polished_key_ && n_ > 0) {
      polished_key_ = key;
      Vec z = x_.z;
      for (Index i = 0; i < n_; ++i) {
        if (places[at(i)] == Place::Lower) z[i] = p_.l[i];
        if (places[at(i)] == Place::Upper) z[i] = p_.u[i];
      }
      descend(places, z, p_.q);
    }
    last_key_ = key;
  }

  /// Proximal steps for (M z + q)_I = 0, the others held: z_I -= (M_II + delta I)^-1 (M z + q)_I, while they help. With
  /// a tiny delta this is Newton's step with refinement; where M_II is singular but the equations consistent it goes
  /// to a solution nearby.
  void descend(const Places& places, Vec& z, const Vec& q) {
    const auto inside = [&](Index i) { return places[at(i)] == Place::Inside; };
    for (const double delta : {1e-13, 1e-9, 1e-6}) {
      SpMat A = p_.M;
      for (Index j = 0; j < n_; ++j)
        for (SpMat::InnerIterator it(A, j); it; ++it) {
          if (!inside(it.row()) || !inside(j)) it.valueRef() = 0;
          if (it.row() == j) it.valueRef() = inside(j) ? it.value() + delta : 1;
        }
      ++factorizations_;
      if (polish_lu_.factor(A) != LuStatus::Ok) continue;
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
        polish_lu_.solve(r, dx);
        x -= dx;
        if (!x.allFinite()) break;
      }
      if (&q != &p_.q || solves(problem_, best_.z(), std::min(limits_.tol, 1e-13))) return;
    }
  }

  /// Whether the direction in which z goes to infinity proves that there is no solution: for monotone M it tends to a d
  /// of the recession cone of the box with M'd = -M d, (M d)_i = 0 where d_i != 0.
  bool infeasible() {
    for (const Vec& d : {x_.z, last_step_})
      for (const double small : {1e-7, 1e-5, 1e-3, 1e-2, 0.1, 0.3}) {
        Vec y = d / d.cwiseAbs().maxCoeff();
        if (!y.allFinite()) break;
        Places places(at(n_), Place::Inside);
        for (Index i = 0; i < n_; ++i) {
          const bool wrong = (below(i) && y[i] < 0) || (above(i) && y[i] > 0);
          if (wrong || std::abs(y[i]) < small) places[at(i)] = Place::Lower, y[i] = 0;
        }
        if (y.isZero(0)) continue;
        if (accept(y)) return true;
        if (!nearly_certifies(places, y)) continue;
        const Vec none = Vec::Zero(n_);
        descend(places, y, none);
        if (accept(y)) return true;
      }
    return false;
  }

  /// Whether q'y < 0 and (M y)_i is small where y_i is not held at 0: else a correction of y, which takes
  /// factorizations, leads to no certificate.
  bool nearly_certifies(const Places& places, const Vec& y) const {
    constexpr double small = 0.01;  // M is equilibrated, and |y| = 1
    if (!(p_.q.dot(y) < 0)) return false;
    const Vec r = p_.M * y;
    for (Index i = 0; i < n_; ++i)
      if (places[at(i)] == Place::Inside && std::abs(r[i]) > small) return false;
    return true;
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
    result.factorizations = factorizations_;
    return result;
  }

  const AffineMcp& problem_;
  const InteriorPoint& options_;
  const Limits& limits_;
  Scaled p_;
  Best best_;
  QuasiDefinite ldlt_;
  SparseLu lu_, polish_lu_;
  SpMat K_;
  Index n_;
  bool symmetric_ = ldlt_.analyze(p_.M);  ///< K is factored as L D L'
  bool usable_ = false;                   ///< lu_ has the factors of a K
  Iterate x_;
  Index pairs_ = 0;  ///< finite bounds
  double first_ratio_ = 0;
  double residual_ = infinity;  ///< when it was last looked at
  std::uint64_t last_key_ = 0, polished_key_ = 0;
  Vec last_step_ = Vec::Zero(n_);
  Vec certificate_;
  long k_ = 0;
  int factorizations_ = 0;
};

}  // namespace

void describe(InteriorPoint& m, Fields& f) {
  describe_iterations(m.max_iterations, f);
  f.add("interior_neighbourhood", &m.gamma, strictly_between(0, 1),
        "the least product is kept above this share of the mean");
  f.add("interior_to_boundary", &m.to_boundary, strictly_between(0, 1),
        "largest step, as a share of the way to the boundary");
  f.add("interior_proximal", &m.proximal, strictly_between(0, 1),
        "weight of the proximal term of free variables, relative to the scaled M");
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

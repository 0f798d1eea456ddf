// SPDX-License-Identifier: Apache-2.0
#include "lcp/iterative/interior_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "lcp/iterative/interior_path.hpp"
#include "lcp/iterative/scaled_mcp.hpp"
#include "lcp/judge/cell.hpp"
#include "lcp/judge/shared_options.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

class Run {
 public:
  Run(const AffineMcp& problem, In start, const InteriorPoint& options, const Limits& limits)
      : problem_(problem),
        options_(options),
        limits_(limits),
        p_(problem),
        box_{p_.l, p_.u},
        best_(problem, start),
        path_(p_.M, box_, true, options.to_boundary, options.proximal, options.lu),
        n_(p_.size()) {}

  using Iterate = InteriorPath::Iterate;

  Result run() {
    int halted = 0, crept = 0;  // steps in a row that hardly move, and that are shorter than a half
    const Vec bounds = this->bounds();
    const Vec nearest = path_.nearest(bounds, p_.M * bounds + p_.q);
    path_.open(nearest, p_.M * nearest + p_.q);
    look();
    for (;;) {
      finish();
      if (solved_) return end(Status::Stalled, "");
      if (const auto stop = limits_.reached()) return end(*stop, "stopped between two steps");
      const bool over = k_ >= options_.max_iterations;
      if ((over || (k_ % 5 == 4 && diverges())) && infeasible()) return proven();
      if (over) return end(Status::IterationLimit, "the limit of iterations is reached");

      const LuStatus status = path_.factor(F_);
      if (status != LuStatus::Ok) return end(Status::Singular, "M + diag(w / s) is " + std::string(to_string(status)));
      // Products grow in proportion to the residual where steps stay short: they have fallen too early.
      const bool early = crept >= 2 && !path_.linear();
      const Iterate d = path_.newton(early ? residual_ / std::sqrt(static_cast<double>(n_)) : 0);
      const double before = residual_, least = step(d);
      ++k_;
      last_step_ = d.z;
      path_.adapt_proximal(least, before, residual_);
      if (!x_.z.allFinite() || !x_.w.allFinite()) return end(Status::Stalled, "the iterates overflow");
      halted = least < 1e-6 ? halted + 1 : 0;
      crept = least < 0.5 ? crept + 1 : 0;
      if (halted >= 3 || (path_.pairs() > 0 && path_.gap(x_) < 1e-28)) {
        finish(true);
        if (infeasible()) return proven();
        return end(Status::Stalled,
                   text_of("the steps have become short (", least, ") at mu = ", path_.gap(x_),
                           ", ||M z + q - w + v|| = ", residual_, ", |z| = ", x_.z.cwiseAbs().maxCoeff(), " (scaled)"));
      }
    }
  }

  /// Moves along d, each group as far as it can. Returns the shorter length. Unequal steps of a quadratic program leave
  /// a residual (P dz times their difference): where that does not fall, and the shorter step is not very short, both
  /// take it.
  double step(const Iterate& d) {
    const InteriorPath::Lengths alpha = path_.length(d);
    const double least = InteriorPath::least(alpha), before = residual_;
    const Iterate from = x_;
    x_ = path_.moved(d, alpha);
    look();
    if (path_.linear() || alpha[0] == alpha[1] || least < 0.3 || residual_ <= (1 - least / 2) * before) return least;
    x_ = from;
    x_ = path_.moved(d, {least, least});
    look();
    return least;
  }

  /// F and the residual at x.
  void look() {
    F_ = p_.M * x_.z + p_.q;
    residual_ = path_.residual(x_, F_).norm();
  }

  /// The bound of each variable, or the middle of both; 0 of a free one.
  Vec bounds() const {
    Vec z = Vec::Zero(n_);
    for (Index i = 0; i < n_; ++i) {
      if (box_.has_lower(i) && box_.has_upper(i))
        z[i] = box_.lower[i] + (box_.upper[i] - box_.lower[i]) / 2;
      else if (!box_.is_free(i))
        z[i] = box_.has_lower(i) ? box_.lower[i] : box_.upper[i];
    }
    return z;
  }

  /// Returns whether z is long, and the residual no smaller than half of what it was when this was asked before.
  bool diverges() {
    const double before = std::exchange(looked_at_, residual_);
    return residual_ > before / 2 && x_.z.cwiseAbs().maxCoeff() > 1e3;
  }

  Cells cells() const {
    Cells cells(at(n_), Cell::Inside);
    const std::vector<Index> active = path_.active();
    for (Index i = 0; i < n_; ++i)
      if (const Index p = active[at(i)]; p >= 0)
        cells[at(i)] = path_.bounds()[at(p)].sign > 0 ? Cell::Below : Cell::Above;
    return cells;
  }

  void offer(const Vec& x) {
    if (best_.offer(p_.expand(x)) && !solved_) solved_ = best_.solves(limits_.tol);
  }

  /// Offers the iterate where it may be a solution, and the point of the cell that it points to once that has come to
  /// rest.
  void finish(bool now = false) {
    if (p_.natural_residual(x_.z, F_) <= limits_.tol) offer(x_.z);
    if (solved_) return;
    const double near = 1e-2 * polished_gap_, gap = path_.gap(x_);
    if (n_ == 0 || !(now || gap < 10 * near)) return;
    const Cells cells = this->cells();
    const std::uint64_t key = key_of(cells);
    const bool rest = key == std::exchange(last_key_, key) && gap < near;
    if ((!rest && !now) || key == polished_key_) return;
    polished_key_ = key;
    polished_gap_ = gap;
    polish(cells);
  }

  /// Exchanges all violated cells of a cell, as block pivoting does, while that halves the residual.
  void polish(Cells cells) {
    double last = infinity;
    for (int k = 0; k < 10; ++k) {
      Vec z = x_.z;
      for (Index i = 0; i < n_; ++i) {
        if (cells[at(i)] == Cell::Below) z[i] = p_.l[i];
        if (cells[at(i)] == Cell::Above) z[i] = p_.u[i];
      }
      descend(cells, z, p_.q);
      if (solved_) return;
      const Vec F = p_.M * z + p_.q;
      double wrong = 0;
      for (Index i = 0; i < n_; ++i) {
        Cell& cell = cells[at(i)];
        const Cell was = cell;
        double by = 0;
        if (was == Cell::Inside && z[i] < p_.l[i]) cell = Cell::Below, by = p_.l[i] - z[i];
        if (was == Cell::Inside && z[i] > p_.u[i]) cell = Cell::Above, by = z[i] - p_.u[i];
        if (was == Cell::Below && F[i] < 0) cell = Cell::Inside, by = -F[i];
        if (was == Cell::Above && F[i] > 0) cell = Cell::Inside, by = F[i];
        if (by < 1e-15) cell = was;
        wrong = std::max(wrong, by);
      }
      if (!(wrong < 0.5 * last)) return;
      last = wrong;
    }
  }

  /// Proximal steps for (M z + q)_I = 0, the others held: z_I -= (M_II + delta I)^-1 (M z + q)_I, while they help. With
  /// a tiny delta this is Newton's step with refinement; where M_II is singular but the equations consistent it goes
  /// to a solution nearby. Those held have a diagonal entry that leaves nothing of their change.
  void descend(const Cells& cells, Vec& z, const Vec& q) {
    constexpr double hold = 1e20;
    const auto inside = [&](Index i) { return cells[at(i)] == Cell::Inside; };
    for (const double delta : {1e-10, 1e-7}) {
      if (path_.system().factor(Vec::NullaryExpr(n_, [&](Index i) { return inside(i) ? delta : hold; })) !=
          LuStatus::Ok)
        continue;
      Vec x = z;
      double last = infinity;
      for (int step = 0; step < 12; ++step) {
        Vec r = p_.M * x + q;
        for (Index i = 0; i < n_; ++i)
          if (!inside(i)) r[i] = 0;
        const double norm = r.cwiseAbs().maxCoeff();
        if (!(norm < 0.1 * last)) break;
        last = norm;
        z = x;
        if (&q == &p_.q) offer(x);
        Vec dx(n_);
        path_.system().solve(r, dx);
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
    const Cells at_x = cells();
    for (const Vec& d : {last_step_, x_.z})
      for (int part = path_.linear() ? 0 : 2; part < 3; ++part) {
        Vec y = d;
        for (Index i = 0; i < n_; ++i) {
          const bool wrong = (p_.l[i] > -infinity && y[i] < 0) || (p_.u[i] < infinity && y[i] > 0);
          if (wrong || path_.group(i) == static_cast<std::size_t>(part)) y[i] = 0;
        }
        y /= std::max(y.cwiseAbs().maxCoeff(), 1e-300);
        if (!y.allFinite() || y.isZero(0)) continue;
        if (accept(y)) return true;
        for (const double small : {0.0, 1e-5, 1e-2}) {
          Vec z = y;
          Cells cells = at_x;
          for (Index i = 0; i < n_; ++i) {
            if (small > 0) cells[at(i)] = std::abs(y[i]) < small ? Cell::Below : Cell::Inside;
            if (cells[at(i)] != Cell::Inside) z[i] = 0;
          }
          if (!nearly_certifies(cells, z)) continue;
          descend(cells, z, Vec::Zero(n_));
          if (accept(z)) return true;
        }
      }
    return false;
  }

  /// Returns whether y'(M z + q - w) < 0 for all z and w of the problem, but for what a correction of y may change.
  bool nearly_certifies(const Cells& cells, const Vec& y) const {
    constexpr double small = 0.01;  // M is equilibrated, and |y| = 1
    const Vec r = p_.M * y;
    for (Index i = 0; i < n_; ++i)
      if (cells[at(i)] == Cell::Inside && std::abs(r[i]) > small) return false;
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
    offer(x_.z);
    Result result = judged(problem_, best_.z(), limits_, status, std::move(message));
    result.iterations = k_;
    result.factorizations = path_.system().factorizations();
    return result;
  }

  const AffineMcp& problem_;
  const InteriorPoint& options_;
  const Limits& limits_;
  ScaledMcp p_;
  Box box_;
  Best best_;
  bool solved_ = false;  ///< best_ is a solution
  InteriorPath path_;
  Iterate& x_ = path_.x;
  Index n_;
  Vec F_;                        ///< M z + q at x
  double residual_ = infinity;   ///< ||r|| at x
  double looked_at_ = infinity;  ///< the residual when diverges() was last asked
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

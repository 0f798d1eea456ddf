// SPDX-License-Identifier: Apache-2.0
#include "lcp/exact_judge.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace perp::lcp::exact {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

struct Rows {
  std::vector<mpq_class> F;
  std::vector<mpq_class> terms;
  std::vector<int> entries;
};

Rows rows(const AffineMcp& problem, const Vec& z) {
  Rows r;
  for (Index i = 0; i < problem.size(); ++i) {
    r.F.emplace_back(problem.q[i]);
    r.terms.emplace_back(std::abs(problem.q[i]));
    r.entries.push_back(0);
  }
  for (Index j = 0; j < problem.size(); ++j)
    for (SpMat::InnerIterator it(problem.M, j); it; ++it) {
      const mpq_class term = mpq_class(it.value()) * mpq_class(z[j]);
      r.F[at(it.row())] += term;
      r.terms[at(it.row())] += abs(term);
      ++r.entries[at(it.row())];
    }
  return r;
}

/// |mid(z - u, F, z - l)|
mpq_class row_residual(const Box& box, Index i, double z, const mpq_class& F) {
  mpq_class mid = F;
  if (std::isfinite(box.upper[i])) mid = std::max(mid, mpq_class(mpq_class(z) - mpq_class(box.upper[i])));
  if (std::isfinite(box.lower[i])) mid = std::min(mid, mpq_class(mpq_class(z) - mpq_class(box.lower[i])));
  return abs(mid);
}

}  // namespace

mpq_class residual(const AffineMcp& problem, const Vec& z) {
  const Rows r = rows(problem, z);
  mpq_class worst = 0;
  for (Index i = 0; i < problem.size(); ++i) worst = std::max(worst, row_residual(problem.box, i, z[i], r.F[at(i)]));
  return worst;
}

bool solved_to_rounding(const AffineMcp& problem, const Vec& z) {
  const Rows r = rows(problem, z);
  for (Index i = 0; i < problem.size(); ++i) {
    const mpq_class allowed = mpq_class(8 * (r.entries[at(i)] + 2)) * mpq_class(0x1p-52) * r.terms[at(i)];
    if (row_residual(problem.box, i, z[i], r.F[at(i)]) > allowed) return false;
  }
  return true;
}

Proof proof(const AffineMcp& problem, const Vec& y) {
  Proof p;
  const Box& box = problem.box;
  p.signs = y.size() == problem.size() && y.allFinite();
  if (!p.signs) return p;
  for (Index i = 0; i < problem.size(); ++i) {
    p.signs = p.signs && !(std::isfinite(box.lower[i]) && y[i] < 0) && !(std::isfinite(box.upper[i]) && y[i] > 0);
    p.margin -= mpq_class(problem.q[i]) * mpq_class(y[i]);
  }
  for (Index j = 0; j < problem.size(); ++j) {
    mpq_class g = 0;
    for (SpMat::InnerIterator it(problem.M, j); it; ++it) g += mpq_class(it.value()) * mpq_class(y[it.row()]);
    if (sgn(g) == 0) continue;
    const double bound = sgn(g) > 0 ? box.upper[j] : box.lower[j];
    if (std::isfinite(bound))
      p.margin -= g * mpq_class(bound);
    else
      p.wrong += abs(g);
  }
  return p;
}

namespace {

/// { (z, w) : w = M z + q, bounds }: x_B = T x_N + const, variables z_0 .. z_{n-1}, w_0 .. w_{n-1}.
class Polyhedron {
 public:
  struct Bound {
    bool finite = false;
    mpq_class value = 0;
  };

  explicit Polyhedron(const AffineMcp& p)
      : n_(p.size()),
        T_(at(n_), std::vector<mpq_class>(at(n_), 0)),
        value_(at(2 * n_)),
        lower_(at(2 * n_)),
        upper_(at(2 * n_)) {
    for (Index i = 0; i < n_; ++i) {
      lower_[at(i)] = bound(p.box.lower[i]);
      upper_[at(i)] = bound(p.box.upper[i]);
      value_[at(i)] = std::clamp(0.0, p.box.lower[i], p.box.upper[i]);
      value_[at(n_ + i)] = p.q[i];
      basic_.push_back(at(n_ + i));
      nonbasic_.push_back(at(i));
    }
    for (Index j = 0; j < n_; ++j)
      for (SpMat::InnerIterator it(p.M, j); it; ++it) {
        T_[at(it.row())][at(j)] += mpq_class(it.value());
        value_[at(n_ + it.row())] += mpq_class(it.value()) * value_[at(j)];
      }
  }

  static Bound bound(double b) { return std::isfinite(b) ? Bound{true, mpq_class(b)} : Bound{}; }
  const mpq_class& value(std::size_t x) const { return value_[x]; }
  const Bound& lower(std::size_t x) const { return lower_[x]; }
  const Bound& upper(std::size_t x) const { return upper_[x]; }
  void restrict_to(std::size_t x, const Bound& lower, const Bound& upper) {
    lower_[x] = lower;
    upper_[x] = upper;
    const auto column = std::find(nonbasic_.begin(), nonbasic_.end(), x);
    if (column == nonbasic_.end()) return;
    mpq_class target = value_[x];
    if (below(x)) target = lower.value;
    if (above(x)) target = upper.value;
    move(static_cast<std::size_t>(column - nonbasic_.begin()), target - value_[x]);
  }

  /// A point within all bounds; false if there is none (the row found is the proof). Bland's rule ends it.
  bool repair() {
    for (;;) {
      std::size_t row = at(n_);
      for (std::size_t k = 0; k < at(n_); ++k)
        if ((below(basic_[k]) || above(basic_[k])) && (row == at(n_) || basic_[k] < basic_[row])) row = k;
      if (row == at(n_)) return true;
      const std::size_t x = basic_[row];
      const bool up = below(x);
      std::size_t column = at(n_);
      for (std::size_t k = 0; k < at(n_); ++k) {
        const int sign = up ? sgn(T_[row][k]) : -sgn(T_[row][k]);
        const std::size_t y = nonbasic_[k];
        const bool stuck = sign > 0 ? upper_[y].finite && value_[y] >= upper_[y].value
                                    : lower_[y].finite && value_[y] <= lower_[y].value;
        if (sign != 0 && !stuck && (column == at(n_) || y < nonbasic_[column])) column = k;
      }
      if (column == at(n_)) return false;
      const mpq_class target = up ? lower_[x].value : upper_[x].value;
      move(column, (target - value_[x]) / T_[row][column]);
      pivot(row, column);
    }
  }

 private:
  bool below(std::size_t x) const { return lower_[x].finite && value_[x] < lower_[x].value; }
  bool above(std::size_t x) const { return upper_[x].finite && value_[x] > upper_[x].value; }
  void move(std::size_t column, const mpq_class& step) {
    value_[nonbasic_[column]] += step;
    for (std::size_t k = 0; k < at(n_); ++k) value_[basic_[k]] += T_[k][column] * step;
  }
  void pivot(std::size_t row, std::size_t column) {
    const mpq_class a = T_[row][column];
    for (std::size_t j = 0; j < at(n_); ++j) T_[row][j] = j == column ? mpq_class(1 / a) : mpq_class(-T_[row][j] / a);
    for (std::size_t i = 0; i < at(n_); ++i) {
      if (i == row || sgn(T_[i][column]) == 0) continue;
      const mpq_class factor = T_[i][column];
      T_[i][column] = 0;
      for (std::size_t j = 0; j < at(n_); ++j) T_[i][j] += factor * T_[row][j];
    }
    std::swap(basic_[row], nonbasic_[column]);
  }

  Index n_;
  std::vector<std::vector<mpq_class>> T_;
  std::vector<mpq_class> value_;
  std::vector<Bound> lower_;
  std::vector<Bound> upper_;
  std::vector<std::size_t> basic_;
  std::vector<std::size_t> nonbasic_;
};

class Referee {
 public:
  Referee(const AffineMcp& problem, long most) : box_(problem.box), n_(at(problem.size())), most_(most) {
    Polyhedron all(problem);
    const Polyhedron::Bound zero{true, 0};
    for (Index i = 0; i < problem.size(); ++i) {  // the signs of w that hold wherever z_i is
      if (box_.lower[i] == box_.upper[i]) continue;
      const bool low = std::isfinite(box_.lower[i]);
      const bool high = std::isfinite(box_.upper[i]);
      if (!low || !high)
        all.restrict_to(n_ + at(i), high ? Polyhedron::Bound{} : zero, low ? Polyhedron::Bound{} : zero);
    }
    visit(std::move(all));
  }

  Verdict verdict() {
    return {.decided = found_ || nodes_ <= most_, .solution = std::move(solution_), .solvable = found_};
  }

 private:
  bool complementary(const Polyhedron& p, std::size_t i) const {
    if (box_.lower[static_cast<Index>(i)] == box_.upper[static_cast<Index>(i)]) return true;
    const int sign = sgn(p.value(n_ + i));
    if (sign == 0) return true;
    const double bound = sign > 0 ? box_.lower[static_cast<Index>(i)] : box_.upper[static_cast<Index>(i)];
    return std::isfinite(bound) && p.value(i) == mpq_class(bound);
  }

  void visit(Polyhedron p) {
    if (found_ || ++nodes_ > most_ || !p.repair()) return;
    std::size_t i = 0;
    while (i < n_ && complementary(p, i)) ++i;
    if (i == n_) {
      found_ = true;
      for (std::size_t k = 0; k < n_; ++k) solution_.push_back(p.value(k));
      return;
    }
    const Polyhedron::Bound none;
    const Polyhedron::Bound zero{true, 0};
    const auto branch = [&](const Polyhedron::Bound& z_low, const Polyhedron::Bound& z_high,
                            const Polyhedron::Bound& w_low, const Polyhedron::Bound& w_high) {
      Polyhedron next = p;
      next.restrict_to(i, z_low, z_high);
      next.restrict_to(n_ + i, w_low, w_high);
      visit(std::move(next));
    };
    const Polyhedron::Bound low = p.lower(i);
    const Polyhedron::Bound high = p.upper(i);
    if (low.finite) branch(low, low, zero, none);
    branch(low, high, zero, zero);
    if (high.finite) branch(high, high, none, zero);
  }

  const Box& box_;
  std::size_t n_;
  long most_;
  long nodes_ = 0;
  bool found_ = false;
  std::vector<mpq_class> solution_;
};

}  // namespace

Verdict decide(const AffineMcp& problem, long most) { return Referee(problem, most).verdict(); }

}  // namespace perp::lcp::exact

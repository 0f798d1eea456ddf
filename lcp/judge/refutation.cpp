// SPDX-License-Identifier: Apache-2.0
#include "lcp/judge/refutation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lcp/judge/infeasible.hpp"
#include "lcp/judge/product_sum.hpp"
#include "lcp/judge/propagation.hpp"

namespace perp::lcp {
namespace {

/// a + b rounded down, and up.
double down(double a, double b) {
  const TwoParts sum = two_sum(a, b);
  return sum.error < 0 ? std::nextafter(sum.value, -infinity) : sum.value;
}
double up(double a, double b) { return -down(-a, -b); }
/// Returns whether x < a + b, exactly.
bool less(double x, double a, double b) {
  const TwoParts sum = two_sum(a, b);
  return x < sum.value || (x == sum.value && sum.error > 0);
}

class Checker {
 public:
  Checker(const AffineMcp& problem, double tolerance, double radius)
      : problem_(problem),
        rows_(problem.M.transpose()),
        t_(tolerance),
        radius_(radius),
        X_(problem.box),
        off_lower_(at(problem.size()), 0),
        off_upper_(at(problem.size()), 0) {
    for (Index j = 0; j < problem.size(); ++j) {
      if (problem.box.has_lower(j)) X_.lower[j] = down(problem.box.lower[j], -t_);
      if (problem.box.has_upper(j)) X_.upper[j] = up(problem.box.upper[j], t_);
    }
  }

  /// Returns whether the proof refutes X, which is as before afterwards.
  bool refutes(const Refutation::Proof& proof) {
    struct Before {
      Index variable;
      double lower, upper;
    };
    std::vector<Before> before;
    bool right = true;
    for (const auto& a : proof.assumptions) {
      if (a.variable < 0 || a.variable >= problem_.size()) right = false;
      if (!right) break;
      before.push_back({a.variable, X_.lower[a.variable], X_.upper[a.variable]});
      right = assume(a);
    }
    right = right && contradiction(proof.y);
    for (std::size_t k = before.size(); k-- > 0;) {
      X_.lower[before[k].variable] = before[k].lower;
      X_.upper[before[k].variable] = before[k].upper;
    }
    return right;
  }

 private:
  /// Returns whether the assumption is refuted; narrows X to its contrary.
  bool assume(const Refutation::Assumption& a) {
    const Index j = a.variable;
    const bool off = std::isnan(a.value);
    const double bound = a.above ? problem_.box.lower[j] : problem_.box.upper[j];
    if (off && !std::isfinite(bound)) return false;
    double& near = a.above ? X_.lower[j] : X_.upper[j];
    double& far = a.above ? X_.upper[j] : X_.lower[j];
    char& flag = (a.above ? off_lower_ : off_upper_)[at(j)];
    // Within the assumption X may be larger than it is, by rounding.
    const double inner = !off ? a.value : a.above ? down(bound, t_) : up(bound, -t_);
    const double outer = !off ? a.value : a.above ? up(bound, t_) : down(bound, -t_);
    const double near_before = std::exchange(near, a.above ? std::max(near, inner) : std::min(near, inner));
    const char flag_before = std::exchange(flag, static_cast<char>(off || flag != 0));
    const bool right = refutes(a.refuted);
    near = near_before;
    flag = flag_before;
    far = a.above ? std::min(far, outer) : std::max(far, outer);
    return right;
  }

  bool at_most(Index i) const {  // F_i <= t
    return !problem_.box.has_lower(i) || off_lower_[at(i)] != 0 || less(-X_.lower[i], -problem_.box.lower[i], -t_);
  }
  bool at_least(Index i) const {  // F_i >= -t
    return !problem_.box.has_upper(i) || off_upper_[at(i)] != 0 || less(X_.upper[i], problem_.box.upper[i], -t_);
  }

  /// sup over X of y'(M z + q) + t |y|_1 < 0, where the signs of y are allowed.
  bool contradiction(const std::vector<Multiplier>& y) {
    struct Term {
      Index column;
      double a, high, low;
    };
    std::vector<Term> terms;
    ProductSum sum;
    for (const Multiplier& m : y) {
      if (m.row < 0 || m.row >= problem_.size() || !std::isfinite(m.high) || !std::isfinite(m.low)) return false;
      if (m.high == 0) return false;
      if (!(m.high > 0 ? at_least(m.row) : at_most(m.row))) return false;
      if (!(std::abs(m.low) < std::abs(m.high))) return false;
      for (SpMat::InnerIterator it(rows_, m.row); it; ++it)
        if (it.value() != 0) terms.push_back({it.row(), it.value(), m.high, m.low});
      sum.announce(problem_.q[m.row], m.high);
      sum.announce(t_, m.high);
    }
    std::ranges::stable_sort(terms, {}, &Term::column);
    // The end of X_j that makes g_j z_j largest, by the exact sign of g_j.
    std::vector<double> ends;  // of each term
    for (std::size_t k = 0, end = 0; k < terms.size(); k = end) {
      ProductSum g;
      for (end = k; end < terms.size() && terms[end].column == terms[k].column; ++end)
        g.announce(terms[end].a, terms[end].high);
      for (std::size_t p = k; p < end; ++p) {
        g.add(terms[p].a, terms[p].high);
        g.add(terms[p].a, terms[p].low);
      }
      if (!g.exact()) return false;
      double z = 0;
      if (g.sign() > 0) z = std::min(X_.upper[terms[k].column], std::max(radius_, X_.lower[terms[k].column]));
      if (g.sign() < 0) z = std::max(X_.lower[terms[k].column], std::min(-radius_, X_.upper[terms[k].column]));
      if (!std::isfinite(z)) return false;
      for (std::size_t p = k; p < end; ++p) {
        ends.push_back(z);
        sum.announce(terms[p].a, terms[p].high, z);
      }
    }
    for (const Multiplier& m : y)
      for (const double part : {m.high, m.low}) {
        sum.add(problem_.q[m.row], part);
        sum.add(t_, m.high > 0 ? part : -part);
      }
    for (std::size_t k = 0; k < terms.size(); ++k)
      for (const double part : {terms[k].high, terms[k].low}) sum.add(terms[k].a, part, ends[k]);
    return sum.exact() && sum.sign() < 0;
  }

  const AffineMcp& problem_;
  SpMat rows_;  // columns of M'
  double t_, radius_;
  Box X_;
  std::vector<char> off_lower_, off_upper_;  // assumed: z_i > l_i + t, z_i < u_i - t
};

void add_rows(const Refutation::Proof& proof, std::vector<Index>& rows) {
  for (const Multiplier& m : proof.y) rows.push_back(m.row);
  for (const auto& a : proof.assumptions) add_rows(a.refuted, rows);
}

/// Points further out than this are nobody's: what a proof that holds within a radius has to exclude.
constexpr double least_radius = 1e20;

}  // namespace

bool holds(const AffineMcp& problem, const Refutation& refutation) {
  if (!(refutation.tolerance >= 0) || !(refutation.radius > 0) || !std::isfinite(refutation.tolerance)) return false;
  return Checker(problem, refutation.tolerance, refutation.radius).refutes(refutation.proof);
}

std::vector<Index> rows_of(const Refutation& refutation) {
  std::vector<Index> rows;
  add_rows(refutation.proof, rows);
  std::ranges::sort(rows);
  const auto rest = std::ranges::unique(rows);
  rows.erase(rest.begin(), rest.end());
  return rows;
}

void raise_tolerance(const AffineMcp& problem, Refutation& refutation, double most) {
  constexpr int steps = 12;
  double failed = most;
  double held = 0;
  const auto with = [&](double t) {
    refutation.tolerance = t;
    return holds(problem, refutation);
  };
  if (with(most)) return;
  if (!with(0)) return;
  // Down to a tolerance that holds, then halfway, in exponents.
  for (double t = most; t > 0 && held == 0; t /= 1024)
    if (with(t))
      held = t;
    else
      failed = t;
  for (int k = 0; k < steps && held > 0; ++k) {
    const double t = std::sqrt(held) * std::sqrt(failed);
    (with(t) ? held : failed) = t;
  }
  refutation.tolerance = held;
}

Refutation refutation_by(const AffineMcp& problem, In y) {
  Refutation out;
  const TwoPartVector parts = certificate_parts(problem, y);
  if (parts.value.size() == 0) return out;
  const Exclusion excluded = exclusion(problem, parts);
  if (!(excluded.margin > 0)) return out;
  double margin = excluded.margin;
  if (excluded.wrong > 0) {
    out.radius = margin / (2 * excluded.wrong);
    margin /= 2;
    if (!(out.radius >= least_radius)) return {};
  }
  for (Index i = 0; i < y.size(); ++i)
    if (parts.value[i] != 0) out.proof.y.push_back({i, parts.value[i], parts.rest[i]});
  // The sums of the sizes are rounded; where that decides, a little less.
  for (const double less : {1e-9, 1e-3, 0.5}) {
    out.tolerance = margin / excluded.size * (1 - less);
    if (holds(problem, out)) return out;
  }
  out.tolerance = 0;
  return out;
}

Refutation refute(const AffineMcp& problem, In y, double tol, const std::vector<char>& rows) {
  Refutation best;
  const auto consider = [&](Refutation found) {
    if (found.tolerance > best.tolerance) best = std::move(found);
    return best.tolerance >= tol;
  };
  if (y.size() == problem.size() && consider(refutation_by(problem, y))) return best;
  Propagation at_tol(problem, rows, tol);
  bool contradiction = at_tol.run();
  if (!contradiction && y.size() == problem.size()) {
    Refutation found = at_tol.refutation(y);
    if (!found.proof.y.empty() && holds(problem, found)) consider(std::move(found));
    return best;
  }
  if (!contradiction) return best;
  Refutation found = at_tol.refutation();
  if (!holds(problem, found)) return best;
  consider(std::move(found));
  // How much more is excluded: bounds are carried through with the tolerance, so for each one anew.
  const auto with = [&](double t) {
    Propagation there(problem, rows, t);
    if (!there.run()) return false;
    Refutation larger = there.refutation();
    return holds(problem, larger) && (consider(std::move(larger)), true);
  };
  constexpr double factor = 32;
  double t = best.tolerance * factor;
  while (t < 1e100 && with(t)) t *= factor;
  for (double step = std::sqrt(factor); step > 1.1; step = std::sqrt(step)) with(best.tolerance * step);
  return best;
}

}  // namespace perp::lcp

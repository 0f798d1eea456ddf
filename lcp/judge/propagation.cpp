// SPDX-License-Identifier: Apache-2.0
#include "lcp/judge/propagation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "lcp/judge/infeasible.hpp"

namespace perp::lcp {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr int most_looks = 60;     // at a row; where bounds creep, more of them decide nothing
constexpr double shrinks = 0.9;    // an interval, or the new bound is not worth a step
constexpr double progress = 1e-3;  // relative: of a bound whose other side is infinite
constexpr double largest_bound = 1e100;
constexpr double narrow_width = 1e-6;  // relative: of a variable that other equations nearly settle

/// a + b rounded away from X: below, or above.
double next_below(double a) { return std::nextafter(a, -infinity); }
double next_above(double a) { return std::nextafter(a, infinity); }

void mix(std::uint64_t& hash, std::uint64_t value) {
  hash = (hash ^ value) * 0x9E3779B97F4A7C15U;
  hash ^= hash >> 29U;
}

}  // namespace

double Propagation::Range::lower(double error) const { return low_infinite > 0 ? -infinity : low - error; }
double Propagation::Range::upper(double error) const { return high_infinite > 0 ? infinity : high + error; }

Propagation::Propagation(const AffineMcp& problem, const std::vector<char>& rows, double tolerance)
    : problem_(problem),
      rows_(rows),
      t_(tolerance),
      by_row_(problem.M.transpose()),
      X_(problem.box),
      queued_(at(problem.size()), 0),
      looks_(at(problem.size()), 0) {
  for (Index j = 0; j < problem.size(); ++j) {
    X_.lower[j] = next_below(X_.lower[j] - t_);
    X_.upper[j] = next_above(X_.upper[j] + t_);
    if (!problem.box.has_lower(j)) X_.lower[j] = -infinity;
    if (!problem.box.has_upper(j)) X_.upper[j] = infinity;
  }
}

bool Propagation::at_most(Index i) const {
  return !problem_.box.has_lower(i) || X_.lower[i] > next_above(problem_.box.lower[i] + t_);
}
bool Propagation::at_least(Index i) const {
  return !problem_.box.has_upper(i) || X_.upper[i] < next_below(problem_.box.upper[i] - t_);
}

bool Propagation::run() {
  for (Index i = 0; i < problem_.size(); ++i) push(i);
  do {
    for (std::size_t next = 0; next < queue_.size() && !contradiction_; ++next) {
      const Index row = queue_[next];
      queued_[at(row)] = 0;
      look(row);
    }
    queue_.clear();
    std::fill(queued_.begin(), queued_.end(), 0);
  } while (!contradiction_ && parallel());
  return contradiction_;
}

void Propagation::push(Index row) {
  if (!known(row) || queued_[at(row)] != 0 || looks_[at(row)] >= most_looks) return;
  queued_[at(row)] = 1;
  queue_.push_back(row);
}

Propagation::Range Propagation::range(const std::vector<Term>& terms, double constant) const {
  Range r{.low = constant, .high = constant, .size = std::abs(constant)};
  for (const auto& [j, a] : terms) {
    const double low = a * (a > 0 ? X_.lower[j] : X_.upper[j]);
    const double high = a * (a > 0 ? X_.upper[j] : X_.lower[j]);
    if (std::isfinite(low))
      r.low += low, r.size += std::abs(low);
    else
      ++r.low_infinite;
    if (std::isfinite(high))
      r.high += high, r.size += std::abs(high);
    else
      ++r.high_infinite;
  }
  return r;
}

void Propagation::look(Index row) {
  ++looks_[at(row)];
  std::vector<Term> terms;
  for (SpMat::InnerIterator it(by_row_, row); it; ++it)
    if (it.value() != 0) terms.push_back({it.row(), it.value()});
  const Range r = range(terms, problem_.q[row]);
  const double slack = static_cast<double>(terms.size() + 4) * eps * (r.size + t_) + std::numeric_limits<double>::min();
  const std::vector<Multiplier> y{{row, 1, 0}};
  signs(row, terms, r, slack, y);
  if (!contradiction_) bounds(terms, r, slack, at_most(row), at_least(row), y);
}

namespace {

std::vector<Multiplier> times(std::vector<Multiplier> y, double sign) {
  for (Multiplier& m : y) m.high *= sign;
  return y;
}

}  // namespace

/// F_row > t, or < -t, on X, or on the part of X beyond a value of z_row.
void Propagation::signs(Index row, const std::vector<Term>& terms, const Range& r, double slack,
                        const std::vector<Multiplier>& y) {
  const Box& box = problem_.box;
  if (box.is_fixed(row)) return;
  const auto own = std::ranges::find(terms, row, &Term::column);
  const double a = own == terms.end() ? 0 : own->a;
  for (const bool positive : {true, false}) {
    // For F_row < -t the mirror image: -F_row, with the bounds exchanged.
    const double sign = positive ? 1 : -1;
    const double least = positive ? r.lower(slack) : -r.upper(slack);
    const bool settled = positive ? at_most(row) : at_least(row);
    if (least > t_) {
      if (settled) return end(times(y, -sign));
      narrow(row, positive, true, positive ? next_above(box.lower[row] + t_) : next_below(box.upper[row] - t_),
             times(y, -sign));
      continue;
    }
    if (settled || !(a > 0)) continue;
    // Beyond v: least of the other terms + a v > t.
    const double near = positive ? X_.lower[row] : -X_.upper[row];
    const int infinite = (positive ? r.low_infinite : r.high_infinite) - (std::isfinite(near) ? 0 : 1);
    if (infinite > 0) continue;
    const double rest = (positive ? r.low : -r.high) - (std::isfinite(near) ? a * near : 0) - slack;
    double v = (t_ - rest + slack) / a;
    v += 4 * eps * std::abs(v);
    const double off = positive ? next_above(box.lower[row] + t_) : -next_below(box.upper[row] - t_);
    if (!std::isfinite(v)) continue;
    if (v <= off)
      narrow(row, positive, true, sign * off, times(y, -sign));
    else
      narrow(row, positive, false, sign * v, times(y, -sign));
    if (contradiction_) return;
  }
}

/// sum <= t and sum >= -t, where they hold, bound every variable in it.
void Propagation::bounds(const std::vector<Term>& terms, const Range& r, double slack, bool at_most, bool at_least,
                         const std::vector<Multiplier>& y) {
  for (const bool upper : {true, false}) {
    if (!(upper ? at_most : at_least)) continue;
    const double sum = upper ? r.low : -r.high;
    const int infinite = upper ? r.low_infinite : r.high_infinite;
    if (infinite > 1) continue;
    if (infinite == 0 && sum - slack > t_) return end(times(y, upper ? -1 : 1));
    for (const auto& [j, a] : terms) {
      const double s = upper ? a : -a;  // s z_j <= t - the least of the others
      const double end_of_j = s > 0 ? X_.lower[j] : X_.upper[j];
      if (infinite == 1 && std::isfinite(end_of_j)) continue;
      const double rest = std::isfinite(end_of_j) ? sum - s * end_of_j : sum;
      double v = (t_ - rest + 2 * slack) / s;
      v += (s > 0 ? 4 : -4) * eps * std::abs(v);
      if (std::isfinite(v)) narrow(j, s > 0, false, v, times(y, upper ? -1 : 1));
      if (contradiction_) return;
    }
  }
}

/// z_variable <= value (above), or >= value, if that is worth a step.
void Propagation::narrow(Index variable, bool is_above, bool off, double value, std::vector<Multiplier> y) {
  const double sign = is_above ? 1 : -1;
  double& far = is_above ? X_.upper[variable] : X_.lower[variable];
  const double near = is_above ? X_.lower[variable] : X_.upper[variable];
  if (std::abs(value) > largest_bound) return;
  if (std::isfinite(far)) {
    const double gain = sign * (far - value);
    const double width = sign * (far - near);
    const double enough = std::isfinite(near) ? (1 - shrinks) * width : progress * (1 + std::abs(far));
    if (!(gain > 0) || !(gain >= enough)) return;
  }
  if (sign * (value - near) < 0) {
    if (!off) end(std::move(y));
    return;
  }
  far = value;
  steps_.push_back({variable, is_above, off, value, std::move(y)});
  push(variable);
  for (SpMat::InnerIterator it(problem_.M, variable); it; ++it) push(it.row());
}

bool Propagation::wide(Index j) const {
  const double width = X_.upper[j] - X_.lower[j];
  return !std::isfinite(width) || width > narrow_width * (1 + std::abs(X_.upper[j]));
}

void Propagation::end(std::vector<Multiplier> y) {
  last_ = std::move(y);
  contradiction_ = true;
}

namespace {

struct Needs {
  std::vector<char> lower, upper;
  char& of(Index j, bool is_upper) { return (is_upper ? upper : lower)[at(j)]; }
};

}  // namespace

/// The steps that y needs, and those that these need.
Refutation Propagation::pruned(std::vector<Multiplier> y) const {
  const std::size_t n = at(problem_.size());
  Needs needs{std::vector<char>(n, 0), std::vector<char>(n, 0)};
  std::vector<double> g(n, 0);
  const auto add = [&](const std::vector<Multiplier>& multipliers, Index assumed) {
    for (const Multiplier& m : multipliers)
      for (SpMat::InnerIterator it(by_row_, m.row); it; ++it) g[at(it.row())] += it.value() * m.high;
    for (const Multiplier& m : multipliers) {
      for (SpMat::InnerIterator it(by_row_, m.row); it; ++it) {
        // A sum that cancels may have either sign.
        const bool single = multipliers.size() == 1;
        const double gj = g[at(it.row())];
        if (!single || gj > 0) needs.of(it.row(), true) = 1;
        if (!single || gj < 0) needs.of(it.row(), false) = 1;
      }
      if (m.row == assumed) continue;
      if (m.high > 0 && problem_.box.has_upper(m.row)) needs.of(m.row, true) = 1;
      if (m.high < 0 && problem_.box.has_lower(m.row)) needs.of(m.row, false) = 1;
    }
    for (const Multiplier& m : multipliers)
      for (SpMat::InnerIterator it(by_row_, m.row); it; ++it) g[at(it.row())] = 0;
  };
  add(y, -1);
  std::vector<std::size_t> kept;
  for (std::size_t k = steps_.size(); k-- > 0;) {
    const Step& step = steps_[k];
    char& needed = needs.of(step.variable, step.above);
    if (needed == 0) continue;
    needed = 0;
    kept.push_back(k);
    // Beyond the value its own row has a sign, too.
    add(step.y, step.variable);
  }
  Refutation out;
  out.tolerance = t_;
  for (std::size_t k = kept.size(); k-- > 0;) {
    const Step& s = steps_[kept[k]];
    out.proof.assumptions.push_back(
        {s.variable, s.above, s.off ? std::numeric_limits<double>::quiet_NaN() : s.value, {.y = s.y}});
  }
  out.proof.y = std::move(y);
  return out;
}

Refutation Propagation::refutation() const { return pruned(last_); }

Refutation Propagation::refutation(In y) const {
  Box W = Box::free(problem_.size());
  for (Index i = 0; i < problem_.size(); ++i) {
    if (known(i) && at_most(i)) W.upper[i] = 0;
    if (known(i) && at_least(i)) W.lower[i] = 0;
  }
  const TwoPartVector parts = exclusion_parts(problem_.M, problem_.q, X_, W, y);
  std::vector<Multiplier> multipliers;
  for (Index i = 0; i < parts.value.size(); ++i)
    if (parts.value[i] != 0) multipliers.push_back({i, parts.value[i], parts.rest[i]});
  return multipliers.empty() ? Refutation{} : pruned(std::move(multipliers));
}

/// Rows whose coefficients in the wide variables are multiples of those of an equation. True: X has become narrower.
bool Propagation::parallel() {
  struct Look {
    std::uint64_t hash;
    Index row;
    bool operator<(const Look& other) const { return std::pair(hash, row) < std::pair(other.hash, other.row); }
  };
  std::vector<Look> looks;
  for (Index i = 0; i < problem_.size(); ++i) {
    if (!known(i)) continue;
    std::uint64_t hash = 1;
    double first = 0;
    for (SpMat::InnerIterator it(by_row_, i); it; ++it) {
      if (it.value() == 0 || !wide(it.row())) continue;
      if (first == 0) first = it.value();
      mix(hash, static_cast<std::uint64_t>(it.row()));
      mix(hash, static_cast<std::uint64_t>(std::llround(std::clamp(it.value() / first, -1e9, 1e9) * 1e6)));
    }
    if (first != 0) looks.push_back({hash, i});
  }
  std::sort(looks.begin(), looks.end());
  const std::size_t before = steps_.size();
  for (std::size_t begin = 0, end = 0; begin < looks.size() && !contradiction_; begin = end) {
    Index equation = -1;
    for (end = begin; end < looks.size() && looks[end].hash == looks[begin].hash; ++end)
      if (equation < 0 && at_most(looks[end].row) && at_least(looks[end].row)) equation = looks[end].row;
    for (std::size_t k = begin; k < end && equation >= 0 && !contradiction_; ++k)
      if (looks[k].row != equation) compare(equation, looks[k].row);
  }
  return !contradiction_ && steps_.size() > before && !queue_.empty();
}

/// F_row b - F_equation a, with a and b the coefficients of a wide variable: no wide variable is left in it.
void Propagation::compare(Index equation, Index row) {
  if (++looks_[at(row)] > 2 * most_looks) return;
  double a = 0, b = 0;
  std::vector<Term> terms;
  const auto both = [&](const auto& visit) {
    SpMat::InnerIterator p(by_row_, equation), q(by_row_, row);
    while (p || q) {
      const Index j = !p ? q.row() : !q ? p.row() : std::min(p.row(), q.row());
      const double of_e = p && p.row() == j ? p.value() : 0;
      const double of_r = q && q.row() == j ? q.value() : 0;
      visit(j, of_e, of_r);
      if (p && p.row() == j) ++p;
      if (q && q.row() == j) ++q;
    }
  };
  both([&](Index j, double of_e, double of_r) {
    if (b == 0 && of_e != 0 && of_r != 0 && wide(j)) b = of_e, a = of_r;
  });
  if (b == 0) return;
  if (b < 0) a = -a, b = -b;
  double rounded = 0;
  both([&](Index j, double of_e, double of_r) {
    const double c = std::fma(b, of_r, -a * of_e) - std::fma(a, of_e, -(a * of_e));
    const double size = std::abs(b * of_r) + std::abs(a * of_e);
    if (std::abs(c) > eps * size || (!(wide(j)) && c != 0)) terms.push_back({j, c});
    // An exact difference that is not 0 keeps the variable; the check of the certificate is exact.
    if (!wide(j)) rounded += eps * size * std::max(std::abs(X_.lower[j]), std::abs(X_.upper[j]));
  });
  const double constant = b * problem_.q[row] - a * problem_.q[equation];
  const Range range_of = range(terms, constant);
  const double slack = static_cast<double>(terms.size() + 4) * eps *
                           (range_of.size + std::abs(b * problem_.q[row]) + std::abs(a * problem_.q[equation])) +
                       4 * rounded + std::numeric_limits<double>::min();
  // |F_equation| <= t: b F_row lies in the range, plus or minus |a| t.
  const double least = range_of.lower(slack) - std::abs(a) * t_;
  const double most = range_of.upper(slack) + std::abs(a) * t_;
  const Box& box = problem_.box;
  std::vector<Multiplier> y{{row, b, 0}, {equation, -a, 0}};
  if (row > equation) std::swap(y[0], y[1]);
  if (least > b * t_) {
    if (at_most(row)) return end(times(y, -1));
    narrow(row, true, true, next_above(box.lower[row] + t_), times(y, -1));
  } else if (most < -b * t_) {
    if (at_least(row)) return end(times(y, 1));
    narrow(row, false, true, next_below(box.upper[row] - t_), times(y, 1));
  }
}

}  // namespace perp::lcp

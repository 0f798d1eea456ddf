// SPDX-License-Identifier: Apache-2.0
#include "lcp/judge/infeasible.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "lcp/dense_factors.hpp"
#include "lcp/equilibrate.hpp"
#include "lcp/judge/product_sum.hpp"
#include "lcp/judge/refutation.hpp"

namespace perp::lcp {
namespace {

/// g_j = sum_i M_ij y_i in doubles, and the sum of its terms' sizes.
struct Column {
  double g = 0;
  double size = 0;
};
Column column(const SpMat& M, Index j, In y) {
  Column c;
  for (SpMat::InnerIterator it(M, j); it; ++it) {
    const double term = it.value() * y[it.row()];
    c.g += term;
    c.size += std::abs(term);
  }
  return c;
}

/// w = M z + q, z in Z, w in W.
struct Relation {
  const SpMat& M;
  const Vec& q;
  const Box& Z;
  const Box& W;
};

/// Rounding of a sum of many terms, generously.
constexpr double rounding = 1e-9;

/// g_j, rounded once; false if it leaves the range.
bool exact_column(const SpMat& M, Index j, const TwoPartVector& y, double& g) {
  const Column rounded = column(M, j, y.value);
  if (std::isfinite(rounded.size) && rounded.size > 1e-280 && std::abs(rounded.g) > rounding * rounded.size) {
    g = rounded.g;
    return true;
  }
  ProductSum sum;
  for (SpMat::InnerIterator it(M, j); it; ++it) sum.announce(it.value(), y.value[it.row()]);
  for (SpMat::InnerIterator it(M, j); it; ++it) {
    sum.add(it.value(), y.value[it.row()]);
    sum.add(it.value(), y.rest[it.row()]);
  }
  g = sum.value();
  if (g == 0) g = sum.sign() * std::numeric_limits<double>::min();  // a value below all doubles keeps its sign
  return sum.exact();
}

bool has_signs(const Box& W, In y) {
  for (Index i = 0; i < y.size(); ++i)
    if ((y[i] > 0 && W.lower[i] == -infinity) || (y[i] < 0 && W.upper[i] == infinity)) return false;
  return y.allFinite();
}

/// Margin 0 where y proves nothing.
Exclusion excluded(const Relation& r, const TwoPartVector& y) {
  if (!has_signs(r.W, y.value)) return {};
  Exclusion out{.size = y.value.lpNorm<1>()};
  std::vector<std::pair<Index, double>> bounds;  // of the columns that add to the sum
  for (Index j = 0; j < r.q.size(); ++j) {
    double g = 0;
    if (!exact_column(r.M, j, y, g)) return {};
    if (g == 0) continue;
    const double bound = g > 0 ? r.Z.upper[j] : r.Z.lower[j];
    if (!std::isfinite(bound)) {
      const Column rounded = column(r.M, j, y.value);
      if (std::abs(g) > rounding * rounded.size) return {};
      out.wrong += std::abs(g);
      continue;
    }
    out.size += std::abs(g);
    if (bound != 0) bounds.emplace_back(j, bound);
  }
  ProductSum sup;
  for (Index i = 0; i < r.q.size(); ++i) sup.announce(r.q[i], y.value[i]);
  for (const auto& [j, bound] : bounds)
    for (SpMat::InnerIterator it(r.M, j); it; ++it) sup.announce(it.value(), y.value[it.row()], bound);
  for (Index i = 0; i < r.q.size(); ++i) {
    sup.add(r.q[i], y.value[i]);
    sup.add(r.q[i], y.rest[i]);
  }
  for (const auto& [j, bound] : bounds)
    for (SpMat::InnerIterator it(r.M, j); it; ++it) {
      sup.add(it.value(), y.value[it.row()], bound);
      sup.add(it.value(), y.rest[it.row()], bound);
    }
  if (sup.exact() && sup.sign() < 0) out.margin = -sup.value();
  return out;
}

/// The radius within which y excludes solutions (infeasible.hpp), less its rounding; infinite, or 0 if it proves
/// nothing.
double excluded_radius(const Relation& r, const TwoPartVector& y) {
  const Exclusion e = excluded(r, y);
  if (!(e.margin > 0)) return 0;
  return e.wrong == 0 ? infinity : e.margin / e.wrong * (1 - rounding);
}

/// Whether y would be a proof if small g_j were 0: what a repair is worth trying for.
bool nearly_excludes(const Relation& r, In y) {
  if (!has_signs(r.W, y)) return false;
  double sup = r.q.dot(y);
  for (Index j = 0; j < r.q.size(); ++j) {
    const Column c = column(r.M, j, y);
    if (c.g == 0) continue;
    const double bound = c.g > 0 ? r.Z.upper[j] : r.Z.lower[j];
    if (std::isfinite(bound))
      sup += c.g * bound;
    else if (!(std::abs(c.g) <= rounding * c.size))
      return false;
  }
  return sup < 0;
}

/// A multiple of y whose entries are nearly numbers of 20 digits, rounded to them; empty if there is none with an odd
/// factor up to 4095 over the entry `reference`.
Vec of_few_digits(const Vec& y, Index reference) {
  const auto few_digits = [](double a) {
    const int exponent = std::ilogb(a);
    return std::scalbn(std::nearbyint(std::scalbn(a, 20 - exponent)), exponent - 20);
  };
  Vec found(y.size());
  for (int factor = 1; factor < 4096; factor += 2) {
    const double multiple = factor / y[reference];
    if (!std::isfinite(multiple)) return {};
    Index i = 0;
    for (; i < y.size(); ++i) {
      const double a = y[i] * multiple;
      found[i] = a == 0 ? 0 : few_digits(a);
      if (!(std::abs(found[i] - a) <= 1e-11 * std::abs(a))) break;
    }
    if (i == y.size()) return found;
  }
  return {};
}

/// The g_j that should be 0 as equations in the y_i that are not.
class TightColumns {
 public:
  TightColumns(const Relation& r, const Vec& y) : r_(r), y_(y) {
    for (Index i = 0; i < y.size() && size(support_) <= most; ++i)
      if (y[i] != 0) support_.push_back(i);
    for (Index j = 0; j < y.size() && size(columns_) <= most; ++j) {
      if (std::isfinite(r.Z.lower[j]) && std::isfinite(r.Z.upper[j])) continue;
      const Column c = column(r.M, j, y);
      if (c.size > 0 && std::abs(c.g) <= 100 * rounding * c.size) columns_.push_back(j);
    }
    if (!usable()) return;
    std::vector<Index> position(static_cast<std::size_t>(y.size()), -1);
    for (std::size_t k = 0; k < support_.size(); ++k)
      position[static_cast<std::size_t>(support_[k])] = static_cast<Index>(k);
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(size(columns_), size(support_));
    for (Index k = 0; k < A.rows(); ++k)
      for (SpMat::InnerIterator it(r.M, columns_[static_cast<std::size_t>(k)]); it; ++it)
        if (const Index p = position[static_cast<std::size_t>(it.row())]; p >= 0) A(k, p) = it.value();
    solver_.compute(A);
  }

  bool usable() const {
    return !columns_.empty() && !support_.empty() && size(columns_) <= most && size(support_) <= most;
  }

  /// d that makes all of them slightly right: negative where only l_j is finite, positive where only u_j is.
  Vec inwards() const {
    return solve([&](Index j) {
      const Column c = column(r_.M, j, y_);
      const double slight = 10 * rounding * c.size;
      return (std::isfinite(r_.Z.lower[j]) ? -slight : std::isfinite(r_.Z.upper[j]) ? slight : 0) - c.g;
    });
  }
  /// d that takes their rounding away.
  Vec correction() const {
    const TwoPartVector y(y_);
    return solve([&](Index j) {
      double g = 0;
      return exact_column(r_.M, j, y, g) ? -g : 0;
    });
  }

 private:
  static constexpr Index most = 150;  // a dense factorization of this size is nothing
  static Index size(const std::vector<Index>& v) { return static_cast<Index>(v.size()); }

  template <class Wanted>
  Vec solve(const Wanted& wanted) const {
    Vec b(size(columns_));
    for (Index k = 0; k < b.size(); ++k) b[k] = wanted(columns_[static_cast<std::size_t>(k)]);
    const Vec on_support = solver_.solve(b);
    Vec d = Vec::Zero(y_.size());
    for (Index k = 0; k < on_support.size(); ++k) d[support_[static_cast<std::size_t>(k)]] = on_support[k];
    return d;
  }

  const Relation& r_;
  const Vec& y_;
  std::vector<Index> support_;
  std::vector<Index> columns_;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver_;
};

/// y after its rounding has been taken away by a second vector; empty if that is no rounding.
TwoPartVector corrected(const Vec& y, const Vec& correction) {
  TwoPartVector out(y);
  for (Index i = 0; i < y.size(); ++i) {
    if (!(std::abs(correction[i]) <= 1e-6 * std::abs(y[i]))) return {};
    const TwoParts sum = two_sum(y[i], correction[i]);
    out.value[i] = sum.value;
    out.rest[i] = sum.error;
  }
  return out;
}

/// y, or y corrected, whichever excludes more; empty if neither excludes anything.
TwoPartVector best_parts(const Relation& r, const Vec& y) {
  const TwoPartVector given(y);
  const double radius = excluded_radius(r, given);
  if (!std::isinf(radius) && nearly_excludes(r, y)) {
    const TightColumns tight(r, y);
    if (tight.usable()) {
      const TwoPartVector better = corrected(y, tight.correction());
      if (better.size() > 0 && excluded_radius(r, better) > radius) return better;
    }
  }
  return radius > 0 ? given : TwoPartVector{};
}

double excluded_by(const Relation& r, const TwoPartVector& y) { return y.value.size() > 0 ? excluded_radius(r, y) : 0; }

/// A y near `start` that excludes all, or all within the radius asked for; empty if none is found.
Vec repaired(const Relation& r, const Vec& start) {
  const auto excludes = [&](const Vec& y) { return y.size() > 0 && excluded_radius(r, TwoPartVector(y)) == infinity; };
  if (excludes(start)) return start;
  Vec last;
  for (const double tiny : {0.0, 1e-13, 1e-10, 1e-7}) {
    const Vec y = start.unaryExpr([&](double a) { return std::abs(a) <= tiny ? 0 : a; });
    if ((last.size() > 0 && y == last) || !nearly_excludes(r, y)) continue;
    last = y;
    if (excludes(y)) return y;
    Index largest = 0;
    y.cwiseAbs().maxCoeff(&largest);
    Index smallest = largest;
    for (Index i = 0; i < y.size(); ++i)
      if (y[i] != 0 && std::abs(y[i]) < std::abs(y[smallest])) smallest = i;
    for (const Index reference : {largest, smallest})
      if (const Vec simple = of_few_digits(y, reference); excludes(simple)) return simple;
    const TightColumns tight(r, y);
    if (!tight.usable()) continue;
    if (const Vec moved = y + tight.inwards(); excludes(moved)) return moved;
    if (excluded_by(r, corrected(y, tight.correction())) >= proof_radius) return y;
  }
  return {};
}

/// What F = M z + q of a solution in the box is known to be.
Box forces(const Box& box) {
  Box W = Box::free(box.size());
  for (Index i = 0; i < box.size(); ++i) {
    const bool low = box.lower[i] > -infinity;
    const bool high = box.upper[i] < infinity;
    if (!high) W.lower[i] = 0;
    if (!low) W.upper[i] = 0;
  }
  return W;
}

/// Of length 1 to 2 in the maximum norm; empty if it is 0 or not finite.
Vec normalized(const Vec& y) {
  const double size = y.size() > 0 ? y.lpNorm<::Eigen::Infinity>() : 0;
  if (!(size > 0) || !y.allFinite()) return {};
  const int exponent = std::ilogb(size);
  return y.unaryExpr([&](double a) { return std::scalbn(a, -exponent); });
}

}  // namespace

namespace {

/// y, if it alone excludes all points of the problem as it is; else the best parts of the equilibrated one, in
/// `scaling`.
struct Parts {
  TwoPartVector y{};
  double radius = 0;
  Vec rows{};  // E, of the scaled problem that y belongs to; empty: it is the problem's own
};
Parts parts_of(const AffineMcp& problem, In y) {
  if (y.size() != problem.size() || !y.allFinite()) return {};
  const Box W = forces(problem.box);
  TwoPartVector given{Vec(y)};
  if (excluded_radius({problem.M, problem.q, problem.box, W}, given) == infinity)
    return {std::move(given), infinity, {}};
  const Scaling scaling = equilibrate(problem);
  const AffineMcp scaled = scaling.apply(problem);
  const Vec scaled_y = normalized(y.cwiseQuotient(scaling.rows));
  if (scaled_y.size() == 0 || !scaling.loses_nothing(problem)) return {};
  const Relation r{scaled.M, scaled.q, scaled.box, W};
  TwoPartVector best = best_parts(r, scaled_y);
  const double radius = excluded_by(r, best);
  return {std::move(best), radius, scaling.rows};
}

}  // namespace

double infeasible_radius(const AffineMcp& problem, In y) { return parts_of(problem, y).radius; }

TwoPartVector certificate_parts(const AffineMcp& problem, In y) {
  Parts parts = parts_of(problem, y);
  if (parts.radius < proof_radius) return {};
  for (Vec* v : {&parts.y.value, &parts.y.rest})
    if (parts.rows.size() > 0 && v->size() > 0) *v = v->cwiseProduct(parts.rows);
  return parts.y;
}

Exclusion exclusion(const AffineMcp& problem, const TwoPartVector& y) {
  const Box W = forces(problem.box);
  return excluded({problem.M, problem.q, problem.box, W}, y);
}

Exclusion exclusion(const SpMat& M, In q, const Box& Z, const Box& W, const TwoPartVector& y) {
  const Vec q_copy = q;
  return excluded({M, q_copy, Z, W}, y);
}

bool proves_infeasible(const AffineMcp& problem, In y) { return infeasible_radius(problem, y) >= proof_radius; }

Vec exact_exclusion(const SpMat& M, In q, const Box& Z, const Box& W, In given) {
  if (given.size() != q.size()) return {};
  Vec start = normalized(given);
  for (Index i = 0; i < start.size(); ++i)
    if ((start[i] > 0 && W.lower[i] == -infinity) || (start[i] < 0 && W.upper[i] == infinity)) start[i] = 0;
  if (start.size() == 0 || start.isZero(0)) return {};
  const Vec q_copy = q;
  return repaired({M, q_copy, Z, W}, start);
}

TwoPartVector exclusion_parts(const SpMat& M, In q, const Box& Z, const Box& W, In given) {
  const Vec y = exact_exclusion(M, q, Z, W, given);
  const Vec q_copy = q;
  return y.size() > 0 ? best_parts({M, q_copy, Z, W}, y) : TwoPartVector{};
}

namespace {

/// exact_certificate() without the tolerance.
Vec certificate_near(const AffineMcp& problem, In y) {
  if (y.size() != problem.size() || !y.allFinite()) return {};
  const Box W = forces(problem.box);
  const auto cleared = [&](Index i) {
    const bool wrong = (y[i] > 0 && W.lower[i] == -infinity) || (y[i] < 0 && W.upper[i] == infinity);
    return wrong ? 0 : y[i];
  };
  const Vec start = Vec::NullaryExpr(y.size(), cleared);
  const Relation unscaled{problem.M, problem.q, problem.box, W};
  if (excluded_radius(unscaled, TwoPartVector(start)) == infinity) return normalized(start);
  if (!nearly_excludes(unscaled, start)) return {};
  const Scaling scaling = equilibrate(problem);
  const AffineMcp scaled = scaling.apply(problem);
  const Vec found = exact_exclusion(scaled.M, scaled.q, scaled.box, W, start.cwiseQuotient(scaling.rows));
  if (found.size() == 0) return {};
  const Vec certificate = normalized(found.cwiseProduct(scaling.rows));
  return certificate.size() > 0 && proves_infeasible(problem, certificate) ? certificate : Vec();
}

}  // namespace

Vec exact_certificate(const AffineMcp& problem, In y, double tol) {
  Vec found = certificate_near(problem, y);
  if (tol > 0 && found.size() > 0 && refutation_by(problem, found).tolerance < tol) return {};
  return found;
}

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#include "lcp/judge/infeasible.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "lcp/equilibrate.hpp"
#include "lcp/exact_sum.hpp"

namespace perp::lcp {
namespace {

/// The exact sum of products a b c, whatever their exponents: all are multiplied by one power of two, so that the
/// largest is near 2^900.
class ProductSum {
 public:
  /// To be told of every product first.
  void announce(double a, double b, double c = 1) {
    if (a != 0 && b != 0 && c != 0) top_ = std::max(top_, std::ilogb(a) + std::ilogb(b) + std::ilogb(c));
  }
  void add(double a, double b, double c = 1) {
    if (a == 0 || b == 0 || c == 0) return;
    const std::array exponents{std::ilogb(a), std::ilogb(b), std::ilogb(c)};
    const int shift = exponents[0] + exponents[1] + exponents[2] - top_ + 900;
    if (shift < -800) {  // the last of 159 digits would be lost
      exact_ = false;
      return;
    }
    const TwoParts ab = two_product(std::scalbn(a, -exponents[0]), std::scalbn(b, -exponents[1]));
    const double scaled_c = std::scalbn(c, -exponents[2]);
    for (const double part : {ab.error, ab.value}) sum_.add_product(std::scalbn(part, shift), scaled_c);
  }
  bool exact() const { return exact_ && sum_.exact(); }
  int sign() const { return sum_.sign(); }
  double value() const { return std::scalbn(sum_.value(), top_ - 900); }

 private:
  ExactSum sum_;
  int top_ = -100000;
  bool exact_ = true;
};

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

/// A vector of twice the digits: high + low, low_i below the digits of high_i; low empty: 0.
struct Multipliers {
  const Vec& high;
  const Vec& low;
  double low_of(Index i) const { return low.size() > 0 ? low[i] : 0; }
};

/// g_j, rounded once; false if it leaves the range.
bool exact_column(const SpMat& M, Index j, const Multipliers& y, double& g) {
  const Column rounded = column(M, j, y.high);
  if (std::isfinite(rounded.size) && rounded.size > 1e-280 && std::abs(rounded.g) > rounding * rounded.size) {
    g = rounded.g;
    return true;
  }
  ProductSum sum;
  for (SpMat::InnerIterator it(M, j); it; ++it) sum.announce(it.value(), y.high[it.row()]);
  for (SpMat::InnerIterator it(M, j); it; ++it) {
    sum.add(it.value(), y.high[it.row()]);
    sum.add(it.value(), y.low_of(it.row()));
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

/// The radius within which y excludes solutions (infeasible.hpp), less its rounding; infinite, or 0 if it proves
/// nothing.
double excluded_radius(const Relation& r, const Multipliers& y) {
  if (!has_signs(r.W, y.high)) return 0;
  double wrong = 0;
  std::vector<std::pair<Index, double>> bounds;  // of the columns that add to the sum
  for (Index j = 0; j < r.q.size(); ++j) {
    double g = 0;
    if (!exact_column(r.M, j, y, g)) return 0;
    if (g == 0) continue;
    const double bound = g > 0 ? r.Z.upper[j] : r.Z.lower[j];
    if (!std::isfinite(bound)) {
      const Column rounded = column(r.M, j, y.high);
      if (std::abs(g) > rounding * rounded.size) return 0;
      wrong += std::abs(g);
    } else if (bound != 0) {
      bounds.emplace_back(j, bound);
    }
  }
  ProductSum sup;
  for (Index i = 0; i < r.q.size(); ++i) sup.announce(r.q[i], y.high[i]);
  for (const auto& [j, bound] : bounds)
    for (SpMat::InnerIterator it(r.M, j); it; ++it) sup.announce(it.value(), y.high[it.row()], bound);
  for (Index i = 0; i < r.q.size(); ++i) {
    sup.add(r.q[i], y.high[i]);
    sup.add(r.q[i], y.low_of(i));
  }
  for (const auto& [j, bound] : bounds)
    for (SpMat::InnerIterator it(r.M, j); it; ++it) {
      sup.add(it.value(), y.high[it.row()], bound);
      sup.add(it.value(), y.low_of(it.row()), bound);
    }
  if (!sup.exact() || sup.sign() >= 0) return 0;
  return wrong == 0 ? infinity : -sup.value() / wrong * (1 - rounding);
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
    return solve([&](Index j) {
      double g = 0;
      const Vec none;
      return exact_column(r_.M, j, {y_, none}, g) ? -g : 0;
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

/// The radius that y excludes after its rounding has been taken away by a second vector, which is not kept.
double corrected_radius(const Relation& r, const Vec& y, const Vec& correction) {
  Vec high = y;
  Vec low = correction;
  for (Index i = 0; i < y.size(); ++i) {
    if (!(std::abs(low[i]) <= 1e-6 * std::abs(y[i]))) return 0;
    const TwoParts sum = two_sum(y[i], low[i]);
    high[i] = sum.value;
    low[i] = sum.error;
  }
  return excluded_radius(r, {high, low});
}

double excluded_by(const Relation& r, const Vec& y) {
  const Vec none;
  const double radius = excluded_radius(r, {y, none});
  if (std::isinf(radius) || !nearly_excludes(r, y)) return radius;
  const TightColumns tight(r, y);
  return tight.usable() ? std::max(radius, corrected_radius(r, y, tight.correction())) : radius;
}

/// A y near `start` that excludes all, or all within the radius asked for; empty if none is found.
Vec repaired(const Relation& r, const Vec& start) {
  const Vec none;
  const auto excludes = [&](const Vec& y) { return y.size() > 0 && excluded_radius(r, {y, none}) == infinity; };
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
    if (corrected_radius(r, y, tight.correction()) >= proof_radius) return y;
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

double infeasible_radius(const AffineMcp& problem, In y) {
  if (y.size() != problem.size() || !y.allFinite()) return 0;
  const Box W = forces(problem.box);
  const Vec none;
  const Vec given = y;
  if (excluded_radius({problem.M, problem.q, problem.box, W}, {given, none}) == infinity) return infinity;
  const Scaling scaling = equilibrate(problem);
  const AffineMcp scaled = scaling.apply(problem);
  const Vec scaled_y = normalized(y.cwiseQuotient(scaling.rows));
  if (scaled_y.size() == 0 || !scaling.loses_nothing(problem)) return 0;
  return excluded_by({scaled.M, scaled.q, scaled.box, W}, scaled_y);
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

Vec exact_certificate(const AffineMcp& problem, In y) {
  if (y.size() != problem.size() || !y.allFinite()) return {};
  const Box W = forces(problem.box);
  const auto cleared = [&](Index i) {
    const bool wrong = (y[i] > 0 && W.lower[i] == -infinity) || (y[i] < 0 && W.upper[i] == infinity);
    return wrong ? 0 : y[i];
  };
  const Vec start = Vec::NullaryExpr(y.size(), cleared);
  const Relation unscaled{problem.M, problem.q, problem.box, W};
  const Vec none;
  if (excluded_radius(unscaled, {start, none}) == infinity) return normalized(start);
  if (!nearly_excludes(unscaled, start)) return {};
  const Scaling scaling = equilibrate(problem);
  const AffineMcp scaled = scaling.apply(problem);
  const Vec found = exact_exclusion(scaled.M, scaled.q, scaled.box, W, start.cwiseQuotient(scaling.rows));
  if (found.size() == 0) return {};
  const Vec certificate = normalized(found.cwiseProduct(scaling.rows));
  return certificate.size() > 0 && proves_infeasible(problem, certificate) ? certificate : Vec();
}

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#include "ncp/analysis/verify.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "lcp/dense_factors.hpp"
#include "lcp/memory.hpp"
#include "ncp/interval/enclosure.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/problem/affine_enclosure.hpp"
#include "ncp/problem/words.hpp"

namespace perp::ncp {
namespace {

using Dense = ::Eigen::MatrixXd;

constexpr double unit = 0x1p-53;  // half an ulp of 1
constexpr double tiny = std::numeric_limits<double>::min();
constexpr int newton_steps = 4;
constexpr int choices = 3;  // of the sets, each at a better point
constexpr int inflations = 12;

double midpoint(const Interval& a) { return a.lower + (a.upper - a.lower) / 2; }
/// Rounded upward.
double radius_about(const Interval& a, double middle) {
  return std::max(0.0, std::max((a - middle).upper, (Interval(middle) - a).upper));
}

/// A bound of the sum of n nonnegative products that was computed as `sum`, each of its numbers with a relative error
/// of at most 3 units.
double no_less(double sum, Index n) {
  const double terms = static_cast<double>(n) + 8;
  return sum * (1 + 2 * terms * unit) + terms * tiny;
}

/// One solution's sets, and the numbers of the proof.
class Proof {
 public:
  Proof(const Mcp& mcp, const Enclosure& enclosure, Vec x)
      : mcp_(mcp), enclosure_(enclosure), x_(std::move(x)), X_(at(mcp.size())), F_(at(mcp.size())) {}

  Verified run();

 private:
  enum class Set : char { Inner, Lower, Upper, Fixed };

  bool choose_sets();
  bool invert();
  void newton();
  bool krawczyk();
  bool within_bounds();
  bool signs();
  void evaluate(In radius);
  /// Over the box X_; the flags of its rows.
  std::vector<char> jacobian();
  /// |C| v, rounded upward; v >= 0.
  Vec times_C(In v) const;
  bool fail(std::string why) {
    why_not_ = std::move(why);
    return false;
  }
  std::string name(Index k) const { return mcp_.variable_name(inner_[at(k)]); }

  const Mcp& mcp_;
  const Enclosure& enclosure_;
  Vec x_;
  std::vector<Interval> X_, F_;
  std::vector<Set> set_;
  std::vector<Index> inner_;   // ascending
  std::vector<int> position_;  // of a variable in inner_, or -1
  SpMat middle_, width_;       // of J_II(X)
  Dense C_, absolute_C_;
  Vec radius_;  // of inner_
  std::string why_not_;
};

void Proof::evaluate(In radius) {
  const Box& box = mcp_.box();
  for (Index i = 0; i < x_.size(); ++i) {
    const Interval wide = Interval(x_[i]) + Interval(-radius[i], radius[i]);
    X_[at(i)] = radius[i] > 0 ? intersection(wide, {box.lower[i], box.upper[i]}) : Interval(x_[i]);
  }
  enclosure_.values(X_, F_);
}

/// At the bound where the natural residual measures the distance to it. False: as before.
bool Proof::choose_sets() {
  const Box& box = mcp_.box();
  evaluate(Vec::Zero(x_.size()));
  const std::vector<Set> before = std::exchange(set_, std::vector<Set>(at(x_.size()), Set::Inner));
  position_.assign(at(x_.size()), -1);
  inner_.clear();
  for (Index i = 0; i < x_.size(); ++i) {
    const double F = midpoint(F_[at(i)]);
    Set& set = set_[at(i)];
    // An infinite bound is no place to be, even where F overflows.
    if (box.lower[i] == box.upper[i])
      set = Set::Fixed;
    else if (box.lower[i] > -infinity && x_[i] - box.lower[i] <= F)
      set = Set::Lower;
    else if (box.upper[i] < infinity && box.upper[i] - x_[i] <= -F)
      set = Set::Upper;
    if (set == Set::Lower || set == Set::Fixed) x_[i] = box.lower[i];
    if (set == Set::Upper) x_[i] = box.upper[i];
    if (set != Set::Inner) continue;
    position_[at(i)] = static_cast<int>(inner_.size());
    inner_.push_back(i);
  }
  return set_ != before;
}

/// J_II over the box X_ as middle and radius; the rows that are not known get radius infinity.
std::vector<char> Proof::jacobian() {
  const SpMat& pattern = mcp_.jacobian_pattern();
  std::vector<Interval> J(at(pattern.nonZeros()));
  std::vector<char> known(at(x_.size()), 0);
  enclosure_.jacobian(X_, J, known);
  const auto n = static_cast<Index>(inner_.size());
  std::vector<::Eigen::Triplet<double>> middle, width;
  std::size_t k = 0;
  for (Index j = 0; j < pattern.cols(); ++j)
    for (SpMat::InnerIterator it(pattern, j); it; ++it, ++k) {
      const int row = position_[at(it.row())], col = position_[at(j)];
      if (row < 0 || col < 0) continue;
      const bool sure = known[at(it.row())] != 0 && J[k].bounded();
      const double m = sure ? midpoint(J[k]) : 0;
      middle.emplace_back(row, col, m);
      width.emplace_back(row, col, sure ? radius_about(J[k], m) : infinity);
    }
  middle_.resize(n, n), width_.resize(n, n);
  middle_.setFromTriplets(middle.begin(), middle.end());
  width_.setFromTriplets(width.begin(), width.end());
  return known;
}

bool Proof::invert() {
  const auto n = static_cast<Index>(inner_.size());
  if (n > most_verified)
    return fail(std::to_string(n) + " variables are between their bounds; it is tried up to " +
                std::to_string(most_verified));
  lcp::require_memory(4.0 * static_cast<double>(n * n) * sizeof(double), "the verification's full matrices");
  jacobian();
  const ::Eigen::PartialPivLU<Dense> lu{Dense(middle_)};
  C_ = lu.inverse();
  if (!C_.allFinite()) return fail("J of the variables between their bounds is singular at the point");
  absolute_C_ = C_.cwiseAbs();
  return true;
}

void Proof::newton() {
  const Vec zero = Vec::Zero(x_.size());
  double last = infinity;
  for (int step = 0; step < newton_steps; ++step) {
    evaluate(zero);
    Vec F(static_cast<Index>(inner_.size()));
    for (Index k = 0; k < F.size(); ++k) F[k] = midpoint(F_[at(inner_[at(k)])]);
    const Vec d = C_ * F;
    const double length = d.size() == 0 ? 0 : d.lpNorm<::Eigen::Infinity>();
    if (!(length < last / 2)) return;
    last = length;
    for (Index k = 0; k < d.size(); ++k) {
      const Index i = inner_[at(k)];
      x_[i] = lcp::project(mcp_.box(), i, x_[i] - d[k]);
    }
  }
}

Vec Proof::times_C(In v) const {
  Vec product = absolute_C_ * v;
  for (double& entry : product) entry = no_less(entry, v.size());
  return product;
}

/// |K(X) - x| < radius by enlarging the radius until it holds ("epsilon inflation").
bool Proof::krawczyk() {
  const auto n = static_cast<Index>(inner_.size());
  evaluate(Vec::Zero(x_.size()));
  Vec F(n), error(n);
  for (Index k = 0; k < n; ++k) {
    const Interval& range = F_[at(inner_[at(k)])];
    if (!range.bounded()) return fail("equation " + mcp_.equation_name(inner_[at(k)]) + " is not defined at the point");
    F[k] = midpoint(range);
    error[k] = radius_about(range, F[k]) + no_less(2 * static_cast<double>(n + 4) * unit * std::abs(F[k]), 1);
  }
  // |C F(x)|: as computed, with the rounding of its terms and what F is uncertain by.
  const Vec step = (C_ * F).cwiseAbs() + times_C(error);
  Vec radius = 2 * step + Vec::Constant(n, tiny);
  for (Index k = 0; k < n; ++k) radius[k] += 4 * unit * std::abs(x_[inner_[at(k)]]);
  Index worst = 0;
  for (int round = 0; round < inflations; ++round) {
    Vec full = Vec::Zero(x_.size());
    for (Index k = 0; k < n; ++k) full[inner_[at(k)]] = radius[k];
    evaluate(full);
    jacobian();
    // |I - C J| radius for every J in J(X): as computed with the middle, its rounding, and the width.
    Dense G = -(C_ * middle_);
    G.diagonal().array() += 1;
    const SpMat absolute_middle = middle_.cwiseAbs();
    Vec spread = absolute_middle * radius;
    const double rounding = 2 * static_cast<double>(n + 4) * unit;
    for (Index k = 0; k < n; ++k) spread[k] = no_less(rounding * no_less(spread[k], n), n);
    const Vec width = width_ * radius;
    for (Index k = 0; k < n; ++k) spread[k] += no_less(width[k], n);
    Vec reach = G.cwiseAbs() * radius + rounding * radius + times_C(spread) + step;
    for (Index k = 0; k < n; ++k) reach[k] = no_less(reach[k], n + 4);
    if ((reach.array() < radius.array()).all()) {
      radius_ = std::move(radius);
      return true;
    }
    (reach - radius).maxCoeff(&worst);
    if (!reach.allFinite()) break;
    radius = reach.cwiseMax(radius) * 1.5;
  }
  return fail("Krawczyk's operator does not map a box about the point into itself, " + name(n == 0 ? 0 : worst) +
              " is worst: J of the variables between their bounds is too near to a singular one, or not differentiable "
              "or known there");
}

bool Proof::within_bounds() {
  const Box& box = mcp_.box();
  for (std::size_t k = 0; k < inner_.size(); ++k) {
    const Index i = inner_[k];
    const double r = radius_[static_cast<Index>(k)];
    const Interval range = Interval(x_[i]) + Interval(-r, r);
    if (!(range.lower > box.lower[i] && range.upper < box.upper[i]))
      return fail("variable " + mcp_.variable_name(i) + " = " + number(x_[i]) + " is too near to its bound " +
                  number(range.lower > box.lower[i] ? box.upper[i] : box.lower[i]) + ", with F = 0");
  }
  return true;
}

bool Proof::signs() {
  Vec full = Vec::Constant(x_.size(), radius_.size() == 0 ? tiny : radius_.maxCoeff());
  for (std::size_t k = 0; k < inner_.size(); ++k) full[inner_[k]] = radius_[static_cast<Index>(k)];
  evaluate(full);
  const std::vector<char> known = jacobian();
  for (Index i = 0; i < x_.size(); ++i) {
    const Interval& range = F_[at(i)];
    if (known[at(i)] == 0)
      return fail("equation " + mcp_.equation_name(i) + " is not known to be defined and smooth around the point");
    const bool holds = set_[at(i)] == Set::Lower ? range.lower > 0 : set_[at(i)] == Set::Upper ? range.upper < 0 : true;
    if (!holds)
      return fail("variable " + mcp_.variable_name(i) + " is at its bound, and the sign of " + mcp_.equation_name(i) +
                  ", in [" + number_below(range.lower) + ", " + number_above(range.upper) + "], is not sure");
  }
  return true;
}

Verified Proof::run() {
  bool regular = true;
  for (int choice = 0; choice < choices && choose_sets() && regular; ++choice)
    if (regular = invert(); regular) newton();
  Verified out;
  out.unique = regular && krawczyk() && within_bounds() && signs();
  out.x = x_;
  out.active = x_.size() - static_cast<Index>(inner_.size());
  out.why_not = why_not_;
  if (!out.unique) return out;
  out.radius = Vec::Constant(x_.size(), radius_.size() == 0 ? 0 : radius_.maxCoeff());
  for (std::size_t k = 0; k < inner_.size(); ++k) out.radius[inner_[k]] = radius_[static_cast<Index>(k)];
  return out;
}

}  // namespace

Verified verify(const Mcp& mcp, In x) {
  if (x.size() != mcp.size() || !x.allFinite())
    throw std::invalid_argument(mcp.name() + ": verify: x has to have " + std::to_string(mcp.size()) +
                                " finite entries");
  const Enclosure* enclosure = mcp.enclosure();
  const auto affine = enclosure == nullptr ? affine_part(mcp) : nullptr;
  const std::unique_ptr<Enclosure> of_affine = affine ? affine_enclosure(*affine) : nullptr;
  if (of_affine) enclosure = of_affine.get();
  if (enclosure == nullptr) {
    Verified out{.x = x};
    out.why_not = "the problem gives no ranges of F and J over boxes: affine problems and .nl models do";
    return out;
  }
  return Proof(mcp, *enclosure, lcp::project(mcp.box(), x)).run();
}

Verified verify(const Mcp& mcp, double tol, Result& result) {
  Verified verified = verify(mcp, result.x);
  if (!verified.unique) return verified;
  const Residual there = residual(mcp, verified.x);
  Vec F(verified.x.size());
  if (!(there.natural <= std::max(result.residual.natural, tol)) || !mcp.eval(verified.x, F)) {
    verified.unique = false;
    verified.why_not = "a solution is enclosed, and the middle of its box does not meet the tolerance";
    return verified;
  }
  result.x = verified.x;
  result.F = F;
  result.residual = there;
  return verified;
}

}  // namespace perp::ncp

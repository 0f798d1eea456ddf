// SPDX-License-Identifier: Apache-2.0
#include "ncp/analysis/function_classes.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <vector>

#include "lcp/dense_factors.hpp"
#include "ncp/analysis/class_proofs.hpp"
#include "ncp/interval/enclosure.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/problem/affine_enclosure.hpp"
#include "ncp/problem/words.hpp"

namespace perp::ncp {
namespace {

using lcp::Answer;

void prove(FunctionProperty& property, const std::string& reason) {
  if (property.answer == Answer::NotDecided) property = {Answer::Yes, reason, {}, {}};
}

/// Proofs from the ranges of J over the box.
void prove_all(const Mcp& mcp, const Enclosure& enclosure, const FunctionClassOptions& options, FunctionClasses& out) {
  const JacobianRange range = jacobian_range(mcp, enclosure);
  if (range.rows.empty()) return;
  if (!range.unknown.empty()) {
    for (FunctionProperty* property : {&out.monotone, &out.p0, &out.p}) property->reason = range.unknown;
    return;
  }
  const Definiteness definite = definiteness(range, options.dense_to);
  if (definite.modulus > 0) {
    out.modulus = definite.modulus;
    const std::string reason = "J + J' has no eigenvalue below " + number_below(2 * definite.modulus) + " on the box";
    for (FunctionProperty* property :
         {&out.strongly_monotone, &out.strictly_monotone, &out.monotone, &out.uniform_p, &out.p, &out.p0})
      prove(*property, reason);
    return;
  }
  if (definite.semidefinite.empty()) {
    out.monotone.reason = definite.why_not;
  } else {
    prove(out.monotone, definite.semidefinite);
    prove(out.p0, "monotone");
  }
  if (const std::string reason = uniform_p(range, options); !reason.empty()) {
    for (FunctionProperty* property : {&out.uniform_p, &out.p, &out.p0}) prove(*property, reason);
  } else if (dominant(range)) {
    prove(out.p0, "every row of J is diagonally dominant with J_ii >= 0, on the box");
  }
}

/// F at points, as ranges that hold it.
class Values {
 public:
  Values(const Mcp& mcp, const Enclosure* enclosure) : mcp_(mcp), enclosure_(enclosure) {}

  bool proven() const { return enclosure_ != nullptr; }
  /// False where one of them, or F itself, may be undefined.
  bool at_point(In x, std::vector<Interval>& F) const {
    F.resize(at(x.size()));
    if (enclosure_ != nullptr) {
      const std::vector<Interval> X(x.begin(), x.end());
      std::vector<char> defined(F.size());
      enclosure_->values(X, F, defined);
      if (std::ranges::find(defined, 0) != defined.end()) return false;
    } else {
      Vec f(x.size());
      if (!mcp_.eval(x, f)) return false;
      const double size = std::max(1.0, f.lpNorm<::Eigen::Infinity>());
      for (Index i = 0; i < x.size(); ++i) F[at(i)] = Interval(f[i]) + Interval(-1e-10 * size, 1e-10 * size);
    }
    return std::ranges::all_of(F, [](const Interval& f) { return f.bounded(); });
  }

 private:
  const Mcp& mcp_;
  const Enclosure* enclosure_;
};

/// Two points, and what they refute.
void refute(const Values& values, const Vec& x, const Vec& y, FunctionClasses& out) {
  const std::string computed = values.proven() ? "" : ", with F as its function computes it";
  std::vector<Interval> Fx, Fy;
  if (x == y || !values.at_point(x, Fx) || !values.at_point(y, Fy)) return;
  Interval form = 0;
  double largest = -infinity;
  for (Index i = 0; i < x.size(); ++i) {
    if (x[i] == y[i]) continue;
    const Interval product = (Interval(x[i]) - y[i]) * (Fx[at(i)] - Fy[at(i)]);
    form += product;
    largest = std::max(largest, product.upper);
  }
  const auto no = [&](FunctionProperty& property, bool holds, const std::string& reason) {
    if (holds && property.answer == Answer::NotDecided) property = {Answer::No, reason, x, y};
  };
  const std::string sum = "two points have (x - y)'(F(x) - F(y)) <= " + number_above(form.upper) + computed;
  no(out.monotone, form.upper < 0, sum);
  no(out.strictly_monotone, form.upper <= 0, sum);
  no(out.strongly_monotone, form.upper <= 0, sum);
  const std::string most =
      "two points have (x_i - y_i) (F_i(x) - F_i(y)) <= " + number_above(largest) + " for every i" + computed;
  no(out.p0, largest < 0, most);
  no(out.p, largest <= 0, most);
  no(out.uniform_p, largest <= 0, most);
}

/// Directions in which J at x breaks the inequalities of matrices.
std::vector<Vec> bad_directions(const SpMat& J, const FunctionClassOptions& options) {
  std::vector<Vec> directions;
  if (J.rows() <= options.dense_to / 3) {
    const ::Eigen::MatrixXd M(J);
    const ::Eigen::SelfAdjointEigenSolver<::Eigen::MatrixXd> eigen(M + M.transpose());
    if (eigen.info() == ::Eigen::Success) directions.emplace_back(eigen.eigenvectors().col(0));
  }
  if (J.rows() <= options.minors_to) {
    const lcp::Diagnosis d = lcp::classify(J);
    for (const lcp::Property* property : {&d.p, &d.p0})
      if (property->vector.size() == J.rows()) directions.push_back(property->vector);
  }
  return directions;
}

/// Pairs about points of the box, along the directions in which J there is worst.
void refute_all(const Mcp& mcp, const Enclosure* enclosure, In x0, const FunctionClassOptions& options,
                FunctionClasses& out) {
  const Values values(mcp, enclosure);
  const Box& box = mcp.box();
  std::mt19937 random(options.seed);
  std::normal_distribution<double> normal;
  SpMat J = mcp.jacobian_pattern();
  for (int sample = 0; sample < options.samples; ++sample) {
    Vec x = lcp::project(box, x0);
    const double size = sample == 0 ? 0 : std::ldexp(1, sample % 8 - 3);
    for (Index i = 0; i < x.size(); ++i)
      x[i] = lcp::project(box, i, x[i] + size * (1 + std::abs(x[i])) * normal(random));
    std::vector<Vec> directions;
    if (mcp.jacobian(x, J) && J.coeffs().allFinite()) directions = bad_directions(J, options);
    directions.push_back(Vec::NullaryExpr(x.size(), [&](Index) { return normal(random); }));
    for (const Vec& d : directions)
      for (const double length : {1.0, 1e-2, 1e-4}) {
        const double t = length * (1 + x.lpNorm<::Eigen::Infinity>()) / std::max(d.lpNorm<::Eigen::Infinity>(), 1e-300);
        refute(values, lcp::project(box, x + t * d), lcp::project(box, x - t * d), out);
      }
  }
}

}  // namespace

std::array<std::pair<std::string_view, const FunctionProperty*>, 6> FunctionClasses::all() const {
  return {{{"monotone", &monotone},
           {"strictly monotone", &strictly_monotone},
           {"strongly monotone", &strongly_monotone},
           {"P0-function", &p0},
           {"P-function", &p},
           {"uniform P-function", &uniform_p}}};
}

FunctionClasses function_classes(const Mcp& mcp, In x0, const FunctionClassOptions& options) {
  if (x0.size() != mcp.size() || !x0.allFinite())
    throw std::invalid_argument(mcp.name() + ": function_classes: x0 has to have " + std::to_string(mcp.size()) +
                                " finite entries");
  const Enclosure* enclosure = mcp.enclosure();
  const auto affine = enclosure == nullptr ? affine_part(mcp) : nullptr;
  const std::unique_ptr<Enclosure> of_affine = affine ? affine_enclosure(*affine) : nullptr;
  if (of_affine) enclosure = of_affine.get();
  FunctionClasses out;
  if (enclosure != nullptr) prove_all(mcp, *enclosure, options, out);
  if (out.strongly_monotone.answer != Answer::Yes) refute_all(mcp, enclosure, x0, options, out);
  for (const auto& [name, property] : out.all())
    if (property->answer == Answer::NotDecided && property->reason.empty())
      const_cast<FunctionProperty*>(property)->reason =
          enclosure == nullptr ? "no two points refute it; the problem gives no ranges to prove it by"
                               : "neither proven by the ranges of J nor refuted by two points";
  return out;
}

}  // namespace perp::ncp

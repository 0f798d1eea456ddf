// SPDX-License-Identifier: Apache-2.0
#include "ncp/reformulation/smoothing_function.hpp"

#include <cassert>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "lcp/wide_arithmetic.hpp"
#include "ncp/problem/fields.hpp"

namespace perp::ncp {
namespace {

using lcp::largest;
using lcp::saturated;

SmoothValue neural_at(double a, double b, double mu) {
  a = saturated(a);
  b = saturated(b);
  const double t = a == b ? 0 : std::abs(a - b) / mu;  // may be infinite
  const double e = std::exp(-t);
  const double plus = std::log1p(e);
  const double small = e / (1 + e);  // the partial of the larger argument
  const double large = 1 / (1 + e);
  const double turned = e > 0 ? t * small : 0;
  return {saturated(std::min(a, b) - mu * plus), a <= b ? large : small, a <= b ? small : large, -plus - turned};
}

/// a, b, mu times 2^-k, the largest of them in [1/2, 1), or all 0.
struct Scaled {
  double a, b, mu;
  int k = 0;
  Scaled(double a0, double b0, double mu0) {
    a0 = saturated(a0);
    b0 = saturated(b0);
    (void)std::frexp(std::max({std::abs(a0), std::abs(b0), mu0}), &k);
    a = std::ldexp(a0, -k);
    b = std::ldexp(b0, -k);
    mu = std::ldexp(mu0, -k);
  }
  /// ab - mu^2, both products with their rounding errors (Kahan).
  double gap() const {
    const double p = a * b;
    const double q = mu * mu;
    return (p - q) + (std::fma(a, b, -p) - std::fma(mu, mu, -q));
  }
  double unscaled(double x) const { return saturated(std::ldexp(x, k)); }
};

SmoothValue chks_at(double a, double b, double mu) {
  const Scaled s(a, b, mu);
  const double sum = s.a + s.b;
  const double difference = s.a - s.b;
  const double R = std::hypot(difference, 2 * s.mu);
  if (R == 0) return {saturated(a), 0.5, 0.5, -1};
  const double phi = sum > 0 ? 2 * s.gap() / (sum + R) : (sum - R) / 2;
  const auto partial = [&](double d) {  // (1 - d / R) / 2
    return d > 0 ? (2 * s.mu / R) * (s.mu / (R + d)) : (R - d) / (2 * R);
  };
  return {mu > 0 ? s.unscaled(phi) : std::min(saturated(a), saturated(b)), partial(difference), partial(-difference),
          -2 * s.mu / R};
}

SmoothValue smoothed_fischer_burmeister_at(double a, double b, double mu) {
  const Scaled s(a, b, mu);
  const double sum = s.a + s.b;
  const double R = std::hypot(s.a, s.b, std::numbers::sqrt2 * s.mu);
  if (R == 0) return {0, 1, 1, -std::numbers::sqrt2};
  const double phi = sum > 0 ? 2 * s.gap() / (sum + R) : sum - R;
  const auto partial = [&](double x, double y) {  // 1 - x / R
    const double rest = std::hypot(y, std::numbers::sqrt2 * s.mu);
    return x > 0 ? (rest / R) * (rest / (R + x)) : (R - x) / R;
  };
  return {s.unscaled(phi), partial(s.a, s.b), partial(s.b, s.a), -2 * s.mu / R};
}

SmoothValue row(const SmoothingFunction& s, double l, double u, double x, double F, double mu) {
  if (l == u) return {saturated(x - l), 1, 0, 0};
  const bool has_lower = l > -infinity;
  const bool has_upper = u < infinity;
  if (!has_lower && !has_upper) return {F, 0, 1, 0};
  if (!has_upper) return s.at(x - l, F, mu);
  const SmoothValue upper = s.at(u - x, -F, mu);
  if (!has_lower) return {-upper.phi, upper.da, upper.db, -upper.dmu};
  const SmoothValue both = s.at(x - l, -upper.phi, mu);
  return {both.phi, both.da + both.db * upper.da, both.db * upper.db, both.dmu - both.db * upper.dmu};
}

}  // namespace

SmoothingFunction neural() {
  return {.name = "neural",
          .formula = "min(a, b) - mu log(1 + exp(-|a - b| / mu))",
          .kappa = std::numbers::ln2,
          .at = neural_at,
          .limit = natural_min(),
          .reference = "Chen & Mangasarian, Comput. Optim. Appl. 5 (1996) 97"};
}

SmoothingFunction chks() {
  return {.name = "chks",
          .formula = "(a + b - sqrt((a - b)^2 + 4 mu^2)) / 2",
          .kappa = 1,
          .at = chks_at,
          .limit = natural_min(),
          .reference = "Chen & Harker, SIAM J. Matrix Anal. Appl. 14 (1993) 1168; Kanzow, ibid. 17 (1996) 851"};
}

SmoothingFunction smoothed_fischer_burmeister() {
  return {.name = "smoothed-fischer-burmeister",
          .formula = "a + b - sqrt(a^2 + b^2 + 2 mu^2)",
          .kappa = std::numbers::sqrt2,
          .at = smoothed_fischer_burmeister_at,
          .limit = fischer_burmeister(),
          .reference = "Kanzow, SIAM J. Matrix Anal. Appl. 17 (1996) 851"};
}

std::span<const SmoothingFunction> smoothing_functions() {
  static const std::vector<SmoothingFunction> all{neural(), chks(), smoothed_fischer_burmeister()};
  return all;
}

SmoothingFunction smoothing_function(std::string_view name) {
  std::string known;
  for (const SmoothingFunction& s : smoothing_functions()) {
    if (s.name == name) return s;
    known += " " + s.name;
  }
  throw std::invalid_argument("there is no smoothing '" + std::string(name) + "'; known:" + known);
}

void describe(SmoothingFunction& s, Fields& f) {
  f.choice("smoothing_function", &s, smoothing_functions(),
           "the smooth approximation of the reformulation; 'perp cfunctions' explains them");
  f.check(s.at && s.limit.at, "smoothing_function has no function");
}

void reformulate(const SmoothingFunction& s, const Box& box, In x, In F, double mu, SmoothReformulation& out) {
  assert(mu >= 0);
  const Index n = x.size();
  for (Vec* v : {&out.Phi, &out.Da, &out.Db, &out.Dmu}) v->resize(n);
  for (Index i = 0; i < n; ++i) {
    const SmoothValue v = row(s, box.lower[i], box.upper[i], x[i], F[i], mu);
    out.Phi[i] = v.phi;
    out.Da[i] = v.da;
    out.Db[i] = v.db;
    out.Dmu[i] = v.dmu;
  }
}

void reformulate(const SmoothingFunction& s, const Box& box, In x, In F, double mu, Out Phi) {
  assert(mu >= 0);
  for (Index i = 0; i < x.size(); ++i) Phi[i] = row(s, box.lower[i], box.upper[i], x[i], F[i], mu).phi;
}

}  // namespace perp::ncp

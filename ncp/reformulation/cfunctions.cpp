// SPDX-License-Identifier: Apache-2.0
// The catalogue of C-functions.
#include <sstream>
#include <stdexcept>
#include <vector>

#include "lcp/wide_arithmetic.hpp"
#include "ncp/problem/fields.hpp"
#include "ncp/reformulation/cfunction.hpp"

namespace perp::ncp {
namespace {

using lcp::product;
using lcp::saturated;
using lcp::Wide;
using lcp::wide_ldexp;
using lcp::wide_product;

const std::string uniform_p = "uniform P-functions; affine F with an R0-matrix";
const std::string uniform_p_or_monotone = uniform_p + "; monotone F with a strictly feasible point";
const std::string p0 = "P0-functions";
const std::vector<double> decades{0.01, 0.1, 1, 10, 100};

/// Throws unless the value lies in the parameter's range.
CParameter checked(std::string_view function, CParameter p) {
  if (p.value > p.low && p.value < p.high) return p;
  std::ostringstream what;
  what << function << ": " << p.name << " is " << p.value << "; it must be ";
  if (p.high < infinity)
    what << "in (" << p.low << ", " << p.high << ")";
  else
    what << "greater than " << p.low << " and finite";
  throw std::invalid_argument(what.str());
}

/// min(ra a, rb b); the partials are of the smaller argument, of the one that gets smaller along h where they tie.
CValue weighted_min(double ra, double rb, double a, double b, double ha, double hb) {
  const double wa = product({ra, saturated(a)});
  const double wb = product({rb, saturated(b)});
  if (wa < wb || (wa == wb && ra * ha <= rb * hb)) return {wa, ra, 0};
  return {wb, 0, rb};
}

CValue min_at(double a, double b, double ha, double hb) {
  if (a < b || (a == b && ha <= hb)) return {saturated(a), 1, 0};
  return {saturated(b), 0, 1};
}

/// On the side of v = 0 that the direction h leads to; with h = 0 not the positive one.
bool positive(double v, double h) { return v > 0 || (v == 0 && h > 0); }

CValue penalised_at(double lambda, double a, double b, double ha, double hb) {
  const CValue fb = lcp::fischer_burmeister(a, b, ha, hb, lambda);
  CValue v{fb.phi, lambda * fb.da, lambda * fb.db};
  if (!positive(a, ha) || !positive(b, hb)) return v;
  const double weight = 1 - lambda;
  a = saturated(a);
  b = saturated(b);
  v.phi = saturated(v.phi + product({weight, a, b}));
  v.da = saturated(v.da + product({weight, b}));
  v.db = saturated(v.db + product({weight, a}));
  return v;
}

/// a and b times 2^-k, the larger of them in [1/2, 1).
struct Pair {
  double a, b;
  int k = 0;
  Pair(double a0, double b0) {
    (void)std::frexp(std::max(std::abs(a0), std::abs(b0)), &k);
    a = std::ldexp(a0, -k);
    b = std::ldexp(b0, -k);
  }
};

/// ab where a + b >= 0, else -(a^2 + b^2) / 2.
CValue evtushenko_purtov_at(double a, double b, double /*ha*/, double /*hb*/) {
  a = saturated(a);
  b = saturated(b);
  if (a + b >= 0) return {product({a, b}), b, a};
  const Pair p(a, b);
  return {wide_ldexp(-(p.a * p.a + p.b * p.b) / 2, 2 * p.k), -a, -b};
}

/// With r = sqrt((a - b)^2 + lambda ab) = sqrt((a + b)^2 - (4 - lambda) ab) and c = 1 - lambda/2:
///     phi = (4 - lambda) ab / (a + b + r),   d phi / da = 1 - (a - cb) / r,   r^2 - (a - cb)^2 = (1 - c^2) b^2,
/// of both forms the one that adds terms of one sign.
CValue kanzow_kleinmichel_at(double lambda, double a, double b, double ha, double hb) {
  const double at_infinity = 2 - lambda / 2;
  if (a == infinity) return {product({at_infinity, saturated(b)}), 0, at_infinity};
  if (b == infinity) return {product({at_infinity, saturated(a)}), at_infinity, 0};
  a = saturated(a);
  b = saturated(b);
  if (a == 0 && b == 0) {
    const bool none = ha == 0 && hb == 0;
    CValue v = kanzow_kleinmichel_at(lambda, none ? 1 : ha, none ? 1 : hb, 0, 0);
    v.phi = 0;
    return v;
  }
  const Pair p(a, b);
  const double sum = p.a + p.b;
  const double difference = p.a - p.b;
  const double ab = p.a * p.b;
  const bool same = ab >= 0;
  const double r =
      same ? std::hypot(difference, std::sqrt(lambda) * std::sqrt(ab)) : std::hypot(sum, std::sqrt((4 - lambda) * -ab));
  const double least = std::min(a, b);
  double phi = 0;
  if (sum <= 0)
    phi = wide_ldexp(sum - r, p.k);
  else if (least != 0)
    phi = product({4 - lambda, least, std::max(p.a, p.b) / (sum + r)});
  const double sine = std::sqrt(lambda * (4 - lambda)) / 2;  // sqrt(1 - c^2)
  const auto partial = [&](double towards, double other) {   // 1 - (x - c y) / r
    const double along = same ? towards + lambda / 2 * other : sum - (4 - lambda) / 2 * other;
    return along > 0 ? (sine * other / r) * (sine * other / (r + along)) : (r - along) / r;
  };
  return {phi, partial(difference, p.b), partial(-difference, p.a)};
}

CValue luo_tseng_at(double root_alpha, double a, double b, double ha, double hb) {
  if (ha == 0 && hb == 0) ha = hb = -1;  // the element from outside is the better one
  const CValue fb = lcp::fischer_burmeister(a, b, ha, hb);
  a = saturated(a);
  b = saturated(b);
  if (positive(a, ha) && positive(b, hb))
    return {product({root_alpha, a, b}), product({root_alpha, b}), product({root_alpha, a})};
  if (a >= 0 || b >= 0) return fb;
  // -sqrt(P^2 + Q^2), P = sqrt(alpha) ab, Q = -phi_FB
  const Pair p(a, b);
  const double Q = std::hypot(p.a, p.b) - p.a - p.b;
  const Wide P = wide_product({root_alpha, a, b});
  const double ratio = std::ldexp(P.m / Q, P.e - p.k);
  const double secant = std::hypot(1.0, ratio);
  const double from_P = std::isinf(ratio) ? 1 : ratio / secant;
  const double h = std::isinf(ratio) ? P.value() : wide_ldexp(Q * secant, p.k);
  return {-h, saturated(product({from_P, root_alpha, -b}) + fb.da / secant),
          saturated(product({from_P, root_alpha, -a}) + fb.db / secant)};
}

CProperties piecewise_linear() {
  return {.level_sets = uniform_p,
          .stationary_points = "F with a P-matrix as Jacobian (elements of the B-subdifferential)"};
}

}  // namespace

// CProperties is named where it stands amid others: of braces alone g++ 12 destroys the members twice if what comes
// after them throws.
CFunction natural_min() {
  return {.name = "min",
          .formula = "min(a, b)",
          .smooth_merit = false,
          .at = min_at,
          .properties = piecewise_linear(),
          .reference = "Pang, Math. Oper. Research 15 (1990) 311"};
}

CFunction min_rho_b(double rho) {
  return {.name = "min-rho-b",
          .formula = "a - max(0, a - rho b)",
          .smooth_merit = false,
          .at = [rho](double a, double b, double ha, double hb) { return weighted_min(1, rho, a, b, ha, hb); },
          .parameter = checked("min-rho-b", {.name = "rho", .value = rho, .grid = decades}),
          .with_parameter = min_rho_b,
          .properties = piecewise_linear(),
          .reference = "Acary & Brogliato, Numerical Methods for Nonsmooth Dynamical Systems (Springer 2008)"};
}

CFunction min_rho_a(double rho) {
  return {.name = "min-rho-a",
          .formula = "b - max(0, b - rho a)",
          .smooth_merit = false,
          .at = [rho](double a, double b, double ha, double hb) { return weighted_min(rho, 1, a, b, ha, hb); },
          .parameter = checked("min-rho-a", {.name = "rho", .value = rho, .grid = decades}),
          .with_parameter = min_rho_a,
          .properties = piecewise_linear(),
          .reference = "Acary & Brogliato, Numerical Methods for Nonsmooth Dynamical Systems (Springer 2008)"};
}

CFunction fischer_burmeister() {
  return {.name = "fischer-burmeister",
          .formula = "a + b - sqrt(a^2 + b^2)",
          .smooth_merit = true,
          .at = [](double a, double b, double ha, double hb) { return lcp::fischer_burmeister(a, b, ha, hb); },
          .value = lcp::fischer_burmeister_value,
          .properties = CProperties{.level_sets = uniform_p, .stationary_points = p0},
          .reference = "Fischer, Optimization 24 (1992) 269"};
}

CFunction penalised_fischer_burmeister(double lambda) {
  return {.name = "penalised-fischer-burmeister",
          .formula = "lambda (a + b - sqrt(a^2 + b^2)) + (1 - lambda) max(0, a) max(0, b)",
          .smooth_merit = true,
          .at = [lambda](double a, double b, double ha, double hb) { return penalised_at(lambda, a, b, ha, hb); },
          .parameter = checked("penalised-fischer-burmeister",
                               {.name = "lambda", .value = lambda, .high = 1, .grid = {0.5, 0.8, 0.95, 0.99}}),
          .with_parameter = penalised_fischer_burmeister,
          .properties = CProperties{.level_sets = uniform_p_or_monotone, .stationary_points = p0},
          .reference = "Chen, Chen & Kanzow, Math. Programming 88 (2000) 211"};
}

CFunction evtushenko_purtov() {
  return {.name = "evtushenko-purtov",
          .formula = "ab - min(0, a + b)^2 / 2",
          .smooth_merit = true,
          .at = evtushenko_purtov_at,
          .properties = CProperties{.singular_at_degenerate = true,
                                    .level_sets = uniform_p_or_monotone,
                                    .stationary_points = "none: not even F(x) = x + 2"},
          .reference = "Evtushenko & Purtov, Soviet Math. Doklady 30 (1984) 313"};
}

CFunction kanzow_kleinmichel(double lambda) {
  return {
      .name = "kanzow-kleinmichel",
      .formula = "a + b - sqrt((a - b)^2 + lambda ab)",
      .smooth_merit = true,
      .at = [lambda](double a, double b, double ha, double hb) { return kanzow_kleinmichel_at(lambda, a, b, ha, hb); },
      .parameter = checked("kanzow-kleinmichel",
                           {.name = "lambda", .value = lambda, .high = 4, .grid = {0.1, 0.5, 1.0, 2.0, 3.0}}),
      .with_parameter = kanzow_kleinmichel,
      .properties = CProperties{.level_sets = uniform_p, .stationary_points = p0},
      .reference = "Kanzow & Kleinmichel, Comput. Optim. Appl. 11 (1998) 227"};
}

CFunction luo_tseng(double alpha) {
  return {.name = "luo-tseng",
          .formula = "sign(min(a, b)) sqrt(alpha max(0, ab)^2 + min(0, a + b - sqrt(a^2 + b^2))^2)",
          .smooth_merit = true,
          .at = [root = std::sqrt(alpha)](double a, double b, double ha,
                                          double hb) { return luo_tseng_at(root, a, b, ha, hb); },
          .parameter = checked("luo-tseng", {.name = "alpha", .value = alpha, .grid = decades}),
          .with_parameter = luo_tseng,
          .properties =
              CProperties{.singular_at_degenerate = true, .level_sets = uniform_p_or_monotone, .stationary_points = p0},
          .reference =
              "Luo & Tseng, in: Complementarity and Variational Problems (SIAM 1997) 204; "
              "Kanzow, Yamashita & Fukushima, J. Optim. Theory Appl. 94 (1997) 115"};
}

std::span<const CFunction> cfunctions() {
  static const std::vector<CFunction> all{
      natural_min(),       min_rho_b(),          min_rho_a(), fischer_burmeister(), penalised_fischer_burmeister(),
      evtushenko_purtov(), kanzow_kleinmichel(), luo_tseng()};
  return all;
}

std::span<const CFunction> cfunction_grid() {
  static const std::vector<CFunction> all = [] {
    std::vector<CFunction> list;
    for (const CFunction& c : cfunctions())
      if (c.parameter)
        for (const double value : c.parameter->grid) list.push_back(c.with_parameter(value));
    return list;
  }();
  return all;
}

CFunction cfunction(std::string_view name, std::optional<double> parameter) {
  std::string known;
  for (const CFunction& c : cfunctions()) {
    if (c.name == name) {
      if (!parameter) return c;
      if (c.parameter) return c.with_parameter(*parameter);
      throw std::invalid_argument(c.name + " has no parameter; " + std::to_string(*parameter) + " was given");
    }
    known += " " + c.name;
  }
  throw std::invalid_argument("there is no C-function '" + std::string(name) + "'; known:" + known);
}

void describe(CFunction& c, Fields& f) {
  f.choice("cfunction", &c, cfunctions(), "the C-function of the reformulation; 'perp cfunctions' explains them");
  f.add("cfunction_parameter",
        Parameter{[&c] { return c.parameter ? std::optional(c.parameter->value) : std::nullopt; },
                  [&c](double value) { c = cfunction(c.name, value); }},
        "parameter of the C-function: lambda, rho or alpha");
  f.check(static_cast<bool>(c.at), "cfunction has no function");
}

}  // namespace perp::ncp

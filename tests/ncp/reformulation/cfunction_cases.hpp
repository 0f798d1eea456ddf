// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The C-functions with several parameters each, and the pairs (a, b) they are tested at.
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "ncp/reformulation/cfunction.hpp"
#include "support/matrices.hpp"

namespace perp::ncp::cases {

using support::Random;

inline constexpr double eps = std::numeric_limits<double>::epsilon();
inline constexpr double tiny = std::numeric_limits<double>::denorm_min();
inline constexpr double huge = std::numeric_limits<double>::max();

/// Every function of the catalogue, those with a parameter also near the ends of its range.
inline std::vector<CFunction> functions() {
  std::vector<CFunction> all(cfunctions().begin(), cfunctions().end());
  for (const double lambda : {0.01, 0.8}) all.push_back(penalised_fischer_burmeister(lambda));
  for (const double lambda : {1e-6, 0.3, 3.9999}) all.push_back(kanzow_kleinmichel(lambda));
  for (const double rho : {1e-5, 300.0}) {
    all.push_back(min_rho_a(rho));
    all.push_back(min_rho_b(rho));
    all.push_back(luo_tseng(rho));
  }
  return all;
}

/// Values at which formulas with squares and differences break: the ends of the range, where squares under- and
/// overflow, where 1 + a is 1, neighbours.
inline std::vector<double> adversarial() {
  std::vector<double> values{0, -0.0};
  for (const double v :
       {tiny, 1e-310, 1e-300, 1e-160, 1e-17, 1e-12, 1e-8, 1.0, 1 + eps, 1e3, 1e8, 1e160, 1e300, 1e308, huge}) {
    values.push_back(v);
    values.push_back(-v);
  }
  return values;
}

/// Random signs and magnitudes over the whole range.
inline double anywhere(Random& random) {
  const double sign = random.chance(0.5) ? 1 : -1;
  return sign * std::pow(10, random.chance(0.5) ? random.uniform(-307, 307) : random.uniform(-3, 3));
}

/// All pairs of adversarial values, and `random_pairs` more: a tenth of them with |a| = |b|, a tenth with |a| and |b|
/// alike but for the last digits.
inline std::vector<std::pair<double, double>> places(int random_pairs = 100000) {
  std::vector<std::pair<double, double>> all;
  for (const double a : adversarial())
    for (const double b : adversarial()) all.emplace_back(a, b);
  Random random(1);
  for (int k = 0; k < random_pairs; ++k) {
    const double a = anywhere(random);
    const double sign = random.chance(0.5) ? 1 : -1;
    const double close = sign * a * (1 + std::pow(10, random.uniform(-16, -1)));
    all.emplace_back(a, random.chance(0.1) ? sign * a : random.chance(0.1) ? close : anywhere(random));
  }
  return all;
}

/// A direction, at times along an axis or the diagonal.
inline std::pair<double, double> direction(Random& random) {
  switch (random.integer(0, 9)) {
    case 0:
      return {1, 0};
    case 1:
      return {0, -1};
    case 2:
      return {-1, -1};
    default:
      return {random.normal(), random.normal()};
  }
}

}  // namespace perp::ncp::cases

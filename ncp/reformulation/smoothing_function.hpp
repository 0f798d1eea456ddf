// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Smoothings phi_mu(a, b) of C-functions: infinitely often differentiable for mu > 0, with
///     |phi_mu(a, b) - phi_0(a, b)| <= kappa mu,
/// phi_0 a C-function with the sign of the minimum (ncp/reformulation/cfunction.hpp), and 0 < d/da, d/db for mu > 0, so
/// that Da + Db J is nonsingular for every P0-matrix J. Jacobian consistency (Chen, Qi & Sun 1998): for mu -> 0 the
/// partials at fixed (a, b) tend to phi_0's, at kinks to an element of Clarke's subdifferential; at(a, b, 0) answers
/// that limit.
///
/// Rows of a box, by Billups' composition as for C-functions: F; phi_mu(x - l, F); -phi_mu(u - x, -F);
/// phi_mu(x - l, -phi_mu(u - x, -F)); x - l. They are within 3 kappa mu of the row for mu = 0.
///
/// Arithmetic: CHKS and Fischer-Burmeister are within a few units in the last place of phi_mu, the neural function of
/// |min(a, b)| + mu, as long as the least argument is more than 1e-290 of the largest; nothing infinite comes out.
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "ncp/reformulation/cfunction.hpp"

namespace perp::ncp {

struct SmoothValue {
  double phi = 0;
  double da = 0;
  double db = 0;
  double dmu = 0;  ///< in [-kappa, 0]
};

struct SmoothingFunction {
  std::string name;
  std::string formula;
  double kappa = 1;
  std::function<SmoothValue(double a, double b, double mu)> at;  ///< pre: mu >= 0
  CFunction limit{};                                             ///< phi_0
  std::string reference{};
};

/// a - p(a - b),  p(x) = x + mu log(1 + exp(-x / mu)), the integral of the sigmoid function 1 / (1 + exp(-x / mu)); min
/// in the limit, kappa = log 2. mu is 1 / alpha of Chen & Mangasarian (1996).
SmoothingFunction neural();
/// (a + b - sqrt((a - b)^2 + 4 mu^2)) / 2 (Chen & Harker 1993; Kanzow 1996; Smale 1987): zero where a, b > 0, ab =
/// mu^2, the central path of interior-point methods; min in the limit, kappa = 1.
SmoothingFunction chks();
/// a + b - sqrt(a^2 + b^2 + 2 mu^2) (Kanzow 1996): zero where CHKS is; Fischer-Burmeister in the limit, kappa =
/// sqrt(2).
SmoothingFunction smoothed_fischer_burmeister();

/// All three: "neural", "chks", "smoothed-fischer-burmeister".
std::span<const SmoothingFunction> smoothing_functions();
/// Throws std::invalid_argument for an unknown name.
SmoothingFunction smoothing_function(std::string_view name);

void describe(SmoothingFunction& function, Fields& fields);

/// Phi_mu at (x, F), its Jacobian Da + Db J and its derivative in mu.
struct SmoothReformulation {
  Vec Phi, Da, Db, Dmu;
};
/// Pre: mu >= 0.
void reformulate(const SmoothingFunction& s, const Box& box, In x, In F, double mu, SmoothReformulation& out);
/// Phi_mu alone.
void reformulate(const SmoothingFunction& s, const Box& box, In x, In F, double mu, Out Phi);

}  // namespace perp::ncp

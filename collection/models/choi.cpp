// SPDX-License-Identifier: Apache-2.0
/// Choi, DeSarbo & Harker 1990: prices of competing brands under logit demand.
#include <algorithm>
#include <cmath>

#include "collection/base/build.hpp"
#include "collection/models/choi_tables.hpp"
#include "collection/models/problems.hpp"

namespace perp::ncp::collection {

namespace {

using namespace choi_tables;
constexpr double chi = 3;           // scale of the logit model
constexpr int fixed_brand = 8 - 1;  // generic, not a player: its price is given
constexpr double fixed_price = .199;

/// DU_ij without the price: -chi (v_i |x_j - y_i|^2 + b_i).
double disutility(int i, int j) {
  double square = 0;
  for (int k = 0; k < ingredients; ++k) square += (x[j][k] - y[i][k]) * (x[j][k] - y[i][k]);
  return -chi * (v[i] * square + b[i]);
}

}  // namespace

/// With w_i = -chi w0_i, E_ij = exp(w_i p_j + DU_ij) and S_i = 1 + sum_j E_ij, consumer i buys brand j with probability
/// s_ij = E_ij / S_i, and the profit (p_j - c_j) mean_i s_ij of brand j is stationary in p_j where
///     F_j = -(1/30) sum_i s_ij (1 + (p_j - c_j) w_i (1 - s_ij)) = 0;   p_j >= c_j; the price of brand 8 is fixed.
/// F fades exponentially at high prices: with all prices at 10 it is below 1e-8 at the players, far from any
/// equilibrium. exp is taken relative to the largest exponent of the consumer, so that no price overflows it.
Problem choi() {
  const Vec cost = Eigen::Map<const Vec>(c, brands);
  Box box{cost, Vec::Constant(brands, infinity)};
  box.lower[fixed_brand] = box.upper[fixed_brand] = fixed_price;
  Problem p;
  p.mcp = make_problem({"choi", box, indexed("p", brands), indexed("marginal_loss", brands)},
                       [](const auto& z, const auto& F) {
                         using std::exp;
                         using T = Number<decltype(z)>;
                         for (auto& row : F) row = 0;
                         for (int i = 0; i < consumers; ++i) {
                           const double w = -chi * w0[i];
                           T E[brands];
                           double largest = 0;  // of the exponents; 0 is that of "buys nothing"
                           for (int j = 0; j < brands; ++j) {
                             E[j] = w * z[j] + disutility(i, j);
                             largest = std::max(largest, value(E[j]));
                           }
                           T S = exp(-largest);
                           for (auto& term : E) {
                             term = exp(term - largest);
                             S += term;
                           }
                           for (int j = 0; j < brands; ++j) {
                             const T s = E[j] / S;
                             F[j] -= s * (1 + (z[j] - c[j]) * w * (1 - s)) / consumers;
                           }
                         }
                       });
  Vec start = cost.array() + 0.01;
  start[fixed_brand] = fixed_price;
  Vec half = cost.array() + 0.5, near = 1.5 * cost;
  half[fixed_brand] = near[fixed_brand] = fixed_price;
  p.starts = {start, near, half};
  p.solutions = {
      {"equilibrium",
       vec({0.61135771696123498, 0.22686800458787471, 0.61135771696123498, 0.22974301705284214, 0.20038070949241155,
            0.22093446367242661, 0.24837387658170118, fixed_price, 0.61135771696123498, 0.51513083793438819,
            0.61135771696123498, 0.61135771696123498, 0.44230245379026872, 0.40888074531864987}),
       1e-14}};
  return p;
}

}  // namespace perp::ncp::collection

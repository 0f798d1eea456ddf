// SPDX-License-Identifier: Apache-2.0
/// The Project Independence Evaluation System in small: an energy market as MCPLIB has it.
#include <array>
#include <cmath>

#include "collection/base/build.hpp"
#include "collection/models/pies_tables.hpp"
#include "collection/models/problems.hpp"

namespace perp::ncp::collection {

namespace {

using namespace pies_tables;

/// Where the blocks of unknowns begin, each by its two indices, the second one fastest.
struct Block {
  int first, columns;
  constexpr Index operator()(int i, int j) const { return first + i * columns + j; }
  constexpr Index operator()(int i) const { return first + i; }
};
constexpr Block c{0, coals};                          // coal mined
constexpr Block o{c.first + regions * coals, oils};   // crude produced
constexpr Block ct{o.first + regions * oils, users};  // shipments
constexpr Block ot{ct.first + regions * users, refineries};
constexpr Block lt{ot.first + regions * refineries, users};
constexpr Block ht{lt.first + refineries * users, users};
constexpr Block p{ht.first + refineries * users, users};  // prices
constexpr Block cv{p.first + fuels * users, 1};           // values at the mine, at the well, at the refinery
constexpr Block ov{cv.first + regions, 1};
constexpr Block lv{ov.first + regions, 1};
constexpr Block hv{lv.first + refineries, 1};
constexpr Block mu{hv.first + refineries, 1};  // rents of the resources
constexpr Index unknowns = mu.first + resources;

/// Profits of production: costs less values.
template <class X, class F>
void production(const X& z, const F& loss) {
  for (int r = 0; r < regions; ++r) {
    for (int t = 0; t < coals; ++t) {
      loss[c(r, t)] = ccost[r][t] - z[cv(r)];
      for (int s = 0; s < resources; ++s) loss[c(r, t)] += cruse[s][r][t] * z[mu(s)];
    }
    for (int t = 0; t < oils; ++t) {
      loss[o(r, t)] = ocost[r][t] - z[ov(r)];
      for (int s = 0; s < resources; ++s) loss[o(r, t)] += oruse[s][r][t] * z[mu(s)];
    }
  }
}

template <class X, class F>
void shipments(const X& z, const F& loss) {
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      loss[ct(i, j)] = ctcost[i][j] + z[cv(i)] - z[p(0, j)];
      loss[ot(i, j)] = otcost[i][j] + rcost[j] + z[ov(i)] - output[j][0] * z[lv(j)] - output[j][1] * z[hv(j)];
      loss[lt(i, j)] = ltcost[i][j] + z[lv(i)] - z[p(1, j)];
      loss[ht(i, j)] = htcost[i][j] + z[hv(i)] - z[p(2, j)];
    }
}

/// Arrivals less demands.
template <class X, class F>
void markets(const X& z, const F& excess) {
  using std::pow;
  for (int u = 0; u < users; ++u)
    for (int g = 0; g < fuels; ++g) {
      Number<F> demand = q0[g];
      for (int h = 0; h < fuels; ++h) demand *= pow(z[p(h, u)] / p0[h], esub[g][h]);
      constexpr std::array arrivals{ct, lt, ht};
      excess[p(g, u)] =
          z[arrivals[static_cast<std::size_t>(g)](0, u)] + z[arrivals[static_cast<std::size_t>(g)](1, u)] - demand;
    }
}

/// Production less shipments, and the resources left.
template <class X, class F>
void balances(const X& z, const F& left) {
  for (int r = 0; r < 2; ++r) {
    left[cv(r)] = -z[ct(r, 0)] - z[ct(r, 1)];
    for (int t = 0; t < coals; ++t) left[cv(r)] += z[c(r, t)];
    left[ov(r)] = -z[ot(r, 0)] - z[ot(r, 1)];
    for (int t = 0; t < oils; ++t) left[ov(r)] += z[o(r, t)];
    const auto crude = z[ot(0, r)] + z[ot(1, r)];
    left[lv(r)] = output[r][0] * crude - z[lt(r, 0)] - z[lt(r, 1)];
    left[hv(r)] = output[r][1] * crude - z[ht(r, 0)] - z[ht(r, 1)];
  }
  for (int s = 0; s < resources; ++s) {
    left[mu(s)] = rmax[s];
    for (int r = 0; r < regions; ++r) {
      for (int t = 0; t < coals; ++t) left[mu(s)] -= cruse[s][r][t] * z[c(r, t)];
      for (int t = 0; t < oils; ++t) left[mu(s)] -= oruse[s][r][t] * z[o(r, t)];
    }
  }
}

Box capacities() {
  Box box{Vec::Zero(unknowns), Vec::Constant(unknowns, infinity)};
  for (int r = 0; r < regions; ++r) {
    for (int t = 0; t < coals; ++t) box.upper[c(r, t)] = cmax[r][t];
    for (int t = 0; t < oils; ++t) box.upper[o(r, t)] = omax[r][t];
  }
  box.lower.segment(p.first, fuels * users).setConstant(0.1);
  box.lower.segment(cv.first, mu.first - cv.first).setConstant(-infinity);
  return box;
}

template <int rows, int columns>
void put(Vec& z, const Block& block, const double (&table)[rows][columns]) {
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) z[block(i, j)] = table[i][j];
}

Vec recorded_start() {
  Vec z = Vec::Ones(unknowns);
  put(z, c, i_c);
  put(z, o, i_o);
  put(z, ct, i_ct);
  put(z, ot, i_ot);
  put(z, lt, i_lt);
  put(z, ht, i_ht);
  put(z, p, iprice);
  return z;
}

Names names() {
  Names made;
  const auto table = [&](const char* letters, const Names& rows, int columns) {
    for (const std::string& row : rows)
      for (int j = 1; j <= columns; ++j) made.push_back(element(letters, row + "," + std::to_string(j)));
  };
  const Names pair{"1", "2"};
  table("c", pair, coals);
  table("o", pair, oils);
  for (const char* letters : {"ct", "ot", "lt", "ht"}) table(letters, pair, 2);
  table("p", {"C", "L", "H"}, users);
  for (const char* letters : {"cv", "ov", "lv", "hv"})
    for (const std::string& name : indexed(letters, 2)) made.push_back(name);
  made.insert(made.end(), {"mu[capital]", "mu[steel]"});
  return made;
}

/// "F_" before the names of the unknowns.
Names complements() {
  Names made = names();
  for (std::string& name : made) name.insert(0, "F_");
  return made;
}

}  // namespace

/// Production c, o between 0 and a capacity, shipments ct, ot, lt, ht >= 0, prices p >= 0.1 of the fuels at the users,
/// values cv, ov, lv, hv (free) of coal, crude, light and heavy oil where they are made, rents mu >= 0 of capital and
/// steel; each beside its complement, with the sums over the indices that stand on one side only:
///     c_rt: ccost + cruse mu - cv_r            ct_ru: ctcost + cv_r - p_Cu        lt_fu: ltcost + lv_f - p_Lu
///     o_rt: ocost + oruse mu - ov_r            ot_rf: otcost + rcost_f + ov_r - output_fL lv_f - output_fH hv_f
///     ht_fu: htcost + hv_f - p_Hu              p_gu: arrivals - q0_g prod_h (p_hu / p0_h)^esub_gh
///     cv_r, ov_r, lv_f, hv_f: production - shipments              mu_s: rmax_s - cruse c - oruse o
/// An LP but for the demands, whose elasticities are not symmetric: no optimization problem. Not defined for p <= 0.
Problem pies() {
  const auto F = [](const auto& z, const auto& excess) {
    for (Index k = p.first; k < cv.first; ++k)
      if (!above(z[k], 0)) return false;
    production(z, excess);
    shipments(z, excess);
    markets(z, excess);
    balances(z, excess);
    return true;
  };
  const Vec start = recorded_start();
  Shape shape{"pies", capacities(), names(), complements()};
  // The pattern is where J is not zero: every entry is constant but for the slopes of the demands, which never vanish.
  const auto dense = make_problem(shape, F);
  SpMat J = dense->jacobian_pattern();
  dense->jacobian(start, J);
  J.prune([](Index, Index, double slope) { return slope != 0; });
  shape.pattern = J;

  Problem made;
  made.mcp = make_problem(std::move(shape), F);
  Vec idle = Vec::Zero(unknowns);
  for (int g = 0; g < fuels; ++g)
    for (int u = 0; u < users; ++u) idle[p(g, u)] = p0[g];
  made.starts = {start, idle, Vec::Ones(unknowns)};
  // Within 0.6 of the recorded start in the quantities, 0.03 in the prices; recomputed to all digits.
  made.solutions = {{"equilibrium",
                     vec({300,
                          300,
                          227.88924500715893,
                          200,
                          300,
                          600,
                          1100,
                          975.0692218705254,
                          1300,
                          1058.0276887482105,
                          0,
                          827.8892450071589,
                          1016.3731984050937,
                          83.62680159490634,
                          2075.0692218705253,
                          1.6505299458894825e-17,
                          0,
                          2358.0276887482105,
                          22.261549825908165,
                          1222.779983296407,
                          1179.0138443741052,
                          1.2549659844669372e-32,
                          4.4014131890387466e-17,
                          830.0276887482102,
                          998.3786893799248,
                          180.63515499418037,
                          11.69731202277267,
                          13.697312022772671,
                          15.826623511584447,
                          16.02662351158445,
                          11.890667378614522,
                          12.39066737861452,
                          11.197312022772671,
                          10.947312022772671,
                          4.872241058396478,
                          5.858645445099485,
                          14.826623511584447,
                          14.826623511584447,
                          11.19066737861452,
                          10.89066737861452,
                          0.2672524915901246,
                          0.17492903562380793}),
                     1e-11}};
  return made;
}

}  // namespace perp::ncp::collection

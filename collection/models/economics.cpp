// SPDX-License-Identifier: Apache-2.0
/// General economic equilibria: activity levels y _|_ losses, prices p _|_ excess supplies, incomes.
#include <utility>

#include "collection/base/build.hpp"
#include "collection/models/problems.hpp"

namespace perp::ncp::collection {

namespace {

/// Mathiesen 1987, an exchange economy with one activity, z = (y, p1, p2, p3), parameters alpha, b2, b3:
///     -p1 + p2 + p3,                                  y - alpha (b2 p2 + b3 p3) / p1,
///     b2 - y - (1 - alpha) (b2 p2 + b3 p3) / p2,      b3 - y,
/// y >= 0, p1, p2 >= 1e-6. F is homogeneous of degree 0 in p up to the scale of F1: with p every s p solves, s > 0, and
/// F' is singular at each of them.
std::unique_ptr<Mcp> exchange(std::string name, double alpha, double b2, double b3, double least_p3) {
  const Box box{vec({0, 1e-6, 1e-6, least_p3}), Vec::Constant(4, infinity)};
  return make_problem({std::move(name), box, joined({{"y"}, indexed("p", 3)})},
                      [alpha, b2, b3](const auto& z, const auto& F) {
                        const auto &y = z[0], &p1 = z[1], &p2 = z[2], &p3 = z[3];
                        if (!above(p1, 0) || !above(p2, 0)) return false;
                        const auto income = b2 * p2 + b3 * p3;
                        F[0] = -p1 + p2 + p3;
                        F[1] = y - alpha * income / p1;
                        F[2] = b2 - y - (1 - alpha) * income / p2;
                        F[3] = b3 - y;
                        return true;
                      });
}

}  // namespace

/// (.9, 5, 3), p3 >= 1e-6: the solutions are y = 3, p = s (6, 1, 5).
Problem mathiesen() {
  Problem p;
  p.mcp = exchange("mathiesen", 0.9, 5, 3, 1e-6);
  p.starts = {Vec::Ones(4), Vec::Constant(4, 10), vec({0, 1, 2, 3}), vec({3, 5, 1, 5})};
  p.solutions = {{"p1 = 6", vec({3, 6, 1, 5}), 0},
                 {"p1 = 1", vec({3, 1, 1. / 6, 5. / 6}), 1e-15},
                 {"p1 + p2 + p3 = 1", vec({3, 1. / 2, 1. / 12, 5. / 12}), 1e-15}};
  return p;
}

/// (.75, 1, .5), p3 >= 1e-6: y = 1/2, p = s (3, 1, 2).
Problem mathiesen_2() {
  Problem p;
  p.mcp = exchange("mathiesen-2-own", 0.75, 1, 0.5, 1e-6);
  p.starts = {Vec::Ones(4), Vec::Constant(4, 10), vec({0, 1, 2, 3}), vec({1, 0.1, 5, 0.2})};
  p.solutions = {{"p2 = 1", vec({0.5, 3, 1, 2}), 0}, {"p1 = 1", vec({0.5, 1, 1. / 3, 2. / 3}), 1e-15}};
  return p;
}

/// (.75, 1, 2), p3 >= 0 (with a positive bound there is no solution): y = 3/4, p = s (1, 1, 0).
Problem mathiesen_3() {
  Problem p;
  p.mcp = exchange("mathiesen-3-own", 0.75, 1, 2, 0);
  p.starts = {Vec::Ones(4), Vec::Constant(4, 10), vec({0, 1, 2, 3}), vec({1, 0.1, 5, 0.2})};
  p.solutions = {{"p1 = 1", vec({0.75, 1, 1, 0}), 0}, {"p1 = 5", vec({0.75, 5, 5, 0}), 0}};
  return p;
}

namespace {

constexpr int goods = 4, sectors = 2, households = 4;
constexpr double endowment[households] = {5, 5, 40, 40};  // consumer c owns so much of good c and nothing else
constexpr double share[goods][households] = {
    {.52, .86, .5, .06}, {.4, .1, .2, .25}, {.04, .02, .2975, .0025}, {.04, .02, .0025, .6875}};
constexpr double activity[goods][sectors] = {{6, -1}, {-1, 3}, {-4, -1}, {-1, -1}};

}  // namespace

/// Kehoe 1985, four goods, two activities a, four consumers with Cobb-Douglas shares alpha (by good) and endowments e,
/// z = (y, p, h) with incomes h free, p1 = 1 fixed, p2..p4 >= 1e-4:
///     F_y = -a'p,   F_p(g) = sum_c e_gc + (a y)_g - sum_c alpha_gc h_c / p_g,   F_h(c) = h_c - sum_g p_g e_gc.
Problem kehoe() {
  Problem p;
  Box box{Vec::Zero(10), Vec::Constant(10, infinity)};
  box.lower.segment(2, 4) = vec({1, 1e-4, 1e-4, 1e-4});
  box.upper[2] = 1;
  box.lower.tail(4).setConstant(-infinity);
  const Names variables = joined({indexed("y", sectors), indexed("p", goods), indexed("h", households)});
  const Names equations = joined({indexed("loss", sectors), indexed("market", goods), indexed("income", households)});
  p.mcp = make_problem({"kehoe", box, variables, equations}, [](const auto& z, const auto& F) {
    const auto y = z.head(sectors), prices = z.segment(sectors, goods), h = z.tail(households);
    for (int s = 0; s < sectors; ++s) {
      F[s] = 0;
      for (int g = 0; g < goods; ++g) F[s] -= activity[g][s] * prices[g];
    }
    for (int g = 0; g < goods; ++g) {
      if (!above(prices[g], 0)) return false;
      Number<decltype(z)> spent = 0;
      for (int c = 0; c < households; ++c) spent += share[g][c] * h[c];
      F[sectors + g] = endowment[g] - spent / prices[g];
      for (int s = 0; s < sectors; ++s) F[sectors + g] += activity[g][s] * y[s];
    }
    for (int c = 0; c < households; ++c) F[sectors + goods + c] = h[c] - prices[c] * endowment[c];
    return true;
  });
  // Prices 1, no production, the incomes that go with them; and all ones.
  p.starts = {vec({0, 0, 1, 1, 1, 1, 5, 5, 40, 40}), Vec::Ones(10), vec({5, 5, 1, 2, 0.5, 3, 5, 10, 20, 120}),
              vec({0, 0, 1, 10, 10, 10, 5, 50, 400, 400})};
  const auto equilibrium = [](double y1, double y2, double p2, double p3, double p4) {
    return vec({y1, y2, 1, p2, p3, p4, 5, 5 * p2, 40 * p3, 40 * p4});
  };
  p.solutions = {
      {"Kehoe 1: p = 1", equilibrium(5.2, 6.9, 1, 1, 1), 1e-15},
      {"Kehoe 2",
       equilibrium(5.3180132497870662, 6.514815149060321, .9086408621452301, 1.1218121838063599, .60411040262933036),
       1e-12},
      {"Kehoe 3",
       equilibrium(4.2701283145309654, 8.1198034676171282, 1.5681643660527573, .24244751192965674, 3.4620455862286157),
       1e-12}};
  return p;
}

}  // namespace perp::ncp::collection

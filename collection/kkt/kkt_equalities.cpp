// SPDX-License-Identifier: Apache-2.0
/// Karush-Kuhn-Tucker systems of test problems of Hock & Schittkowski 1981 with equations, whose multipliers mu are
/// free (see collection/base/nlp.hpp). The first starts are the book's point with multipliers 0 and 1.
#include <cmath>

#include "collection/base/nlp.hpp"
#include "collection/kkt/kkt_entries.hpp"

namespace perp::ncp::collection {

/// HS6: (1 - x1)^2, 10 (x2 - x1^2) = 0.
Problem hs6_kkt() {
  Problem p = kkt_problem<2>({"hs6-kkt", free_box(2), 0, 1}, {vec({-1.2, 1}), vec({0, 0})}, {},
                             [](const auto& x, const auto& g) {
                               g[0] = 10 * (x[1] - sq(x[0]));
                               return sq(1 - x[0]);
                             });
  p.solutions = {{"minimum", vec({1, 1, 0}), 0}};
  p.solutions_complete = true;  // F2 = -10 mu
  return p;
}

/// HS7: log(1 + x1^2) - x2, (1 + x1^2)^2 + x2^2 = 4. With s = 1 + x1^2, F1 = 0 is x1 = 0 or mu = 1 / (2 s^2), where F2
/// = 0 and the constraint give x2 = -s^2 and s^4 + s^2 = 4: four KKT points.
Problem hs7_kkt() {
  Problem p =
      kkt_problem<2>({"hs7-kkt", free_box(2), 0, 1}, {vec({2, 2}), vec({0, 1})}, {}, [](const auto& x, const auto& g) {
        using std::log;
        g[0] = sq(1 + sq(x[0])) + sq(x[1]) - 4;
        return log(1 + sq(x[0])) - x[1];
      });
  const double r = std::sqrt(3.0);
  p.solutions = {{"minimum", vec({0, r, -0.5 / r}), 1e-15}, {"x1 = 0", vec({0, -r, 0.5 / r}), 1e-15}};
  const double ss = 0.5 * (std::sqrt(17.0) - 1);  // s^2
  for (const double x1 : {std::sqrt(std::sqrt(ss) - 1), -std::sqrt(std::sqrt(ss) - 1)})
    p.solutions.push_back({x1 > 0 ? "x1 > 0" : "x1 < 0", vec({x1, -ss, 0.5 / ss}), 1e-14});
  p.solutions_complete = true;
  return p;
}

/// HS26: (x1 - x2)^2 + (x2 - x3)^4, (1 + x2^2) x1 + x3^4 = 3. The Hessian of the Lagrangian is singular on the
/// constraint's tangent at the minimum, where mu = 0: the Jacobian is singular.
Problem hs26_kkt() {
  return kkt_problem<3>({"hs26-kkt", free_box(3), 0, 1}, {vec({-2.6, 2, 2}), Vec::Zero(3)},
                        {{"minimum", vec({1, 1, 1, 0}), 0}}, [](const auto& x, const auto& g) {
                          g[0] = (1 + sq(x[1])) * x[0] + sq(sq(x[2])) - 3;
                          return sq(x[0] - x[1]) + sq(sq(x[1] - x[2]));
                        });
}

/// HS32: (x1 + 3 x2 + x3)^2 + 4 (x1 - x2)^2, 6 x2 + 4 x3 - x1^3 >= 3, x1 + x2 + x3 = 1, x >= 0.
Problem hs32_kkt() {
  return kkt_problem<3>({"hs32-kkt", Box::nonnegative(3), 1, 1}, {vec({0.1, 0.7, 0.2}), Vec::Zero(3)},
                        {{"minimum", vec({0, 0, 1, 0, -2}), 0}}, [](const auto& x, const auto& g) {
                          g[0] = 6 * x[1] + 4 * x[2] - cube(x[0]) - 3;
                          g[1] = 1 - x[0] - x[1] - x[2];
                          return sq(x[0] + 3 * x[1] + x[2]) + 4 * sq(x[0] - x[1]);
                        });
}

/// HS41: 2 - x1 x2 x3, x1 + 2 x2 + 2 x3 = x4, 0 <= x <= (1, 1, 1, 2).
Problem hs41_kkt() {
  const Box X{Vec::Zero(4), vec({1, 1, 1, 2})};
  return kkt_problem<4>({"hs41-kkt", X, 0, 1}, {Vec::Constant(4, 2), vec({0.5, 0.5, 0.5, 1})},
                        {{"minimum", vec({2. / 3, 1. / 3, 1. / 3, 2, -1. / 9}), 1e-15}, {"origin", Vec::Zero(5), 0}},
                        [](const auto& x, const auto& g) {
                          g[0] = x[0] + 2 * x[1] + 2 * x[2] - x[3];
                          return 2 - x[0] * x[1] * x[2];
                        });
}

/// HS53: (x1 - x2)^2 + (x2 + x3 - 2)^2 + (x4 - 1)^2 + (x5 - 1)^2, x1 + 3 x2 = 0, x3 + x4 = 2 x5, x2 = x5, -10 <= x <=
/// 10: a linear system in the box; strictly convex on the constraints, so one solution.
Problem hs53_kkt() {
  const Box X{Vec::Constant(5, -10), Vec::Constant(5, 10)};
  Problem p = kkt_problem<5>({.name = "hs53-kkt", .X = X, .equalities = 3, .quadratic = true},
                             {Vec::Constant(5, 2), X.upper}, {}, [](const auto& x, const auto& g) {
                               g[0] = x[0] + 3 * x[1];
                               g[1] = x[2] + x[3] - 2 * x[4];
                               g[2] = x[1] - x[4];
                               return sq(x[0] - x[1]) + sq(x[1] + x[2] - 2) + sq(x[3] - 1) + sq(x[4] - 1);
                             });
  const Vec scaled = vec({-33, 11, 27, -5, 11, -88, -96, 256}) / 43;
  p.solutions = {{"minimum", scaled, 1e-14}};
  p.solutions_complete = true;
  return p;
}

/// HS56: -x1 x2 x3, x1 = 4.2 sin(x4)^2, x2 = 4.2 sin(x5)^2, x3 = 4.2 sin(x6)^2, x1 + 2 x2 + 2 x3 = 7.2 sin(x7)^2:
/// inequalities written with squared sines. Infinitely many KKT points.
Problem hs56_kkt() {
  const double a = std::asin(std::sqrt(1 / 4.2));
  const double b = std::asin(std::sqrt(5 / 7.2));
  Problem p = kkt_problem<7>({"hs56-kkt", free_box(7), 0, 4}, {vec({1, 1, 1, a, a, a, b}), Vec::Ones(7)}, {},
                             [](const auto& x, const auto& g) {
                               using std::sin;
                               for (int k = 0; k < 3; ++k) g[k] = x[k] - 4.2 * sq(sin(x[3 + k]));
                               g[3] = x[0] + 2 * x[1] + 2 * x[2] - 7.2 * sq(sin(x[6]));
                               return -(x[0] * x[1] * x[2]);
                             });
  const double c = std::asin(std::sqrt(4. / 7)), d = std::asin(std::sqrt(2. / 7));
  constexpr double quarter = 1.5707963267948966;
  p.solutions = {{"minimum", vec({2.4, 1.2, 1.2, c, d, d, quarter, 0, 0, 0, -1.44}), 1e-14}};
  return p;
}

/// HS61: 4 x1^2 + 2 x2^2 + 2 x3^2 - 33 x1 + 16 x2 - 24 x3, 3 x1 - 2 x2^2 = 7, 4 x1 - x3^2 = 11.
Problem hs61_kkt() {
  return kkt_problem<3>(
      {"hs61-kkt", free_box(3), 0, 2}, {Vec::Zero(3), vec({5, -2, 3})},
      {{"minimum",
        vec({5.326770135563928, -2.118998632218976, 3.2104642253505506, 0.887684087748218, 1.737777205316692}), 1e-12}},
      [](const auto& x, const auto& g) {
        g[0] = 3 * x[0] - 2 * sq(x[1]) - 7;
        g[1] = 4 * x[0] - sq(x[2]) - 11;
        return 4 * sq(x[0]) + 2 * sq(x[1]) + 2 * sq(x[2]) - 33 * x[0] + 16 * x[1] - 24 * x[2];
      });
}

/// HS62: -32.174 (255 log((s1 + .03) / (.09 x1 + s2 + .03)) + 280 log((s2 + .03) / (.07 x2 + s3 + .03)) + 290 log((s3 +
/// .03) / (.13 x3 + .03))), s1 = x1 + x2 + x3, s2 = x2 + x3, s3 = x3; s1 = 1, 0 <= x <= 1.
Problem hs62_kkt() {
  const Box X{Vec::Zero(3), Vec::Ones(3)};
  return kkt_problem<3>(
      {"hs62-kkt", X, 0, 1}, {vec({0.7, 0.2, 0.1}), vec({0, 0, 1})},
      {{"minimum", vec({0.6178126908126926, 0.328202223119669, 0.053985086067638494, -6386.937539877763}), 1e-10}},
      [](const auto& x, const auto& g) {
        using std::log;
        const auto s3 = x[2] + 0.03;
        const auto s2 = x[1] + s3;
        const auto s1 = x[0] + s2;
        g[0] = x[0] + x[1] + x[2] - 1;
        return -32.174 * (255 * log(s1 / (0.09 * x[0] + s2)) + 280 * log(s2 / (0.07 * x[1] + s3)) +
                          290 * log(s3 / (0.13 * x[2] + 0.03)));
      });
}

/// HS71: x1 x4 (x1 + x2 + x3) + x3, x1 x2 x3 x4 >= 25, |x|^2 = 40, 1 <= x <= 5.
Problem hs71_kkt() {
  const Box X{Vec::Ones(4), Vec::Constant(4, 5)};
  return kkt_problem<4>(
      {"hs71-kkt", X, 1, 1}, {vec({1, 5, 5, 1}), Vec::Constant(4, 3)},
      {{"minimum",
        vec({1, 4.742999637264417, 3.8211499841848737, 1.3794082931726726, 0.5522936601207269, -0.16146856677050586}),
        1e-12}},
      [](const auto& x, const auto& g) {
        g[0] = x[0] * x[1] * x[2] * x[3] - 25;
        g[1] = sq(x[0]) + sq(x[1]) + sq(x[2]) + sq(x[3]) - 40;
        return x[0] * x[3] * (x[0] + x[1] + x[2]) + x[2];
      });
}

/// HS73, cattle feed: a linear cost, two constraints, one of them with the square root of a sum of squares, shares x >=
/// 0 with sum 1. Convex.
Problem hs73_kkt() {
  return kkt_problem<4>({"hs73-kkt", Box::nonnegative(4), 2, 1}, {Vec::Ones(4), Vec::Constant(4, 0.25)},
                        {{"minimum",
                          vec({0.6355215686350698, 0, 0.31270188075152355, 0.05177655061340671, 0.5803550834513885,
                               0.41054108085874574, 18.371240043852747}),
                          1e-12}},
                        [](const auto& x, const auto& g) {
                          using std::sqrt;
                          g[0] = 2.3 * x[0] + 5.6 * x[1] + 11.1 * x[2] + 1.3 * x[3] - 5;
                          g[1] = 12 * x[0] + 11.9 * x[1] + 41.8 * x[2] + 52.1 * x[3] - 21 -
                                 1.645 * sqrt(0.28 * sq(x[0]) + 0.19 * sq(x[1]) + 20.5 * sq(x[2]) + 0.62 * sq(x[3]));
                          g[2] = x[0] + x[1] + x[2] + x[3] - 1;
                          return 24.55 * x[0] + 26.75 * x[1] + 39 * x[2] + 40.5 * x[3];
                        });
}

/// HS74, static power scheduling: 3 x1 + 1e-6 x1^3 + 2 x2 + (2/3) 1e-6 x2^3, |x3 - x4| <= 0.55, three power balances
/// with sines of the phase angles x3, x4; 0 <= x1, x2 <= 1200, |x3|, |x4| <= 0.55.
Problem hs74_kkt() {
  constexpr double a = 0.55;
  const Box X{vec({0, 0, -a, -a}), vec({1200, 1200, a, a})};
  return kkt_problem<4>({"hs74-kkt", X, 2, 3}, {Vec::Zero(4), vec({600, 600, 0, 0})},
                        {{"minimum",
                          vec({679.9453198512116, 1026.0671326104648, 0.11887636449310193, -0.39623355320321024, 0, 0,
                               -4.386976913962699, -4.105627521246922, -5.463278493108374}),
                          1e-10}},
                        [](const auto& x, const auto& g) {
                          using std::sin;
                          g[0] = x[3] - x[2] + a;
                          g[1] = x[2] - x[3] + a;
                          g[2] = 1000 * sin(-x[2] - 0.25) + 1000 * sin(-x[3] - 0.25) + 894.8 - x[0];
                          g[3] = 1000 * sin(x[2] - 0.25) + 1000 * sin(x[2] - x[3] - 0.25) + 894.8 - x[1];
                          g[4] = 1000 * sin(x[3] - 0.25) + 1000 * sin(x[3] - x[2] - 0.25) + 1294.8;
                          return 3 * x[0] + 1e-6 * cube(x[0]) + 2 * x[1] + 2e-6 / 3 * cube(x[1]);
                        });
}

/// HS78: x1 x2 x3 x4 x5, |x|^2 = 10, x2 x3 = 5 x4 x5, x1^3 + x2^3 = -1, all free.
Problem hs78_kkt() {
  return kkt_problem<5>({"hs78-kkt", free_box(5), 0, 3}, {vec({-2, 1.5, 2, -1, -1}), vec({-1, 1, 1, 1, 1})},
                        {{"minimum",
                          vec({-1.7171435703943823, 1.5957096901835544, 1.8272457529271946, -0.7636430781841304,
                               -0.7636430781841305, -0.74444593097518, 0.7035751900173159, -0.0968055248950665}),
                          1e-12}},
                        [](const auto& x, const auto& g) {
                          g[0] = sq(x[0]) + sq(x[1]) + sq(x[2]) + sq(x[3]) + sq(x[4]) - 10;
                          g[1] = x[1] * x[2] - 5 * x[3] * x[4];
                          g[2] = cube(x[0]) + cube(x[1]) + 1;
                          return x[0] * x[1] * x[2] * x[3] * x[4];
                        });
}

/// HS83, Colville's problem 3: a quadratic function between pairs of quadratic constraints, 0 <= c1 <= 92, 90 <= c2 <=
/// 110, 20 <= c3 <= 25, and bounds on all unknowns; five of all these are active.
Problem hs83_kkt() {
  const Box X{vec({78, 33, 27, 27, 27}), vec({102, 45, 45, 45, 45})};
  return kkt_problem<5>(
      {"hs83-kkt", X, 6}, {X.lower, vec({90, 39, 36, 36, 36})},
      {{"minimum",
        vec({78, 33, 29.995256025681595, 45, 36.77581290578818, 0, 403.26887953632206, 0, 0, 809.4250334564156, 0}),
        1e-12}},
      [](const auto& x, const auto& g) {
        const auto c1 = 85.334407 + 0.0056858 * x[1] * x[4] + 0.0006262 * x[0] * x[3] - 0.0022053 * x[2] * x[4];
        const auto c2 = 80.51249 + 0.0071317 * x[1] * x[4] + 0.0029955 * x[0] * x[1] + 0.0021813 * sq(x[2]);
        const auto c3 = 9.300961 + 0.0047026 * x[2] * x[4] + 0.0012547 * x[0] * x[2] + 0.0019085 * x[2] * x[3];
        g[0] = c1;
        g[1] = 92 - c1;
        g[2] = c2 - 90;
        g[3] = 110 - c2;
        g[4] = c3 - 20;
        g[5] = 25 - c3;
        return 5.3578547 * sq(x[2]) + 0.8356891 * x[0] * x[4] + 37.293239 * x[0] - 40792.141;
      });
}

/// HS106, heat exchangers: x1 + x2 + x3, three linear constraints, three bilinear ones with terms of 10^6 beside
/// multipliers of 10^-2, 100 <= x1 <= 10^4, 1000 <= x2, x3 <= 10^4, 10 <= x4, .., x8 <= 1000.
Problem hs106_kkt() {
  Box X{Vec::Constant(8, 10), Vec::Constant(8, 1000)};
  X.lower.head(3) << 100, 1000, 1000;
  X.upper.head(3).setConstant(10000);
  return kkt_problem<8>(
      {"hs106-kkt", X, 6}, {vec({5000, 5000, 5000, 200, 350, 150, 225, 425}), X.lower},
      {{"minimum",
        vec({579.3066844253552, 1359.9706680516551, 5109.970668051654, 182.01769958111993, 295.6011732779338,
             217.98230041888007, 286.4165263031861, 395.6011732779338, 1964.046072567176, 5210.6741454948005,
             5109.970668051654, 0.00847584761824135, 0.0095786517090104, 0.01}),
        1e-10}},
      [](const auto& x, const auto& g) {
        g[0] = 1 - 0.0025 * (x[3] + x[5]);
        g[1] = 1 - 0.0025 * (x[4] + x[6] - x[3]);
        g[2] = 1 - 0.01 * (x[7] - x[4]);
        g[3] = x[0] * x[5] - 833.33252 * x[3] - 100 * x[0] + 83333.333;
        g[4] = x[1] * x[6] - 1250 * x[4] - x[1] * x[3] + 1250 * x[3];
        g[5] = x[2] * x[7] - 1250000 - x[2] * x[4] + 2500 * x[4];
        return x[0] + x[1] + x[2];
      });
}

/// HS112, chemical equilibrium: sum_j x_j (c_j + log(x_j / sum x)), three balances of atoms, x >= 1e-6. Convex.
Problem hs112_kkt() {
  constexpr int n = 10;
  const Box X{Vec::Constant(n, 1e-6), Vec::Constant(n, infinity)};
  Problem p = kkt_problem<n>({"hs112-kkt", X, 0, 3}, {Vec::Constant(n, 0.1), Vec::Constant(n, 1e-3)}, {},
                             [](const auto& x, const auto& g) {
                               using std::log;
                               constexpr double c[n] = {-6.089,  -17.164, -34.054, -5.914,  -24.721,
                                                        -14.986, -24.100, -10.708, -26.662, -22.179};
                               g[0] = x[0] + 2 * x[1] + 2 * x[2] + x[5] + x[9] - 2;
                               g[1] = x[3] + 2 * x[4] + x[5] + x[6] - 1;
                               g[2] = x[2] + x[6] + x[7] + 2 * x[8] + x[9] - 1;
                               auto sum = x[0];
                               for (int j = 1; j < n; ++j) sum += x[j];
                               auto f = x[0] * (c[0] + log(x[0] / sum));
                               for (int j = 1; j < n; ++j) f += x[j] * (c[j] + log(x[j] / sum));
                               return f;
                             });
  p.solutions = {
      {"minimum",
       vec({0.04066808735569009, 0.14773035434082155, 0.7831533540092357, 0.001414219809030125, 0.48524664869927187,
            0.0006931720784210651, 0.027399310714003155, 0.017947279584925323, 0.0373143659130299, 0.09687132386577622,
            -9.785055008529769, -12.968920691636926, -15.222060150669408}),
       1e-12}};
  return p;
}

}  // namespace perp::ncp::collection

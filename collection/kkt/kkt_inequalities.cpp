// SPDX-License-Identifier: Apache-2.0
/// Karush-Kuhn-Tucker systems of test problems of Hock & Schittkowski 1981 with inequalities (see
/// collection/base/nlp.hpp). The first starts are the book's point with multipliers 0 and 1.
#include <cmath>

#include "collection/base/nlp.hpp"
#include "collection/kkt/kkt_entries.hpp"

namespace perp::ncp::collection {

/// HS15: 100 (x2 - x1^2)^2 + (1 - x1)^2, x1 x2 >= 1, x1 + x2^2 >= 0, x1 <= 1/2.
Problem hs15_kkt() {
  const Box X{Vec::Constant(2, -infinity), vec({0.5, infinity})};
  return kkt_problem<2>({"hs15-kkt", X, 2}, {vec({-2, 1}), vec({0.5, 1})}, {{"minimum", vec({0.5, 2, 700, 0}), 0}},
                        [](const auto& x, const auto& g) {
                          g[0] = x[0] * x[1] - 1;
                          g[1] = x[0] + sq(x[1]);
                          return 100 * sq(x[1] - sq(x[0])) + sq(1 - x[0]);
                        });
}

/// HS17: the same function, x2^2 >= x1, x1^2 >= x2, -1/2 <= x1 <= 1/2, x2 <= 1. At the minimum both constraints are
/// active, one with multiplier 0.
Problem hs17_kkt() {
  const Box X{vec({-0.5, -infinity}), vec({0.5, 1})};
  return kkt_problem<2>({"hs17-kkt", X, 2}, {vec({-2, 1}), vec({0, 0.5})}, {{"minimum", vec({0, 0, 2, 0}), 0}},
                        [](const auto& x, const auto& g) {
                          g[0] = sq(x[1]) - x[0];
                          g[1] = sq(x[0]) - x[1];
                          return 100 * sq(x[1] - sq(x[0])) + sq(1 - x[0]);
                        });
}

/// HS19: (x1 - 10)^3 + (x2 - 20)^3, (x1 - 5)^2 + (x2 - 5)^2 >= 100, (x2 - 5)^2 + (x1 - 6)^2 <= 82.81, 13 <= x1 <= 100,
/// 0
/// <= x2 <= 100: between two circles that nearly touch.
Problem hs19_kkt() {
  const Box X{vec({13, 0}), vec({100, 100})};
  return kkt_problem<2>(
      {"hs19-kkt", X, 2}, {vec({20.1, 5.84}), vec({14, 1})},
      {{"minimum", vec({14.094999999999951, 0.8429607892153748, 1097.1189367883455, 1229.5420867930834}), 1e-10}},
      [](const auto& x, const auto& g) {
        g[0] = sq(x[0] - 5) + sq(x[1] - 5) - 100;
        g[1] = 82.81 - sq(x[1] - 5) - sq(x[0] - 6);
        return cube(x[0] - 10) + cube(x[1] - 20);
      });
}

/// HS23: x1^2 + x2^2, x1 + x2 >= 1, x1^2 + x2^2 >= 1, 9 x1^2 + x2^2 >= 9, x1^2 >= x2, x2^2 >= x1, -50 <= x <= 50.
Problem hs23_kkt() {
  const Box X{Vec::Constant(2, -50), Vec::Constant(2, 50)};
  return kkt_problem<2>({"hs23-kkt", X, 5}, {vec({3, 1}), vec({50, 50})}, {{"minimum", vec({1, 1, 0, 0, 0, 2, 2}), 0}},
                        [](const auto& x, const auto& g) {
                          g[0] = x[0] + x[1] - 1;
                          g[1] = sq(x[0]) + sq(x[1]) - 1;
                          g[2] = 9 * sq(x[0]) + sq(x[1]) - 9;
                          g[3] = sq(x[0]) - x[1];
                          g[4] = sq(x[1]) - x[0];
                          return sq(x[0]) + sq(x[1]);
                        });
}

/// HS24: ((x1 - 3)^2 - 9) x2^3 / (27 sqrt 3), x1 / sqrt 3 >= x2, x1 + sqrt 3 x2 >= 0, x1 + sqrt 3 x2 <= 6, x >= 0. F
/// and its derivatives in x vanish at x = 0, a KKT point that is no minimum.
Problem hs24_kkt() {
  const double r = std::sqrt(3.0);
  return kkt_problem<2>({"hs24-kkt", Box::nonnegative(2), 3}, {vec({1, 0.5}), vec({3, 3})},
                        {{"minimum", vec({3, r, 0.5 * r, 0, 0.5}), 1e-14}, {"origin", Vec::Zero(5), 0}},
                        [r](const auto& x, const auto& g) {
                          g[0] = x[0] / r - x[1];
                          g[1] = x[0] + r * x[1];
                          g[2] = 6 - x[0] - r * x[1];
                          return (sq(x[0] - 3) - 9) * cube(x[1]) / (27 * r);
                        });
}

/// HS29: -x1 x2 x3, x1^2 + 2 x2^2 + 4 x3^2 <= 48: four minima, mirror images of each other, and a continuum of KKT
/// points on the axes, where lambda = 0.
Problem hs29_kkt() {
  Problem p = kkt_problem<3>({"hs29-kkt", free_box(3), 1}, {Vec::Ones(3), vec({-1, 1, -1}), vec({10, 0.1, 0.1})}, {},
                             [](const auto& x, const auto& g) {
                               g[0] = 48 - sq(x[0]) - 2 * sq(x[1]) - 4 * sq(x[2]);
                               return -(x[0] * x[1] * x[2]);
                             });
  const double b = std::sqrt(8.0);
  const double lambda = std::sqrt(0.5);
  p.solutions = {{"minimum +++", vec({4, b, 2, lambda}), 1e-15},
                 {"minimum +--", vec({4, -b, -2, lambda}), 1e-15},
                 {"minimum -+-", vec({-4, b, -2, lambda}), 1e-15},
                 {"minimum --+", vec({-4, -b, 2, lambda}), 1e-15},
                 {"origin", Vec::Zero(4), 0}};
  return p;
}

/// HS30: |x|^2, x1^2 + x2^2 >= 1, 1 <= x1 <= 10, -10 <= x2, x3 <= 10. At (1, 0, 0) x1's bound and the constraint are
/// active with one gradient: every lambda in [0, 1] will do.
Problem hs30_kkt() {
  const Box X{vec({1, -10, -10}), Vec::Constant(3, 10)};
  return kkt_problem<3>({"hs30-kkt", X, 1}, {Vec::Ones(3), vec({10, 10, -10})},
                        {{"lambda = 0", vec({1, 0, 0, 0}), 0},
                         {"lambda = 1/2", vec({1, 0, 0, 0.5}), 0},
                         {"lambda = 1", vec({1, 0, 0, 1}), 0}},
                        [](const auto& x, const auto& g) {
                          g[0] = sq(x[0]) + sq(x[1]) - 1;
                          return sq(x[0]) + sq(x[1]) + sq(x[2]);
                        });
}

/// HS33: (x1 - 1)(x1 - 2)(x1 - 3) + x3, x3^2 >= x1^2 + x2^2, |x|^2 >= 4, x >= 0, x3 <= 5.
Problem hs33_kkt() {
  const Box X{Vec::Zero(3), vec({infinity, infinity, 5})};
  Problem p =
      kkt_problem<3>({"hs33-kkt", X, 2}, {vec({0, 0, 3}), vec({1, 1, 1})}, {}, [](const auto& x, const auto& g) {
        g[0] = sq(x[2]) - sq(x[0]) - sq(x[1]);
        g[1] = sq(x[0]) + sq(x[1]) + sq(x[2]) - 4;
        return (x[0] - 1) * (x[0] - 2) * (x[0] - 3) + x[2];
      });
  const double r = std::sqrt(2.0);
  p.solutions = {{"minimum", vec({0, r, r, r / 8, r / 8}), 1e-15}};
  return p;
}

/// HS36: -x1 x2 x3, x1 + 2 x2 + 2 x3 <= 72, 0 <= x <= (20, 11, 42).
Problem hs36_kkt() {
  const Box X{Vec::Zero(3), vec({20, 11, 42})};
  return kkt_problem<3>({"hs36-kkt", X, 1}, {Vec::Constant(3, 10), Vec::Ones(3)},
                        {{"minimum", vec({20, 11, 15, 110}), 0}, {"origin", Vec::Zero(4), 0}},
                        [](const auto& x, const auto& g) {
                          g[0] = 72 - x[0] - 2 * x[1] - 2 * x[2];
                          return -(x[0] * x[1] * x[2]);
                        });
}

/// HS43 (Rosen & Suzuki): x1^2 + x2^2 + 2 x3^2 + x4^2 - 5 x1 - 5 x2 - 21 x3 + 7 x4 in three ellipsoids, all free.
/// Strictly convex, gradients of the active constraints independent: one solution.
Problem hs43_kkt() {
  Problem p = kkt_problem<4>({"hs43-kkt", free_box(4), 3}, {Vec::Zero(4), Vec::Constant(4, 10)}, {},
                             [](const auto& x, const auto& g) {
                               const auto s1 = sq(x[0]), s2 = sq(x[1]), s3 = sq(x[2]), s4 = sq(x[3]);
                               g[0] = 8 - s1 - s2 - s3 - s4 - x[0] + x[1] - x[2] + x[3];
                               g[1] = 10 - s1 - 2 * s2 - s3 - 2 * s4 + x[0] + x[3];
                               g[2] = 5 - 2 * s1 - s2 - s3 - 2 * x[0] + x[1] + x[3];
                               return s1 + s2 + 2 * s3 + s4 - 5 * x[0] - 5 * x[1] - 21 * x[2] + 7 * x[3];
                             });
  p.solutions = {{"minimum", vec({0, 1, 2, -1, 1, 0, 2}), 0}};
  p.solutions_complete = true;
  return p;
}

/// HS44: x1 - x2 - x3 - x1 x3 + x1 x4 + x2 x3 - x2 x4 over a polyhedron, x >= 0: an LCP with an indefinite matrix.
Problem hs44_kkt() {
  return kkt_problem<4>({.name = "hs44-kkt", .X = Box::nonnegative(4), .inequalities = 6, .quadratic = true},
                        {Vec::Zero(4), Vec::Ones(4), Vec::Constant(4, 10)},
                        {{"minimum", vec({0, 3, 0, 4, 0, 0, 1.25, 0, 1.5, 0}), 0}}, [](const auto& x, const auto& g) {
                          g[0] = 8 - x[0] - 2 * x[1];
                          g[1] = 12 - 4 * x[0] - x[1];
                          g[2] = 12 - 3 * x[0] - 4 * x[1];
                          g[3] = 8 - 2 * x[2] - x[3];
                          g[4] = 8 - x[2] - 2 * x[3];
                          g[5] = 5 - x[2] - x[3];
                          return x[0] - x[1] - x[2] - x[0] * x[2] + x[0] * x[3] + x[1] * x[2] - x[1] * x[3];
                        });
}

/// HS64: 5 x1 + 50000 / x1 + 20 x2 + 72000 / x2 + 10 x3 + 144000 / x3, 4 / x1 + 32 / x2 + 120 / x3 <= 1, x >= 1e-5.
/// Convex where x > 0, one active constraint: one solution.
Problem hs64_kkt() {
  const Box X{Vec::Constant(3, 1e-5), Vec::Constant(3, infinity)};
  Problem p =
      kkt_problem<3>({"hs64-kkt", X, 1}, {Vec::Ones(3), Vec::Constant(3, 100)}, {}, [](const auto& x, const auto& g) {
        g[0] = 1 - 4 / x[0] - 32 / x[1] - 120 / x[2];
        return 5 * x[0] + 50000 / x[0] + 20 * x[1] + 72000 / x[1] + 10 * x[2] + 144000 / x[2];
      });
  p.solutions = {
      {"minimum", vec({108.73470491089893, 85.1262127908938, 204.32459661260557, 2279.045065075332}), 1e-10}};
  p.solutions_complete = true;
  return p;
}

/// HS65: (x1 - x2)^2 + (x1 + x2 - 10)^2 / 9 + (x3 - 5)^2, |x|^2 <= 48, -4.5 <= x1, x2 <= 4.5, -5 <= x3 <= 5. Strictly
/// convex: one solution.
Problem hs65_kkt() {
  const Box X{vec({-4.5, -4.5, -5}), vec({4.5, 4.5, 5})};
  Problem p = kkt_problem<3>({"hs65-kkt", X, 1}, {vec({-5, 5, 0}), X.lower}, {}, [](const auto& x, const auto& g) {
    g[0] = 48 - sq(x[0]) - sq(x[1]) - sq(x[2]);
    return sq(x[0] - x[1]) + sq(x[0] + x[1] - 10) / 9 + sq(x[2] - 5);
  });
  p.solutions = {
      {"minimum", vec({3.6504617252130367, 3.6504617252130367, 4.620417555320008, 0.08215327730346257}), 1e-12}};
  p.solutions_complete = true;
  return p;
}

/// HS66: 0.2 x3 - 0.8 x1, x2 >= exp(x1), x3 >= exp(x2), 0 <= x <= (100, 100, 10). Convex: one solution.
Problem hs66_kkt() {
  const Box X{Vec::Zero(3), vec({100, 100, 10})};
  Problem p =
      kkt_problem<3>({"hs66-kkt", X, 2}, {vec({0, 1.05, 2.9}), vec({1, 2, 10})}, {}, [](const auto& x, const auto& g) {
        using std::exp;
        g[0] = x[1] - exp(x[0]);
        g[1] = x[2] - exp(x[1]);
        return 0.2 * x[2] - 0.8 * x[0];
      });
  p.solutions = {
      {"minimum",
       vec({0.1841264879228478, 1.202167873197043, 3.327322322599096, 0.6654644645198191, 0.19999999999999996}),
       1e-12}};
  p.solutions_complete = true;
  return p;
}

/// HS72: 1 + x1 + x2 + x3 + x4, 4/x1 + 2.25/x2 + 1/x3 + 0.25/x4 <= 0.0401, 0.16/x1 + 0.36/x2 + 0.64/x3 + 0.64/x4 <=
/// 0.010085, 0.001 <= x_i <= (5 - i) 10^5. Convex; multipliers of 10^4: one solution.
Problem hs72_kkt() {
  const Box X{Vec::Constant(4, 0.001), vec({4e5, 3e5, 2e5, 1e5})};
  Problem p =
      kkt_problem<4>({"hs72-kkt", X, 2}, {Vec::Ones(4), Vec::Constant(4, 100)}, {}, [](const auto& x, const auto& g) {
        g[0] = 0.0401 - 4 / x[0] - 2.25 / x[1] - 1 / x[2] - 0.25 / x[3];
        g[1] = 0.010085 - 0.16 / x[0] - 0.36 / x[1] - 0.64 / x[2] - 0.64 / x[3];
        return 1 + x[0] + x[1] + x[2] + x[3];
      });
  p.solutions = {{"minimum",
                  vec({193.40742727194637, 179.54707603227456, 185.01806335815152, 168.7067911272405, 7692.936528467465,
                       41466.79256302109}),
                  1e-10}};
  p.solutions_complete = true;
  return p;
}

/// HS93, the design of a transformer: polynomials of degree up to 6, x >= 0.
Problem hs93_kkt() {
  return kkt_problem<6>({"hs93-kkt", Box::nonnegative(6), 2},
                        {vec({5.54, 4.4, 12.02, 11.82, 0.702, 0.852}), vec({5, 5, 10, 10, 1, 1})},
                        {{"minimum",
                          vec({5.332666335528824, 4.656744059172028, 10.432991940468293, 12.082306340063704,
                               0.7526074362238301, 0.8786508746591366, 71.45948976574837, 62.15222892431373}),
                          1e-12}},
                        [](const auto& x, const auto& g) {
                          const auto core = x[0] * x[3] * (x[0] + x[1] + x[2]);
                          const auto coil = x[1] * x[2] * (x[0] + 1.57 * x[1] + x[3]);
                          g[0] = 0.001 * x[0] * x[1] * x[2] * x[3] * x[4] * x[5] - 2.07;
                          g[1] = 1 - 0.00062 * core * sq(x[4]) - 0.00058 * coil * sq(x[5]);
                          return 0.0204 * core + 0.0187 * coil + 0.0607 * core * sq(x[4]) + 0.0437 * coil * sq(x[5]);
                        });
}

/// HS100: (x1 - 10)^2 + 5 (x2 - 12)^2 + x3^4 + 3 (x4 - 11)^2 + 10 x5^6 + 7 x6^2 + x7^4 - 4 x6 x7 - 10 x6 - 8 x7 and
/// four constraints, all free.
Problem hs100_kkt() {
  return kkt_problem<7>(
      {"hs100-kkt", free_box(7), 4}, {vec({1, 2, 0, 4, 0, 1, 1}), Vec::Zero(7)},
      {{"minimum",
        vec({2.33049937287957, 1.951372372896889, -0.47754139238887156, 4.365726233655811, -0.6244869705268175,
             1.0381310186079584, 1.5942267116118685, 1.139719959167376, 0, 0, 0.36861451718721155}),
        1e-12}},
      [](const auto& x, const auto& g) {
        g[0] = 127 - 2 * sq(x[0]) - 3 * sq(sq(x[1])) - x[2] - 4 * sq(x[3]) - 5 * x[4];
        g[1] = 282 - 7 * x[0] - 3 * x[1] - 10 * sq(x[2]) - x[3] + x[4];
        g[2] = 196 - 23 * x[0] - sq(x[1]) - 6 * sq(x[5]) + 8 * x[6];
        g[3] = -4 * sq(x[0]) - sq(x[1]) + 3 * x[0] * x[1] - 2 * sq(x[2]) - 5 * x[5] + 11 * x[6];
        return sq(x[0] - 10) + 5 * sq(x[1] - 12) + sq(sq(x[2])) + 3 * sq(x[3] - 11) + 10 * sq(cube(x[4])) +
               7 * sq(x[5]) + sq(sq(x[6])) - 4 * x[5] * x[6] - 10 * x[5] - 8 * x[6];
      });
}

/// HS113 (Wong 2): a convex quadratic function of ten unknowns, three linear and five quadratic constraints, all free.
Problem hs113_kkt() {
  return kkt_problem<10>(
      {"hs113-kkt", free_box(10), 8}, {vec({2, 3, 5, 5, 1, 2, 7, 3, 6, 10}), Vec::Zero(10)},
      {{"minimum",
        vec({2.1719963712554553, 2.3636829736972804, 8.77392573847685, 5.095984487948453, 0.9906547649638593,
             1.4305739789363159, 1.321644208161703, 9.828725807886322, 8.280091670098345, 8.375926663921323,
             1.7165331534681731, 0.47452015418897125, 1.3759266639213232, 0.020545555102422407, 0.31202850893533274, 0,
             0.2870493192908773, 0}),
        1e-12}},
      [](const auto& x, const auto& g) {
        g[0] = 105 - 4 * x[0] - 5 * x[1] + 3 * x[6] - 9 * x[7];
        g[1] = -10 * x[0] + 8 * x[1] + 17 * x[6] - 2 * x[7];
        g[2] = 8 * x[0] - 2 * x[1] - 5 * x[8] + 2 * x[9] + 12;
        g[3] = -3 * sq(x[0] - 2) - 4 * sq(x[1] - 3) - 2 * sq(x[2]) + 7 * x[3] + 120;
        g[4] = -5 * sq(x[0]) - 8 * x[1] - sq(x[2] - 6) + 2 * x[3] + 40;
        g[5] = -0.5 * sq(x[0] - 8) - 2 * sq(x[1] - 4) - 3 * sq(x[4]) + x[5] + 30;
        g[6] = -sq(x[0]) - 2 * sq(x[1] - 2) + 2 * x[0] * x[1] - 14 * x[4] + 6 * x[5];
        g[7] = 3 * x[0] - 6 * x[1] - 12 * sq(x[8] - 8) + 7 * x[9];
        return sq(x[0]) + sq(x[1]) + x[0] * x[1] - 14 * x[0] - 16 * x[1] + sq(x[2] - 10) + 4 * sq(x[3] - 5) +
               sq(x[4] - 3) + 2 * sq(x[5] - 1) + 5 * sq(x[6]) + 7 * sq(x[7] - 11) + 2 * sq(x[8] - 10) + sq(x[9] - 7) +
               45;
      });
}

/// HS118: a production plan of five periods k = 0..4 with three goods each,
///     sum_k 2.3 a_k + 1e-4 a_k^2 + 1.7 b_k + 1e-4 b_k^2 + 2.2 c_k + 1.5e-4 c_k^2,     a_k + b_k + c_k >= demand_k,
///     -7 <= a_k - a_{k-1} <= 6, -7 <= b_k - b_{k-1} <= 7, -7 <= c_k - c_{k-1} <= 6, k >= 1, all within bounds.
/// Nearly a linear program, with as many active constraints as unknowns, or more.
Problem hs118_kkt() {
  constexpr int periods = 5, goods = 3;
  Vec upper(15), book(15), middle(15);
  upper << 21, 57, 16, 90, 120, 60, 90, 120, 60, 90, 120, 60, 90, 120, 60;
  Vec lower = Vec::Zero(15);
  lower.head(3) << 8, 43, 3;
  for (int j = 0; j < 15; ++j) book[j] = j % goods == 0 ? 20 : j == 1 ? 55 : j % goods == 1 ? 60 : j == 2 ? 15 : 20;
  middle = 0.5 * (lower + upper);
  return kkt_problem<15>({.name = "hs118-kkt", .X = {lower, upper}, .inequalities = 29, .quadratic = true},
                         {book, middle},
                         {{"minimum",
                           joined({vec({8, 49, 3, 1, 56, 0, 0.9999999999999964, 63, 6, 3.0000000000000013, 70, 12,
                                        4.999999999999994, 77, 18}),
                                   vec({1.6612000000000007, 2.3002, 0, 0, 0.048599999999999206, 0, 0, 0, 0, 0, 0,
                                        1.7597999999999994, 0, 0.2909999999999991, 2.3002}),
                                   vec({0, 0, 0, 1.1721999999999992, 0, 0.19259999999999908, 2.3005999999999998, 0, 0,
                                        0, 0.5855999999999997, 0, 0.09559999999999975, 2.3009999999999997})}),
                           1e-12}},
                         [](const auto& x, const auto& g) {
                           constexpr double price[] = {2.3, 1.7, 2.2}, curvature[] = {1e-4, 1e-4, 1.5e-4};
                           constexpr double rise[] = {6, 7, 6}, demand[] = {60, 50, 70, 85, 100};
                           auto cost = 0 * x[0];
                           int row = 0;
                           for (int k = 0; k < periods; ++k) {
                             auto supply = -demand[k] + x[goods * k];
                             for (int j = 0; j < goods; ++j) {
                               const auto& now = x[goods * k + j];
                               cost += price[j] * now + curvature[j] * sq(now);
                               if (j > 0) supply += now;
                               if (k == 0) continue;
                               const auto growth = now - x[goods * (k - 1) + j];
                               g[row++] = growth + 7;
                               g[row++] = rise[j] - growth;
                             }
                             g[row++] = supply;
                           }
                           return cost;
                         });
}

}  // namespace perp::ncp::collection

// SPDX-License-Identifier: Apache-2.0
/// Karush-Kuhn-Tucker systems of test problems of Hock & Schittkowski 1981 with bounds only (see
/// collection/base/nlp.hpp): l <= x <= u  _|_  grad f(x). The first start is the book's.
#include <cmath>

#include "collection/base/nlp.hpp"
#include "collection/kkt/kkt_entries.hpp"

namespace perp::ncp::collection {

namespace {

/// 100 (x2 - x1^2)^2 + (1 - x1)^2
constexpr auto curved_valley = [](const auto& x, const auto&) { return 100 * sq(x[1] - sq(x[0])) + sq(1 - x[0]); };

}  // namespace

/// HS1: Rosenbrock's function, x2 >= -1.5. x2 = -1.5 would need x1^2 <= -1.5, and F = 0 has one root.
Problem hs1_kkt() {
  const Box X{vec({-infinity, -1.5}), vec({infinity, infinity})};
  Problem p =
      kkt_problem<2>({"hs1-kkt", X}, {vec({-2, 1}), vec({-1.2, 1}), vec({0, 0}), vec({10, -1.5})}, {}, curved_valley);
  p.solutions = {{"minimum", vec({1, 1}), 0}};
  p.solutions_complete = true;
  return p;
}

/// HS2: the same, x2 >= 1.5: x2 = 1.5 at three roots of 400 x1^3 - 598 x1 - 2 = 0, all with x1^2 <= 1.5, so that F2 =
/// 200 (1.5 - x1^2) >= 0.
Problem hs2_kkt() {
  const Box X{vec({-infinity, 1.5}), vec({infinity, infinity})};
  Problem p =
      kkt_problem<2>({"hs2-kkt", X}, {vec({-2, 1}), vec({0, 1.5}), vec({2, 4}), vec({-1.2, 10})}, {}, curved_valley);
  const double a = std::sqrt(598.0 / 1200);
  const double angle = std::acos(1 / (400 * a * a * a));
  const auto root = [&](double turn) { return vec({2 * a * std::cos((angle + turn) / 3), 1.5}); };
  constexpr double circle = 6.283185307179586;
  p.solutions = {{"minimum", root(0), 1e-14},
                 {"local minimum", root(circle), 1e-14},
                 {"local maximum on the bound", root(2 * circle), 1e-14}};
  p.solutions_complete = true;
  return p;
}

/// HS3: x2 + 1e-5 (x2 - x1)^2, x2 >= 0. F1 = 0 says x1 = x2, hence F2 = 1 and x2 = 0.
Problem hs3_kkt() {
  const Box X{vec({-infinity, 0}), vec({infinity, infinity})};
  Problem p =
      kkt_problem<2>({.name = "hs3-kkt", .X = X, .quadratic = true}, {vec({10, 1}), vec({0, 0}), vec({-1e4, 1e4})}, {},
                     [](const auto& x, const auto&) { return x[1] + 1e-5 * sq(x[1] - x[0]); });
  p.solutions = {{"minimum", vec({0, 0}), 0}};
  p.solutions_complete = true;
  return p;
}

/// HS5: sin(x1 + x2) + (x1 - x2)^2 - 1.5 x1 + 2.5 x2 + 1, -1.5 <= x1 <= 4, -3 <= x2 <= 3. Inside, F = 0 is cos(s) =
/// -1/2 and x1 - x2 = 1 with s = x1 + x2.
Problem hs5_kkt() {
  const Box X{vec({-1.5, -3}), vec({4, 3})};
  Problem p = kkt_problem<2>({"hs5-kkt", X}, {vec({0, 0}), vec({4, 3}), vec({-1.5, -3}), vec({1.25, 0}), vec({4, -3})},
                             {}, [](const auto& x, const auto&) {
                               using std::sin;
                               return sin(x[0] + x[1]) + sq(x[0] - x[1]) - 1.5 * x[0] + 2.5 * x[1] + 1;
                             });
  constexpr double third = 1.0471975511965976;  // pi / 3
  p.solutions = {{"minimum", vec({0.5 - third, -0.5 - third}), 1e-15},
                 {"local minimum", vec({0.5 + 2 * third, -0.5 + 2 * third}), 1e-15},
                 {"saddle", vec({0.5 + third, -0.5 + third}), 1e-15}};
  return p;
}

/// HS38, Colville's problem 4, in the box [-10, 10]^4: 100 (x2 - x1^2)^2 + (1 - x1)^2 + 90 (x4 - x3^2)^2 + (1 - x3)^2 +
/// 10.1 ((x2 - 1)^2 + (x4 - 1)^2) + 19.8 (x2 - 1)(x4 - 1).
Problem hs38_kkt() {
  const Box X{Vec::Constant(4, -10), Vec::Constant(4, 10)};
  return kkt_problem<4>({"hs38-kkt", X},
                        {vec({-3, -1, -3, -1}), Vec::Zero(4), Vec::Constant(4, 10), Vec::Constant(4, -10)},
                        {{"minimum", Vec::Ones(4), 0}}, [](const auto& x, const auto&) {
                          return 100 * sq(x[1] - sq(x[0])) + sq(1 - x[0]) + 90 * sq(x[3] - sq(x[2])) + sq(1 - x[2]) +
                                 10.1 * (sq(x[1] - 1) + sq(x[3] - 1)) + 19.8 * (x[1] - 1) * (x[3] - 1);
                        });
}

/// HS45: 2 - x1 x2 x3 x4 x5 / 120, 0 <= x_i <= i. Where two of the unknowns are 0 F vanishes: a continuum of KKT points
/// that are no minima. The book's start lies above x1's bound.
Problem hs45_kkt() {
  const Box X{Vec::Zero(5), vec({1, 2, 3, 4, 5})};
  return kkt_problem<5>({"hs45-kkt", X},
                        {Vec::Constant(5, 2), Vec::Constant(5, 0.1), vec({0.5, 1, 1.5, 2, 2.5}), vec({0, 2, 3, 4, 5})},
                        {{"minimum", vec({1, 2, 3, 4, 5}), 0}, {"the worst", Vec::Zero(5), 0}},
                        [](const auto& x, const auto&) { return 2 - x[0] * x[1] * x[2] * x[3] * x[4] / 120; });
}

/// HS110: sum_i (log(x_i - 2)^2 + log(10 - x_i)^2) - (prod_i x_i)^0.2, 2.001 <= x_i <= 9.999, i = 1..10. Poles 0.001
/// outside the box.
Problem hs110_kkt() {
  constexpr int n = 10;
  const Box X{Vec::Constant(n, 2.001), Vec::Constant(n, 9.999)};
  return kkt_problem<n>({"hs110-kkt", X}, {Vec::Constant(n, 9), Vec::Constant(n, 6), X.lower, Vec::Constant(n, 2.5)},
                        {{"minimum", Vec::Constant(n, 9.350265833069384), 1e-12}}, [](const auto& x, const auto&) {
                          using std::log, std::pow;
                          auto product = x[0];
                          auto sum = sq(log(x[0] - 2)) + sq(log(10 - x[0]));
                          for (int i = 1; i < n; ++i) {
                            product *= x[i];
                            sum += sq(log(x[i] - 2)) + sq(log(10 - x[i]));
                          }
                          return sum - pow(product, 0.2);
                        });
}

}  // namespace perp::ncp::collection

// SPDX-License-Identifier: Apache-2.0
/// Karush-Kuhn-Tucker systems of test problems of Hock & Schittkowski 1981 (HS) and of Colville 1968.
///     min f(x), g(x) >= 0, x in X:    X    contains x       _|_  grad f(x) - g'(x)' lambda
///                                     R_+  contains lambda  _|_  g(x).
#include <cmath>

#include "collection/base/build.hpp"
#include "collection/models/problems.hpp"

namespace perp::ncp::collection {

namespace {

Names kkt_names(Index unknowns, Index constraints) {
  return joined({indexed("x", unknowns), indexed("lambda", constraints)});
}

// Colville's problems 1 (HS86) and 2 (HS117), which are dual to each other.
constexpr int columns = 5;
constexpr int rows = 10;
constexpr double A[rows][columns] = {{-16, 2, 0, 1, 0},    {0, -2, 0, 4, 2}, {-3.5, 0, 2, 0, 0},   {0, -2, 0, -4, -1},
                                     {0, -9, -2, 1, -2.8}, {2, 0, -4, 0, 0}, {-1, -1, -1, -1, -1}, {-1, -2, -3, -2, -1},
                                     {1, 2, 3, 4, 5},      {1, 1, 1, 1, 1}};
constexpr double b[rows] = {-40, -2, -.25, -4, -4, -1, -40, -60, 5, 1};
constexpr double C[columns][columns] = {{30, -20, -10, 32, -10},
                                        {-20, 39, -6, -31, 32},
                                        {-10, -6, 10, -6, -10},
                                        {32, -31, -6, 39, -20},
                                        {-10, 32, -10, -20, 30}};
constexpr double d[columns] = {4, 8, 10, 6, 2};
constexpr double e[columns] = {-15, -27, -36, -18, -12};

/// e + 2 C x + 3 d . x . x - A' lambda, row j: the gradient of HS86's Lagrangian, the constraint of HS117.
template <class T>
T colville_gradient(int j, Row<const T> x, Row<const T> lambda) {
  T sum = e[j] + 3 * d[j] * x[j] * x[j];
  for (int k = 0; k < columns; ++k) sum += 2 * C[j][k] * x[k];
  for (int i = 0; i < rows; ++i) sum -= A[i][j] * lambda[i];
  return sum;
}

/// -b + A x, row i.
template <class T>
T colville_constraint(int i, Row<const T> x) {
  T sum = -b[i];
  for (int k = 0; k < columns; ++k) sum += A[i][k] * x[k];
  return sum;
}

}  // namespace

/// HS34: min -x1, x2 >= exp(x1), x3 >= exp(x2), x1, x2 in [0, 100], x3 in [0, 10]:
///     -1 + l1 exp(x1), -l1 + l2 exp(x2), -l2, x2 - exp(x1), x3 - exp(x2).
/// At the solution F3 = -l2 < 0: x3 sits at its upper bound.
Problem hs34_kkt() {
  Problem p;
  const Box box{Vec::Zero(5), vec({100, 100, 10, infinity, infinity})};
  p.mcp = make_problem({"hs34-kkt", box, kkt_names(3, 2)}, [](const auto& z, const auto& F) {
    using std::exp;
    const auto e1 = exp(z[0]), e2 = exp(z[1]);
    F[0] = -1 + z[3] * e1;
    F[1] = -z[3] + z[4] * e2;
    F[2] = -z[4];
    F[3] = z[1] - e1;
    F[4] = z[2] - e2;
  });
  p.starts = {vec({0, 1.05, 2.9, 0, 0}), vec({1, 1, 5, 0.1, 0.1}), vec({0, 1.05, 2.9, 1, 1}), Vec::Zero(5)};
  const double ln10 = std::log(10.0);
  p.solutions = {{"unique", vec({std::log(ln10), ln10, 10, 1 / ln10, 0.1 / ln10}), 1e-14}};
  p.solutions_complete = true;
  return p;
}

/// HS35 (Beale): min 9 - 8 x1 - 6 x2 - 4 x3 + 2 x1^2 + 2 x2^2 + x3^2 + 2 x1 x2 + 2 x1 x3, x1 + x2 + 2 x3 <= 3, x >= 0.
Problem hs35_kkt() {
  Problem p;
  p.mcp = make_problem({"hs35-kkt", Box::nonnegative(4), kkt_names(3, 1)}, [](const auto& z, const auto& F) {
    const auto &x1 = z[0], &x2 = z[1], &x3 = z[2], &lambda = z[3];
    F[0] = -8 + 4 * x1 + 2 * x2 + 2 * x3 + lambda;
    F[1] = -6 + 2 * x1 + 4 * x2 + lambda;
    F[2] = -4 + 2 * x1 + 2 * x3 + 2 * lambda;
    F[3] = 3 - x1 - x2 - 2 * x3;
  });
  p.starts = {Vec::Zero(4), Vec::Ones(4), vec({0.5, 0.5, 0.5, 0}), Vec::Constant(4, 10)};
  p.solutions = {{"unique", vec({4. / 3, 7. / 9, 4. / 9, 2. / 9}), 1e-15}};
  p.solutions_complete = true;
  return p;
}

/// HS76: min x1^2 + x2^2/2 + x3^2 + x4^2/2 - x1 x3 + x3 x4 - x1 - 3 x2 + x3 - x4 subject to 5 - x1 - 2 x2 - x3 - x4 >=
/// 0, 4 - 3 x1 - x2 - 2 x3 + x4 >= 0, x2 + 4 x3 - 1.5 >= 0, x >= 0.
Problem hs76_kkt() {
  Problem p;
  p.mcp = make_problem({"hs76-kkt", Box::nonnegative(7), kkt_names(4, 3)}, [](const auto& z, const auto& F) {
    const auto &x1 = z[0], &x2 = z[1], &x3 = z[2], &x4 = z[3], &l1 = z[4], &l2 = z[5], &l3 = z[6];
    F[0] = 2 * x1 - x3 - 1 + l1 + 3 * l2;
    F[1] = x2 - 3 + 2 * l1 + l2 - l3;
    F[2] = 2 * x3 - x1 + x4 + 1 + l1 + 2 * l2 - 4 * l3;
    F[3] = x4 + x3 - 1 + l1 - l2;
    F[4] = 5 - x1 - 2 * x2 - x3 - x4;
    F[5] = 4 - 3 * x1 - x2 - 2 * x3 + x4;
    F[6] = x2 + 4 * x3 - 1.5;
  });
  p.starts = {Vec::Zero(7), Vec::Ones(7), vec({0.5, 0.5, 0.5, 0.5, 0, 0, 0}), Vec::Constant(7, 10)};
  p.solutions = {{"unique", vec({3. / 11, 23. / 11, 0, 6. / 11, 5. / 11, 0, 0}), 1e-15}};
  p.solutions_complete = true;
  return p;
}

namespace {

/// The solution of HS86; HS117 has y = lambda, x = w = x.
Vec colville_x() { return vec({.3, .33346760653460711, .4, .42831010478169879, .22396487356079811}); }
Vec colville_lambda() {
  return vec({0, 0, 5.1740407276981735, 0, 3.0611086877584506, 11.839545664800733, 0, 0, .1038961907706156, 0});
}

}  // namespace

/// HS86: min e'x + x'Cx + d'x^3, A x >= b, x >= 0, with z = (x, lambda):
///     F_x = e + 2 C x + 3 d . x^2 - A' lambda,     F_lambda = A x - b.
/// Strictly convex where x > 0; four constraints with independent gradients are active: one solution.
Problem colvnlp() {
  Problem p;
  p.mcp = make_problem({"colvnlp", Box::nonnegative(15), kkt_names(5, 10)}, [](const auto& z, const auto& F) {
    const auto x = z.head(columns), lambda = z.tail(rows);
    for (int j = 0; j < columns; ++j) F[j] = colville_gradient(j, x, lambda);
    for (int i = 0; i < rows; ++i) F[columns + i] = colville_constraint(i, x);
  });
  Vec feasible = Vec::Zero(15);
  feasible[4] = 1;
  p.starts = {Vec::Zero(15), Vec::Ones(15), feasible};
  p.solutions = {{"Colville 1", joined({colville_x(), colville_lambda()}), 1e-14}};
  p.solutions_complete = true;
  return p;
}

/// HS117, Colville's dual of HS86: min -b'y + 2 d'x^3 + x'Cx, e + 2 C x + 3 d . x^2 - A'y >= 0, x, y >= 0, with
/// z = (y, x, w):
///     F_y = -b + A w,   F_x = 2 C x + 6 d . x^2 - 2 C w - 6 d . x . w,   F_w = e + 2 C x + 3 d . x^2 - A'y.
/// Not monotone.
Problem colvdual() {
  Problem p;
  const Names names = joined({indexed("y", 10), indexed("x", 5), indexed("w", 5)});
  p.mcp = make_problem({"colvdual", Box::nonnegative(20), names}, [](const auto& z, const auto& F) {
    const auto y = z.head(rows), x = z.segment(rows, columns), w = z.tail(columns);
    for (int i = 0; i < rows; ++i) F[i] = colville_constraint(i, w);
    for (int j = 0; j < columns; ++j) {
      F[rows + j] = 6 * d[j] * x[j] * (x[j] - w[j]);
      for (int k = 0; k < columns; ++k) F[rows + j] += 2 * C[j][k] * (x[k] - w[k]);
      F[rows + columns + j] = colville_gradient(j, x, y);
    }
  });
  Vec hs117 = Vec::Constant(20, 0.001);
  hs117[6] = 60;
  hs117.tail(columns).setZero();
  p.starts = {hs117, Vec::Ones(20), Vec::Zero(20)};
  p.solutions = {{"Colville 2", joined({colville_lambda(), colville_x(), colville_x()}), 1e-14}};
  return p;
}

}  // namespace perp::ncp::collection

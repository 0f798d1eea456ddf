// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Karush-Kuhn-Tucker systems from the functions of a nonlinear program,
///     min f(x)  subject to  g_k(x) >= 0, k = 1..m,   h_k(x) = 0, k = 1..p,   x in the box X:
///     X        contains x       _|_  grad f(x) - g'(x)' lambda - h'(x)' mu,
///     R_+^m    contains lambda  _|_  g(x),
///     R^p      contains mu      _|_  h(x).
/// Gradients come by forward differentiation, and the Jacobian by differentiating that once more (dual.hpp), so that
/// only f, g and h are written down. Private to the collection.
#include <vector>

#include "collection/base/build.hpp"

namespace perp::ncp::collection {

/// u^2, u^3
template <class U>
U sq(const U& u) {
  return u * u;
}
template <class U>
U cube(const U& u) {
  return u * u * u;
}

struct Nlp {
  std::string name;
  Box X;
  int inequalities = 0;
  int equalities = 0;
  bool quadratic = false;  ///< f is quadratic, g and h are affine: the KKT system is affine
};

/// The box of (x, lambda, mu), and the names "x[1]", .., "lambda[1]", .., "mu[1]", ....
Shape kkt_shape(const Nlp& nlp);
/// F(x) = F(0) + F'(0) x of a problem known to be affine.
std::unique_ptr<Mcp> as_affine(const Mcp& mcp, Shape shape);
/// Each of the points with all multipliers 0 and, where there are multipliers, with all of them 1.
std::vector<Vec> kkt_starts(const Nlp& nlp, std::initializer_list<Vec> points);

/// `fn(x, g)` answers f(x) and writes g_1, .., g_m, h_1, .., h_p to g; x and g are Rows of some Partial, or of double.
template <int n, class Fn>
Problem kkt_problem(const Nlp& nlp, std::initializer_list<Vec> points, std::vector<KnownSolution> solutions, Fn fn) {
  const int m = nlp.inequalities + nlp.equalities;
  Problem p{.mcp = {}, .starts = kkt_starts(nlp, points), .solutions = std::move(solutions)};
  p.mcp = make_problem(kkt_shape(nlp), [fn, m](const auto& z, const auto& F) {
    using T = Number<decltype(F)>;
    Partial<T, n> x[n];
    std::vector<Partial<T, n>> values(static_cast<std::size_t>(m));
    const Row<Partial<T, n>> g(values.data(), m);
    for (int j = 0; j < n; ++j) {
      x[j].v = z[j];
      x[j].d[j] = 1;
    }
    const Partial<T, n> f = fn(Row<const Partial<T, n>>(x, n), g);
    for (int j = 0; j < n; ++j) {
      F[j] = f.d[j];
      for (int k = 0; k < m; ++k) F[j] -= z[n + k] * g[k].d[j];
    }
    for (int k = 0; k < m; ++k) F[n + k] = g[k].v;
  });
  if (nlp.quadratic) p.mcp = as_affine(*p.mcp, kkt_shape(nlp));
  p.objective = [fn, m](In z) {
    std::vector<double> g(static_cast<std::size_t>(m));
    return fn(Row<const double>(z.data(), n), Row<double>(g.data(), m));
  };
  return p;
}

}  // namespace perp::ncp::collection

#pragma once
/// Karush-Kuhn-Tucker systems from the functions of a nonlinear program,
///     min f(x)  subject to  g_k(x) >= 0, k = 1..m,   h_k(x) = 0, k = 1..p,   x in the box X:
///     X        contains x       _|_  grad f(x) - g'(x)' lambda - h'(x)' mu,
///     R_+^m    contains lambda  _|_  g(x),
///     R^p      contains mu      _|_  h(x).
/// Gradients come by forward differentiation, and the Jacobian by differentiating that once more (dual.hpp), so that
/// only f, g and h are written down. Private to the collection.
#include <vector>

#include "ncp/collection/base/build.hpp"

namespace perp::ncp::collection {

/// v with its n partial derivatives, all of type T (double or Dual).
template <class T, int n>
struct Partial {
  T v = 0;
  T d[n] = {};

  Partial() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): a number is a Partial with zero derivatives
  Partial(double number) : v(number) {}
  static Partial chain(const T& f, const T& df, const Partial& u) {
    Partial w;
    w.v = f;
    for (int k = 0; k < n; ++k) w.d[k] = df * u.d[k];
    return w;
  }

  Partial& operator+=(const Partial& b) {
    v += b.v;
    for (int k = 0; k < n; ++k) d[k] += b.d[k];
    return *this;
  }
  Partial& operator-=(const Partial& b) {
    v -= b.v;
    for (int k = 0; k < n; ++k) d[k] -= b.d[k];
    return *this;
  }
  Partial& operator*=(const Partial& b) {
    for (int k = 0; k < n; ++k) d[k] = d[k] * b.v + v * b.d[k];
    v *= b.v;
    return *this;
  }
  Partial& operator/=(const Partial& b) {
    v /= b.v;
    for (int k = 0; k < n; ++k) d[k] = (d[k] - v * b.d[k]) / b.v;
    return *this;
  }
  friend Partial operator-(const Partial& a) { return chain(-a.v, T(-1), a); }
  friend Partial operator+(Partial a, const Partial& b) { return a += b; }
  friend Partial operator-(Partial a, const Partial& b) { return a -= b; }
  friend Partial operator*(Partial a, const Partial& b) { return a *= b; }
  friend Partial operator/(Partial a, const Partial& b) { return a /= b; }
  friend Partial operator+(Partial a, double b) { return a.v += b, a; }
  friend Partial operator+(double a, Partial b) { return b.v += a, b; }
  friend Partial operator-(Partial a, double b) { return a.v -= b, a; }
  friend Partial operator-(double a, const Partial& b) { return chain(a - b.v, T(-1), b); }
  friend Partial operator*(const Partial& a, double b) { return chain(a.v * b, T(b), a); }
  friend Partial operator*(double a, const Partial& b) { return chain(b.v * a, T(a), b); }
  friend Partial operator/(const Partial& a, double b) { return chain(a.v / b, T(1 / b), a); }
  friend Partial operator/(double a, const Partial& b) { return chain(a / b.v, -a / (b.v * b.v), b); }

  // The functions of a T are found by the using declarations (double) and by its own friends (Dual).
  friend Partial exp(const Partial& u) {
    using std::exp;
    const T e = exp(u.v);
    return chain(e, e, u);
  }
  friend Partial log(const Partial& u) {
    using std::log;
    return chain(log(u.v), 1 / u.v, u);
  }
  friend Partial sqrt(const Partial& u) {
    using std::sqrt;
    const T root = sqrt(u.v);
    return chain(root, 0.5 / root, u);
  }
  friend Partial sin(const Partial& u) {
    using std::cos, std::sin;
    return chain(sin(u.v), cos(u.v), u);
  }
  friend Partial cos(const Partial& u) {
    using std::cos, std::sin;
    return chain(cos(u.v), -sin(u.v), u);
  }
  friend Partial pow(const Partial& u, double p) {
    using std::pow;
    return chain(pow(u.v, p), p * pow(u.v, p - 1), u);
  }
};

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
Problem kkt_problem(const Nlp& nlp, std::initializer_list<Vec> points, Fn fn) {
  const int m = nlp.inequalities + nlp.equalities;
  Problem p;
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
    return true;
  });
  if (nlp.quadratic) p.mcp = as_affine(*p.mcp, kkt_shape(nlp));
  p.objective = [fn, m](In z) {
    std::vector<double> g(static_cast<std::size_t>(m));
    return fn(Row<const double>(z.data(), n), Row<double>(g.data(), m));
  };
  p.starts = kkt_starts(nlp, points);
  return p;
}

}  // namespace perp::ncp::collection

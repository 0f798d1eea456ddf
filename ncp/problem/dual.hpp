// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Forward-mode automatic differentiation: a Partial is v + sum_k d_k eps_k with eps_j eps_k = 0, so that arithmetic on
/// it carries `width` directional derivatives along with the value. A Jacobian with n columns takes ceil(n / width)
/// sweeps; with columns in groups (ncp/problem/colouring.hpp), so many groups. At kinks a derivative is that of one
/// side: of abs at 0 that of the right, of min and max of equal operands that of the first. Comparisons look at v.
/// Reference: Griewank & Walther, Evaluating Derivatives, 2nd ed. 2008, section 3.1 (vector forward mode).
#include <cmath>
#include <compare>
#include <type_traits>

namespace perp::ncp {

/// v with n directional derivatives, all of type T: double, or Dual for derivatives of derivatives.
template <class T, int n>
struct Partial {
  static constexpr int width = n;
  T v = 0;
  T d[n] = {};

  Partial() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): a number is a Partial with zero derivatives
  Partial(double number) : v(number) {}

  /// f(u): value f and derivative df * du.
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
  Partial& operator*=(double s) { return *this = chain(v * s, T(s), *this); }
  Partial& operator/=(double s) { return *this = chain(v / s, T(1 / s), *this); }

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
  friend Partial atan(const Partial& u) {
    using std::atan;
    return chain(atan(u.v), 1 / (1 + u.v * u.v), u);
  }
  friend Partial expm1(const Partial& u) {
    using std::exp, std::expm1;
    return chain(expm1(u.v), exp(u.v), u);
  }
  friend Partial log1p(const Partial& u) {
    using std::log1p;
    return chain(log1p(u.v), 1 / (1 + u.v), u);
  }
  friend Partial log10(const Partial& u) {
    using std::log10;
    return chain(log10(u.v), 1 / (u.v * std::log(10.0)), u);
  }
  friend Partial tan(const Partial& u) {
    using std::tan;
    const T t = tan(u.v);
    return chain(t, 1 + t * t, u);
  }
  friend Partial asin(const Partial& u) {
    using std::asin, std::sqrt;
    return chain(asin(u.v), 1 / sqrt((1 - u.v) * (1 + u.v)), u);
  }
  friend Partial acos(const Partial& u) {
    using std::acos, std::sqrt;
    return chain(acos(u.v), -1 / sqrt((1 - u.v) * (1 + u.v)), u);
  }
  friend Partial sinh(const Partial& u) {
    using std::cosh, std::sinh;
    return chain(sinh(u.v), cosh(u.v), u);
  }
  friend Partial cosh(const Partial& u) {
    using std::cosh, std::sinh;
    return chain(cosh(u.v), sinh(u.v), u);
  }
  friend Partial tanh(const Partial& u) {
    using std::cosh, std::tanh;
    const T c = cosh(u.v);
    return chain(tanh(u.v), 1 / (c * c), u);
  }
  friend Partial asinh(const Partial& u) {
    using std::asinh, std::sqrt;
    return chain(asinh(u.v), 1 / sqrt(u.v * u.v + 1), u);
  }
  friend Partial acosh(const Partial& u) {
    using std::acosh, std::sqrt;
    return chain(acosh(u.v), 1 / sqrt((u.v - 1) * (u.v + 1)), u);
  }
  friend Partial atanh(const Partial& u) {
    using std::atanh;
    return chain(atanh(u.v), 1 / ((1 - u.v) * (1 + u.v)), u);
  }
  friend Partial floor(const Partial& u) {
    using std::floor;
    return chain(floor(u.v), T(0), u);
  }
  friend Partial ceil(const Partial& u) {
    using std::ceil;
    return chain(ceil(u.v), T(0), u);
  }
  friend Partial abs(const Partial& u) { return u.v < 0 ? -u : u; }
  friend Partial fabs(const Partial& u) { return abs(u); }
  friend Partial min(const Partial& a, const Partial& b) { return b.v < a.v ? b : a; }
  friend Partial max(const Partial& a, const Partial& b) { return a.v < b.v ? b : a; }
  friend Partial atan2(const Partial& y, const Partial& x) {
    using std::atan2;
    const T r2 = x.v * x.v + y.v * y.v;
    Partial w;
    w.v = atan2(y.v, x.v);
    for (int k = 0; k < n; ++k) w.d[k] = (x.v * y.d[k] - y.v * x.d[k]) / r2;
    return w;
  }
  /// u > 0, or p an integer.
  friend Partial pow(const Partial& u, double p) {
    using std::pow;
    return chain(pow(u.v, p), p == 0 ? T(0) : T(p * pow(u.v, p - 1)), u);
  }
  /// a > 0, or a = 0 < u.
  friend Partial pow(double a, const Partial& u) {
    using std::pow;
    const T power = pow(T(a), u.v);
    return chain(power, a == 0 ? T(0) : T(power * std::log(a)), u);
  }
  /// u > 0; also where p has no derivative, and then as pow(u, double).
  friend Partial pow(const Partial& u, const Partial& p) {
    using std::log, std::pow;
    Partial w;
    w.v = pow(u.v, p.v);
    const T by_base = p.v == 0 ? T(0) : T(p.v * pow(u.v, p.v - 1));
    const T by_exponent = u.v == 0 ? T(0) : T(w.v * log(u.v));
    for (int k = 0; k < n; ++k) {
      w.d[k] = by_base * u.d[k];
      if (!std::is_same_v<T, double> || p.d[k] != 0) w.d[k] += by_exponent * p.d[k];
    }
    return w;
  }

  friend bool operator==(const Partial& a, const Partial& b) { return a.v == b.v; }
  friend auto operator<=>(const Partial& a, const Partial& b) { return a.v <=> b.v; }
};

using Dual = Partial<double, 8>;

}  // namespace perp::ncp

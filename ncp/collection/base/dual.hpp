#pragma once
/// Forward-mode automatic differentiation: a Partial is v + sum_k d_k eps_k with eps_j eps_k = 0, so that arithmetic on
/// it carries `width` directional derivatives along with the value. A Jacobian with n columns takes ceil(n / width)
/// sweeps. Private to the collection. Reference: Griewank & Walther 2008, section 3.1 (vector forward mode).
#include <cmath>

namespace perp::ncp::collection {

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
  /// u > 0, or p an integer.
  friend Partial pow(const Partial& u, double p) {
    using std::pow;
    return chain(pow(u.v, p), p * pow(u.v, p - 1), u);
  }
};

using Dual = Partial<double, 8>;

/// The value alone, for domain tests and scalings that must not be differentiated.
inline double value(double u) { return u; }
inline double value(const Dual& u) { return u.v; }

}  // namespace perp::ncp::collection

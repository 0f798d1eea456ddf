#pragma once
/// Forward-mode automatic differentiation: a Dual is v + sum_k d_k eps_k with eps_j eps_k = 0, so that arithmetic on
/// it carries `width` directional derivatives along with the value. A Jacobian with n columns takes ceil(n / width)
/// sweeps. Private to the collection. Reference: Griewank & Walther 2008, section 3.1 (vector forward mode).
#include <cmath>

namespace perp::ncp::collection {

struct Dual {
  static constexpr int width = 8;
  double v = 0;
  double d[width] = {};

  Dual() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): a number is a Dual with zero derivatives
  Dual(double value) : v(value) {}

  /// f(u): value f and derivative df * du.
  static Dual chain(double f, double df, const Dual& u) {
    Dual w(f);
    for (int k = 0; k < width; ++k) w.d[k] = df * u.d[k];
    return w;
  }
  Dual& operator+=(const Dual& b) {
    v += b.v;
    for (int k = 0; k < width; ++k) d[k] += b.d[k];
    return *this;
  }
  Dual& operator-=(const Dual& b) {
    v -= b.v;
    for (int k = 0; k < width; ++k) d[k] -= b.d[k];
    return *this;
  }
  Dual& operator*=(const Dual& b) {
    for (int k = 0; k < width; ++k) d[k] = d[k] * b.v + v * b.d[k];
    v *= b.v;
    return *this;
  }
  Dual& operator/=(const Dual& b) {
    v /= b.v;
    for (int k = 0; k < width; ++k) d[k] = (d[k] - v * b.d[k]) / b.v;
    return *this;
  }
  Dual& operator*=(double s) { return *this = chain(v * s, s, *this); }
  Dual& operator/=(double s) { return *this = chain(v / s, 1 / s, *this); }

  friend Dual operator-(const Dual& a) { return chain(-a.v, -1, a); }
  friend Dual operator+(Dual a, const Dual& b) { return a += b; }
  friend Dual operator-(Dual a, const Dual& b) { return a -= b; }
  friend Dual operator*(Dual a, const Dual& b) { return a *= b; }
  friend Dual operator/(Dual a, const Dual& b) { return a /= b; }
  friend Dual operator+(Dual a, double b) { return a.v += b, a; }
  friend Dual operator+(double a, Dual b) { return b.v += a, b; }
  friend Dual operator-(Dual a, double b) { return a.v -= b, a; }
  friend Dual operator-(double a, const Dual& b) { return chain(a - b.v, -1, b); }
  friend Dual operator*(Dual a, double b) { return a *= b; }
  friend Dual operator*(double a, Dual b) { return b *= a; }
  friend Dual operator/(Dual a, double b) { return a /= b; }
  friend Dual operator/(double a, const Dual& b) { return chain(a / b.v, -a / (b.v * b.v), b); }
  friend Dual exp(const Dual& u) { return chain(std::exp(u.v), std::exp(u.v), u); }
  friend Dual log(const Dual& u) { return chain(std::log(u.v), 1 / u.v, u); }
  friend Dual sqrt(const Dual& u) { return chain(std::sqrt(u.v), 0.5 / std::sqrt(u.v), u); }
  friend Dual sin(const Dual& u) { return chain(std::sin(u.v), std::cos(u.v), u); }
  friend Dual cos(const Dual& u) { return chain(std::cos(u.v), -std::sin(u.v), u); }
  friend Dual atan(const Dual& u) { return chain(std::atan(u.v), 1 / (1 + u.v * u.v), u); }
  /// u > 0, or p an integer.
  friend Dual pow(const Dual& u, double p) { return chain(std::pow(u.v, p), p * std::pow(u.v, p - 1), u); }
};

/// The value alone, for domain tests and scalings that must not be differentiated.
inline double value(double u) { return u; }
inline double value(const Dual& u) { return u.v; }

}  // namespace perp::ncp::collection

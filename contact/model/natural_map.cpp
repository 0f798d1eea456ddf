// SPDX-License-Identifier: Apache-2.0
#include "contact/model/natural_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lcp/exact_sum.hpp"

namespace perp::contact {
namespace {

using Eigen::Vector3d;

/// A difference above this part of what is subtracted has its digits as it stands.
constexpr double cancels = 0.01;
/// Below this part of the other, a component's square is below every exact difference of the other with anything.
constexpr double tiny_share = 0x1p-60;

double tangential(const Vector3d& v) { return std::hypot(v[1], v[2]); }

/// alpha |(T1, T2)| - beta N, to a few eps of itself, one of alpha and beta being 1.
double difference(double alpha, double T1, double T2, double beta, double N) {
  const double T = std::hypot(T1, T2);
  const double plain = alpha * T - beta * N;
  if (!(std::abs(plain) < cancels * (alpha * T))) return plain;
  T1 = std::abs(T1);
  T2 = std::abs(T2);
  if (T1 < T2) std::swap(T1, T2);
  // To about 1, so that no square overflows or loses digits; the two products are of one size here.
  const int unit = std::ilogb(T1);
  const int size = std::ilogb(alpha * T);
  const double alpha_1 = std::ldexp(alpha, unit - size);
  const double T1_1 = std::ldexp(T1, -unit);
  const int own = std::ilogb(N);
  const double beta_1 = std::ldexp(beta, own - size);
  const double N_1 = std::ldexp(N, -own);
  const lcp::TwoParts a = lcp::two_product(alpha_1, T1_1);
  const lcp::TwoParts b = lcp::two_product(beta_1, N_1);
  if (T2 < tiny_share * T1) {  // |(T1, T2)| = T1 + T2^2 / (T1 + T); either part is nothing beside the other
    lcp::ExactSum first;
    for (const double part : {a.value, a.error, -b.value, -b.error}) first.add(part);
    return std::ldexp(first.value(), size) + alpha * T2 * (T2 / (T1 + T));
  }
  const lcp::TwoParts c = lcp::two_product(alpha_1, std::ldexp(T2, -unit));
  lcp::ExactSum numerator;
  const auto add_square = [&numerator](const lcp::TwoParts& x, double sign) {
    numerator.add_product(sign * x.error, x.error);
    numerator.add_product(sign * 2 * x.value, x.error);
    numerator.add_product(sign * x.value, x.value);
  };
  add_square(a, 1);
  add_square(c, 1);
  add_square(b, -1);
  return std::ldexp(numerator.value() / (std::hypot(a.value, c.value) + b.value), size);
}

}  // namespace

double corrected_normal(const Vector3d& u, double mu) { return difference(mu, u[1], u[2], 1, -u[0]); }

Vector3d natural_map(const Vector3d& r, const Vector3d& u, double mu, double rho) {
  const double hypotenuse = std::hypot(1, mu);
  const double cosine = 1 / hypotenuse;
  const double sine = mu / hypotenuse;
  const Vector3d w = rho * u;
  const double hat = rho * corrected_normal(u, mu);
  const Vector3d y = r - w;  // its tangential part alone
  const double r_T = tangential(r);
  const double w_T = tangential(w);
  const double y_T = tangential(y);

  // sum_i x_i (x_i - 2 z_i) / (|y_T| + |z_T|): |y_T| - |z_T| without squares, for y_T = z_T - x_T.
  const auto growth = [&](const Vector3d& x, const Vector3d& z, double z_T) {
    const double sum = y_T + z_T;
    if (!(sum > 0)) return sum;
    return x[1] * ((x[1] - 2 * z[1]) / sum) + x[2] * ((x[2] - 2 * z[2]) / sum);
  };
  const double longer = difference(1, r[1], r[2], mu, r[0]) + growth(w, r, r_T);  // s + d
  const double g = growth(r, w, w_T);
  const double b = cosine * longer + sine * hat;
  const double c = cosine * (r[0] - w[0]) + sine * g;
  // About y = 0 rounding may say both: the one that is further from 0 is no rounding.
  if (std::min(b, c) <= 0) return c <= b ? r : Vector3d(hat, w[1], w[2]);
  const Vector3d t = y_T > 0 ? Vector3d(0, y[1] / y_T, y[2] / y_T) : Vector3d::Zero();
  if (std::hypot(r[0], r_T) <= std::hypot(hat, w_T)) {
    Vector3d e = r - sine * c * t;
    e[0] = sine * (sine * r[0] - cosine * g) + cosine * (cosine * w[0]);
    return e;
  }
  Vector3d e = w + cosine * b * t;
  e[0] = cosine * (cosine * hat - sine * longer);
  return e;
}

}  // namespace perp::contact

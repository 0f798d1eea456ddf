// SPDX-License-Identifier: Apache-2.0
#include "contact/model/natural_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "lcp/exact_sum.hpp"
#include "lcp/types.hpp"

namespace perp::contact {
namespace {

using Eigen::Vector2d;
using lcp::at;

/// A difference above this part of what is subtracted has its digits as it stands.
constexpr double cancels = 0.01;
/// Below this part of the other, a component's square is below every exact difference of the other with anything.
constexpr double tiny_share = 0x1p-60;

double length(const Vector2d& v) { return std::hypot(v[0], v[1]); }

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

/// |v| in two parts; pre: |v| is near one or below.
lcp::TwoParts length_in_parts(const Vector2d& v) {
  const double rounded = length(v);
  if (rounded == 0) return {0, 0};
  lcp::ExactSum rest;
  rest.add_product(v[0], v[0]);
  rest.add_product(v[1], v[1]);
  rest.add_product(-rounded, rounded);
  return {rounded, rest.value() / (2 * rounded)};
}

/// v_N + sum mu_j |v_j| over these disks, to a few eps of itself.
template <int Size>
double corrected_normal(const ContactVector<Size>& v, const Frictions<Size>& mu, int width, unsigned which) {
  if (which == 0) return v[0];
  if constexpr (disks<Size> == 1) return difference(mu[0], v[1], v[2], 1, -v[0]);
  const double largest = v.cwiseAbs().maxCoeff();
  if (!(largest > 0 && std::isfinite(largest))) return largest;
  const int unit = std::ilogb(largest);
  lcp::ExactSum sum;
  sum.add(std::ldexp(v[0], -unit));
  for (int j = 0; j < disks<Size>; ++j) {
    if ((which >> j & 1U) == 0) continue;
    Vector2d part = disk<Size>(v, j, width);
    for (double& x : part) x = std::ldexp(x, -unit);
    const lcp::TwoParts size = length_in_parts(part);
    sum.add_product(mu[at(j)], size.value);
    sum.add(mu[at(j)] * size.error);
  }
  return std::ldexp(sum.value(), unit);
}

/// The map where the disks `which` of y = r - rho uhat are left, and the others are not.
template <int Size>
class Map {
 public:
  static constexpr unsigned all = (1U << disks<Size>)-1;

  Map(const ContactVector<Size>& r, const ContactVector<Size>& u, const Frictions<Size>& mu, double rho, int width)
      : r_(r),
        u_(u),
        mu_(mu),
        rho_(rho),
        width_(width),
        w_(rho * u),
        hat_(rho * hat_without(0)),
        whole_(direction_of(all)) {
    for (int j = 0; j < disks<Size>; ++j) {
      Disk& d = disk_[at(j)];
      d.r = disk<Size>(r, j, width);
      d.w = disk<Size>(w_, j, width);
      d.y = d.r - d.w;
      d.y_T = length(d.y);
      d.r_T = length(d.r);
      d.w_T = length(d.w);
      d.longer = difference(1, d.r[0], d.r[1], mu[at(j)], r[0]) + growth(d.y_T, d.w, d.r, d.r_T);
      d.g = growth(d.y_T, d.r, d.w, d.w_T);
    }
  }

  ContactVector<Size> value() {
    double b = -std::numeric_limits<double>::infinity();
    unsigned left = 0;  // the disks that y has left; P_N >= y_N brings it back into some, and out of none
    for (int j = 0; j < disks<Size>; ++j) {
      const Direction of = direction(1U << j);
      const double b_j = of.cosine * disk_[at(j)].longer + of.sine[at(j)] * hat_;
      if (b_j > 0) left |= 1U << j;
      b = std::max(b, b_j);
    }
    const double c = normal(all);
    // About y = 0 rounding may say both: the one that is further from 0 is no rounding.
    if (std::min(b, c) <= 0) return c <= b ? r_ : inside();
    double r_size = r_[0];
    double w_size = hat_;
    for (const Disk& d : disk_) {
      r_size = std::hypot(r_size, d.r_T);
      w_size = std::hypot(w_size, d.w_T);
    }
    small_r_ = r_size <= w_size;
    if constexpr (disks<Size> == 2)
      if (left == all)
        for (const int j : {0, 1})
          if (excess(1 - j, 1U << j) <= 0) return outside(1U << j);
    return outside(left);
  }

 private:
  struct Disk {
    Vector2d r, w, y;
    double y_T = 0;
    double r_T = 0;
    double w_T = 0;
    double longer = 0;  // s + d
    double g = 0;
  };
  /// (1, mu_j of these disks) over its length.
  struct Direction {
    double cosine = 1;
    std::array<double, disks<Size>> sine{};
  };

  /// |y_T| - |z_T| without squares, for y_T = z_T - x_T.
  static double growth(double y_T, const Vector2d& x, const Vector2d& z, double z_T) {
    const double sum = y_T + z_T;
    if (!(sum > 0)) return sum;
    return x[0] * ((x[0] - 2 * z[0]) / sum) + x[1] * ((x[1] - 2 * z[1]) / sum);
  }

  static bool has(unsigned which, int j) { return (which >> j & 1U) != 0; }
  double hat_without(unsigned which) const { return corrected_normal<Size>(u_, mu_, width_, all & ~which); }

  Direction direction(unsigned which) const { return which == all ? whole_ : direction_of(which); }
  Direction direction_of(unsigned which) const {
    double hypotenuse = 1;
    for (int j = 0; j < disks<Size>; ++j)
      if (has(which, j)) hypotenuse = std::hypot(hypotenuse, mu_[at(j)]);
    Direction out{.cosine = 1 / hypotenuse};
    for (int j = 0; j < disks<Size>; ++j)
      if (has(which, j)) out.sine[at(j)] = mu_[at(j)] / hypotenuse;
    return out;
  }

  /// c over the length: cosine times it is P_N.
  double normal(unsigned which) const {
    const Direction of = direction(which);
    double sum = 0;
    for (int j = 0; j < disks<Size>; ++j) sum += of.sine[at(j)] * disk_[at(j)].g;
    return of.cosine * (r_[0] - rho_ * hat_without(which)) + sum;
  }

  /// |y_j| - mu_j P_N of a disk j that is not among these.
  double excess(int j, unsigned which) const {
    const Disk& d = disk_[at(j)];
    if (small_r_) return d.y_T - mu_[at(j)] * (direction(which).cosine * normal(which));
    return d.longer + mu_[at(j)] * outside_normal(which);
  }

  double outside_normal(unsigned which) const {
    const auto [cosine, sine] = direction(which);
    double sum = 0;
    if (small_r_) {
      for (int j = 0; j < disks<Size>; ++j) sum += sine[at(j)] * (sine[at(j)] * r_[0] - cosine * disk_[at(j)].g);
      return sum + cosine * (cosine * (rho_ * hat_without(which)));
    }
    for (int j = 0; j < disks<Size>; ++j) sum += sine[at(j)] * disk_[at(j)].longer;
    return cosine * (cosine * hat_ - sum);
  }

  ContactVector<Size> inside() const {
    ContactVector<Size> e = w_;
    e[0] = hat_;
    return e;
  }

  ContactVector<Size> outside(unsigned which) const {
    const auto [cosine, sine] = direction(which);
    const double c = small_r_ ? normal(which) : 0;
    ContactVector<Size> e = w_;
    for (int j = 0; j < disks<Size>; ++j) {
      if (!has(which, j)) continue;
      const Disk& d = disk_[at(j)];
      const Vector2d t = d.y_T > 0 ? Vector2d(d.y / d.y_T) : Vector2d::Zero();
      if (small_r_) {
        set_disk<Size>(e, j, width_, d.r - sine[at(j)] * c * t);
        continue;
      }
      double b = cosine * (cosine * d.longer + sine[at(j)] * hat_);
      for (int i = 0; i < disks<Size>; ++i)
        if (i != j) b += sine[at(i)] * (sine[at(i)] * d.longer - sine[at(j)] * disk_[at(i)].longer);
      set_disk<Size>(e, j, width_, d.w + b * t);
    }
    e[0] = outside_normal(which);
    return e;
  }

  const ContactVector<Size>& r_;
  const ContactVector<Size>& u_;
  const Frictions<Size>& mu_;
  double rho_;
  int width_;
  ContactVector<Size> w_;  // rho u
  double hat_;             // rho uhat_N
  Direction whole_;        // of all disks
  std::array<Disk, disks<Size>> disk_{};
  bool small_r_ = false;
};

}  // namespace

template <int Size>
ContactVector<Size> natural_map(const ContactVector<Size>& r, const ContactVector<Size>& u, const Frictions<Size>& mu,
                                double rho, int width) {
  return Map<Size>(r, u, mu, rho, width).value();
}

template ContactVector<3> natural_map<3>(const ContactVector<3>&, const ContactVector<3>&, const Frictions<3>&, double,
                                         int);
template ContactVector<5> natural_map<5>(const ContactVector<5>&, const ContactVector<5>&, const Frictions<5>&, double,
                                         int);

}  // namespace perp::contact

// SPDX-License-Identifier: Apache-2.0
/// The natural map of contacts with rolling friction beside MPFR at 6,000 bits, by the definition: each set of disks
/// that P_K may cut is tried.
#include <gtest/gtest.h>
#include <mpfr.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <string>

#include "contact/model/mpfr_real.hpp"
#include "contact/model/natural_map.hpp"
#include "support/matrices.hpp"

namespace perp::contact::rolling {
namespace {

using lcp::at;
using support::Random;
using Vector = ContactVector<5>;
using test::Real;
using Reals = std::array<Real, 5>;

struct Point {
  Vector r = Vector::Zero();
  Vector u = Vector::Zero();
  Frictions<5> mu{};
  double rho = 1;
  int width = 2;
};

std::string text(const Point& p) {
  std::ostringstream out;
  out << std::hexfloat << "r " << p.r.transpose() << ", u " << p.u.transpose() << ", mu " << p.mu[0] << ' ' << p.mu[1]
      << ", rho " << p.rho << ", width " << p.width;
  return out.str();
}

/// |v_j|.
Real length(const Reals& v, std::size_t j, int width) {
  if (width == 1) return norm(v[1 + j], Real(0));
  return norm(v[1 + 2 * j], v[2 + 2 * j]);
}

Real norm(const Reals& v) { return norm(norm(v[0], norm(v[1], v[2])), norm(v[3], v[4])); }

/// r - P_K(r - rho uhat). Of the sets A of disks that are left, x = (y_N + sum_A mu_j |y_j|) / (1 + sum_A mu_j^2) fits
/// for one: |y_j| > mu_j x of these and no others.
Reals reference(const Point& p, Real& least_size) {
  Reals r;
  Reals w;
  Reals y;
  for (int i = 0; i < 5; ++i) {
    r[at(i)] = p.r[i];
    w[at(i)] = p.u[i];
  }
  w[0] = w[0] + p.mu[0] * length(w, 0, p.width) + p.mu[1] * length(w, 1, p.width);
  for (std::size_t i = 0; i < 5; ++i) {
    w[i] = Real(p.rho) * w[i];
    y[i] = r[i] - w[i];
  }
  least_size = norm(r) <= norm(w) ? norm(r) : norm(w);
  const std::array<Real, 2> size{length(y, 0, p.width), length(y, 1, p.width)};
  if (y[0] + p.mu[0] * size[0] + p.mu[1] * size[1] <= Real(0)) return r;
  for (unsigned which = 0; which < 4; ++which) {
    Real sum = y[0];
    Real squares = 1;
    for (std::size_t j = 0; j < 2; ++j)
      if ((which >> j & 1U) != 0) {
        sum = sum + p.mu[j] * size[j];
        squares = squares + Real(p.mu[j]) * p.mu[j];
      }
    const Real x = sum / squares;
    bool fits = Real(0) <= x;
    for (std::size_t j = 0; j < 2; ++j) fits = fits && ((which >> j & 1U) == 0) == (size[j] <= p.mu[j] * x);
    if (!fits) continue;
    Reals e = w;
    e[0] = r[0] - x;
    for (std::size_t j = 0; j < 2; ++j)
      if ((which >> j & 1U) != 0)
        for (std::size_t i = 0; i < at(p.width); ++i) {
          const std::size_t k = 1 + j * at(p.width) + i;
          e[k] = r[k] - p.mu[j] * x / size[j] * y[k];
        }
    return e;
  }
  ADD_FAILURE() << "no set of disks: " << text(p);
  return r;
}

/// |e - e_MPFR| over what is allowed.
double share(const Point& p) {
  const Vector e = natural_map<5>(p.r, p.u, p.mu, p.rho, p.width);
  Real size;
  const Reals exact = reference(p, size);
  Reals difference;
  for (int i = 0; i < 5; ++i) difference[at(i)] = exact[at(i)] - Real(e[i]);
  const double most = std::max({1.0, p.mu[0], p.mu[1]});
  const Real denormals = 64 * std::max(1.0, p.rho) * most * std::numeric_limits<double>::denorm_min();
  const Real allowed = Real(1e-10) * norm(exact) + Real(8 * std::numeric_limits<double>::epsilon()) * size + denormals;
  return (norm(difference) / allowed).value();
}

/// Points where something cancels, or nearly: disks of one and two entries, r and u from 1e-100 to 1e100 with entries
/// of sizes of their own, each region of the cone and its borders.
class Points {
 public:
  explicit Points(unsigned seed) : random_(seed) {}

  Point next() {
    Point p;
    p.width = random_.chance(0.3) ? 1 : 2;
    p.mu = {friction(), friction()};
    p.rho = random_.chance(0.7) ? 1 : power(4);
    const bool far = random_.chance(0.5);
    p.r = vector(size(far));
    p.u = vector(size(far));
    if (random_.chance(0.5)) put_on_disk(p, p.r, random_.integer(0, 1));
    if (random_.chance(0.2)) put_on_disk(p, p.r, 0);
    if (random_.chance(0.3)) p.u[0] = -p.mu[0] * disk_size(p, p.u, 0) - p.mu[1] * disk_size(p, p.u, 1);
    if (random_.chance(0.3)) near(p);
    if (random_.chance(0.3)) turn(p);
    for (int i = 0; i < 5; ++i) {
      if (random_.chance(0.1)) p.r[i] *= 1 + random_.normal() * std::pow(10, -random_.uniform(1, 17));
      if (random_.chance(0.1)) p.u[i] *= 1 + random_.normal() * std::pow(10, -random_.uniform(1, 17));
    }
    if (random_.chance(0.2)) p.r[random_.integer(0, 4)] = 0;
    if (random_.chance(0.2)) p.u[random_.integer(0, 4)] = 0;
    if (random_.chance(0.1)) set_disk<5>(p.u, random_.integer(0, 1), p.width, Eigen::Vector2d::Zero());
    if (p.width == 1) p.r.tail<2>() = p.u.tail<2>() = Eigen::Vector2d::Zero();
    return p;
  }

 private:
  double power(double digits) { return std::pow(10, random_.uniform(-digits, digits)); }
  double size(bool far) { return far ? power(100) : random_.chance(0.5) ? power(20) : power(1); }
  double friction() {
    if (random_.chance(0.1)) return 0;
    return random_.chance(0.5) ? 0.75 : power(3);
  }
  Vector vector(double size) {
    Vector v = random_.normals(5);
    for (int i = 0; i < 5 && random_.chance(0.5); ++i) v[i] *= power(10);  // each its own
    v *= size / v.norm();
    if (random_.chance(0.3)) v[0] = std::abs(v[0]);
    return v;
  }
  static double disk_size(const Point& p, const Vector& v, int j) {
    const Eigen::Vector2d part = disk<5>(v, j, p.width);
    return std::hypot(part[0], part[1]);
  }
  /// |r_j| = mu_j r_N to rounding.
  static void put_on_disk(const Point& p, Vector& r, int j) {
    r[0] = std::abs(r[0]);
    const double length = disk_size(p, r, j);
    if (length > 0) set_disk<5>(r, j, p.width, p.mu[at(j)] * r[0] / length * disk<5>(r, j, p.width));
  }
  /// y = r - rho uhat zero, on a disk or on the border of -K*.
  void near(Point& p) {
    Vector w = p.rho * p.u;
    w[0] += p.rho * (p.mu[0] * disk_size(p, p.u, 0) + p.mu[1] * disk_size(p, p.u, 1));
    Vector y = vector(p.r.norm());
    switch (random_.integer(0, 2)) {
      case 0:
        y.setZero();
        break;
      case 1:
        put_on_disk(p, y, random_.integer(0, 1));
        break;
      default:
        y[0] = -p.mu[0] * disk_size(p, y, 0) - p.mu[1] * disk_size(p, y, 1);
    }
    p.r = w + y;
  }
  /// u_j along r_j, or against it.
  void turn(Point& p) {
    const double sign = random_.chance(0.3) ? 1 : -1;
    for (int j = 0; j < 2; ++j) {
      const double length = disk_size(p, p.r, j);
      if (length > 0) set_disk<5>(p.u, j, p.width, sign * disk_size(p, p.u, j) / length * disk<5>(p.r, j, p.width));
    }
  }

  Random random_;
};

// Catches a set of disks that does not fit, a subtraction that loses the smaller of r and uhat, a disk's term with the
// other's coefficient. PERP_POINTS sets how many: 10^5 take a minute.
TEST(NaturalMap, OfRollingAgreesWithMpfr) {
  const char* asked = std::getenv("PERP_POINTS");
  const int count = asked != nullptr ? std::atoi(asked) : 10'000;
  Points points(1);
  double worst = 0;
  for (int k = 0; k < count; ++k) {
    const Point p = points.next();
    const double now = share(p);
    worst = now <= worst ? worst : now;
    ASSERT_LE(now, 1) << text(p);
  }
  RecordProperty("worst_share", std::to_string(worst));
  std::printf("worst share of what is allowed: %.3f\n", worst);
}

// y is in the cone, y_R = 0 and mu_r = 0: rounding says of |y_R| that it has left its disk. Catches that this lets the
// other disk, which y has not left, be cut.
TEST(NaturalMap, OfRollingCutsNoDiskThatIsNotLeft) {
  Point p{.mu = {0x1.cfcfe0e02dfd1p+8, 0}};
  p.r << 0x1.a94ba46862cf7p-232, -0x1.6de837968c5a9p+172, 0x1.68ac8c1b5b35p+173, 0x1.b34b783165e3ap+171,
      0x1.02709b005c799p+174;
  p.u << -0x1.6e5c100f73b74p+182, 0, 0x1.68ac8c1b5b35p+173, 0x1.b34b783165e3ap+171, 0x1.02709b005c799p+174;
  EXPECT_LE(share(p), 1);
}

// A second disk that nothing touches changes nothing.
TEST(NaturalMap, OfRollingIsThatOfSlidingWithoutRolling) {
  Random random(2);
  for (int k = 0; k < 1000; ++k) {
    Vector r = Vector::Zero();
    Vector u = Vector::Zero();
    r.head<3>() = random.normals(3);
    u.head<3>() = random.normals(3);
    const double mu = random.uniform(0, 2);
    const Eigen::Vector3d slides = natural_map(Eigen::Vector3d(r.head<3>()), Eigen::Vector3d(u.head<3>()), mu);
    const Vector e = natural_map<5>(r, u, {mu, random.uniform(0, 2)});
    EXPECT_LE((e.head<3>() - slides).norm(), 1e-15 * (1 + slides.norm()));
    EXPECT_EQ(e.tail<2>().norm(), 0);
  }
}

}  // namespace
}  // namespace perp::contact::rolling

// SPDX-License-Identifier: Apache-2.0
#include "contact/cones/cone_path.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/cones/predictor_corrector.hpp"
#include "contact/model/unit_cone.hpp"
#include "lcp/types.hpp"

namespace perp::contact {
namespace {

using Vector = Eigen::Vector3d;

/// Well inside: the impulses of piles are some times larger than |q|, and long steps follow from a start beyond them.
constexpr double cone_start = 10;
constexpr double cone_to_boundary = 0.99;
constexpr double cone_least_centring = 1e-6;

/// a o b.
Vector cone_product(const Vector& a, const Vector& b) {
  Vector out;
  out << a.dot(b), a[0] * b.tail<2>() + b[0] * a.tail<2>();
  return out;
}

/// x with a o x = b.
Vector cone_quotient(const Vector& a, const Vector& b) {
  Vector x;
  x[0] = (a[0] * b[0] - a.tail<2>().dot(b.tail<2>())) / cone_det(a);
  x.tail<2>() = (b.tail<2>() - x[0] * a.tail<2>()) / a[0];
  return x;
}

/// How far from x along d the border of K is: the least positive root of det(x + t d) = a t^2 + 2 b t + c.
double cone_reach(const Vector& x, const Vector& d) {
  const double a = d[0] * d[0] - d.tail<2>().squaredNorm();
  const double b = x[0] * d[0] - x.tail<2>().dot(d.tail<2>());
  const double c = cone_det(x);
  const double discriminant = b * b - a * c;
  if (std::isnan(discriminant)) return 0;
  if (discriminant < 0) return lcp::infinity;
  const double root = std::sqrt(discriminant);
  if (b < 0) return c / (root - b);
  return a < 0 ? (b + root) / -a : lcp::infinity;
}

/// r of x = r - y, r o y = tau e: of each eigenvalue l of x the positive root of r (r - l) = tau.
Vector cone_part(const Vector& x, double tau) {
  const double length = x.tail<2>().norm();
  const auto root = [tau](double l) {
    const double far = std::hypot(l, 2 * std::sqrt(tau));
    return l > 0 ? (far + l) / 2 : 2 * tau / (far - l);
  };
  const double large = root(x[0] + length);
  const double small = root(x[0] - length);
  Vector r;
  r[0] = (large + small) / 2;
  r.tail<2>().setZero();
  if (length > 0) r.tail<2>() = (large - small) / (2 * length) * x.tail<2>();
  return r;
}

}  // namespace

/// One contact and its part of Newton's step: scale() and couple() once for each matrix, towards() for each direction.
struct ConePath::Contact : Scaled::Block {
  Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d T_inverse = Eigen::Matrix3d::Identity();
  Vector lambda = Vector::Zero();  // T y = T^-1 r
  double s = 0;                    // the opening, given or coupled
  bool coupled = false;
  Vector by_r = Vector::Zero();  // ds/dr, ds/dy; zero if s is given
  Vector by_y = Vector::Zero();

  void scale(const Vector& r, const Vector& y);
  void couple(const Vector& r, const Vector& y);
  Vector towards(double target, const Vector& dr, const Vector& dy) const;
};

/// With J = diag(1, -1, -1), |x|^2 = det x and v = (r / |r| + J y / |y|) / (2 gamma), which has det v = 1:
/// T = (|r| / |y|)^(1/2) [v_N v_T'; v_T 1 + v_T v_T' / (1 + v_N)].
void ConePath::Contact::scale(const Vector& r, const Vector& y) {
  const double size_r = std::sqrt(cone_det(r));
  const double size_y = std::sqrt(cone_det(y));
  const double gamma = std::sqrt((1 + r.dot(y) / (size_r * size_y)) / 2);
  const double beta = std::sqrt(size_r / size_y);
  Vector v = r / size_r;
  v[0] += y[0] / size_y;
  v.tail<2>() -= y.tail<2>() / size_y;
  v /= 2 * gamma;
  const Eigen::Vector2d t = v.tail<2>();
  T(0, 0) = v[0];
  T.topRightCorner<1, 2>() = t.transpose();
  T.bottomLeftCorner<2, 1>() = t;
  T.bottomRightCorner<2, 2>() = Eigen::Matrix2d::Identity() + t * t.transpose() / (1 + v[0]);
  T_inverse = T / beta;
  T_inverse.topRightCorner<1, 2>() *= -1;
  T_inverse.bottomLeftCorner<2, 1>() *= -1;
  T *= beta;
  lambda = T_inverse * r;
}

void ConePath::Contact::couple(const Vector& r, const Vector& y) {
  s = -r.tail<2>().dot(y.tail<2>()) / r[0];
  by_r << -s / r[0], -y.tail<2>() / r[0];
  by_y << 0, -r.tail<2>() / r[0];
}

/// c of dy = c - T^-2 dr, where lambda o (T^-1 dr + T dy) = target e - lambda o lambda, less the second-order terms of
/// (dr, dy).
Vector ConePath::Contact::towards(double target, const Vector& dr, const Vector& dy) const {
  Vector right = -cone_product(lambda, lambda) - cone_product(T_inverse * dr, T * dy);
  right[0] += target;
  return T_inverse * cone_quotient(lambda, right);
}

ConePath::ConePath(const Scaled& problem, ContactSystem& system) : problem_(problem), system_(system) {
  Vec e = Vec::Zero(problem.size());
  for (const Scaled::Block& block : problem.blocks) {
    contacts_.emplace_back(Contact{block});
    e[block.first] = cone_start;
  }
  open({e, e}, Vec::Zero(static_cast<Index>(contacts_.size())));
}

ConePath::~ConePath() = default;

void ConePath::open(Point point, const Vec& openings) {
  at_ = std::move(point);
  tau_ = at_.r.dot(at_.y) / static_cast<double>(contacts_.size());
  last_step_ = 1;
  for (std::size_t a = 0; a < contacts_.size(); ++a) {
    contacts_[a].s = openings[static_cast<Index>(a)];
    contacts_[a].coupled = false;
  }
}

ConePath::Point ConePath::near(const Vec& r, const Vec& openings, double tau) const {
  const Vec u = problem_.W * r + problem_.q;
  Point point{.r = r, .y = u};
  for (std::size_t a = 0; a < contacts_.size(); ++a) {
    const Contact& c = contacts_[a];
    Vector x = c.of(r) - c.of(u);
    x[0] -= openings[static_cast<Index>(a)];
    point.r.segment(c.first, c.size) = cone_part(x, tau).head(c.size);
    point.y.segment(c.first, c.size) = cone_part(-x, tau).head(c.size);
  }
  return point;
}

void ConePath::couple(Point point) {
  open(std::move(point), Vec::Zero(static_cast<Index>(contacts_.size())));
  for (Contact& c : contacts_) c.coupled = true;
}

Vec ConePath::openings() const {
  Vec s(static_cast<Index>(contacts_.size()));
  for (std::size_t a = 0; a < contacts_.size(); ++a) s[static_cast<Index>(a)] = contacts_[a].s;
  return s;
}

Vec ConePath::slip() const {
  Vec speeds(static_cast<Index>(contacts_.size()));
  for (std::size_t a = 0; a < contacts_.size(); ++a)
    speeds[static_cast<Index>(a)] = contacts_[a].of(at_.y).tail<2>().norm();
  return speeds;
}

bool ConePath::assemble() {
  std::vector<Eigen::Matrix3d> A(contacts_.size());
  std::vector<Eigen::Matrix3d> inverse(contacts_.size());
  std::vector<ContactCoupling> couplings;
  for (std::size_t a = 0; a < A.size(); ++a) {
    Contact& c = contacts_[a];
    c.scale(c.of(at_.r), c.of(at_.y));
    A[a] = c.T_inverse * c.T_inverse;
    inverse[a] = c.T * c.T;
    if (!c.coupled) continue;
    c.couple(c.of(at_.r), c.of(at_.y));
    couplings.push_back({.contact = a, .p = Vector::UnitX(), .q = c.by_r - A[a] * c.by_y});
  }
  return system_.factor(A, inverse, std::move(couplings));
}

/// Newton's direction towards r o y = target e, with the second-order terms of `affine` if there is one.
ConePath::Direction ConePath::direction(double target, const Direction* affine) {
  Direction d{.r = Vec(at_.r.size()), .y = Vec(at_.r.size())};
  Vec rhs = at_.y - problem_.W * at_.r - problem_.q;
  for (std::size_t a = 0; a < contacts_.size(); ++a) {
    const Contact& c = contacts_[a];
    const Vector dr = affine != nullptr ? c.of(affine->r) : Vector::Zero();
    const Vector dy = affine != nullptr ? c.of(affine->y) : Vector::Zero();
    const Vector towards = c.towards(target, dr, dy);
    d.y.segment(c.first, c.size) = towards.head(c.size);
    rhs.segment(c.first, c.size) += towards.head(c.size);
    rhs[c.first] -= c.s + (c.coupled ? c.by_y.dot(towards) : 0);
  }
  system_.solve(rhs, d.r);
  for (const Contact& c : contacts_)
    d.y.segment(c.first, c.size) -= (c.T_inverse * (c.T_inverse * c.of(d.r))).head(c.size);
  return d;
}

/// The step to the boundary, at most one.
double ConePath::reach(const Direction& d) const {
  double alpha = 1;
  for (const Contact& c : contacts_)
    alpha = std::min({alpha, cone_reach(c.of(at_.r), c.of(d.r)), cone_reach(c.of(at_.y), c.of(d.y))});
  return alpha;
}

double ConePath::mean_after(const Direction& d, double alpha) const {
  return (at_.r + alpha * d.r).dot(at_.y + alpha * d.y) / static_cast<double>(contacts_.size());
}

bool ConePath::step() {
  if (contacts_.empty() || !assemble()) return false;
  const Direction d = predictor_corrector(*this, tau_, cone_least_centring, last_step_).direction;
  if (!d.r.allFinite() || !d.y.allFinite()) return false;
  last_step_ = cone_to_boundary * reach(d);
  at_.r += last_step_ * d.r;
  at_.y += last_step_ * d.y;
  tau_ = mean_after(d, 0);
  return std::isfinite(tau_) && tau_ > 0;
}

}  // namespace perp::contact

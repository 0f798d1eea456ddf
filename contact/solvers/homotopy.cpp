// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/homotopy.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "contact/cones/predictor_corrector.hpp"
#include "contact/laws/glocker_law.hpp"

namespace perp::contact {
namespace {

constexpr int neighbourhood_cuts = 6;
constexpr double cut = 0.8;
constexpr double least_delta = 1e-13;

constexpr std::size_t disk = 3;  // its place among the sides

}  // namespace

/// z >= 0 and w >= 0 whose products tend to zero: r_N and w_N; kappa_i and w_i, the facets' first, the disk's last.
struct Homotopy::Pairs {
  std::array<double, 5> z{};
  std::array<double, 5> w{};
};

/// A facet, or the disk, i: sigma changes by gradient.dr + s dkappa, and c is kappa's factor in u_T + sum c_i kappa_i.
struct Homotopy::Side {
  double sigma = 0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double s = 0;
  Eigen::Vector2d c = Eigen::Vector2d::Zero();
};

/// One contact and its part of Newton's step: block() once for each matrix, rhs() and recover() for each direction.
struct Homotopy::Contact : Scaled::Block {
  Pairs at{};
  Eigen::Vector3d r = Eigen::Vector3d::Zero();
  Eigen::Vector3d u = Eigen::Vector3d::Zero();

  std::size_t sides() const { return size == 3 ? 4 : size == 2 ? 2 : 0; }
  void evaluate(double delta, double eps);
  Eigen::Matrix3d block();
  Eigen::Vector3d rhs(double target, const Pairs* affine);
  Pairs recover(const Eigen::Vector3d& dr) const;
  double change(std::size_t i, const Eigen::Vector3d& dr) const;

  std::array<Side, 4> side{};  // of evaluate()
  SmoothNormal normal{};
  std::array<double, 4> D{};  // of block(): dsigma_i + D_i dkappa_i = h_i, dsigma_i by dr, w eliminated
  std::array<double, 4> h{};  // of rhs()
  std::array<double, 5> p{};  // of rhs(): z dw + w dz = z p
};

struct Homotopy::Direction {
  Vec r;
  std::vector<Pairs> of;
};

void Homotopy::Contact::evaluate(double delta, double eps) {
  for (std::size_t i = 0; i < std::min(sides(), disk); ++i) {
    const auto& e = facet_normal(size, i);
    side[i] = {.sigma = r[0] - e[0] * r[1] - e[1] * r[2] + eps * at.z[i + 1],
               .gradient = {1, -e[0], -e[1]},
               .s = eps,
               .c = {e[0], e[1]}};
  }
  if (size < 3) return;
  normal = smooth_normal(r[0], delta);
  const auto [g, slope] = normal;
  const Eigen::Vector2d r_T = r.tail<2>();
  const double square = r_T.squaredNorm();
  side[disk].sigma = g - square / g;
  side[disk].gradient[0] = slope * (1 + square / (g * g));  // change() has the rest
  side[disk].c = 2 * r_T / g;
}

/// B of u_T + sum c_i kappa_i = 0 with dkappa_i = (h_i - dsigma_i) / D_i, and of w_N.
Eigen::Matrix3d Homotopy::Contact::block() {
  Eigen::Matrix3d B = Eigen::Matrix3d::Zero();
  B(0, 0) = at.w[0] / at.z[0];
  for (std::size_t i = 0; i < sides(); ++i) D[i] = side[i].s + at.w[i + 1] / at.z[i + 1];
  for (std::size_t i = 0; i < std::min(sides(), disk); ++i)
    B.bottomRows<2>() -= side[i].c * side[i].gradient.transpose() / D[i];
  if (size < 3) return B;
  const double kappa_D = at.z[disk + 1];
  const double a = side[disk].gradient[0];
  const Eigen::Vector2d& b = side[disk].c;
  const auto [g, slope] = normal;
  B.bottomLeftCorner<2, 1>() -= b * a / D[disk] + b * kappa_D * slope / g;
  B.bottomRightCorner<2, 2>() += b * 2 * r.tail<2>().transpose() / g / D[disk];
  B.diagonal().tail<2>().array() += 2 * kappa_D / g;
  return B;
}

/// Towards products `target`, with the second-order terms of `affine` if there is one.
Eigen::Vector3d Homotopy::Contact::rhs(double target, const Pairs* affine) {
  for (std::size_t i = 0; i <= sides(); ++i) {
    const double second = affine != nullptr ? affine->z[i] * affine->w[i] : 0;
    p[i] = (target - at.z[i] * at.w[i] - second) / at.z[i];
  }
  Eigen::Vector3d rhs = -u;
  rhs[0] = -(u[0] - at.w[0]) + p[0];
  for (std::size_t i = 0; i < sides(); ++i) {
    h[i] = -(side[i].sigma - at.w[i + 1]) + p[i + 1];
    rhs.tail<2>() -= side[i].c * (at.z[i + 1] + h[i] / D[i]);
  }
  return rhs;
}

/// gradient_i.dr.
double Homotopy::Contact::change(std::size_t i, const Eigen::Vector3d& dr) const {
  const Eigen::Vector3d& a = side[i].gradient;
  if (i == disk) return a[0] * dr[0] - 2 / normal.g * r.tail<2>().dot(dr.tail<2>());
  return a[0] * dr[0] + a[1] * dr[1] + a[2] * dr[2];
}

Homotopy::Pairs Homotopy::Contact::recover(const Eigen::Vector3d& dr) const {
  Pairs d;
  d.z[0] = dr[0];
  for (std::size_t i = 0; i < sides(); ++i) d.z[i + 1] = (h[i] - change(i, dr)) / D[i];
  for (std::size_t i = 0; i <= sides(); ++i) d.w[i] = p[i] - at.w[i] / at.z[i] * d.z[i];
  return d;
}

Homotopy::Homotopy(const Scaled& problem, ContactSystem& system, const HomotopyOptions& options)
    : problem_(problem), options_(options), system_(system) {
  r_ = Vec::Zero(problem.size());
  for (const Scaled::Block& block : problem.blocks) {
    Contact& c = contacts_.emplace_back(Contact{block});
    c.at.z.fill(1);
    r_[block.first] = 1;
    products_ += 1 + static_cast<Index>(c.sides());
  }
  tau_ = 1;
  begin();
  for (Contact& c : contacts_) {
    c.evaluate(delta_, eps_);
    c.at.w[0] = std::max(c.u[0], 1.0);
    for (std::size_t i = 0; i < c.sides(); ++i) c.at.w[i + 1] = std::max(c.side[i].sigma, 1.0);
  }
  tau_ = mean();
}

Homotopy::~Homotopy() = default;

void Homotopy::start(In r, double tau) {
  r_ = r;
  tau_ = tau;
  begin();
  centre(tau);
}

void Homotopy::begin() {
  last_ = {.k = 0, .tau = tau_};
  last_step_ = 1;
  parameters();
  spread();
}

void Homotopy::parameters() {
  delta_ = std::clamp(options_.delta_share * tau_, least_delta, 1.0);
  eps_ = options_.eps_share * tau_;
}

/// u = W r + q, and its part of both to every contact.
void Homotopy::spread() {
  u_ = problem_.W * r_ + problem_.q;
  for (Contact& c : contacts_) {
    c.at.z[0] = r_[c.first];
    c.r = c.of(r_);
    c.u = c.of(u_);
  }
}

/// Products about tau at r, w >= F: where one factor is far from zero the other is tau over it, both are sqrt(tau)
/// where neither is. kappa_D begins at |u_T| g / (2 |r_T|), what it is where the contact slips.
void Homotopy::centre(double tau) {
  const double root = std::sqrt(tau);
  const auto pair = [&](Pairs& at, std::size_t i, double F) {
    at.w[i] = std::max(F, tau / std::max(at.z[i], root));
    at.z[i] = std::max(at.z[i], tau / std::max(at.w[i], root));
  };
  for (Contact& c : contacts_) {
    pair(c.at, 0, c.u[0]);
    c.r[0] = r_[c.first] = c.at.z[0];
    std::fill(c.at.z.begin() + 1, c.at.z.end(), 0);
    if (const double length = c.r.tail<2>().norm(); c.size == 3 && length > 0)
      c.at.z[4] = c.u.tail<2>().norm() * smooth_normal(c.r[0], delta_).g / (2 * length);
    c.evaluate(delta_, eps_);
    for (std::size_t i = 0; i < c.sides(); ++i) pair(c.at, i + 1, c.side[i].sigma);
  }
  spread();
  tau_ = mean();
}

/// Of the products.
double Homotopy::mean() const {
  double sum = 0;
  for (const Contact& c : contacts_)
    for (std::size_t i = 0; i <= c.sides(); ++i) sum += c.at.z[i] * c.at.w[i];
  return products_ > 0 ? sum / static_cast<double>(products_) : 0;
}

/// K = W + the blocks that the eliminated multipliers leave, and its factors.
bool Homotopy::assemble() {
  for (Contact& c : contacts_) c.evaluate(delta_, eps_);
  std::vector<ContactRows> rows(contacts_.size());
  for (std::size_t a = 0; a < rows.size(); ++a) rows[a] = {.A = contacts_[a].block(), .B = Eigen::Matrix3d::Identity()};
  return system_.factor(rows);
}

/// Newton's direction towards products `target`, with the second-order terms of `affine` if there is one.
Homotopy::Direction Homotopy::direction(double target, const Direction* affine) {
  Direction d{.r = Vec(r_.size()), .of = std::vector<Pairs>(contacts_.size())};
  Vec rhs(r_.size());
  for (std::size_t a = 0; a < contacts_.size(); ++a) {
    Contact& c = contacts_[a];
    rhs.segment(c.first, c.size) = c.rhs(target, affine != nullptr ? &affine->of[a] : nullptr).head(c.size);
  }
  system_.solve(rhs, d.r);
  for (std::size_t a = 0; a < contacts_.size(); ++a) {
    const Contact& c = contacts_[a];
    d.of[a] = c.recover(c.of(d.r));
  }
  return d;
}

/// take(z, w, dz, dw) of every product.
template <class Take>
void Homotopy::for_pairs(const Direction& d, const Take& take) const {
  for (std::size_t a = 0; a < contacts_.size(); ++a)
    for (std::size_t i = 0; i <= contacts_[a].sides(); ++i)
      take(contacts_[a].at.z[i], contacts_[a].at.w[i], d.of[a].z[i], d.of[a].w[i]);
}

/// The step to the boundary, at most one.
double Homotopy::reach(const Direction& d) const {
  double alpha = 1;
  for_pairs(d, [&alpha](double z, double w, double dz, double dw) {
    if (dz < 0) alpha = std::min(alpha, -z / dz);
    if (dw < 0) alpha = std::min(alpha, -w / dw);
  });
  return alpha;
}

/// The mean product after a step.
double Homotopy::mean_after(const Direction& d, double alpha) const {
  double sum = 0;
  for_pairs(d, [&](double z, double w, double dz, double dw) { sum += (z + alpha * dz) * (w + alpha * dw); });
  return sum / static_cast<double>(products_);
}

/// alpha x 0.8, at most a few times, until the least product is no less than `neighbourhood` times the mean.
double Homotopy::shortened(const Direction& d, double alpha) const {
  for (int k = 0; k < neighbourhood_cuts; ++k, alpha *= cut) {
    double sum = 0;
    double least = std::numeric_limits<double>::infinity();
    for_pairs(d, [&](double z, double w, double dz, double dw) {
      const double product = (z + alpha * dz) * (w + alpha * dw);
      sum += product;
      least = std::min(least, product);
    });
    if (least >= options_.neighbourhood * sum / static_cast<double>(products_)) break;
  }
  return alpha;
}

bool Homotopy::step() {
  parameters();
  if (products_ == 0 || !assemble()) return false;
  const auto [d, sigma] = predictor_corrector(*this, tau_, options_.least_centring, last_step_);
  if (!d.r.allFinite()) return false;
  const double alpha = shortened(d, std::min(1.0, options_.to_boundary * reach(d)));
  r_ += alpha * d.r;
  for (std::size_t a = 0; a < contacts_.size(); ++a)
    for (std::size_t i = 0; i <= contacts_[a].sides(); ++i) {
      contacts_[a].at.z[i] += alpha * d.of[a].z[i];
      contacts_[a].at.w[i] += alpha * d.of[a].w[i];
    }
  spread();
  tau_ = mean();
  last_step_ = alpha;
  last_ = {.k = last_.k + 1, .tau = tau_, .step = alpha, .sigma = sigma};
  return std::isfinite(tau_) && tau_ > 0;
}

}  // namespace perp::contact

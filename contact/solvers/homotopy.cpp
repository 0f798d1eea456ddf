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

constexpr std::size_t sides_in_space = 4;  // of a disk: three facets, the last is the disk itself
constexpr std::size_t sides_in_plane = 2;

}  // namespace

/// z >= 0 and w >= 0 whose products tend to zero: r_N and w_N; kappa_i and w_i, disk by disk the facets' first, then
/// the disk's own.
template <int Size>
struct Homotopy<Size>::Pairs {
  std::array<double, 1 + sides_in_space * disks<Size>> z{};
  std::array<double, 1 + sides_in_space * disks<Size>> w{};
};

/// A facet, or the disk, i: sigma changes by gradient.dr + s dkappa, and c is kappa's factor in u_T + sum c_i kappa_i,
/// which changes by c_N dr_N + c_T dr_T.
template <int Size>
struct Homotopy<Size>::Side {
  double sigma = 0;
  ContactVector<Size> gradient = ContactVector<Size>::Zero();
  double s = 0;
  Eigen::Vector2d c = Eigen::Vector2d::Zero();
  Eigen::Vector2d c_N = Eigen::Vector2d::Zero();
  double c_T = 0;
};

/// One contact and its part of Newton's step: block() once for each matrix, rhs() and recover() for each direction.
template <int Size>
struct Homotopy<Size>::Contact : Scaled::Block {
  Pairs at{};
  ContactVector<Size> r = ContactVector<Size>::Zero();
  ContactVector<Size> u = ContactVector<Size>::Zero();

  std::size_t sides_of_disk() const { return entries() == 2 ? sides_in_space : sides_in_plane; }
  std::size_t sides() const { return static_cast<std::size_t>(disk_count()) * sides_of_disk(); }
  bool is_disk(std::size_t i) const { return i % sides_in_space == sides_in_space - 1 && entries() == 2; }
  /// The disk that side i is of, and that disk's part of r or u.
  int disk_of(std::size_t i) const { return static_cast<int>(i / sides_of_disk()); }
  Eigen::Vector2d part(const ContactVector<Size>& y, int j) const { return disk<Size>(y, j, width); }
  /// y_T += x of disk j.
  template <class Y, class X>
  void add(int j, const X& x, Y& y) const {
    for (int i = 0; i < entries(); ++i) y.row(first_of(j) + i) += x.row(i);
  }

  void evaluate(double delta, double eps);
  ContactMatrix<Size> block();
  ContactVector<Size> rhs(double target, const Pairs* affine);
  Pairs recover(const ContactVector<Size>& dr) const;

  std::array<Side, sides_in_space * disks<Size>> side{};  // of evaluate()
  std::array<double, sides_in_space * disks<Size>> D{};   // of block(): dsigma_i + D_i dkappa_i = h_i, dsigma_i by dr
  std::array<double, sides_in_space * disks<Size>> h{};   // of rhs()
  std::array<double, 1 + sides_in_space * disks<Size>> p{};  // of rhs(): z dw + w dz = z p
};

template <int Size>
struct Homotopy<Size>::Direction {
  Vec r;
  std::vector<Pairs> of;
};

template <int Size>
void Homotopy<Size>::Contact::evaluate(double delta, double eps) {
  if (size == 1) return;
  for (std::size_t i = 0; i < sides(); ++i) {
    const int j = disk_of(i);
    const Eigen::Vector2d r_T = part(r, j);
    Side& of = side[i];
    if (is_disk(i)) {
      const GlockerDisk its = normalised_disk(delta, r[0], r_T[0], r_T[1]);
      of = {.sigma = its.sigma, .c = its.c * r_T, .c_N = its.c_N * r_T, .c_T = its.c};
      of.gradient[0] = its.sigma_N;
      set_disk<Size>(of.gradient, j, width, {its.sigma_T1, its.sigma_T2});
      continue;
    }
    const auto& e = facet_normal(entries() + 1, i % sides_of_disk());
    of = {.sigma = r[0] - e[0] * r_T[0] - e[1] * r_T[1] + eps * at.z[i + 1], .s = eps, .c = {e[0], e[1]}};
    of.gradient[0] = 1;
    set_disk<Size>(of.gradient, j, width, -of.c);
  }
}

/// B of u_T + sum c_i kappa_i = 0 with dkappa_i = (h_i - dsigma_i) / D_i, and of w_N.
template <int Size>
ContactMatrix<Size> Homotopy<Size>::Contact::block() {
  ContactMatrix<Size> B = ContactMatrix<Size>::Zero();
  B(0, 0) = at.w[0] / at.z[0];
  for (std::size_t i = 0; i < sides(); ++i) {
    D[i] = side[i].s + at.w[i + 1] / at.z[i + 1];
    add(disk_of(i), (side[i].c * side[i].gradient.transpose() / -D[i]).eval(), B);
    for (int k = 0; k < entries(); ++k) {
      const int row = first_of(disk_of(i)) + k;
      B(row, 0) += side[i].c_N[k] * at.z[i + 1];
      B(row, row) += side[i].c_T * at.z[i + 1];
    }
  }
  return B;
}

/// Towards products `target`, with the second-order terms of `affine` if there is one.
template <int Size>
ContactVector<Size> Homotopy<Size>::Contact::rhs(double target, const Pairs* affine) {
  for (std::size_t i = 0; i <= sides(); ++i) {
    const double second = affine != nullptr ? affine->z[i] * affine->w[i] : 0;
    p[i] = (target - at.z[i] * at.w[i] - second) / at.z[i];
  }
  ContactVector<Size> rhs = -u;
  rhs[0] = -(u[0] - at.w[0]) + p[0];
  for (std::size_t i = 0; i < sides(); ++i) {
    h[i] = -(side[i].sigma - at.w[i + 1]) + p[i + 1];
    add(disk_of(i), (side[i].c * -(at.z[i + 1] + h[i] / D[i])).eval(), rhs);
  }
  return rhs;
}

template <int Size>
typename Homotopy<Size>::Pairs Homotopy<Size>::Contact::recover(const ContactVector<Size>& dr) const {
  Pairs d;
  d.z[0] = dr[0];
  for (std::size_t i = 0; i < sides(); ++i) d.z[i + 1] = (h[i] - side[i].gradient.dot(dr)) / D[i];
  for (std::size_t i = 0; i <= sides(); ++i) d.w[i] = p[i] - at.w[i] / at.z[i] * d.z[i];
  return d;
}

template <int Size>
Homotopy<Size>::Homotopy(const Scaled& problem, ContactSystemOf<Size>& system, const HomotopyOptions& options)
    : problem_(problem), options_(options), system_(system) {
  r_ = Vec::Zero(problem.size());
  for (const Scaled::Block& block : problem.blocks) {
    Contact& c = contacts_.emplace_back(Contact{block});
    c.at.z.fill(1);
    r_[block.first] = 1;
    products_ += 1 + static_cast<Index>(c.sides());
  }
  parameters();
  spread();
  for (Contact& c : contacts_) {
    c.evaluate(delta_, eps_);
    c.at.w[0] = std::max(c.u[0], 1.0);
    for (std::size_t i = 0; i < c.sides(); ++i) c.at.w[i + 1] = std::max(c.side[i].sigma, 1.0);
  }
  tau_ = mean();
}

template <int Size>
Homotopy<Size>::~Homotopy() = default;

template <int Size>
void Homotopy<Size>::parameters() {
  delta_ = std::clamp(options_.delta_share * tau_, least_delta, 1.0);
  eps_ = options_.eps_share * tau_;
}

/// u = W r + q, and its part of both to every contact.
template <int Size>
void Homotopy<Size>::spread() {
  u_ = problem_.W * r_ + problem_.q;
  for (Contact& c : contacts_) {
    c.at.z[0] = r_[c.first];
    c.r = c.template of<Size>(r_);
    c.u = c.template of<Size>(u_);
  }
}

/// Of the products.
template <int Size>
double Homotopy<Size>::mean() const {
  double sum = 0;
  for (const Contact& c : contacts_)
    for (std::size_t i = 0; i <= c.sides(); ++i) sum += c.at.z[i] * c.at.w[i];
  return products_ > 0 ? sum / static_cast<double>(products_) : 0;
}

/// K = W + the blocks that the eliminated multipliers leave, and its factors.
template <int Size>
bool Homotopy<Size>::assemble() {
  for (Contact& c : contacts_) c.evaluate(delta_, eps_);
  std::vector<RowsOfSize<Size>> rows(contacts_.size());
  for (std::size_t a = 0; a < rows.size(); ++a)
    rows[a] = {.A = contacts_[a].block(), .B = ContactMatrix<Size>::Identity()};
  return system_.factor(rows);
}

/// Newton's direction towards products `target`, with the second-order terms of `affine` if there is one.
template <int Size>
typename Homotopy<Size>::Direction Homotopy<Size>::direction(double target, const Direction* affine) {
  Direction d{.r = Vec(r_.size()), .of = std::vector<Pairs>(contacts_.size())};
  Vec rhs(r_.size());
  for (std::size_t a = 0; a < contacts_.size(); ++a) {
    Contact& c = contacts_[a];
    rhs.segment(c.first, c.size) = c.rhs(target, affine != nullptr ? &affine->of[a] : nullptr).head(c.size);
  }
  system_.solve(rhs, d.r);
  for (std::size_t a = 0; a < contacts_.size(); ++a) {
    const Contact& c = contacts_[a];
    d.of[a] = c.recover(c.template of<Size>(d.r));
  }
  return d;
}

/// take(z, w, dz, dw) of every product.
template <int Size>
template <class Take>
void Homotopy<Size>::for_pairs(const Direction& d, const Take& take) const {
  for (std::size_t a = 0; a < contacts_.size(); ++a)
    for (std::size_t i = 0; i <= contacts_[a].sides(); ++i)
      take(contacts_[a].at.z[i], contacts_[a].at.w[i], d.of[a].z[i], d.of[a].w[i]);
}

/// The step to the boundary, at most one.
template <int Size>
double Homotopy<Size>::reach(const Direction& d) const {
  double alpha = 1;
  for_pairs(d, [&alpha](double z, double w, double dz, double dw) {
    if (dz < 0) alpha = std::min(alpha, -z / dz);
    if (dw < 0) alpha = std::min(alpha, -w / dw);
  });
  return alpha;
}

/// The mean product after a step.
template <int Size>
double Homotopy<Size>::mean_after(const Direction& d, double alpha) const {
  double sum = 0;
  for_pairs(d, [&](double z, double w, double dz, double dw) { sum += (z + alpha * dz) * (w + alpha * dw); });
  return sum / static_cast<double>(products_);
}

/// alpha x 0.8, at most a few times, until the least product is no less than `neighbourhood` times the mean.
template <int Size>
double Homotopy<Size>::shortened(const Direction& d, double alpha) const {
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

template <int Size>
bool Homotopy<Size>::step() {
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

template class Homotopy<3>;
template class Homotopy<5>;

}  // namespace perp::contact

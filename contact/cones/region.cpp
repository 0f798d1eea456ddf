// SPDX-License-Identifier: Apache-2.0
#include "contact/cones/region.hpp"

#include <Eigen/LU>
#include <utility>

namespace perp::contact {
namespace {

/// D in the region, where any will do: W has a diagonal near one.
constexpr double inside_weight = 1;
constexpr double outside_cone = 1e-9;
constexpr double region_symmetric = 1e-8;

Eigen::MatrixXd symmetric_part(const Eigen::MatrixXd& A) { return 0.5 * (A + A.transpose()); }

}  // namespace

Region::Region(const Scaled& problem, ContactSystem& system, std::vector<Eigen::Matrix3d> D,
               std::vector<Eigen::Matrix3d> inverse, Vec r0, std::vector<std::size_t> inside)
    : problem_(problem),
      system_(system),
      D_(std::move(D)),
      inverse_(std::move(inverse)),
      r0_(std::move(r0)),
      size_of_one_(problem.blocks.front().size),
      inside_(std::move(inside)),
      is_inside_(problem.blocks.size(), 0) {
  for (const std::size_t a : inside_) {
    is_inside_[a] = 1;
    D_[a] = inside_weight * Eigen::Matrix3d::Identity();
    inverse_[a] = Eigen::Matrix3d::Identity() / inside_weight;
  }
}

bool Region::factor() {
  if (!system_.factor(D_, inverse_)) return false;
  columns_.resize(problem_.size(), 0);
  add_columns(0);
  return columns_.allFinite();
}

/// Of K^-1, for the contacts of the region from this one on.
void Region::add_columns(std::size_t from) {
  const Index d = size_of_one_;
  const Index count = d * static_cast<Index>(inside_.size() - from);
  Eigen::MatrixXd units = Eigen::MatrixXd::Zero(problem_.size(), count);
  for (std::size_t k = from; k < inside_.size(); ++k)
    for (Index i = 0; i < d; ++i)
      units(problem_.blocks[inside_[k]].first + i, d * static_cast<Index>(k - from) + i) = 1;
  Eigen::MatrixXd x;
  system_.solve_columns(units, x);
  columns_.conservativeResize(Eigen::NoChange, columns_.cols() + count);
  columns_.rightCols(count) = x;
  region_ = Problem();
}

std::vector<std::size_t> Region::leaving(const Vec& r) const {
  std::vector<std::size_t> contacts;
  for (std::size_t a = 0; a < is_inside_.size(); ++a) {
    const Eigen::Vector3d of = problem_.blocks[a].of(r);
    if (is_inside_[a] == 0 && of[0] - of.tail<2>().norm() < -outside_cone) contacts.push_back(a);
  }
  return contacts;
}

void Region::grow(const std::vector<std::size_t>& contacts) {
  const std::size_t before = inside_.size();
  for (const std::size_t a : contacts) {
    is_inside_[a] = 1;
    inside_.push_back(a);
  }
  add_columns(before);
}

/// c of the law of the others.
Vec Region::rest() const {
  Vec c = -problem_.q;
  for (std::size_t a = 0; a < is_inside_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    if (is_inside_[a] == 0) c.segment(block.first, block.size) += (D_[a] * block.of(r0_)).head(block.size);
  }
  return c;
}

const Problem& Region::problem() {
  if (region_.mu.size() > 0) return region_;
  const Index d = size_of_one_;
  const auto count = static_cast<Index>(inside_.size());
  Vec y;
  system_.solve(rest(), y);
  Eigen::MatrixXd G(d * count, d * count);
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(d * count, d * count);
  Vec a(d * count);
  for (Index k = 0; k < count; ++k) {
    const std::size_t contact = inside_[at(k)];
    const Index first = problem_.blocks[contact].first;
    G.middleRows(d * k, d) = columns_.middleRows(first, d);
    a.segment(d * k, d) = y.segment(first, d);
    D.block(d * k, d * k, d, d) = D_[contact].topLeftCorner(d, d);
  }
  const bool symmetric = (G - G.transpose()).norm() <= region_symmetric * G.norm();
  Eigen::MatrixXd inverse = (symmetric ? symmetric_part(G) : G).partialPivLu().inverse();
  if (symmetric) inverse = symmetric_part(inverse);
  region_.dimension = size_of_one_;
  region_.W = Eigen::MatrixXd(inverse - D).sparseView(0, 0);
  region_.q = -inverse * a;
  region_.mu = Vec::Ones(count);
  return region_;
}

Vec Region::whole(const Vec& region) const {
  const Index d = size_of_one_;
  const Vec u = region_.W * region + region_.q;
  Vec c = rest();
  for (std::size_t k = 0; k < inside_.size(); ++k) {
    const Index i = d * static_cast<Index>(k);
    c.segment(problem_.blocks[inside_[k]].first, d) +=
        u.segment(i, d) + D_[inside_[k]].topLeftCorner(d, d) * region.segment(i, d);
  }
  Vec r;
  system_.solve(c, r);
  return r;
}

Vec Region::slips(const Vec& region_u) const {
  Vec speeds = Vec::Zero(static_cast<Index>(problem_.blocks.size()));
  for (std::size_t k = 0; k < inside_.size(); ++k)
    speeds[static_cast<Index>(inside_[k])] =
        region_u.segment(size_of_one_ * static_cast<Index>(k) + 1, size_of_one_ - 1).norm();
  return speeds;
}

}  // namespace perp::contact

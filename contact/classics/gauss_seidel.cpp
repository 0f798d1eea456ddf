// SPDX-License-Identifier: Apache-2.0
#include "contact/classics/gauss_seidel.hpp"

#include <cmath>

#include "contact/model/unit_cone.hpp"

namespace perp::contact {

std::vector<LocalProblem> local_problems(const Scaled& problem) {
  std::vector<LocalProblem> contacts;
  for (const Scaled::Block& block : problem.blocks) {
    Eigen::Matrix3d W = Eigen::Matrix3d::Zero();
    for (int j = 0; j < block.size; ++j)
      for (int i = 0; i < block.size; ++i) W(i, j) = problem.W.near(block.first + i, block.first + j);
    contacts.emplace_back(block.size, W);
  }
  return contacts;
}

MovingImpulses::MovingImpulses(const Scaled& problem, Vec& r, Vec& u)
    : problem_(problem), parts_(problem.W.parts()), r_(r), u_(u) {
  if (parts_ == nullptr) return;
  H_ = parts_->root() != nullptr ? parts_->root() : &parts_->H();
  v_ = *H_ * r;
  if (parts_->root() == nullptr) v_ = parts_->inverse(v_);
}

Eigen::Vector3d MovingImpulses::velocity(const Scaled::Block& block) const {
  if (parts_ == nullptr) return block.of(u_);
  Eigen::Vector3d u = block.of(problem_.q) + problem_.W.shift() * block.of(r_);
  for (int k = 0; k < block.size; ++k) u[k] += H_->col(block.first + k).dot(v_);
  return u;
}

double MovingImpulses::set(const Scaled::Block& block, const Eigen::Vector3d& after) {
  const Eigen::Vector3d d = after - block.of(r_);
  if (d.isZero(0)) return 0;
  r_.segment(block.first, block.size) = after.head(block.size);
  if (parts_ != nullptr && parts_->root() == nullptr) {
    v_ += parts_->inverse(Vec(H_->middleCols(block.first, block.size) * d.head(block.size)));
    return d.squaredNorm();
  }
  const SpMat& columns = parts_ != nullptr ? *H_ : problem_.W.matrix();
  Vec& moved = parts_ != nullptr ? v_ : u_;
  for (int k = 0; k < block.size; ++k)
    if (d[k] != 0)
      for (SpMat::InnerIterator it(columns, block.first + k); it; ++it) moved[it.row()] += it.value() * d[k];
  return d.squaredNorm();
}

void MovingImpulses::finish() {
  if (parts_ != nullptr) u_ = problem_.W * r_ + problem_.q;
}

GaussSeidel::GaussSeidel(const Scaled& problem, LocalSolver local, double omega)
    : problem_(problem), contacts_(local_problems(problem)), local_(local), omega_(omega) {}

/// What the local problem of contact a makes of its impulse.
Eigen::Vector3d GaussSeidel::solved(std::size_t a, const Eigen::Vector3d& before, const Eigen::Vector3d& u) const {
  Eigen::Vector3d after = contacts_[a].solve(local_, u - contacts_[a].W() * before, before);
  if (omega_ != 1) after = project_onto_unit_cone(before + omega_ * (after - before));
  return after;
}

double GaussSeidel::sweep(Vec& r, Vec& u) const {
  MovingImpulses moving(problem_, r, u);
  double change = 0;
  for (std::size_t a = 0; a < contacts_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    change += moving.set(block, solved(a, block.of(r), moving.velocity(block)));
  }
  moving.finish();
  return std::sqrt(change);
}

}  // namespace perp::contact

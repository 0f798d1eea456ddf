// SPDX-License-Identifier: Apache-2.0
#include "contact/classics/gauss_seidel.hpp"

#include <cmath>

#include "contact/classics/cone.hpp"

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

double set_impulse(const Scaled& problem, const Scaled::Block& block, const Eigen::Vector3d& after, Vec& r, Vec& u) {
  const Eigen::Vector3d d = after - block.of(r);
  if (d.isZero(0)) return 0;
  const SpMat& W = problem.W.matrix();
  for (int k = 0; k < block.size; ++k) {
    r[block.first + k] = after[k];
    if (d[k] == 0) continue;
    for (SpMat::InnerIterator it(W, block.first + k); it; ++it) u[it.row()] += it.value() * d[k];
  }
  return d.squaredNorm();
}

GaussSeidel::GaussSeidel(const Scaled& problem, LocalSolver local, double omega)
    : problem_(problem), contacts_(local_problems(problem)), local_(local), omega_(omega) {}

/// What the local problem of contact a makes of its impulse.
Eigen::Vector3d GaussSeidel::solved(std::size_t a, const Eigen::Vector3d& before, const Eigen::Vector3d& u) const {
  Eigen::Vector3d after = contacts_[a].solve(local_, u - contacts_[a].W() * before, before);
  if (omega_ != 1) after = project_onto_unit_cone(before + omega_ * (after - before));
  return after;
}

/// With velocities v of the bodies in place of u: u_a = H_a'v + q_a, and v moves by M^-1 H_a dr_a. Of rigid bodies H
/// stands for L^-1 H, and 1 for M.
double GaussSeidel::sweep_by_parts(Vec& r, Vec& u) const {
  const DelassusParts& parts = *problem_.W.parts();
  const SpMat* root = parts.root();
  const SpMat& H = root != nullptr ? *root : parts.H();
  Vec v = H * r;
  if (root == nullptr) v = parts.inverse(v);
  double change = 0;
  for (std::size_t a = 0; a < contacts_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    const Eigen::Vector3d before = block.of(r);
    Eigen::Vector3d here = block.of(problem_.q) + problem_.W.shift() * before;
    for (int k = 0; k < block.size; ++k) here[k] += H.col(block.first + k).dot(v);
    const Eigen::Vector3d after = solved(a, before, here);
    const Eigen::Vector3d d = after - before;
    if (d.isZero(0)) continue;
    r.segment(block.first, block.size) = after.head(block.size);
    if (root != nullptr)
      for (int k = 0; k < block.size; ++k)
        for (SpMat::InnerIterator it(H, block.first + k); it; ++it) v[it.row()] += it.value() * d[k];
    else
      v += parts.inverse(Vec(H.middleCols(block.first, block.size) * d.head(block.size)));
    change += d.squaredNorm();
  }
  u = problem_.W * r + problem_.q;
  return std::sqrt(change);
}

double GaussSeidel::sweep(Vec& r, Vec& u) const {
  if (problem_.W.parts() != nullptr) return sweep_by_parts(r, u);
  double change = 0;
  for (std::size_t a = 0; a < contacts_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    const Eigen::Vector3d before = block.of(r);
    change += set_impulse(problem_, block, solved(a, before, block.of(u)), r, u);
  }
  return std::sqrt(change);
}

}  // namespace perp::contact

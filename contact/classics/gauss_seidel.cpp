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
      for (int i = 0; i < block.size; ++i) W(i, j) = problem.W.coeff(block.first + i, block.first + j);
    contacts.emplace_back(block.size, W);
  }
  return contacts;
}

double set_impulse(const Scaled& problem, const Scaled::Block& block, const Eigen::Vector3d& after, Vec& r, Vec& u) {
  const Eigen::Vector3d d = after - block.of(r);
  if (d.isZero(0)) return 0;
  for (int k = 0; k < block.size; ++k) {
    r[block.first + k] = after[k];
    if (d[k] == 0) continue;
    for (SpMat::InnerIterator it(problem.W, block.first + k); it; ++it) u[it.row()] += it.value() * d[k];
  }
  return d.squaredNorm();
}

GaussSeidel::GaussSeidel(const Scaled& problem, LocalSolver local, double omega)
    : problem_(problem), contacts_(local_problems(problem)), local_(local), omega_(omega) {}

double GaussSeidel::sweep(Vec& r, Vec& u) const {
  double change = 0;
  for (std::size_t a = 0; a < contacts_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    const Eigen::Vector3d before = block.of(r);
    Eigen::Vector3d after = contacts_[a].solve(local_, block.of(u) - contacts_[a].W() * before, before);
    if (omega_ != 1) after = project_onto_unit_cone(before + omega_ * (after - before));
    change += set_impulse(problem_, block, after, r, u);
  }
  return std::sqrt(change);
}

}  // namespace perp::contact

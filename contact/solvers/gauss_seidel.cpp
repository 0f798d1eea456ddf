// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/gauss_seidel.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "contact/solvers/alart_curnier.hpp"

namespace perp::contact {
namespace {

constexpr int local_steps = 10;
constexpr double local_tol = 1e-13;

/// The local problem of one contact from r; r as it was where Newton's method fails.
Eigen::Vector3d local(int size, const Eigen::Matrix3d& W, const Eigen::Matrix3d& inverse, const Eigen::Vector3d& b,
                      const Eigen::Vector3d& from) {
  if (b[0] >= 0) return Eigen::Vector3d::Zero();
  if (!(W(0, 0) > 0)) return from;
  if (size == 1) return {-b[0] / W(0, 0), 0, 0};
  Eigen::Vector3d stuck = -(inverse * b);
  if ((W * stuck + b).norm() <= 1e-12 * b.norm() && stuck.tail<2>().norm() <= stuck[0]) return stuck;
  const double rho_N = 1 / W(0, 0);
  const double tangential = size == 2 ? W(1, 1) : (W(1, 1) + W(2, 2)) / 2;
  const double rho_T = tangential > 0 ? 1 / tangential : 1;
  Eigen::Vector3d r = from;
  r[0] = std::max(r[0], -b[0] * rho_N);
  for (int k = 0; k < local_steps; ++k) {
    const AlartCurnierRows rows = alart_curnier_rows(size, r, W * r + b, rho_N, rho_T);
    Eigen::Matrix3d K = rows.A + rows.B * W;
    for (int i = size; i < 3; ++i) K(i, i) = 1;
    const Eigen::Vector3d d = K.partialPivLu().solve(rows.c);
    if (!d.allFinite()) return from;
    r += d;
    if (d.norm() <= local_tol * r.norm()) return r;
  }
  return from;
}

}  // namespace

GaussSeidel::GaussSeidel(const Scaled& problem) : problem_(problem) {
  for (const Scaled::Block& block : problem.blocks) {
    Eigen::Matrix3d W = Eigen::Matrix3d::Zero();
    for (int j = 0; j < block.size; ++j)
      for (int i = 0; i < block.size; ++i) W(i, j) = problem.W.coeff(block.first + i, block.first + j);
    diagonal_.push_back(W);
    for (int i = block.size; i < 3; ++i) W(i, i) = 1;
    const Eigen::FullPivLU<Eigen::Matrix3d> factors(W);
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();  // of singular blocks: none
    if (factors.isInvertible()) inverse = factors.inverse();
    inverse_.push_back(inverse);
  }
}

double GaussSeidel::sweep(Vec& r, Vec& u) const {
  double change = 0;
  for (std::size_t a = 0; a < diagonal_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    const Eigen::Vector3d before = block.of(r);
    const Eigen::Vector3d velocity = block.of(u);
    const Eigen::Vector3d after =
        local(block.size, diagonal_[a], inverse_[a], velocity - diagonal_[a] * before, before);
    const Eigen::Vector3d d = after - before;
    if (d.isZero(0)) continue;
    change += d.squaredNorm();
    for (int k = 0; k < block.size; ++k) {
      r[block.first + k] = after[k];
      if (d[k] == 0) continue;
      for (SpMat::InnerIterator it(problem_.W, block.first + k); it; ++it) u[it.row()] += it.value() * d[k];
    }
  }
  return std::sqrt(change);
}

}  // namespace perp::contact

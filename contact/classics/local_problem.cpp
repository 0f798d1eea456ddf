// SPDX-License-Identifier: Apache-2.0
#include "contact/classics/local_problem.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "contact/classics/alart_curnier.hpp"
#include "contact/model/unit_cone.hpp"

namespace perp::contact {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int local_steps = 10;
constexpr double local_tol = 1e-13;
/// De Saxce & Feng's steps of one visit.
constexpr int local_projections = 10;

/// The root of h in [low, high] with h(low) < 0 <= h(high), by regula falsi as in the Illinois algorithm, with a
/// bisection every third step.
template <class Function>
double root_between(const Function& h, double low, double high) {
  double at_low = h(low);
  double at_high = h(high);
  for (int k = 0;; ++k) {
    double middle = k % 3 == 2 ? (low + high) / 2 : high - at_high * (high - low) / (at_high - at_low);
    if (!(middle > low && middle < high)) middle = (low + high) / 2;
    if (!(middle > low && middle < high)) break;  // no double is between them
    const double value = h(middle);
    if (value < 0) {
      low = middle;
      at_low = value;
      at_high /= 2;
    } else {
      high = middle;
      at_high = value;
      at_low /= 2;
    }
    if (value == 0) break;
  }
  return high;
}

}  // namespace

LocalProblem::LocalProblem(int size, const Eigen::Matrix3d& W)
    : size_(size), W_(W), norm_(W.cwiseAbs().rowwise().sum().maxCoeff()) {
  Eigen::Matrix3d padded = W;
  for (int i = size; i < 3; ++i) padded(i, i) = 1;
  const Eigen::FullPivLU<Eigen::Matrix3d> factors(padded);
  if (factors.isInvertible()) inverse_ = factors.inverse();
}

Vector3d LocalProblem::solve(LocalSolver solver, const Vector3d& b, const Vector3d& from) const {
  if (b[0] >= 0) return Vector3d::Zero();
  if (!(W_(0, 0) > 0)) return from;
  if (size_ == 1) return {-b[0] / W_(0, 0), 0, 0};
  if (solver == LocalSolver::Projection) return project(b, from);
  const Vector3d stuck = -(inverse_ * b);
  if ((W_ * stuck + b).norm() <= 1e-12 * b.norm() && stuck.tail<2>().norm() <= stuck[0]) return stuck;
  if (Vector3d r = from; solver == LocalSolver::Newton && newton(b, r)) return r;
  return sliding(b, from);
}

bool LocalProblem::newton(const Vector3d& b, Vector3d& r) const {
  const double rho_N = 1 / W_(0, 0);
  const double tangential = size_ == 2 ? W_(1, 1) : (W_(1, 1) + W_(2, 2)) / 2;
  const double rho_T = tangential > 0 ? 1 / tangential : 1;
  r[0] = std::max(r[0], -b[0] * rho_N);
  for (int k = 0; k < local_steps; ++k) {
    const NewtonRows rows = alart_curnier_rows(size_, r, W_ * r + b, rho_N, rho_T);
    Eigen::Matrix3d K = rows.A + rows.B * W_;
    for (int i = size_; i < 3; ++i) K(i, i) = 1;
    const Vector3d d = K.partialPivLu().solve(rows.c);
    if (!d.allFinite()) return false;
    r += d;
    if (d.norm() <= local_tol * r.norm()) return true;
  }
  return false;
}

Vector3d LocalProblem::project(const Vector3d& b, Vector3d r) const {
  for (int k = 0; k < local_projections; ++k) r = project_onto_unit_cone(r - corrected(W_ * r + b) / norm_);
  return r;
}

/// u_N = 0, u_T = -lambda r_T, |r_T| = r_N. With A = W_TT - W_TN W_NT / W_NN and c = b_T - W_TN b_N / W_NN
///     r_T = -v / p,   r_N = g / (W_NN p),   v = (adj A + lambda I) c,   p = det(A + lambda I),   g = W_NT v - b_N p,
/// and h(lambda) = g - W_NN |v| = 0. h grows like -b_N lambda^2 > 0, and h(0) < 0 where the contact cannot stick: there
/// is a root. Its square is the quartic of Bonnefon & Daviet (2011).
Vector3d LocalProblem::sliding(const Vector3d& b, const Vector3d& from) const {
  Matrix2d A = W_.bottomRightCorner<2, 2>() - W_.bottomLeftCorner<2, 1>() * W_.topRightCorner<1, 2>() / W_(0, 0);
  if (size_ == 2) A(1, 1) = 1;
  const Vector2d c = b.tail<2>() - W_.bottomLeftCorner<2, 1>() * (b[0] / W_(0, 0));
  Matrix2d adjugate;
  adjugate << A(1, 1), -A(0, 1), -A(1, 0), A(0, 0);
  const auto v = [&](double lambda) -> Vector2d { return adjugate * c + lambda * c; };
  const auto p = [&](double lambda) { return A.determinant() + lambda * (A.trace() + lambda); };
  const auto g = [&](double lambda) { return W_.topRightCorner<1, 2>().dot(v(lambda)) - b[0] * p(lambda); };
  const auto h = [&](double lambda) { return g(lambda) - W_(0, 0) * v(lambda).norm(); };
  double high = std::max(norm_, 1e-300);
  while (!(h(high) >= 0) && std::isfinite(high)) high *= 2;
  const double lambda = h(0) < 0 ? root_between(h, 0, high) : 0;
  Vector3d r;
  r << std::max(0.0, g(lambda) / W_(0, 0)), -v(lambda);
  r /= p(lambda);
  return r.allFinite() ? r : from;
}

}  // namespace perp::contact

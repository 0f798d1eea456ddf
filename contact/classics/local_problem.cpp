// SPDX-License-Identifier: Apache-2.0
#include "contact/classics/local_problem.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "contact/classics/alart_curnier.hpp"
#include "contact/model/unit_cone.hpp"

namespace perp::contact {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr int local_steps = 10;
constexpr double local_tol = 1e-13;
/// De Saxce & Feng's steps of one visit.
constexpr int local_projections = 10;
/// Solves two disks in turn, for one normal impulse.
constexpr int local_turns = 100;
/// Normal impulses of two disks are looked for up to so many times what stops the contact without friction.
constexpr double most_local_impulse = 1e8;

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

/// The least of t'A t / 2 + c.t in the disk of that radius, A semidefinite: (A + lambda) t = -c, lambda > 0 where |t|
/// is the radius (More & Sorensen, SIAM J. Sci. Stat. Comput. 4 (1983) 553).
Vector2d least_in_disk(const Matrix2d& A, const Vector2d& c, double radius) {
  if (!(radius > 0)) return Vector2d::Zero();
  const auto t = [&](double lambda) -> Vector2d { return -(A + lambda * Matrix2d::Identity()).inverse() * c; };
  const auto h = [&](double lambda) { return radius - t(lambda).norm(); };
  const double low = std::numeric_limits<double>::epsilon() * A.trace();  // A may be singular
  if (h(low) >= 0) return t(low);
  double high = std::max(c.norm() / radius, 2 * low);
  while (!(h(high) >= 0) && std::isfinite(high)) high *= 2;
  const Vector2d on_it = t(root_between(h, low, high));
  return radius / on_it.norm() * on_it;
}

}  // namespace

template <int Size>
LocalProblem<Size>::LocalProblem(const Scaled::Block& block, const Matrix& W)
    : size_(block.size), width_(block.width), W_(W), norm_(W.cwiseAbs().rowwise().sum().maxCoeff()) {
  Matrix padded = W;
  for (int i = size_; i < Size; ++i) padded(i, i) = 1;
  const Eigen::FullPivLU<Matrix> factors(padded);
  if (factors.isInvertible()) inverse_ = factors.inverse();
}

template <int Size>
bool LocalProblem<Size>::sticks(const Vector& r) const {
  for (int j = 0; j < disks<Size>; ++j)
    if (!(disk<Size>(r, j, width_).norm() <= r[0])) return false;
  return true;
}

template <int Size>
ContactVector<Size> LocalProblem<Size>::solve(LocalSolver solver, const Vector& b, const Vector& from) const {
  if (b[0] >= 0) return Vector::Zero();
  if (!(W_(0, 0) > 0)) return from;
  if (size_ == 1) return -b[0] / W_(0, 0) * Vector::Unit(0);
  if (solver == LocalSolver::Projection) return project(b, from);
  const Vector stuck = -(inverse_ * b);
  if ((W_ * stuck + b).norm() <= 1e-12 * b.norm() && sticks(stuck)) return stuck;
  if (Vector r = from; solver == LocalSolver::Newton && newton(b, r)) return r;
  return sliding(b, from);
}

template <int Size>
bool LocalProblem<Size>::newton(const Vector& b, Vector& r) const {
  const Scaled::Block block{.size = size_, .width = width_};
  const double rho_N = 1 / W_(0, 0);
  std::array<double, disks<Size>> rho_T{};
  for (int j = 0; j < disks<Size>; ++j) {
    const int first = 1 + j * width_;
    const int count = std::min(width_, size_ - first);
    const double tangential = count > 0 ? W_.diagonal().segment(first, count).mean() : 0;
    rho_T[at(j)] = tangential > 0 ? 1 / tangential : 1;
  }
  r[0] = std::max(r[0], -b[0] * rho_N);
  for (int k = 0; k < local_steps; ++k) {
    const NewtonRowsOfSize<Size> rows = alart_curnier_rows<Size>(block, r, W_ * r + b, rho_N, rho_T);
    Matrix K = rows.A + rows.B * W_;
    for (int i = size_; i < Size; ++i) K(i, i) = 1;
    const Vector d = K.partialPivLu().solve(rows.c);
    if (!d.allFinite()) return false;
    r += d;
    if (d.norm() <= local_tol * r.norm()) return true;
  }
  return false;
}

template <int Size>
ContactVector<Size> LocalProblem<Size>::project(const Vector& b, Vector r) const {
  for (int k = 0; k < local_projections; ++k)
    r = project_onto_unit_cone<Size>(r - corrected<Size>(W_ * r + b, width_) / norm_, width_);
  return r;
}

/// u_N = 0, u_T = -lambda r_T, |r_T| = r_N. With A = W_TT - W_TN W_NT / W_NN and c = b_T - W_TN b_N / W_NN
///     r_T = -v / p,   r_N = g / (W_NN p),   v = (adj A + lambda I) c,   p = det(A + lambda I),   g = W_NT v - b_N p,
/// and h(lambda) = g - W_NN |v| = 0. h grows like -b_N lambda^2 > 0, and h(0) < 0 where the contact cannot stick: there
/// is a root. Its square is the quartic of Bonnefon & Daviet (2011).
template <>
ContactVector<3> LocalProblem<3>::sliding(const Vector& b, const Vector& from) const {
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
  Vector r;
  r << std::max(0.0, g(lambda) / W_(0, 0)), -v(lambda);
  r /= p(lambda);
  return r.allFinite() ? r : from;
}

/// r with this normal impulse and friction that opposes slip and rolling: the least of r'W r / 2 + b.r in both disks,
/// by turns.
template <>
ContactVector<5> LocalProblem<5>::in_disks(double normal, const Vector& b, Vector r) const {
  r[0] = normal;
  for (int k = 0; k < local_turns; ++k) {
    const Vector before = r;
    for (int j = 0; j < 2; ++j) {
      const int first = 1 + j * width_;
      const int count = std::min(width_, size_ - first);
      if (count <= 0) break;
      Vector rest = r;
      set_disk<5>(rest, j, width_, Vector2d::Zero());
      Matrix2d A = Matrix2d::Identity();
      A.topLeftCorner(count, count) = W_.block(first, first, count, count);
      const Vector2d part = least_in_disk(A, disk<5>(W_ * rest + b, j, width_), normal);
      set_disk<5>(r, j, width_, part);
    }
    if ((r - before).norm() <= local_tol * r.norm()) break;
  }
  return r;
}

/// u_N as a function of r_N, the disks' impulses following, is below zero at 0, and above it far out where W is
/// positive definite: there is a root, and it solves the contact.
template <>
ContactVector<5> LocalProblem<5>::sliding(const Vector& b, const Vector& from) const {
  const auto opening = [&](double normal) { return W_.row(0).dot(in_disks(normal, b, from)) + b[0]; };
  double high = -b[0] / W_(0, 0);
  while (!(opening(high) >= 0) && high < most_local_impulse * (-b[0] / W_(0, 0))) high *= 2;
  if (!(opening(high) >= 0)) return project(b, from);
  const Vector r = in_disks(root_between(opening, 0, high), b, from);
  return r.allFinite() ? r : from;
}

template class LocalProblem<3>;
template class LocalProblem<5>;

}  // namespace perp::contact

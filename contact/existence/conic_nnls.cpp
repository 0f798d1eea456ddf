// SPDX-License-Identifier: Apache-2.0
#include "contact/existence/conic_nnls.hpp"

#include <Eigen/Jacobi>
#include <cmath>
#include <utility>

namespace perp::contact {
namespace {

using lcp::at;
using lcp::Index;
using lcp::Vec;

/// Of the largest entry: less is zero.
constexpr double negligible = 1e-14;
/// A column of which the others leave less than this part depends on them.
constexpr double dependent = 1e-15;
/// Solutions are refined so often with the residual of the columns themselves; with R alone, of the normal equations.
constexpr int refinements = 1;
constexpr int normal_refinements = 3;
/// Up to so many entries Q is kept, which does not square the condition of the columns.
constexpr Index dense_entries = 200000;

}  // namespace

double ConicNnls::Column::dot(lcp::In v) const {
  double sum = 0;
  for (const auto& [row, value] : entries) sum += value * v[row];
  return sum;
}

Vec ConicNnls::residual(const Vec& x) const {
  Vec rho = e_;
  for (std::size_t j = 0; j < columns_.size(); ++j)
    for (const auto& [row, value] : columns_[j].entries) rho[row] += x[static_cast<Index>(j)] * value;
  return rho;
}

/// The least squares solution of C z = v.
Vec ConicNnls::coefficients(const Vec& v) const {
  const auto R = R_.triangularView<Eigen::Upper>();
  if (keeps_Q_) return R.solve(Q_.transpose() * v);
  Vec products(x_.size());
  for (Index j = 0; j < products.size(); ++j) products[j] = columns_[at(j)].dot(v);
  return R.solve(R.transpose().solve(products));
}

/// False: it depends on the others up to rounding. Q's new column is made orthogonal twice, which is enough (Kahan and
/// Parlett; Parlett 1998, 6.9).
bool ConicNnls::append(Column column) {
  const auto size = static_cast<Index>(columns_.size());
  Vec dense = Vec::Zero(e_.size());
  for (const auto& [row, value] : column.entries) dense[row] += value;
  if (keeps_Q_ && (size + 1) * e_.size() > dense_entries) {
    keeps_Q_ = false;
    Q_.resize(0, 0);
  }
  const double squares = dense.squaredNorm();
  Vec r(size);
  double rest = 0;
  if (keeps_Q_) {
    r = Q_.transpose() * dense;
    dense -= Q_ * r;
    const Vec more = Q_.transpose() * dense;
    dense -= Q_ * more;
    r += more;
    rest = dense.norm();
  } else {
    for (Index j = 0; j < size; ++j) r[j] = columns_[at(j)].dot(dense);
    R_.triangularView<Eigen::Upper>().transpose().solveInPlace(r);
    rest = std::sqrt(squares - r.squaredNorm());
  }
  if (!(rest > dependent * std::sqrt(squares))) return false;
  if (keeps_Q_) {
    Q_.conservativeResize(e_.size(), size + 1);
    Q_.col(size) = dense / rest;
  }
  R_.conservativeResize(size + 1, size + 1);
  R_.row(size).setZero();
  R_.col(size).head(size) = r;
  R_(size, size) = rest;
  columns_.push_back(std::move(column));
  x_.conservativeResize(size + 1);
  x_[size] = 0;
  return true;
}

bool ConicNnls::least_squares(Vec& z) const {
  z = coefficients(-e_);
  for (int k = 0; k < (keeps_Q_ ? refinements : normal_refinements); ++k) z -= coefficients(residual(z));
  return z.allFinite();
}

/// Column j of R goes, and Givens' rotations turn what is left of it into a triangle again.
void ConicNnls::drop(Index j) {
  const Index last = R_.cols() - 1;
  for (Index k = j; k < last; ++k) R_.col(k) = R_.col(k + 1).eval();
  for (Index k = j; k < last; ++k) {
    Eigen::JacobiRotation<double> rotation;
    rotation.makeGivens(R_(k, k), R_(k + 1, k));
    R_.middleCols(k, last - k).applyOnTheLeft(k, k + 1, rotation.adjoint());
    R_(k + 1, k) = 0;
    if (keeps_Q_) Q_.applyOnTheRight(k, k + 1, rotation);
  }
  R_.conservativeResize(last, last);
  if (keeps_Q_) Q_.conservativeResize(e_.size(), last);
  columns_.erase(columns_.begin() + j);
  for (Index k = j; k < last; ++k) x_[k] = x_[k + 1];
  x_.conservativeResize(last);
}

void ConicNnls::drop_zeros() {
  const double zero = negligible * x_.lpNorm<Eigen::Infinity>();
  for (Index j = x_.size() - 1; j >= 0; --j)
    if (!(x_[j] > zero)) drop(j);
}

bool ConicNnls::enter(Column column) {
  const double before = rho_.norm();
  const ConicNnls old = *this;
  if (!append(std::move(column))) return false;
  // Every round but the last drops a column.
  while (!columns_.empty()) {
    Vec z;
    if (!least_squares(z)) {
      *this = old;
      return false;
    }
    double step = 1;
    Index blocking = -1;
    for (Index j = 0; j < z.size(); ++j)
      if (z[j] <= 0 && x_[j] / (x_[j] - z[j]) <= step) {
        step = z[j] < x_[j] ? x_[j] / (x_[j] - z[j]) : 0;
        blocking = j;
      }
    x_ += step * (z - x_);
    if (blocking < 0) break;
    x_[blocking] = 0;
    drop_zeros();
  }
  rho_ = residual(x_);
  if (rho_.norm() < before) return true;
  *this = old;
  return false;
}

}  // namespace perp::contact

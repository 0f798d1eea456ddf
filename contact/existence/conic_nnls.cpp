// SPDX-License-Identifier: Apache-2.0
#include "contact/existence/conic_nnls.hpp"

#include <utility>

namespace perp::contact {
namespace {

using lcp::at;
using lcp::Index;
using lcp::Vec;

/// Of the largest entry: less is zero.
constexpr double negligible = 1e-14;
/// Solutions of the normal equations are refined so often with the residual of the columns themselves.
constexpr int refinements = 3;
/// Up to so many entries the columns are factored themselves, which does not square their condition.
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

void ConicNnls::append(Column column) {
  const auto size = static_cast<Index>(columns_.size());
  Vec dense = Vec::Zero(e_.size());
  for (const auto& [row, value] : column.entries) dense[row] += value;
  gram_.conservativeResize(size + 1, size + 1);
  for (Index j = 0; j < size; ++j) gram_(j, size) = gram_(size, j) = columns_[at(j)].dot(dense);
  gram_(size, size) = dense.squaredNorm();
  columns_.push_back(std::move(column));
  x_.conservativeResize(size + 1);
  x_[size] = 0;
}

bool ConicNnls::least_squares(Vec& z) const {
  if (x_.size() * e_.size() <= dense_entries) {
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(e_.size(), x_.size());
    for (Index j = 0; j < x_.size(); ++j)
      for (const auto& [row, value] : columns_[at(j)].entries) C(row, j) += value;
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(C);
    z = factor.solve(-e_);
    z -= factor.solve(residual(z));
    return z.allFinite();
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(gram_);
  if (factor.info() != Eigen::Success) return false;
  z = Vec::Zero(x_.size());
  for (int k = 0; k <= refinements; ++k) {
    const Vec rho = residual(z);
    Vec gradient(z.size());
    for (Index j = 0; j < z.size(); ++j) gradient[j] = columns_[at(j)].dot(rho);
    z -= factor.solve(gradient);
  }
  return z.allFinite();
}

void ConicNnls::drop_zeros() {
  const double zero = negligible * x_.lpNorm<Eigen::Infinity>();
  std::vector<Index> kept;
  for (Index j = 0; j < x_.size(); ++j)
    if (x_[j] > zero) kept.push_back(j);
  std::vector<Column> columns;
  for (const Index j : kept) columns.push_back(std::move(columns_[at(j)]));
  columns_ = std::move(columns);
  gram_ = Eigen::MatrixXd(gram_(kept, kept));
  x_ = Vec(x_(kept));
}

bool ConicNnls::enter(Column column) {
  const double before = rho_.norm();
  const ConicNnls old = *this;
  append(std::move(column));
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

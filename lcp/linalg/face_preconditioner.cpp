// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/face_preconditioner.hpp"

#include <cmath>

namespace perp::lcp {
namespace {}  // namespace

SparseRows SparseRows::transposed(int columns) const {
  SparseRows T;
  T.start.assign(at(columns) + 1, 0);
  T.column.resize(column.size());
  T.value.resize(value.size());
  for (const int j : column) ++T.start[at(j) + 1];
  for (int j = 0; j < columns; ++j) T.start[at(j) + 1] += T.start[at(j)];
  std::vector<int> next(T.start.begin(), T.start.end() - 1);
  for (int i = 0; i < rows(); ++i)
    for (int s = start[at(i)]; s < start[at(i) + 1]; ++s) {
      const auto t = at(next[at(column[at(s)])]++);
      T.column[t] = i;
      T.value[t] = value[at(s)];
    }
  return T;
}

void SparseRows::multiply(const Vec& x, Vec& y) const {
  for (int i = 0; i < rows(); ++i) {
    double sum = 0;
    for (int s = start[at(i)]; s < start[at(i) + 1]; ++s) sum += value[at(s)] * x[column[at(s)]];
    y[i] = sum;
  }
}

SparseRows rows_of(const SpMat& M) {
  SparseRows A;
  A.start.reserve(static_cast<std::size_t>(M.cols()) + 1);
  A.column.reserve(static_cast<std::size_t>(M.nonZeros()));
  A.value.reserve(static_cast<std::size_t>(M.nonZeros()));
  for (Index j = 0; j < M.cols(); ++j) {
    for (SpMat::InnerIterator it(M, j); it; ++it) A.push(static_cast<int>(it.row()), it.value());
    A.end_row();
  }
  return A;
}

Curvature curvature(const SparseRows& A, const Vec& d) {
  long double value = 0;
  long double size = 0;
  for (int i = 0; i < A.rows(); ++i) {
    if (d[i] == 0) continue;
    for (int s = A.start[at(i)]; s < A.start[at(i) + 1]; ++s) {
      const long double term = static_cast<long double>(d[i]) * static_cast<long double>(A.value[at(s)]) *
                               static_cast<long double>(d[A.column[at(s)]]);
      value += term;
      size += std::abs(term);
    }
  }
  return {static_cast<double>(value), static_cast<double>(size)};
}

FaceStatus CholeskyFace::set_free(const Mask& free) {
  std::vector<int> number(free.size(), -1);
  unknowns_.clear();
  for (int i = 0; i < A_.rows(); ++i)
    if (free[at(i)]) {
      number[at(i)] = static_cast<int>(unknowns_.size());
      unknowns_.push_back(i);
    }
  const auto n = static_cast<Index>(unknowns_.size());
  right_ = solution_ = Vec::Zero(n);
  SpMat block(n, n);  // its lower triangle
  std::vector<Index> diagonal;
  for (Index k = 0; k < n; ++k) {
    const int i = unknowns_[at(k)];
    block.startVec(k);
    for (int s = A_.start[at(i)]; s < A_.start[at(i) + 1]; ++s) {
      const int row = number[at(A_.column[at(s)])];
      if (row < k) continue;
      if (row == k) diagonal.push_back(block.data().size());
      block.insertBack(row, k) = A_.value[at(s)];
    }
  }
  block.finalize();
  double sigma = 0;
  for (const double next : {0.0, 1e-12, 1e-10, 1e-8, 1e-6}) {
    for (const Index s : diagonal) block.valuePtr()[s] *= (1 + next) / (1 + sigma);
    sigma = next;
    ++factorizations;
    const CholeskyStatus status = block_.factor(block, entries_);
    if (status == CholeskyStatus::Ok) return FaceStatus::Ok;
    if (status != CholeskyStatus::NotPositiveDefinite) break;
    if (sigma > 0 || block_.failed_direction().size() == 0) continue;
    direction = Vec::Zero(A_.rows());
    for (Index k = 0; k < n; ++k) direction[unknowns_[at(k)]] = block_.failed_direction()[k];
    if (curvature(A_, direction).negative()) return FaceStatus::NegativeCurvature;
  }
  return FaceStatus::OutOfMemory;
}

void CholeskyFace::apply(const Vec& r, Vec& x) {
  for (std::size_t k = 0; k < unknowns_.size(); ++k) right_[static_cast<Index>(k)] = r[unknowns_[k]];
  block_.solve(right_, solution_);
  x.setZero();
  for (std::size_t k = 0; k < unknowns_.size(); ++k) x[unknowns_[k]] = solution_[static_cast<Index>(k)];
}

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#include "contact/model/bodies_matrix.hpp"

#include <algorithm>
#include <cmath>

namespace perp::contact {
namespace {

/// The place of (i, j) among the values of A.
Index place_of(const SpMat& A, int i, int j) {
  const int* begin = A.innerIndexPtr() + A.outerIndexPtr()[j];
  const int* end = A.innerIndexPtr() + A.outerIndexPtr()[j + 1];
  return std::lower_bound(begin, end, i) - A.innerIndexPtr();
}

/// Those that the contact's columns of H have entries in, ascending.
std::vector<int> rows_of(const SpMat& H, const Scaled::Block& block) {
  std::vector<int> rows;
  for (int c = 0; c < block.size; ++c)
    for (SpMat::InnerIterator it(H, block.first + c); it; ++it) rows.push_back(static_cast<int>(it.row()));
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

}  // namespace

template <int Size>
BodiesMatrixOf<Size>::BodiesMatrixOf(const Scaled& problem)
    : velocities_(problem.W.parts()->inertia().velocities()), by_lu_(problem.W.parts()->inertia().by_lu()) {
  const SpMat& M = problem.W.parts()->M();
  const SpMat& H = problem.W.parts()->H();
  std::vector<std::vector<int>> rows;           // of each contact
  std::vector<Eigen::Triplet<double>> touched;  // rows by contacts
  for (const Scaled::Block& block : problem.blocks) {
    const std::vector<int>& own = rows.emplace_back(rows_of(H, block));
    Part& part = parts_.emplace_back();
    part.H.assign(own.size(), Row::Zero());
    for (int c = 0; c < block.size; ++c)
      for (SpMat::InnerIterator it(H, block.first + c); it; ++it)
        part.H[at(std::lower_bound(own.begin(), own.end(), it.row()) - own.begin())][c] = it.value();
    for (const int i : own) touched.emplace_back(i, static_cast<int>(rows.size()) - 1, 1.0);
  }
  SpMat incidence(M.rows(), static_cast<Index>(parts_.size()));
  incidence.setFromTriplets(touched.begin(), touched.end());
  SpMat pattern = M;
  pattern.coeffs().setOnes();
  K_ = pattern + SpMat(incidence * SpMat(incidence.transpose()));
  K_.makeCompressed();
  for (std::size_t a = 0; a < parts_.size(); ++a)
    for (const int j : rows[a])
      for (const int i : rows[a]) (i >= j ? parts_[a].lower : parts_[a].upper).push_back(place_of(K_, i, j));
  inertia_.assign(at(K_.nonZeros()), 0.0);
  for (Index j = 0; j < M.cols(); ++j)
    for (SpMat::InnerIterator it(M, j); it; ++it)
      inertia_[at(place_of(K_, static_cast<int>(it.row()), static_cast<int>(j)))] = it.value();
}

template <int Size>
void BodiesMatrixOf<Size>::assemble(const std::vector<ContactMatrix<Size>>& E, bool lower_alone) {
  std::copy(inertia_.begin(), inertia_.end(), K_.valuePtr());
  double* const value = K_.valuePtr();
  Rows HE;
  for (std::size_t a = 0; a < parts_.size(); ++a) {
    const Part& part = parts_[a];
    HE.clear();
    for (const Row& row : part.H) HE.emplace_back(row * E[a]);
    const Index* lower = part.lower.data();
    const Index* upper = part.upper.data();
    for (std::size_t j = 0; j < HE.size(); ++j) {
      for (std::size_t i = j; i < HE.size(); ++i) value[*lower++] += HE[i].dot(part.H[j]);
      for (std::size_t i = 0; i < (lower_alone ? 0 : j); ++i) value[*upper++] += HE[i].dot(part.H[j]);
    }
  }
}

template <int Size>
SpMat BodiesMatrixOf<Size>::with_unit_diagonal(Vec& scale) const {
  constexpr double least_share = 1e-8;
  scale = Vec::Ones(K_.cols());
  for (Index j = 0; j < K_.cols(); ++j) {
    double diagonal = 0;
    double largest = 0;
    for (SpMat::InnerIterator it(K_, j); it; ++it) {
      largest = std::max(largest, std::abs(it.value()));
      if (it.row() == j) diagonal = std::abs(it.value());
    }
    const double unit = std::max(diagonal, least_share * largest);
    if (unit > 0 && std::isfinite(unit)) scale[j] = 1 / std::sqrt(unit);
  }
  for (Index j = velocities_; j < K_.cols(); ++j) {
    double largest = 0;
    for (SpMat::InnerIterator it(K_, j); it; ++it)
      if (it.row() < velocities_) largest = std::max(largest, scale[it.row()] * std::abs(it.value()));
    if (largest > 0 && std::isfinite(largest)) scale[j] = 1 / largest;
  }
  return scale.asDiagonal() * K_ * scale.asDiagonal();
}

template class BodiesMatrixOf<3>;
template class BodiesMatrixOf<5>;

}  // namespace perp::contact

// SPDX-License-Identifier: Apache-2.0
#include "lcp/cholesky/cholesky_supernodal.hpp"

#include <algorithm>
#include <cmath>

namespace perp::lcp {
namespace {

/// Columns that are eliminated at a time within a supernode, and columns of an update.
constexpr Index eliminated_columns = 32;
constexpr Index updated_columns = 64;

using DenseBlock = Eigen::Map<Eigen::MatrixXd>;
using DensePart = Eigen::Ref<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

/// L of a small block, A = L S L', into its lower triangle. The first column whose pivot has not its sign, or their
/// number; a pivot that is not a number is taken for right.
Index eliminate_small(DensePart A, In s) {
  for (Index k = 0; k < A.cols(); ++k) {
    const Index rest = A.cols() - k - 1;
    const Vec row = A.row(k).head(k).transpose().cwiseProduct(s.head(k));
    const double pivot = s[k] * (A(k, k) - A.row(k).head(k).dot(row));
    if (pivot <= 0) return k;
    A(k, k) = std::sqrt(pivot);
    A.col(k).tail(rest).noalias() -= A.bottomLeftCorner(rest, k) * row;
    A.col(k).tail(rest) /= s[k] * A(k, k);
  }
  return A.cols();
}

/// C -= B S B' in the lower triangle of C, B with the rows of C, and C's columns at the top.
void subtract_square(const DensePart& B, In s, DensePart C) {
  for (Index j = 0; j < C.cols(); j += updated_columns) {
    const Index width = std::min(updated_columns, C.cols() - j);
    const Index rows = C.rows() - j;
    const Eigen::MatrixXd top = B.middleRows(j, width) * s.asDiagonal();
    C.block(j, j, rows, width).noalias() -= B.bottomRows(rows) * top.transpose();
  }
}

}  // namespace

SupernodalFactor::SupernodalFactor(const SpMat& A, std::span<const int> order, std::span<const signed char> signs,
                                   const SupernodalShape& shape)
    : shape_(shape), signs_(Vec::Ones(A.rows())), owner_(order.size()), places_(at(A.nonZeros()), -1) {
  if (!signs.empty())
    for (std::size_t k = 0; k < order.size(); ++k) signs_[static_cast<Index>(k)] = signs[at(order[k])];
  std::size_t most = 0;
  for (std::size_t s = 0; s + 1 < shape.first.size(); ++s) {
    std::fill(owner_.begin() + shape.first[s], owner_.begin() + shape.first[s + 1], static_cast<int>(s));
    most = std::max(most, at(shape.rows_at[s + 1] - shape.rows_at[s]));
  }
  relative_.resize(most);
  update_.resize(static_cast<Index>(most), updated_columns);
  std::vector<int> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[at(order[k])] = static_cast<int>(k);
  std::size_t entry = 0;
  for (Index j = 0; j < A.cols(); ++j)
    for (SpMat::InnerIterator it(A, j); it; ++it, ++entry) {
      if (it.row() < j) continue;
      const auto [column, row] = std::minmax(place[at(j)], place[at(it.row())]);
      const std::size_t s = at(owner_[at(column)]);
      const auto rows = shape.rows.subspan(at(shape.rows_at[s]), at(shape.rows_at[s + 1] - shape.rows_at[s]));
      const auto local = std::lower_bound(rows.begin(), rows.end(), row) - rows.begin();
      places_[entry] =
          shape.values_at[s] + (column - shape.first[s]) * static_cast<int>(rows.size()) + static_cast<int>(local);
    }
}

/// L of the supernode's own block. Its first column whose pivot has not its sign, or their number.
Index SupernodalFactor::eliminate(std::size_t s, double* values) const {
  const Index columns = shape_.first[s + 1] - shape_.first[s];
  const Index rows = shape_.rows_at[s + 1] - shape_.rows_at[s];
  DenseBlock L(values + shape_.values_at[s], rows, columns);
  for (Index j = 0; j < columns; j += eliminated_columns) {
    const Index width = std::min(eliminated_columns, columns - j);
    const Index below = rows - j - width;
    const auto signs = signs_.segment(shape_.first[s] + j, width);
    const Index failed = eliminate_small(L.block(j, j, width, width), signs);
    if (failed < width) return j + failed;
    auto under = L.block(j + width, j, below, width);
    L.block(j, j, width, width).triangularView<Eigen::Lower>().adjoint().solveInPlace<Eigen::OnTheRight>(under);
    under *= signs.asDiagonal();
    subtract_square(under, signs, L.block(j + width, j + width, below, columns - j - width));
  }
  return columns;
}

/// Where the rows of s from this one on are among those of the ancestor.
void SupernodalFactor::locate(std::size_t s, Index from, std::size_t ancestor) {
  const int* row = shape_.rows.data() + shape_.rows_at[s];
  const int* const begin = shape_.rows.data() + shape_.rows_at[ancestor];
  const int* there = begin;
  for (Index i = from; i < shape_.rows_at[s + 1] - shape_.rows_at[s]; ++i) {
    while (*there < row[i]) ++there;
    relative_[at(i)] = static_cast<int>(there - begin);
  }
}

void SupernodalFactor::update_ancestors(std::size_t s, double* values) {
  const Index columns = shape_.first[s + 1] - shape_.first[s];
  const Index rows = shape_.rows_at[s + 1] - shape_.rows_at[s];
  const int* row = shape_.rows.data() + shape_.rows_at[s];
  const DenseBlock L(values + shape_.values_at[s], rows, columns);
  std::size_t ancestor = s;
  double* block = nullptr;
  Index height = 0;
  for (Index j = columns; j < rows; j += updated_columns) {
    const Index width = std::min(updated_columns, rows - j);
    auto update = update_.topLeftCorner(rows - j, width);
    const Eigen::MatrixXd top = L.middleRows(j, width) * signs_.segment(shape_.first[s], columns).asDiagonal();
    update.noalias() = L.bottomRows(rows - j) * top.transpose();
    for (Index k = 0; k < width; ++k) {
      if (const std::size_t owner = at(owner_[at(row[j + k])]); owner != ancestor) {
        ancestor = owner;
        locate(s, j + k, ancestor);
        block = values + shape_.values_at[ancestor];
        height = shape_.rows_at[ancestor + 1] - shape_.rows_at[ancestor];
      }
      double* const to = block + (row[j + k] - shape_.first[ancestor]) * height;
      for (Index i = k; i < rows - j; ++i) to[relative_[at(j + i)]] -= update(i, k);
    }
  }
}

Index SupernodalFactor::factor(const SpMat& A, std::span<double> values) {
  std::fill(values.begin(), values.end(), 0.0);
  for (std::size_t e = 0; e < places_.size(); ++e)
    if (places_[e] >= 0) values[at(places_[e])] += A.valuePtr()[e];
  for (std::size_t s = 0; s + 1 < shape_.first.size(); ++s) {
    const Index failed = shape_.first[s] + eliminate(s, values.data());
    if (failed < shape_.first[s + 1]) return failed;
    update_ancestors(s, values.data());
  }
  return static_cast<Index>(owner_.size());
}

template <class X>
void SupernodalFactor::solve(std::span<const double> values, X& x) const {
  X below(static_cast<Index>(relative_.size()), x.cols());
  const auto with_block = [&](std::size_t s, auto use) {
    const Index columns = shape_.first[s + 1] - shape_.first[s];
    const Index rows = shape_.rows_at[s + 1] - shape_.rows_at[s];
    const Eigen::Map<const Eigen::MatrixXd> L(values.data() + shape_.values_at[s], rows, columns);
    auto own = x.middleRows(shape_.first[s], columns);
    auto under = below.topRows(rows - columns);
    use(L.topRows(columns).template triangularView<Eigen::Lower>(), L.bottomRows(rows - columns), own, under,
        shape_.rows.data() + shape_.rows_at[s] + columns);
  };
  const std::size_t count = shape_.first.size() - 1;
  for (std::size_t s = 0; s < count; ++s)
    with_block(s, [&](const auto& diagonal, const auto& L, auto& own, auto& under, const int* row) {
      diagonal.solveInPlace(own);
      under.noalias() = L * own;
      for (Index c = 0; c < x.cols(); ++c)
        for (Index i = 0; i < L.rows(); ++i) x(row[i], c) -= under(i, c);
    });
  x = signs_.asDiagonal() * x;
  for (std::size_t s = count; s-- > 0;)
    with_block(s, [&](const auto& diagonal, const auto& L, auto& own, auto& under, const int* row) {
      for (Index c = 0; c < x.cols(); ++c)
        for (Index i = 0; i < L.rows(); ++i) under(i, c) = x(row[i], c);
      own.noalias() -= L.transpose() * under;
      diagonal.transpose().solveInPlace(own);
    });
}

template void SupernodalFactor::solve(std::span<const double>, Vec&) const;
template void SupernodalFactor::solve(std::span<const double>, Eigen::MatrixXd&) const;

}  // namespace perp::lcp

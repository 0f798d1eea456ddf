// SPDX-License-Identifier: Apache-2.0
#include "lcp/cholesky/cholesky_supernodal.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numeric>
#include <vector>

#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::Random;
using support::sparse;

/// An arrow: two blocks of these sizes that meet in the last `tip` columns; three supernodes.
struct Arrow {
  Arrow(int one, int two, int tip) {
    const int n = one + two + tip;
    first = {0, one, one + two, n};
    const int heights[] = {one + tip, two + tip, tip};
    rows_at = values_at = {0};
    for (std::size_t s = 0; s < 3; ++s) {
      for (int i = first[s]; i < first[s + 1]; ++i) rows.push_back(i);
      for (int i = one + two; i < n && s < 2; ++i) rows.push_back(i);
      rows_at.push_back(static_cast<int>(rows.size()));
      values_at.push_back(values_at.back() + heights[s] * (first[s + 1] - first[s]));
    }
    Random random(3);
    const Dense B = random.normals(n, n);
    A = B * B.transpose() + n * Dense::Identity(n, n);
    A.block(one, 0, two, one).setZero();
    A.block(0, one, one, two).setZero();
  }
  SupernodalShape shape() const { return {first, rows_at, values_at, rows}; }
  /// The lower triangle of the factor.
  Dense whole(const std::vector<double>& values) const {
    Dense L = Dense::Zero(A.rows(), A.rows());
    for (std::size_t s = 0; s < 3; ++s) {
      const double* value = values.data() + values_at[s];
      for (int j = first[s]; j < first[s + 1]; ++j)
        for (int k = rows_at[s]; k < rows_at[s + 1]; ++k, ++value)
          if (rows[static_cast<std::size_t>(k)] >= j) L(rows[static_cast<std::size_t>(k)], j) = *value;
    }
    return L;
  }

  std::vector<int> first, rows_at, values_at, rows;
  Dense A;
};

// Catches updates that miss a panel, or end at the wrong rows of the ancestor; wide and narrow supernodes. What is
// above the diagonal is not read. Second factors are of the new matrix alone.
TEST(SupernodalFactor, IsCholeskysFactor) {
  for (const auto& [one, two, tip] : {std::array{3, 2, 4}, {70, 33, 130}, {32, 64, 65}}) {
    const Arrow arrow(one, two, tip);
    const Index n = arrow.A.rows();
    std::vector<int> order(static_cast<std::size_t>(n));  // last row first
    std::iota(order.rbegin(), order.rend(), 0);
    const Dense reversed = arrow.A.reverse();
    const SpMat A = sparse(reversed);
    SpMat spoilt = A;
    for (Index j = 0; j < n; ++j)
      for (SpMat::InnerIterator it(spoilt, j); it && it.row() < j; ++it) it.valueRef() = 1e9;
    SupernodalFactor factor(A, order, {}, arrow.shape());
    std::vector<double> values(static_cast<std::size_t>(arrow.values_at.back()), 7.0);
    for (const double scale : {4.0, 1.0}) {
      ASSERT_EQ(factor.factor(SpMat(scale * spoilt), values), n);
      const Dense L = arrow.whole(values);
      EXPECT_LE((L * L.transpose() - scale * arrow.A).cwiseAbs().maxCoeff(), 1e-12 * scale * arrow.A.norm()) << n;
    }
  }
}

// Catches a wrong column, and columns before it that are not complete, which a witness is made of.
TEST(SupernodalFactor, StopsAtTheFirstPivotThatIsNotPositive) {
  Arrow arrow(70, 33, 130);
  for (const int failed : {40, 102, 200}) {
    Dense A = arrow.A;
    A(failed, failed) = -1;
    std::vector<int> order(static_cast<std::size_t>(A.rows()));
    std::iota(order.begin(), order.end(), 0);
    const SpMat matrix = sparse(A);
    std::vector<double> values(static_cast<std::size_t>(arrow.values_at.back()));
    ASSERT_EQ(SupernodalFactor(matrix, order, {}, arrow.shape()).factor(matrix, values), failed);
    const Dense L = arrow.whole(values).topLeftCorner(failed, failed);
    EXPECT_LE((L * L.transpose() - A.topLeftCorner(failed, failed)).cwiseAbs().maxCoeff(), 1e-12 * A.norm()) << failed;
  }
}

}  // namespace
}  // namespace perp::lcp

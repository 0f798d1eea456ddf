// SPDX-License-Identifier: Apache-2.0
#include "lcp/lu/past_zeros.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "lcp/dense_factors.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;

// Linear algebra: with the unit columns of the rows left in place of the dependent columns the matrix is regular, and
// there are n - rank of both. Catches a pivot in a column of rounding, and a row that is left and pivots, too.
TEST(PastZeros, TheRowsLeftMakeUpForTheDependentColumns) {
  support::Random random(5);
  for (int round = 0; round < 100; ++round) {
    const int n = random.integer(0, 25);
    const int rank = random.integer(0, n);
    Dense A = Dense(support::random_sparse(n, 3, random));
    for (int j = rank; j < n; ++j)
      A.col(j) = rank == 0 || j % 3 == 0 ? Eigen::VectorXd(Eigen::VectorXd::Zero(n))
                                         : Eigen::VectorXd(A.col(j % rank) - 0.3 * A.col((j + 1) % rank));
    std::vector<int> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), 0);
    const SpMat sparse = support::sparse(A);
    const PastZeros factors(sparse, order);
    const std::vector<int> rows = factors.rows_left();
    ASSERT_EQ(rows.size(), factors.dependent().size());
    if (n == 0) continue;
    Eigen::FullPivLU<Dense> exact(A);
    exact.setThreshold(1e-10);
    EXPECT_EQ(static_cast<Index>(rows.size()), n - exact.rank()) << "round " << round;
    for (std::size_t k = 0; k < rows.size(); ++k) A.col(factors.dependent()[k]) = Dense::Identity(n, n).col(rows[k]);
    EXPECT_TRUE(Eigen::FullPivLU<Dense>(A).isInvertible()) << "round " << round;
  }
}

// Columns depend on those before them: of two that are the same the second in the order.
TEST(PastZeros, ColumnsDependOnThoseBefore) {
  const SpMat A = support::matrix({{1, 0, 1}, {2, 1, 2}, {0, 3, 0}});
  EXPECT_EQ(PastZeros(A, std::vector<int>{0, 1, 2}).dependent(), std::vector<int>{2});
  EXPECT_EQ(PastZeros(A, std::vector<int>{2, 1, 0}).dependent(), std::vector<int>{0});
}

}  // namespace
}  // namespace perp::lcp

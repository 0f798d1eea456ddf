// SPDX-License-Identifier: Apache-2.0
#include "ncp/interval/exact_multipliers.hpp"

#include <gtest/gtest.h>

#include <random>

#include "lcp/exact_sum.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp {
namespace {

/// y'M of column j, exactly.
lcp::ExactSum along(const SpMat& M, Index j, const lcp::TwoPartVector& y) {
  lcp::ExactSum sum;
  for (SpMat::InnerIterator it(M, j); it; ++it) {
    sum.add_product(it.value(), y.value[it.row()]);
    sum.add_product(it.value(), y.rest[it.row()]);
  }
  return sum;
}

// Random integers, with a y in the null space of the free columns that is known but for rounding: half of the columns
// are combinations that y meets, the others are not. Catches an elimination that goes wrong, columns that are forced
// although y'M is not 0 there, and multipliers that lose digits on the way to doubles.
TEST(ExactMultipliers, MeetTheColumnsThatAreNearlyMet) {
  std::mt19937 random(4);
  const auto number = [&](int from, int to) { return std::uniform_int_distribution<int>(from, to)(random); };
  int found = 0;
  for (int run = 0; run < 200; ++run) {
    const Index n = 3 + run % 12;
    Vec y(n);
    for (double& entry : y) entry = number(1, 9) / 7.0;
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n);
    for (Index j = 0; j < n; ++j)
      for (Index i = 1; i < n; ++i) M(i, j) = number(-5, 5);
    Vec numerators = (7 * y).array().round();
    for (Index j = 0; j < n / 2; ++j) {  // y_0 M_0j = -sum of the others: scaled by 7 y_0 all are integers
      M.col(j) *= numerators[0];
      M(0, j) = 0;
      M(0, j) = -M.col(j).dot(numerators) / numerators[0];
    }
    const SpMat sparse = M.sparseView();
    const auto exact = exact_multipliers({sparse, Vec::Zero(n), Box::free(n)}, y);
    if (!exact) continue;
    ++found;
    for (Index j = 0; j < n; ++j) {
      const lcp::ExactSum sum = along(sparse, j, *exact);
      const bool met = std::abs(M.col(j).dot(numerators)) < 0.5;
      EXPECT_EQ(sum.sign() == 0, met) << run << ", " << j;
    }
    EXPECT_LE((exact->value / exact->value.lpNorm<Eigen::Infinity>() - y / y.lpNorm<Eigen::Infinity>())
                  .lpNorm<Eigen::Infinity>(),
              1e-5);
  }
  EXPECT_GE(found, 150);
}

// (1 + eps) y_0 = y_1 and (1 - eps) y_0 = y_1 have no common y. Catches a y that is close and not exact.
TEST(ExactMultipliers, AreNotGivenWhereNoneIsExact) {
  const SpMat M = Eigen::MatrixXd{{1 + 0x1p-52, 1 - 0x1p-52}, {-1, -1}}.sparseView();
  EXPECT_FALSE(exact_multipliers({M, Vec::Zero(2), Box::free(2)}, Vec::Ones(2)));
}

}  // namespace
}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/plainly_regular.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lcp/dense_factors.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::Random;
using support::sparse;

// Singular values from 1 down to s: regular is said of those far from singular only, of no size beyond the small ones,
// and of nothing that is not finite. Catches a singular Jacobian whose note is lost.
TEST(PlainlyRegular, IsFarFromSingular) {
  Random random(1);
  for (const Index n : {1, 2, 7, 40})
    for (const double s : {0.0, 1e-15, 1e-11, 1e-5, 1.0}) {
      const Dense Q = Eigen::HouseholderQR<Dense>(random.normals(n, n)).householderQ();
      Vec d = Vec::Ones(n);
      d[n - 1] = s;
      const SpMat B = sparse(Dense(Q * d.asDiagonal() * Q.transpose()));
      EXPECT_EQ(plainly_regular(B), s >= 1e-5 || (n == 1 && s > 0)) << n << ' ' << s;
    }
  for (int run = 0; run < 100; ++run) {  // rows of integers, the last a sum of two others: pivots of 0
    Dense B = random.normals(6, 6).array().round();
    B.row(5) = B.row(run % 5) + B.row((run + 1) % 5);
    EXPECT_FALSE(plainly_regular(sparse(B))) << B;
  }
  EXPECT_FALSE(plainly_regular(sparse(Dense(Dense::Identity(41, 41)))));
  EXPECT_FALSE(plainly_regular(sparse(Dense(Dense::Constant(2, 2, std::nan(""))))));
  EXPECT_TRUE(plainly_regular(SpMat(0, 0)));
}

}  // namespace
}  // namespace perp::lcp

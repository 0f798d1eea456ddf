// SPDX-License-Identifier: Apache-2.0
#include "lcp/cholesky/symmetric.hpp"

#include <gtest/gtest.h>

namespace perp::lcp {
namespace {

/// Tridiagonal, 2 on the diagonal, -1 below it and `above` above.
SpMat band(Index n, double above) {
  SpMat A(n, n);
  for (Index i = 0; i < n; ++i) {
    A.insert(i, i) = 2;
    if (i > 0) A.insert(i, i - 1) = -1;
    if (i + 1 < n) A.insert(i, i + 1) = above;
  }
  A.makeCompressed();
  return A;
}

// Catches: an entry without a mirror image, above the diagonal or below it, that is not met; stored zeros that are.
TEST(Symmetric, IsSeenInPatternAndValues) {
  EXPECT_TRUE(symmetric(band(9, -1)));
  EXPECT_FALSE(symmetric(band(9, -1 + 1e-6)));
  SpMat A = band(81, -1);
  A.coeffRef(0, 80) = 1e-3;
  EXPECT_FALSE(symmetric(A)) << "not compressed";
  A.makeCompressed();
  EXPECT_FALSE(symmetric(A));
  A.coeffRef(0, 80) = 0;  // stored, but nothing
  EXPECT_TRUE(symmetric(A));
  A = band(81, -1);
  A.coeffRef(80, 0) = 1e-3;
  A.makeCompressed();
  EXPECT_FALSE(symmetric(A));
  EXPECT_FALSE(symmetric(SpMat(3, 4)));
  EXPECT_TRUE(symmetric(SpMat(0, 0)));
}

// Catches: a tolerance that is not the caller's, or not relative to the diagonal.
TEST(Symmetric, UpToATolerance) {
  const SpMat A = band(9, -1 + 1e-14);
  EXPECT_TRUE(symmetric(A));
  EXPECT_FALSE(symmetric(A, 1e-15));
  EXPECT_FALSE(symmetric(A, 0));
  EXPECT_TRUE(symmetric(band(9, -1), 0));
  SpMat small = 1e-30 * A;
  EXPECT_TRUE(symmetric(small));
  EXPECT_FALSE(symmetric(small, 1e-15));
}

}  // namespace
}  // namespace perp::lcp

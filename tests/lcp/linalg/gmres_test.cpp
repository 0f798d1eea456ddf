// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/gmres.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::Random;

// In exact arithmetic GMRES ends after as many products as there are eigenvalues that are not one, and one more (Saad &
// Schultz 1986, section 3.4): the identity and a matrix of rank four, 30 unknowns. Catches vectors that are not
// orthogonal and a wrong least-squares problem.
TEST(Gmres, EndsWithTheRank) {
  Random random(1);
  const Dense A = Dense::Identity(30, 30) + random.normals(30, 4) * random.normals(4, 30);
  const Vec b = random.normals(30);
  int products = 0;
  const auto x = gmres([&](const Vec& v) { return ++products, Vec(A * v); }, b, 1e-11, 30);
  ASSERT_TRUE(x);
  EXPECT_LE((A * *x - b).norm(), 1e-10 * b.norm());
  EXPECT_LE(products, 5);
}

// A cycle of n unknowns shows nothing before the n-th product; NaN and a zero right-hand side end at once. Catches a
// point that is called a solution although its residual is |b|.
TEST(Gmres, SaysWhereItDoesNotConverge) {
  const auto shift = [](const Vec& v) {
    Vec out(v.size());
    out << v.tail(v.size() - 1), v[0];
    return out;
  };
  const Vec b = Vec::Unit(10, 3);
  EXPECT_FALSE(gmres(shift, b, 1e-10, 9));
  const auto x = gmres(shift, b, 1e-10, 10);
  ASSERT_TRUE(x);
  EXPECT_LE((shift(*x) - b).norm(), 1e-12);
  const auto nan = [](const Vec& v) { return Vec(v * std::numeric_limits<double>::quiet_NaN()); };
  EXPECT_FALSE(gmres(nan, b, 1e-10, 10));
  const auto zero = gmres(nan, Vec::Zero(10), 1e-10, 10);
  ASSERT_TRUE(zero);
  EXPECT_EQ(zero->norm(), 0);
}

}  // namespace
}  // namespace perp::lcp

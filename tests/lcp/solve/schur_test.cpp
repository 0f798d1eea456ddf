// SPDX-License-Identifier: Apache-2.0
/// Solutions refined to twice the precision, and what is made of them.
#include "lcp/solve/schur.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lcp/dense_factors.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::Random;
using support::sparse;
using support::vec;

SchurProduct product_of(const SpMat& K, const SpMat& B) { return {std::make_shared<const RefinedLu>(K), B}; }

// The operator is the matrix, to more digits than it has; nothing is made of a singular K. Catches a part of r or w
// that is left out.
TEST(SchurProduct, IsTheProduct) {
  const SpMat K = sparse((Dense(3, 3) << 2, 1, 0, 0, 4, 1e-9, 1, 0, 1e9).finished());
  const SpMat B = sparse((Dense(3, 2) << 1, 0, 2, 3, 0, 1e8).finished());
  const Vec r = vec({1e8, -1});
  const Vec w = vec({1, 2});
  const Dense S = B.transpose() * Dense(K).inverse() * B;
  const Vec exact = S * r + w;
  const Vec u = product_of(K, B)(r, w).value;
  EXPECT_LE((u - exact).norm(), 1e-12 * exact.norm());
  // With B = K, S = K: S r = (1, 1), of entries of 2^20 and a condition number of 2^42.
  const double big = 0x1p20;
  const SpMat L = sparse((Dense(2, 2) << big + 1, big, big, big - 1).finished());
  const Vec rest = product_of(L, L)(vec({1, -1}), vec({-1 + 0x1p-40, -1 - 0x1p-40})).value;
  EXPECT_NEAR(rest[0], 0x1p-40, 0x1p-60);
  EXPECT_NEAR(rest[1], -0x1p-40, 0x1p-60);
  EXPECT_TRUE(product_of(sparse(Dense::Ones(3, 3)), B)(r, w).value.array().isNaN().all());
  EXPECT_EQ(product_of(SpMat(0, 0), SpMat(0, 2))(r, w).value, w);
  EXPECT_THROW(product_of(K, sparse(Dense::Ones(2, 2))), std::invalid_argument);
}

// Catches rows for columns, and the drop of entries that are small beside a large diagonal, but not beside their own.
TEST(Schur, DropsRoundingOnly) {
  const SpMat K = sparse(Dense::Identity(2, 2));
  const SpMat B = sparse((Dense(2, 2) << 1e8, 1e-9, 0, 1e-8).finished());
  const Schur s = schur(K, B, vec({2, 3}), 1e-15);
  EXPECT_TRUE(s.regular());
  EXPECT_NEAR(s.S.coeff(0, 1), 0.1, 1e-16);
  EXPECT_EQ(s.x, vec({2, 3}));
  EXPECT_THROW(schur(K, sparse(Dense::Ones(3, 1)), vec({1, 1}), 0), std::invalid_argument);
  EXPECT_EQ(schur(sparse(Dense::Ones(2, 2)), B, vec({1, 1}), 0).K->status(), LuStatus::Singular);
}

// [1 1; 1 1 + d] y = (0, 1) has y = (-1, 1) / d, which is a double and a rest. Catches a rest that is lost, and parts
// of K that are refined no longer than the best of them: the other part has condition number 1 and y = 2^60.
TEST(RefinedLu, EachPartToTwiceThePrecision) {
  for (const double d : {0x1p-10, 0x1p-30, 0x1p-44}) {
    const SpMat K = sparse((Dense(3, 3) << 3, 0, 0, 0, 1, 1, 0, 1, 1 + 3 * d).finished());
    const std::optional<TwoPartVector> y = RefinedLu(K).refined(TwoPartVector(vec({0x1p60, 0, 1})));
    ASSERT_TRUE(y) << d;
    for (const auto& [i, scale, exact] : {std::tuple{0, 3.0, 0x1p60}, {1, -3 * d, 1.0}, {2, 3 * d, 1.0}}) {
      EXPECT_NEAR(y->value[i] * scale, exact, 1e-15 * exact) << d;
      const double left = std::fma(scale, y->value[i], -exact);
      EXPECT_NEAR(scale * y->rest[i], -left, 1e-26 * exact) << d << ' ' << i;
    }
  }
}

// Random K and B: sparse columns are those of dense algebra, also scaled, and what a solution may be off by is more
// than it is. Catches a scaling that is undone twice, and a row that belongs to another column.
TEST(RefinedLu, ColumnsAreThoseOfTheInverse) {
  Random random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const Vec D = Vec::NullaryExpr(7, [&] { return std::ldexp(1, random.integer(-20, 20)); });
    const Dense A = random.normals(7, 7) + 4 * Dense::Identity(7, 7);
    const SpMat K = sparse(D.asDiagonal() * A * D.asDiagonal());
    const SpMat B = sparse(D.asDiagonal() * Dense(random.normals(7, 3)));
    const RefinedLu lu(K);
    const Dense inverse = Dense(K).partialPivLu().solve(Dense(B));
    lu.for_each_column(B, [&](Index j, const SparseVector& z) {
      EXPECT_LE((z.values() - inverse.col(j)).cwiseProduct(D).norm(), 1e-11 * inverse.col(j).cwiseProduct(D).norm());
      return true;
    });
    const Dense S = Dense(B).transpose() * inverse;
    EXPECT_LE((Dense(*lu.schur(B, 0)) - S).norm(), 1e-11 * S.norm());
    const Vec b = vec({1, 2, 3, 4, 5, 6, 7});
    const Vec w = vec({1, 2, 3});
    const SchurImage image = schur_image(lu, B, TwoPartSums(b), TwoPartSums(w));
    const Vec y = Dense(K).partialPivLu().solve(b);
    const Vec terms = Dense(B).cwiseAbs().transpose() * y.cwiseAbs() + w;
    EXPECT_LE((image.value - B.transpose() * y - w).norm(), 1e-10 * terms.norm());
    EXPECT_LE((image.terms - terms).norm(), 1e-10 * terms.norm());
    EXPECT_LE(image.doubt.maxCoeff(), 1e-20 * (terms.maxCoeff() + b.cwiseProduct(D).lpNorm<1>()));
    EXPECT_GT(image.doubt.minCoeff(), 0);
  }
}

// A dense K of condition number 1e12 to 1e14: solutions end at what twice the precision leaves of it, and no digit of
// the first is lost. Catches an end that is asked for and cannot be reached: such constraints were called dependent.
TEST(RefinedLu, IllConditionedOnesAreSolvedToo) {
  Random random(4);
  for (const double smallest : {1e-6, 1e-10, 1e-12, 1e-13})
    for (int trial = 0; trial < 8; ++trial) {
      const Dense U = Dense(random.normals(8, 8)).householderQr().householderQ();
      const Dense V = Dense(random.normals(8, 8)).householderQr().householderQ();
      Vec singular = Vec::Ones(8);
      singular[7] = smallest;
      const RefinedLu lu(sparse(U * singular.asDiagonal() * V.transpose()));
      ASSERT_TRUE(lu.regular());
      const std::optional<TwoPartVector> y = lu.refined(TwoPartVector(Vec(random.normals(8, 1))));
      ASSERT_TRUE(y) << smallest << ' ' << trial;
      EXPECT_LE(lu.doubt(*y, Vec::Zero(8)).norm(), 1e-14 * y->value.norm()) << smallest;
    }
  EXPECT_FALSE(RefinedLu(sparse(Dense::Identity(3, 3))).refined(TwoPartVector(vec({NAN, 1, 1}))).has_value());
}

// What cancels in B r is in the doubt, where nothing is left of it in y: contacts on one body with r of 2^120, 2^60
// and 1.
TEST(SchurProduct, DoubtsWhatCancelsBeforeItIsSolved) {
  const SpMat B = sparse((Dense(1, 6) << -1, -1, -1, 1, 1, 1).finished());
  const SchurImage image = product_of(sparse(Dense::Identity(1, 1)), B)(vec({0x1p120, 0x1p60, 1, 0x1p120, 0x1p60, 1}),
                                                                        vec({1, 1, 1, -1, -1, -1}));
  EXPECT_GT(image.doubt.minCoeff(), 1);
  EXPECT_LT(product_of(sparse(Dense::Identity(1, 1)), B)(vec({8, 4, 1, 8, 4, 1}), Vec::Zero(6)).doubt.maxCoeff(),
            1e-28);
}

// W_0 - B' K^-1 B as an operator: with W_0 = 4 - 2^-50 and B' K^-1 B = 4 the product is that of -2^-50. Catches a sign,
// and a W_0 that is rounded with the rest.
TEST(SchurProduct, TakesAwayWhatCancels) {
  const SchurProduct W(std::make_shared<const RefinedLu>(sparse((Dense(1, 1) << 9).finished())),
                       sparse((Dense(1, 1) << 6).finished()), -1, sparse((Dense(1, 1) << 4 - 0x1p-50).finished()));
  EXPECT_EQ(W(vec({3}), vec({0})).value[0], -3 * 0x1p-50);
  EXPECT_EQ(W(vec({3}), vec({5})).value[0], 5 - 3 * 0x1p-50);
  EXPECT_EQ(W.offset(vec({3}), vec({2}))[0], 0);  // 6 * 3 / 9 = 2
  EXPECT_NEAR(W.matrix(0)->coeff(0, 0), 0, 1e-14);
  EXPECT_THROW(
      SchurProduct(std::make_shared<const RefinedLu>(sparse(Dense::Identity(2, 2))), SpMat(2, 1), 1, SpMat(2, 2)),
      std::invalid_argument);
}

}  // namespace
}  // namespace perp::lcp

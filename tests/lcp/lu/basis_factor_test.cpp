// SPDX-License-Identifier: Apache-2.0
#include "lcp/lu/basis_factor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "lcp/gpl.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::Triplets;
using support::vec;
using Update = BasisFactor::Update;

class Basis : public testing::TestWithParam<LuBackend> {
 protected:
  BasisOptions options() const { return {.lu = GetParam()}; }
};

INSTANTIATE_TEST_SUITE_P(Backends, Basis,
                         testing::Values(LuBackend::General, LuBackend::Klu, LuBackend::Eigen, LuBackend::Dense,
                                         LuBackend::Auto),
                         [](const auto& backend) { return std::string(to_string(backend.param)); });

std::vector<Index> first_columns(Index n) {
  std::vector<Index> basis(static_cast<std::size_t>(n));
  std::iota(basis.begin(), basis.end(), Index{0});
  return basis;
}

Dense columns(const SpMat& A, const std::vector<Index>& basis) {
  Dense B(A.rows(), A.rows());
  for (Index p = 0; p < A.rows(); ++p) B.col(p) = Dense(A.col(basis[static_cast<std::size_t>(p)]));
  return B;
}

Vec ftran(const BasisFactor& factor, const Vec& b) {
  Vec x(b.size());
  factor.ftran(b, x);
  return x;
}

Vec btran(const BasisFactor& factor, const Vec& b) {
  Vec x(b.size());
  factor.btran(b, x);
  return x;
}

/// [M, I, random]: n x 3n.
SpMat wide(Index n, Random& random) {
  Dense A(n, 3 * n);
  A << Dense(support::random_sparse(n, 2, random)), Dense::Identity(n, n), Dense(support::random_sparse(n, 3, random));
  return support::sparse(A);
}

/// Relative to the solution, both solves against dense LU of the columns basis() names.
void expect_represents(const BasisFactor& factor, const SpMat& A, Random& random, double tol) {
  const Dense B = columns(A, factor.basis());
  const Vec b = random.normals(A.rows());
  const Vec x = ftran(factor, b);
  const Vec y = btran(factor, b);
  EXPECT_LT((B * x - b).norm(), tol * (B.norm() * x.norm() + b.norm()));
  EXPECT_LT((B.transpose() * y - b).norm(), tol * (B.norm() * y.norm() + b.norm()));
  const Eigen::PartialPivLU<Dense> lu(B);
  EXPECT_LT((x - lu.solve(b)).norm(), 1e3 * tol * x.norm() / lu.rcond());
  EXPECT_LT((y - B.transpose().partialPivLu().solve(b)).norm(), 1e3 * tol * y.norm() / lu.rcond());
}

// Hundreds of exchanges as a pivoting method makes them, each checked against dense solves. Catches etas applied in the
// wrong order, at the wrong place, or kept over a refactorization.
TEST_P(Basis, RepresentsTheBasisThroughHundredsOfReplacements) {
  Random random(1);
  const Index n = 40;
  const SpMat A = wide(n, random);
  BasisFactor factor(A, options());
  ASSERT_EQ(factor.factor(first_columns(n)), LuStatus::Ok);
  int made = 0;
  int fresh = 1;
  for (int k = 0; made < 400; ++k) {
    ASSERT_LT(k, 20000);
    const Index p = random.integer(0, n - 1);
    const Index q = random.integer(0, 3 * n - 1);
    const Vec d = ftran(factor, A.col(q));
    if (std::abs(d[p]) < 0.05 * d.lpNorm<Eigen::Infinity>()) continue;  // as a ratio test would
    ASSERT_EQ(factor.replace(p, q, d), Update::Ok);
    ++made;
    ASSERT_EQ(factor.basis()[static_cast<std::size_t>(p)], q);
    expect_represents(factor, A, random, 1e-9);
    ASSERT_FALSE(HasFailure()) << "replacement " << made;
    if (factor.stale()) {
      const std::vector<Index> basis = factor.basis();
      ASSERT_EQ(factor.factor(basis), LuStatus::Ok);
      EXPECT_EQ(factor.factorizations(), ++fresh);
      EXPECT_EQ(factor.updates(), 0);
      EXPECT_FALSE(factor.stale());
      expect_represents(factor, A, random, 1e-12);
    }
  }
  EXPECT_GE(fresh, 2);
}

// The same column again and again: B e_p = 2 e_p, 3 e_p ... Catches a pivot used twice or not at all.
TEST_P(Basis, ReplacesOnePositionManyTimes) {
  const SpMat A = matrix({{1, 0, 2, 3, 4, 5}, {0, 1, 1, 1, 1, 1}});
  BasisFactor factor(A, options());
  ASSERT_EQ(factor.factor(first_columns(2)), LuStatus::Ok);
  for (Index q = 2; q < 6; ++q) {
    ASSERT_EQ(factor.replace(0, q, ftran(factor, A.col(q))), Update::Ok);
    EXPECT_LT((ftran(factor, vec({static_cast<double>(q), 1})) - vec({1, 0})).norm(), 1e-14) << q;
    EXPECT_LT((btran(factor, vec({static_cast<double>(q + 1), 1})) - vec({1, 1})).norm(), 1e-14) << q;
  }
}

// The new basis would be singular: the answer says so, and nothing has changed to the last bit.
TEST_P(Basis, RefusesASingularReplacement) {
  Random random(2);
  const Index n = 20;
  const SpMat A = wide(n, random);
  BasisFactor factor(A, options());
  ASSERT_EQ(factor.factor(first_columns(n)), LuStatus::Ok);
  ASSERT_EQ(factor.replace(3, n + 3, ftran(factor, A.col(n + 3))), Update::Ok);
  const std::vector<Index> basis = factor.basis();
  const Vec b = random.normals(n);
  const Vec x = ftran(factor, b);
  const Vec y = btran(factor, b);
  EXPECT_EQ(factor.replace(5, 7, ftran(factor, A.col(7))), Update::Singular) << "column 7 is at position 7 already";
  EXPECT_EQ(factor.replace(5, n, Vec::Zero(n)), Update::Singular);
  Vec tiny = Vec::Ones(n);
  tiny[5] = 1e-14;
  EXPECT_EQ(factor.replace(5, n, tiny), Update::Singular) << "the pivot is rounding";
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), infinity}) {
    EXPECT_EQ(factor.replace(5, n, Vec::Constant(n, bad)), Update::Singular);
    Vec one = Vec::Ones(n);
    one[9] = bad;
    EXPECT_EQ(factor.replace(5, n, one), Update::Singular) << "not at the pivot";
  }
  EXPECT_EQ(factor.basis(), basis);
  EXPECT_EQ(factor.updates(), 1);
  EXPECT_EQ(ftran(factor, b), x);
  EXPECT_EQ(btran(factor, b), y);
}

// A small pivot: made, as the caller may have no other, but with a warning. The new basis has determinant 1e-10.
TEST_P(Basis, WarnsOfASmallPivot) {
  const SpMat A = matrix({{1, 0, 1}, {0, 1, 1e-10}});
  BasisFactor factor(A, options());
  ASSERT_EQ(factor.factor(first_columns(2)), LuStatus::Ok);
  EXPECT_EQ(factor.replace(1, 2, ftran(factor, A.col(2))), Update::Unstable);
  EXPECT_EQ(factor.updates(), 1);
  EXPECT_EQ(factor.basis()[1], 2);
  EXPECT_LT((ftran(factor, vec({2, 1e-10})) - vec({1, 1})).norm(), 1e-6);
  const double just_enough = 1.0001e-8;
  BasisFactor other(A, options());
  ASSERT_EQ(other.factor(first_columns(2)), LuStatus::Ok);
  EXPECT_EQ(other.replace(1, 2, vec({1, just_enough})), Update::Ok);
}

TEST_P(Basis, IsStaleByLength) {
  const SpMat A = matrix({{1, 0, 1}, {0, 1, 2}});
  BasisOptions five = options();
  five.refactor_every = 5;
  BasisFactor factor(A, five);
  ASSERT_EQ(factor.factor(first_columns(2)), LuStatus::Ok);
  for (int k = 0; k < 5; ++k) {
    EXPECT_FALSE(factor.stale());
    EXPECT_EQ(factor.updates(), k);
    ASSERT_EQ(factor.replace(0, k % 2 ? 0 : 2, ftran(factor, A.col(k % 2 ? 0 : 2))), Update::Ok);
  }
  EXPECT_TRUE(factor.stale());
  EXPECT_EQ(factor.updates(), 5);
}

// Full columns into a basis of unit columns: each eta has n entries where B has 2 n (with n for the diagonal).
TEST_P(Basis, IsStaleByFill) {
  const Index n = 30;
  Dense A(n, 2 * n);
  A << Dense::Identity(n, n), Dense::Ones(n, n) + static_cast<double>(n) * Dense::Identity(n, n);
  const SpMat S = support::sparse(A);
  BasisOptions tight = options();
  tight.fill_limit = 2;
  BasisFactor factor(S, tight);
  ASSERT_EQ(factor.factor(first_columns(n)), LuStatus::Ok);
  for (Index p = 0; p < 4; ++p) {
    ASSERT_EQ(factor.replace(p, n + p, ftran(factor, S.col(n + p))), Update::Ok);
    EXPECT_FALSE(factor.stale()) << p;  // up to 4 n = 2 (n + n) entries
  }
  ASSERT_EQ(factor.replace(4, n + 4, ftran(factor, S.col(n + 4))), Update::Ok);
  EXPECT_TRUE(factor.stale());
}

// An ill-chosen pivot, and solves that cost more than a factorization: each makes the file stale on its own.
TEST_P(Basis, IsStaleByGrowthAndByWork) {
  const SpMat A = matrix({{1, 0, 1e-7, 1}, {0, 1, 1, 1}});
  BasisFactor grown(A, options());
  ASSERT_EQ(grown.factor(first_columns(2)), LuStatus::Ok);
  ASSERT_EQ(grown.replace(0, 2, ftran(grown, A.col(2))), Update::Ok);
  EXPECT_TRUE(grown.stale()) << "the pivot is 1e-7 of its column";
  BasisOptions lazy = options();
  lazy.work_limit = 10;
  BasisFactor worked(A, lazy);
  ASSERT_EQ(worked.factor(first_columns(2)), LuStatus::Ok);
  ASSERT_EQ(worked.replace(0, 3, ftran(worked, A.col(3))), Update::Ok);
  EXPECT_FALSE(worked.stale());
  for (int k = 0; k < 100; ++k) (void)btran(worked, vec({1, 1}));
  EXPECT_TRUE(worked.stale());
}

// A solve that is not B^-1 a_q (a caller's mistake, or lost digits) is found within eight replacements by its residual.
TEST_P(Basis, IsStaleByDrift) {
  Random random(5);
  const Index n = 20;
  const SpMat A = wide(n, random);
  BasisFactor factor(A, options());
  ASSERT_EQ(factor.factor(first_columns(n)), LuStatus::Ok);
  for (Index p = 0; p < 8; ++p) {
    EXPECT_FALSE(factor.stale());
    Vec d = ftran(factor, A.col(n + p));
    d *= 1 + 1e-6;
    ASSERT_NE(factor.replace(p, n + p, d), Update::Singular);
  }
  EXPECT_TRUE(factor.stale());
}

// The numbers m + i stand for unit columns that are no columns of A; columns of A with one entry need not be 1. Catches
// slacks at the wrong row or position, scaled wrongly, or two of one row.
TEST_P(Basis, UnitColumnsAreSetAside) {
  Random random(6);
  const Index n = 30;
  Dense dense(n, 2 * n);
  dense << Dense(support::random_sparse(n, 3, random)), Dense::Zero(n, n);
  for (Index i = 0; i < n; ++i) dense(i, n + i) = i % 2 ? -2.5 : 1e3;
  const SpMat A = support::sparse(dense);
  Dense with_units(n, 3 * n);
  with_units << dense, Dense::Identity(n, n);
  BasisFactor factor(A, options());
  for (int round = 0; round < 50; ++round) {
    std::vector<Index> basis(static_cast<std::size_t>(n));
    Index slacks = 0;
    for (Index p = 0; p < n; ++p) {
      const Index kind = random.integer(0, 2);
      basis[static_cast<std::size_t>(p)] = p + kind * n;
      slacks += kind > 0;
    }
    std::shuffle(basis.begin(), basis.end(), std::mt19937(static_cast<unsigned>(round)));
    if (std::abs(columns(support::sparse(with_units), basis).determinant()) < 1e-6) continue;
    ASSERT_EQ(factor.factor(basis), LuStatus::Ok);
    EXPECT_LE(factor.active(), n - slacks);
    expect_represents(factor, support::sparse(with_units), random, 1e-10);
    const Vec b = random.normals(n);
    EXPECT_LT(factor.residual(b, ftran(factor, b)).norm(), 1e-8 * b.norm());
    EXPECT_NEAR(
        std::log10(factor.rcond() * columns(support::sparse(with_units), basis).cwiseAbs().colwise().sum().maxCoeff() *
                   columns(support::sparse(with_units), basis).inverse().cwiseAbs().colwise().sum().maxCoeff()),
        0, 0.6);
  }
  EXPECT_EQ(factor.factor(std::vector<Index>(static_cast<std::size_t>(n), 2 * n)), LuStatus::Singular)
      << "e_1, n times";
}

// Sparse right-hand sides give what dense ones give, through replacements too, and the places of every nonzero. Catches
// a place that is not listed, a mark left behind by an earlier solve, an order that applies a column too early.
TEST_P(Basis, SparseSolvesAgreeWithDenseOnes) {
  Random random(7);
  const Index n = 400;
  Triplets entries;
  for (Index i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 4.0);
    if (i % 20 > 0) entries.emplace_back(i, i - 1, -1.0);
    if (i + 1 < n && i % 7 > 0) entries.emplace_back(i, i + 1, -1.5);
  }
  SpMat A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  BasisFactor factor(A, options());
  std::vector<Index> basis(static_cast<std::size_t>(n));
  for (Index p = 0; p < n; ++p) basis[static_cast<std::size_t>(p)] = p % 3 ? p : n + p;
  ASSERT_EQ(factor.factor(basis), LuStatus::Ok);
  SparseVector b(n);
  SparseVector x(n);
  int sparse = 0;
  for (int k = 0; k < 200; ++k) {
    for (const bool transposed : {false, true}) {
      b.clear();
      for (int i = 0; i < 2; ++i) b.add(random.integer(0, n - 1), random.normal());
      const Vec expected = transposed ? btran(factor, b.values()) : ftran(factor, b.values());
      if (transposed)
        factor.btran(b, x);
      else
        factor.ftran(b, x);
      ASSERT_LT((x.values() - expected).norm(), 1e-13 * expected.norm());
      sparse += !x.full();
      if (x.full()) continue;
      Vec listed = Vec::Zero(n);
      for (const int i : x.places()) listed[i] += x[i];
      ASSERT_EQ(listed, x.values()) << "each place once";
    }
    const Index p = random.integer(0, n - 1);
    const Index q = factor.basis()[static_cast<std::size_t>(p)] < n ? n + p : p;
    factor.ftran_column(q, x);
    if (k % 2) {
      ASSERT_EQ(factor.replace(p, q, x), Update::Ok);
    }
  }
  EXPECT_TRUE(GetParam() != LuBackend::General || sparse > 300) << sparse << " of 400";
}

// Dependent columns are replaced by unit columns of rows nothing else can pivot on; the others stay. The null space of
// the matrix tells how many there are.
TEST_P(Basis, DependentColumnsAreReplaced) {
  Random random(8);
  for (int round = 0; round < 100; ++round) {
    const int n = random.integer(2, 30);
    const int rank = random.integer(0, n);
    Dense dense = Dense(support::random_sparse(n, 2, random));
    for (Index j = rank; j < n; ++j) {  // combinations of two others, copies, zero columns
      const Index a = rank > 0 ? random.integer(0, rank - 1) : 0;
      const Index c = rank > 0 ? random.integer(0, rank - 1) : 0;
      dense.col(j) = rank == 0 || j % 3 == 0 ? Vec(Vec::Zero(n))
                                             : Vec(dense.col(a) - 0.3 * static_cast<double>(j % 2) * dense.col(c));
    }
    const SpMat A = support::sparse(dense);
    Eigen::FullPivLU<Dense> exact(dense);
    exact.setThreshold(1e-10);
    BasisFactor factor(A, options());
    std::vector<BasisFactor::Dependency> replaced;
    ASSERT_EQ(factor.factor_repaired(first_columns(n), replaced), LuStatus::Ok) << "round " << round;
    EXPECT_EQ(static_cast<Index>(replaced.size()), n - exact.rank()) << "round " << round;
    for (const BasisFactor::Dependency& d : replaced) {
      EXPECT_EQ(d.column, d.position);
      EXPECT_EQ(factor.basis()[static_cast<std::size_t>(d.position)], n + d.row);
    }
    EXPECT_GT(factor.rcond(), 1e-12);
  }
}

// In a block of more rows than Perp looks at itself the library's factors say which columns depend on others: here
// three sums of two others.
TEST_P(Basis, DependentColumnsOfALargeBlockAreReplaced) {
  constexpr Index n = 340;
  Dense dense = Dense::Zero(n, n);
  dense.diagonal().setConstant(2.5);
  dense.diagonal(1).setConstant(-1);
  dense.diagonal(-1).setConstant(-1);
  for (const Index j : {50, 150, 250}) dense.col(j) = dense.col(j - 10) + dense.col(j + 10);
  const SpMat A = support::sparse(dense);
  BasisFactor factor(A, options());
  std::vector<BasisFactor::Dependency> replaced;
  ASSERT_EQ(factor.factor_repaired(first_columns(n), replaced), LuStatus::Ok);
  EXPECT_EQ(replaced.size(), 3U);
  EXPECT_GT(factor.rcond(), 1e-12);
}

// A basis that was just found singular is not factored a second time before it is repaired.
TEST_P(Basis, RepairsWhatWasFoundSingular) {
  const SpMat A = matrix({{1, 0, 0}, {0, 0, 1}, {0, 0, 3}});
  BasisFactor factor(A, options());
  std::vector<BasisFactor::Dependency> replaced;
  ASSERT_EQ(factor.factor(first_columns(3)), LuStatus::Singular);
  ASSERT_EQ(factor.factor_repaired(first_columns(3), replaced), LuStatus::Ok);
  EXPECT_EQ(replaced.size(), 1U);
  EXPECT_EQ(factor.factorizations(), 2);
}

// A singular basis leaves no factors, not those of the basis before; and the next basis is factored anew.
TEST_P(Basis, SaysWhenTheBasisIsSingular) {
  const SpMat A = matrix({{1, 0, 2}, {0, 1, 0}});
  BasisFactor factor(A, options());
  Vec x(2);
  EXPECT_THROW(factor.ftran(vec({1, 1}), x), std::logic_error) << "before the first factorization";
  ASSERT_EQ(factor.factor(first_columns(2)), LuStatus::Ok);
  EXPECT_EQ(factor.factor(std::vector<Index>{0, 2}), LuStatus::Singular);
  EXPECT_EQ(factor.factor(std::vector<Index>{1, 1}), LuStatus::Singular) << "one column twice";
  EXPECT_THROW(factor.ftran(vec({1, 1}), x), std::logic_error);
  EXPECT_THROW(factor.btran(vec({1, 1}), x), std::logic_error);
  EXPECT_EQ(factor.rcond(), 0);
  ASSERT_EQ(factor.factor(std::vector<Index>{2, 1}), LuStatus::Ok);
  EXPECT_LT((ftran(factor, vec({2, 3})) - vec({1, 3})).norm(), 1e-15);
  EXPECT_EQ(factor.factorizations(), 4);
  EXPECT_EQ(factor.rcond(), 0.5);
}

// By the pivots alone, without a solve. Catches a small pivot among the columns with one entry, or in the block, that
// is overlooked, and doubt where there is none.
TEST_P(Basis, SaysWhereItIsSurelyRegular) {
  const auto surely = [this](const SpMat& A) {
    BasisFactor factor(A, options());
    EXPECT_EQ(factor.factor(first_columns(A.rows())), LuStatus::Ok);
    return factor.surely_regular();
  };
  EXPECT_FALSE(surely(matrix({{1, 0, 0}, {0, 1, 2}, {0, 2, 4.0000000001}})));
  EXPECT_FALSE(surely(matrix({{1e-12, 1, 1}, {0, 2, 1}, {0, 1, 2}})));
  EXPECT_FALSE(surely(matrix({{1, 0, 0}, {0, 2e-12, 1e-12}, {0, 1e-12, 2e-12}})));
  // Eigen's LU does not tell its pivots, nor what may stand for UMFPACK.
  const bool told = GetParam() != LuBackend::Eigen && (GetParam() != LuBackend::General || gpl_linked());
  EXPECT_TRUE(surely(matrix({{1, 0, 0}, {0, 2, 1}, {0, 1, 2}})) || !told);
}

// Everything of another size or out of range would read beyond an array.
TEST_P(Basis, RefusesWrongSizes) {
  const SpMat A = matrix({{1, 0, 2}, {0, 1, 1}});
  EXPECT_THROW(BasisFactor(SpMat(3, 2), options()), std::invalid_argument);
  BasisFactor factor(A, options());
  EXPECT_THROW((void)factor.factor(std::vector<Index>{0}), std::invalid_argument);
  EXPECT_THROW((void)factor.factor(std::vector<Index>{0, 1, 2}), std::invalid_argument);
  EXPECT_THROW((void)factor.factor(std::vector<Index>{0, 5}), std::invalid_argument);
  EXPECT_THROW((void)factor.factor(std::vector<Index>{-1, 0}), std::invalid_argument);
  ASSERT_EQ(factor.factor(first_columns(2)), LuStatus::Ok);
  ASSERT_EQ(factor.replace(1, 2, ftran(factor, A.col(2))), Update::Ok);
  Vec one(1);
  Vec two(2);
  EXPECT_THROW(factor.ftran(vec({1}), two), std::invalid_argument);
  EXPECT_THROW(factor.ftran(vec({1, 1}), one), std::invalid_argument);
  EXPECT_THROW(factor.btran(vec({1}), two), std::invalid_argument);
  EXPECT_THROW(factor.btran(vec({1, 1}), one), std::invalid_argument);
  EXPECT_THROW((void)factor.replace(2, 0, vec({1, 1})), std::invalid_argument);
  EXPECT_THROW((void)factor.replace(-1, 0, vec({1, 1})), std::invalid_argument);
  EXPECT_THROW((void)factor.replace(0, 5, vec({1, 1})), std::invalid_argument);
  EXPECT_THROW((void)factor.replace(0, -1, vec({1, 1})), std::invalid_argument);
  EXPECT_THROW((void)factor.replace(0, 0, vec({1})), std::invalid_argument);
  EXPECT_EQ(factor.updates(), 1) << "nothing refused was made";
}

TEST_P(Basis, EmptyBasis) {
  const SpMat A(0, 3);
  BasisFactor factor(A, options());
  ASSERT_EQ(factor.factor(std::vector<Index>{}), LuStatus::Ok);
  EXPECT_EQ(ftran(factor, Vec(0)).size(), 0);
  EXPECT_EQ(btran(factor, Vec(0)).size(), 0);
  EXPECT_FALSE(factor.stale());
}

// The matrix may have gaps between its columns.
TEST_P(Basis, TakesAMatrixThatIsNotCompressed) {
  SpMat A(2, 3);
  A.reserve(Eigen::VectorXi::Constant(3, 4));
  A.insert(0, 0) = 1;
  A.insert(1, 1) = 2;
  A.insert(0, 2) = 4;
  A.insert(1, 2) = 4;
  ASSERT_FALSE(A.isCompressed());
  BasisFactor factor(A, options());
  ASSERT_EQ(factor.factor(std::vector<Index>{2, 1}), LuStatus::Ok);
  EXPECT_LT((ftran(factor, vec({4, 6})) - vec({1, 1})).norm(), 1e-15);
}

TEST_P(Basis, MovesWithItsFactors) {
  const SpMat A = matrix({{1, 0, 2}, {0, 1, 1}});
  BasisFactor factor(A, options());
  ASSERT_EQ(factor.factor(first_columns(2)), LuStatus::Ok);
  ASSERT_EQ(factor.replace(0, 2, ftran(factor, A.col(2))), Update::Ok);
  const BasisFactor moved = std::move(factor);
  EXPECT_LT((ftran(moved, vec({2, 2})) - vec({1, 1})).norm(), 1e-15);
  EXPECT_EQ(moved.updates(), 1);
}

// Bases that take turns with one factorization: each still solves with its own matrix, and a pattern is analysed once.
// Catches a basis that solves with the factors of another one.
TEST_P(Basis, TakesTurnsWithOthers) {
  Random random(9);
  const SpMat A = wide(60, random);
  const SpMat B = 2 * A;
  BasisOptions shared = options();
  SharedLu one{SparseLu(shared.lu)};
  shared.shared = &one;
  BasisFactor first(A, shared);
  BasisFactor second(B, shared);
  ASSERT_EQ(first.factor(first_columns(60)), LuStatus::Ok);
  ASSERT_EQ(second.factor(first_columns(60)), LuStatus::Ok);
  EXPECT_EQ(one.lu.analyses(), 1);
  for (int k = 0; k < 3; ++k) {
    expect_represents(first, A, random, 1e-9);
    expect_represents(second, B, random, 1e-9);
  }
}

}  // namespace
}  // namespace perp::lcp

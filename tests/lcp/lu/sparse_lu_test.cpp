// SPDX-License-Identifier: Apache-2.0
#include "lcp/lu/sparse_lu.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "lcp/gpl.hpp"
#include "lcp/lu/lu_factors.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::nan;
using support::Random;
using support::sparse;
using support::vec;

class Lu : public testing::TestWithParam<LuBackend> {
 protected:
  SparseLu lu{GetParam()};
  Vec solve(const Vec& b) const {
    Vec x = Vec::Constant(b.size(), nan);
    lu.solve(b, x);
    return x;
  }
  Vec solve_transposed(const Vec& b) const {
    Vec x = Vec::Constant(b.size(), nan);
    lu.solve_transposed(b, x);
    return x;
  }
};

INSTANTIATE_TEST_SUITE_P(Backends, Lu,
                         testing::Values(LuBackend::General, LuBackend::Klu, LuBackend::Eigen, LuBackend::Dense,
                                         LuBackend::Auto),
                         [](const auto& backend) { return std::string(to_string(backend.param)); });

/// 1 / (||A||_1 ||A^-1||_1) by the dense inverse.
double dense_rcond(const Dense& A) {
  const auto norm1 = [](const Dense& B) { return B.cwiseAbs().colwise().sum().maxCoeff(); };
  return 1 / (norm1(A) * norm1(A.fullPivLu().inverse()));
}

/// ||A x - b|| relative to ||A|| ||x|| + ||b||, maximum norms (Higham 2002, section 7.1).
double backward_error(const Dense& A, const Vec& x, const Vec& b) {
  const double size = A.cwiseAbs().rowwise().sum().maxCoeff() * x.cwiseAbs().maxCoeff() + b.cwiseAbs().maxCoeff();
  return (A * x - b).cwiseAbs().maxCoeff() / size;
}

// Against Eigen's dense LU. Catches a wrong permutation or scaling, and A' taken for A.
TEST_P(Lu, SolvesRandomSystemsLikeADenseLu) {
  Random random(1);
  for (const Index n : {1, 2, 3, 5, 17, 60, 200})
    for (int k = 0; k < 10; ++k) {
      const SpMat A = support::random_sparse(n, k % 4, random);
      const Dense D = A;
      const Vec b = random.normals(n);
      ASSERT_EQ(lu.factor(A), LuStatus::Ok) << n;
      EXPECT_EQ(lu.size(), n);
      const Vec x = solve(b);
      const Vec y = solve_transposed(b);
      ASSERT_LT(backward_error(D, x, b), 1e-13) << n;
      ASSERT_LT(backward_error(D.transpose(), y, b), 1e-13) << n;
      const double error = 1e-14 / dense_rcond(D);
      ASSERT_LT((x - D.partialPivLu().solve(b)).norm(), error * x.norm() + 1e-300) << n;
      ASSERT_LT((y - D.transpose().partialPivLu().solve(b)).norm(), error * y.norm() * 10 + 1e-300) << n;
    }
}

// The factorization must survive its matrix, and the caller's x may hold anything before.
TEST_P(Lu, KeepsACopyOfTheMatrix) {
  auto A = std::make_unique<SpMat>(matrix({{2, 1}, {1, 3}}));
  ASSERT_EQ(lu.factor(*A), LuStatus::Ok);
  A->setZero();
  A.reset();
  EXPECT_LT((solve(vec({3, 4})) - vec({1, 1})).norm(), 1e-15);
  Vec x = vec({nan, infinity});
  lu.solve_refined(vec({3, 4}), x);
  EXPECT_LT((x - vec({1, 1})).norm(), 1e-15);
}

// A graded system: refinement must not make the residual larger, and with no steps it is the plain solution.
TEST_P(Lu, RefinementDoesNotEnlargeTheResidual) {
  Random random(2);
  for (int k = 0; k < 50; ++k) {
    Dense D = random.normals(30, 30);
    for (Index j = 0; j < 30; ++j) D.col(j) *= std::pow(10, random.uniform(-6, 6));
    const Vec b = random.normals(30);
    ASSERT_EQ(lu.factor(sparse(D)), LuStatus::Ok);
    const Vec x = solve(b);
    Vec refined(30);
    lu.solve_refined(b, refined);
    const SpMat A = sparse(D);
    ASSERT_LE((b - A * refined).lpNorm<Eigen::Infinity>(), (b - A * x).lpNorm<Eigen::Infinity>());
    lu.solve_refined(b, refined, 0);
    ASSERT_EQ(refined, x);
  }
}

// The analysis is the dear part of repeated factorizations. Catches that it is made anew, and - worse - that it is kept
// for another pattern of the same size and number of entries.
TEST_P(Lu, AnalysesOncePerPattern) {
  const SpMat A = matrix({{2, 1, 0}, {0, 3, 0}, {4, 0, 5}});
  const SpMat other = matrix({{2, 0, 1}, {0, 3, 0}, {4, 0, 5}});
  EXPECT_EQ(lu.analyses(), 0);
  ASSERT_EQ(lu.factor(A), LuStatus::Ok);
  ASSERT_EQ(lu.factor(A * 2), LuStatus::Ok);
  EXPECT_EQ(lu.analyses(), 1);
  EXPECT_LT((solve(vec({6, 6, 18})) - vec({1, 1, 1})).norm(), 1e-14) << "with the values of the last matrix";
  EXPECT_EQ(lu.factor(SpMat(A * nan)), LuStatus::NotFinite);
  ASSERT_EQ(lu.factor(A), LuStatus::Ok);
  EXPECT_EQ(lu.analyses(), 1) << "a refused matrix leaves the analysis alone";
  EXPECT_EQ(lu.factor(SpMat(A * 0.0)), LuStatus::Singular) << "explicit zeros have the pattern too";
  ASSERT_EQ(lu.factor(A), LuStatus::Ok);
  EXPECT_EQ(lu.analyses(), 1) << "as does one that is numerically singular";
  ASSERT_EQ(lu.factor(other), LuStatus::Ok);
  EXPECT_EQ(lu.analyses(), 2);
  EXPECT_LT((solve(vec({3, 3, 9})) - vec({1, 1, 1})).norm(), 1e-14);
  ASSERT_EQ(lu.factor(SpMat(0, 0)), LuStatus::Ok);
  ASSERT_EQ(lu.factor(other), LuStatus::Ok);
  EXPECT_LT((solve(vec({3, 3, 9})) - vec({1, 1, 1})).norm(), 1e-14) << "after the empty matrix";
}

// Matrices without an inverse, structurally or by their values. Catches "Ok" with a zero pivot, and a library that
// crashes on an empty column.
TEST_P(Lu, TellsSingularMatrices) {
  std::vector<std::pair<const char*, SpMat>> singular{
      {"1 x 1 without entries", SpMat(1, 1)},
      {"no entries", SpMat(4, 4)},
      {"empty row", matrix({{1, 2, 3}, {0, 0, 0}, {4, 5, 7}})},
      {"empty column", matrix({{1, 0, 3}, {2, 0, 5}, {4, 0, 7}})},
      {"empty last column", matrix({{1, 2, 0}, {3, 4, 0}, {5, 6, 0}})},
      {"no transversal", matrix({{1, 1, 1}, {1, 0, 0}, {1, 0, 0}})},
      {"equal columns", matrix({{1, 1, 0}, {2, 2, 1}, {4, 4, 3}})},
      {"equal rows", matrix({{1, 2, 4}, {1, 2, 4}, {0, 1, 3}})},
      {"rank one", matrix({{1, 2}, {2, 4}})},
      {"explicit zero", SpMat(matrix({{1}}) * 0.0)},
  };
  Random random(3);
  SpMat hole = support::random_sparse(50, 3, random);
  hole.prune([](Index i, Index, double) { return i != 17; });
  singular.emplace_back("a row of 50 empty", hole);
  for (const auto& [name, A] : singular) {
    EXPECT_EQ(lu.factor(A), LuStatus::Singular) << name;
    EXPECT_EQ(lu.rcond(), 0) << name;
    EXPECT_THROW((void)solve(Vec::Ones(A.rows())), std::logic_error) << name;
    EXPECT_THROW((void)solve_transposed(Vec::Ones(A.rows())), std::logic_error) << name;
    ASSERT_EQ(lu.factor(matrix({{0, 4}, {2, 0}})), LuStatus::Ok) << "after " << name;
    EXPECT_EQ(solve(vec({4, 2})), vec({1, 1})) << "after " << name;
  }
}

// Dependent to the last bit but not exactly: whatever is answered, rcond() must say it.
TEST_P(Lu, RcondTellsNearSingularity) {
  Random random(4);
  for (int k = 0; k < 20; ++k) {
    Dense D = random.normals(20, 20);
    D.col(7) = D.col(3) + 2 * D.col(11);
    if (lu.factor(sparse(D)) == LuStatus::Ok) {
      EXPECT_LT(lu.rcond(), 1e-14);
    } else {
      EXPECT_EQ(lu.rcond(), 0);
    }
  }
}

// A NaN pivot compares false with everything; UMFPACK reports 'ok' for some.
TEST_P(Lu, RefusesValuesThatAreNotFinite) {
  for (const double bad : {nan, infinity, -infinity})
    for (const auto& [i, j] : {std::pair{0, 0}, {1, 2}, {2, 0}, {2, 2}}) {
      SpMat A = matrix({{2, 1, 1}, {1, 3, 1}, {1, 1, 4}});
      A.coeffRef(i, j) = bad;
      EXPECT_EQ(lu.factor(A), LuStatus::NotFinite) << i << ' ' << j << ' ' << bad;
      EXPECT_EQ(lu.rcond(), 0);
      EXPECT_THROW((void)solve(Vec::Ones(3)), std::logic_error);
      A.coeffRef(i, j) = 10;
      ASSERT_EQ(lu.factor(A), LuStatus::Ok);
      EXPECT_LT((solve(A * vec({1, 2, 3})) - vec({1, 2, 3})).norm(), 1e-12);
    }
}

TEST_P(Lu, RefusesAMatrixThatIsNotSquare) {
  ASSERT_EQ(lu.factor(matrix({{2}})), LuStatus::Ok);
  EXPECT_THROW((void)lu.factor(SpMat(2, 3)), std::invalid_argument);
  EXPECT_THROW((void)lu.factor(SpMat(3, 2)), std::invalid_argument);
  EXPECT_THROW((void)lu.factor(SpMat(0, 1)), std::invalid_argument);
  EXPECT_EQ(solve(vec({4})), vec({2})) << "the old factors are still there";
}

// The libraries read and write n numbers whatever they are given.
TEST_P(Lu, RefusesVectorsOfAnotherSize) {
  ASSERT_EQ(lu.factor(matrix({{2, 1}, {1, 3}})), LuStatus::Ok);
  Vec two = vec({1, 1});
  Vec one = vec({1});
  Vec three = vec({1, 1, 1});
  EXPECT_THROW(lu.solve(one, two), std::invalid_argument);
  EXPECT_THROW(lu.solve(two, one), std::invalid_argument);
  EXPECT_THROW(lu.solve(three, three), std::invalid_argument);
  EXPECT_THROW(lu.solve_transposed(three, two), std::invalid_argument);
  EXPECT_THROW(lu.solve_transposed(two, three), std::invalid_argument);
  EXPECT_THROW(lu.solve_refined(one, one), std::invalid_argument);
}

TEST_P(Lu, SolveNeedsFactors) {
  Vec x(0);
  EXPECT_THROW(lu.solve(Vec(0), x), std::logic_error);
  EXPECT_THROW(lu.solve_transposed(Vec(0), x), std::logic_error);
  EXPECT_THROW(lu.solve_refined(Vec(0), x), std::logic_error);
  EXPECT_EQ(lu.rcond(), 0);
  EXPECT_EQ(lu.size(), 0);
}

TEST_P(Lu, EmptyAndScalarMatrices) {
  ASSERT_EQ(lu.factor(SpMat(0, 0)), LuStatus::Ok);
  EXPECT_EQ(solve(Vec(0)).size(), 0);
  EXPECT_EQ(solve_transposed(Vec(0)).size(), 0);
  Vec empty(0);
  lu.solve_refined(Vec(0), empty);
  EXPECT_EQ(lu.rcond(), 1);
  ASSERT_EQ(lu.factor(matrix({{-4}})), LuStatus::Ok);
  EXPECT_EQ(solve(vec({2})), vec({-0.5}));
  EXPECT_EQ(solve_transposed(vec({2})), vec({-0.5}));
  EXPECT_EQ(lu.rcond(), 1);
}

// A matrix built by insert() has gaps between its columns.
TEST_P(Lu, TakesAMatrixThatIsNotCompressed) {
  SpMat A(3, 3);
  A.reserve(Eigen::VectorXi::Constant(3, 5));
  A.insert(0, 0) = 2;
  A.insert(2, 0) = 1;
  A.insert(1, 1) = 4;
  A.insert(2, 2) = 8;
  ASSERT_FALSE(A.isCompressed());
  ASSERT_EQ(lu.factor(A), LuStatus::Ok);
  EXPECT_FALSE(A.isCompressed());
  EXPECT_EQ(solve(vec({2, 4, 9})), vec({1, 1, 1}));
  A.makeCompressed();
  ASSERT_EQ(lu.factor(A), LuStatus::Ok);
  EXPECT_EQ(lu.analyses(), 1) << "the same pattern";
}

// ||A^-1||_1 is bounded below and rarely off by more than three (Higham 1988). Hilbert: the condition is
// 748, 28375, 9.437e5, 2.907e7, 9.852e8, 3.387e10 for n = 3 .. 8 (Higham 2002, table 28.1).
TEST_P(Lu, RcondIsWithinTenOfTheDenseOne) {
  const auto check = [&](const Dense& D, const char* name) {
    const double right = dense_rcond(D);
    ASSERT_EQ(lu.factor(sparse(D)), LuStatus::Ok) << name;
    EXPECT_GE(lu.rcond(), 0.9 * right) << name << " of order " << D.rows();
    EXPECT_LE(lu.rcond(), 10 * right) << name << " of order " << D.rows();
    EXPECT_LE(lu.rcond(), 1) << name;
  };
  const double published[] = {748, 28375, 9.437e5, 2.907e7, 9.852e8, 3.387e10};
  for (Index n = 3; n <= 8; ++n) {
    check(support::hilbert(n), "Hilbert");
    EXPECT_NEAR(lu.rcond() * published[n - 3], 1, 0.01) << n;
  }
  Random random(5);
  for (int k = 0; k < 100; ++k) {
    const Index n = random.integer(1, 40);
    check(random.normals(n, n), "random");
    check(Dense(support::random_sparse(n, 2, random)), "random sparse");
    Dense graded = random.normals(n, n);
    for (Index i = 0; i < n; ++i) graded.row(i) *= std::pow(10, random.uniform(-4, 4));
    check(graded, "graded");
    if (n == 1) continue;
    Dense near = random.normals(n, n);
    near.col(0) = near.col(n - 1) + 1e-10 * random.normals(n);
    check(near, "nearly singular");
  }
  check(Dense::Identity(9, 9), "identity");
}

// Numbers at the ends of the range: no NaN, nothing outside [0, 1].
TEST_P(Lu, RcondIsANumberInTheUnitInterval) {
  for (const double a : {5e-324, 1e-310, 1e-200, 1.0, 1e200, 1e308})
    for (const double b : {5e-324, 1e-200, 1e200, 1e308})
      for (const SpMat& A : {matrix({{a, 0}, {0, b}}), matrix({{a, b}, {-b, a}}), matrix({{a, b}, {b, 1}})}) {
        (void)lu.factor(A);
        const double rcond = lu.rcond();
        EXPECT_TRUE(rcond >= 0 && rcond <= 1) << a << ' ' << b << ' ' << rcond;
      }
}

TEST_P(Lu, MovesWithItsFactors) {
  ASSERT_EQ(lu.factor(matrix({{2, 1}, {1, 3}})), LuStatus::Ok);
  SparseLu moved = std::move(lu);
  Vec x(2);
  moved.solve(vec({3, 4}), x);
  EXPECT_LT((x - vec({1, 1})).norm(), 1e-15);
  EXPECT_EQ(moved.analyses(), 1);
  lu = SparseLu(GetParam());  // an object moved from takes a new value, and works
  ASSERT_EQ(lu.factor(matrix({{4}})), LuStatus::Ok);
  EXPECT_EQ(solve(vec({8})), vec({2}));
  lu = std::move(moved);  // over an object that holds factors
  EXPECT_LT((solve(vec({3, 4})) - vec({1, 1})).norm(), 1e-15);
}

// The solves are const, so two threads may share a factorization. Catches workspace inside the factors (KLU has one).
TEST_P(Lu, SolvesInManyThreadsWithOneFactorization) {
  Random random(6);
  const Index n = 300;
  const SpMat A = support::random_sparse(n, 3, random);
  ASSERT_EQ(lu.factor(A), LuStatus::Ok);
  constexpr int threads = 4;
  std::vector<Vec> b;
  std::vector<Vec> x;
  std::vector<Vec> y;
  for (int k = 0; k < threads; ++k) {
    b.push_back(random.normals(n));
    x.push_back(solve(b.back()));
    y.push_back(solve_transposed(b.back()));
  }
  std::atomic<int> wrong = 0;
  {
    std::vector<std::jthread> pool;
    for (std::size_t k = 0; k < threads; ++k)
      pool.emplace_back([&, k] {
        for (int repeat = 0; repeat < 1000; ++repeat) {
          wrong += solve(b[k]) != x[k];
          wrong += solve_transposed(b[k]) != y[k];
        }
      });
  }
  EXPECT_EQ(wrong, 0);
}

// Two objects share nothing: factorizations in two threads.
TEST_P(Lu, FactorsInTwoThreads) {
  std::atomic<int> wrong = 0;
  const auto work = [&](unsigned seed) {
    Random random(seed);
    SparseLu own(GetParam());
    for (int k = 0; k < 100; ++k) {
      const SpMat A = support::random_sparse(100, 2, random);
      const Vec b = random.normals(100);
      Vec x(100);
      if (own.factor(A) != LuStatus::Ok) {
        ++wrong;
        continue;
      }
      own.solve(b, x);
      wrong += backward_error(A, x, b) > 1e-13;
    }
  };
  {
    std::jthread one(work, 7);
    std::jthread two(work, 8);
  }
  EXPECT_EQ(wrong, 0);
}

/// L U of the factors, and (R A)(P, Q).
std::pair<Dense, Dense> products(const LuFactors& f, const SpMat& A) {
  const Index n = A.rows();
  Dense L = Dense::Identity(n, n);
  Dense U = f.diagonal.asDiagonal();
  for (Index j = 0; j < n; ++j) {
    for (int k = f.L.start[at(j)]; k < f.L.start[at(j) + 1]; ++k) L(f.L.row[at(k)], j) = f.L.value[at(k)];
    for (int k = f.U.start[at(j)]; k < f.U.start[at(j) + 1]; ++k) U(f.U.row[at(k)], j) = f.U.value[at(k)];
  }
  const Dense scaled = f.R.asDiagonal() * Dense(A);
  Dense permuted(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) permuted(i, j) = scaled(f.P[at(i)], f.Q[at(j)]);
  return {L * U, permuted};
}

// The general library shows its factors, whichever it uses within: small matrices with many diagonal blocks, ones with
// dense factors. Catches entries above the blocks that are lost, and scales by pivots taken for scales by rows.
TEST(LuFactors, MultiplyToTheMatrix) {
  Random random(9);
  SpMat blocks = support::random_sparse(80, 2, random);
  blocks.prune([](Index i, Index j, double) { return i / 10 <= j / 10; });
  const std::pair<LuBackend, SpMat> all[] = {{LuBackend::General, blocks},
                                             {LuBackend::General, support::random_sparse(300, 2, random)},
                                             {LuBackend::General, support::random_sparse(300, 12, random)},
                                             {LuBackend::General, support::stencil(6)}};
  for (const auto& [backend, A] : all) {
    SparseLu lu(backend);
    ASSERT_EQ(lu.factor(A), LuStatus::Ok);
    LuFactors factors;
    ASSERT_TRUE(lu.factors(factors));
    const auto [LU, B] = products(factors, A);
    EXPECT_LE((LU - B).cwiseAbs().maxCoeff(), 1e-12 * (1 + LU.cwiseAbs().maxCoeff()));
    LuSolver solver(std::move(factors));
    const Vec b = random.normals(A.rows());
    SparseVector given(A.rows());
    SparseVector x(A.rows());
    given.assign(b);
    solver.solve(given, x);
    EXPECT_LE(backward_error(A, x.values(), b), 1e-12);
    solver.solve_transposed(given, x);
    EXPECT_LE(backward_error(Dense(A).transpose(), x.values(), b), 1e-12);
  }
}

// What BasisFactor repairs singular bases by. Catches zero pivots that spoil the factors, or are not shown.
TEST(LuFactors, OfSingularMatricesHaveTheirZeros) {
  Random random(10);
  for (const int density : {2, 12}) {
    Dense D = support::random_sparse(200, density, random);
    D.col(17) = D.col(3) + 2 * D.col(150);
    D.col(60) = -D.col(3);
    const SpMat A = sparse(D);
    SparseLu lu(LuBackend::General);
    if (lu.factor(A) == LuStatus::Ok) continue;  // rounding may hide the dependence
    LuFactors factors;
    ASSERT_TRUE(lu.factors(factors));
    EXPECT_GE((factors.diagonal.array().abs() < 1e-11).count(), 2);
    const auto [LU, B] = products(factors, A);
    EXPECT_LE((LU - B).cwiseAbs().maxCoeff(), 1e-11 * (1 + LU.cwiseAbs().maxCoeff()));
  }
}

TEST(LuNames, AreWords) {
  EXPECT_EQ(to_string(LuBackend::General), gpl_linked() ? "umfpack" : "mixed");
  EXPECT_EQ(to_string(LuBackend::Klu), "klu");
  EXPECT_EQ(to_string(LuBackend::Eigen), "eigen");
  EXPECT_EQ(to_string(LuBackend::Dense), "dense");
  EXPECT_EQ(to_string(LuBackend::Auto), "auto");
  EXPECT_EQ(to_string(LuStatus::Ok), "ok");
  EXPECT_EQ(to_string(LuStatus::Singular), "singular");
  EXPECT_EQ(to_string(LuStatus::NotFinite), "not finite");
}

}  // namespace
}  // namespace perp::lcp

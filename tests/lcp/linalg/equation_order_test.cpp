// SPDX-License-Identifier: Apache-2.0
// Systems whose rows stand in an order known by construction, shuffled: [H -A'; A 0] with some x and all y free is
// symmetric but for signs. Would catch an order that is not one, a shuffled system that is not put right, and a bounded
// variable that loses its row.
#include "lcp/linalg/equation_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "lcp/classes/classify.hpp"
#include "lcp/solve/solve.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;

/// The optimality conditions of  min x'Hx / 2 + c'x,  A x = b,  x_j >= 0 for j < bounded.
AffineMcp optimality(const Dense& H, const Dense& A, const Vec& c, const Vec& b, Index bounded) {
  const Index n = H.rows(), m = A.rows();
  Dense M = Dense::Zero(n + m, n + m);
  M << H, -A.transpose(), A, Dense::Zero(m, m);
  AffineMcp problem{.M = support::sparse(M), .q = Vec(n + m), .box = Box::free(n + m)};
  problem.q << c, -b;
  problem.box.lower.head(bounded).setZero();
  return problem;
}

/// The same with equations in another order, every other one times -1.
AffineMcp shuffled(const AffineMcp& problem, Random& random, bool change_signs) {
  std::vector<Index> rows(at(problem.size())), free;
  std::iota(rows.begin(), rows.end(), Index{0});
  for (Index i = 0; i < problem.size(); ++i)
    if (problem.box.is_free(i)) free.push_back(i);
  std::vector<Index> order = free;
  for (std::size_t k = order.size(); k > 1; --k)
    std::swap(order[k - 1], order[at(random.integer(0, static_cast<int>(k) - 1))]);
  EquationOrder shuffle{.row_of = rows, .sign = Vec::Ones(problem.size())};
  for (std::size_t k = 0; k < free.size(); ++k) {
    shuffle.row_of[at(free[k])] = order[k];
    if (change_signs && k % 2 == 1) shuffle.sign[free[k]] = -1;
  }
  return shuffle.apply(problem);
}

Dense random_matrix(Index m, Index n, double density, Random& random) {
  return Dense::NullaryExpr(m, n, [&] { return random.chance(density) ? random.uniform(-2, 2) : 0.0; });
}

TEST(EquationOrder, ShuffledOptimalityConditionsArePutRight) {
  Random random(1);
  for (int k = 0; k < 60; ++k) {
    const Index n = random.integer(2, 13), m = random.integer(1, static_cast<int>(n));
    const Index bounded = random.integer(1, static_cast<int>(n));
    const Dense G = random_matrix(n, n, 0.4, random);
    const Dense H = k % 3 == 0 ? Dense::Zero(n, n) : Dense(G * G.transpose());
    const Dense A = random_matrix(m, n, 0.5, random);
    const AffineMcp natural = optimality(H, A, Vec::Ones(n), Vec::Ones(m), bounded);
    EXPECT_FALSE(equation_order(natural.M, natural.box)) << k;
    const AffineMcp given = shuffled(natural, random, k % 2 == 1);
    const auto order = equation_order(given.M, given.box);
    const AffineMcp found = order ? order->apply(given) : given;
    EXPECT_TRUE(classify(found.M).positive_semidefinite.yes()) << k;
    for (Index i = 0; order && i < bounded; ++i) {
      EXPECT_EQ(order->row_of[at(i)], i);
      EXPECT_EQ(order->sign[i], 1);
    }
  }
}

// Twins: any of their orders is as good.
TEST(EquationOrder, AlikeEquations) {
  const AffineMcp natural = optimality(Dense::Zero(3, 3), Dense::Ones(3, 3), Vec::Ones(3), Vec::Ones(3), 3);
  EXPECT_FALSE(equation_order(natural.M, natural.box));
}

// A chain couples each equation only to the next: found along it, in a time that grows with it.
TEST(EquationOrder, LongChains) {
  const Index m = 20'000, n = m + 1;  // x_(k+1) - x_k = 1, the first x is bounded
  support::Triplets entries;
  for (int k = 0; k < m; ++k)
    for (const auto& [j, a] : {std::pair{k, -1.0}, {k + 1, 1.0}}) {
      const int row = static_cast<int>(n) + (k + 1) % static_cast<int>(m);  // rotated
      entries.emplace_back(row, j, a);
      entries.emplace_back(j, static_cast<int>(n) + k, -a);
    }
  const SpMat M = support::from(n + m, entries);
  Box box = Box::free(n + m);
  box.lower.head(1).setZero();
  const auto order = equation_order(M, box);
  ASSERT_TRUE(order);
  for (Index k = 0; k < m; ++k) ASSERT_EQ(order->row_of[at(n + k)], n + (k + 1) % m);
}

// A band upside down is symmetric, and further from anything useful.
TEST(EquationOrder, EquationsAloneStayAsTheyAre) {
  EXPECT_FALSE(equation_order(matrix({{4, 1, 0, 0}, {2, 4, 1, 0}, {3, 2, 4, 1}, {0, 3, 2, 4}}), Box::free(4)));
  EXPECT_FALSE(equation_order(matrix({{1, 0}, {1, 1}}), Box::free(2)));
}

// Symmetric in another order, but with signs that fit nowhere: M_12 = M_21 of a bounded pair and one without diagonal.
TEST(EquationOrder, SymmetryWithoutSignsIsNone) {
  Box box = Box::free(4);
  box.lower.head(2).setZero();
  EXPECT_FALSE(equation_order(matrix({{1, 0, 2, 3}, {0, 1, 4, 5}, {3, -5, 0, 0}, {2, 4, 0, 0}}), box));
}

// The certificate of the ordered problem is one of the problem given, and the classes are the same.
TEST(EquationOrder, ProofsAndClassesDoNotDependOnTheOrder) {
  Random random(3);
  for (int k = 0; k < 40; ++k) {
    const Index n = random.integer(5, 10), m = random.integer(2, 4);
    Dense A = random_matrix(m, n, 0.6, random).cwiseAbs();
    A.row(0).setOnes();
    Vec b = A * Vec::Ones(n);
    if (k % 2 == 0) b[0] = -1;  // no x >= 0 has this sum
    const Vec c = Vec::NullaryExpr(n, [&] { return random.uniform(0.5, 2); });
    const AffineMcp natural = optimality(Dense::Zero(n, n), A, c, b, n);
    const AffineMcp given = shuffled(natural, random, true);
    const Vec start = Vec::Zero(natural.size());
    const Result there = solve(natural, start), here = solve(given, start);
    EXPECT_EQ(there.status, here.status) << k;
    EXPECT_EQ(here.status, k % 2 == 0 ? Status::Infeasible : Status::Solved) << k << ": " << here.message;
    EXPECT_EQ(there.certificate.size(), here.certificate.size()) << k;
    EXPECT_TRUE(here.certificate.size() == 0 || proves_infeasible(given, here.certificate)) << k;
    EXPECT_TRUE(!here.refutation || holds(given, *here.refutation)) << k;
    const Diagnosis one = classify(natural), other = classify(given);
    for (std::size_t p = 0; p < one.all().size(); ++p)
      EXPECT_EQ(one.all()[p].second->answer, other.all()[p].second->answer) << one.all()[p].first;
  }
}

}  // namespace
}  // namespace perp::lcp

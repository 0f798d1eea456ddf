// SPDX-License-Identifier: Apache-2.0
// Problems whose structure a file, or the order of its rows, would give away, as functions: solved by what the pattern
// of J says alone. Expected values come from forward substitution. Would catch a method that has to fight with all
// equations of a chain at once, blocks that are put together wrongly, and a verdict that a part alone has decided.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "ncp/strategy/presets.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/matrices.hpp"

namespace perp::ncp {
namespace {

using support::Triplets;

/// x_t = r x_(t-1) (1 - x_(t-1)), x_0 = 0.1, with its rows in the order given: row k is the equation of x_(order[k]).
std::unique_ptr<Mcp> logistic(Index T, double r, const std::vector<Index>& order) {
  Triplets entries;
  for (int k = 0; k < T; ++k) {
    const auto t = static_cast<int>(order[at(k)]);
    entries.emplace_back(k, t, 1);
    if (t > 0) entries.emplace_back(k, t - 1, 1);
  }
  Functions f{.name = "logistic", .box = Box::free(T), .pattern = support::from(T, entries), .F = {}};
  const auto before = [](In x, Index t) { return t > 0 ? x[t - 1] : 0.1; };
  f.F = [=](In x, Out F) {
    for (Index k = 0; k < T; ++k) {
      const Index t = order[at(k)];
      F[k] = x[t] - r * before(x, t) * (1 - before(x, t));
    }
    return true;
  };
  f.J = [=](In x, SpMat& J) {
    for (Index j = 0; j < T; ++j)
      for (SpMat::InnerIterator it(J, j); it; ++it) it.valueRef() = order[at(it.row())] == j ? 1 : -r * (1 - 2 * x[j]);
    return true;
  };
  return make_mcp(std::move(f));
}

std::vector<Index> natural(Index n) {
  std::vector<Index> order(at(n));
  std::iota(order.begin(), order.end(), Index{0});
  return order;
}

TEST(BlockByBlock, ChaoticChainsOfAnyLength) {
  for (const Index T : {5, 16, 40, 100, 400})
    for (const char* name : {"auto", "path"})
      for (const bool reversed : {false, true}) {
        std::vector<Index> order = natural(T);
        if (reversed) std::reverse(order.begin(), order.end());
        const auto mcp = logistic(T, 3.8, order);
        const Result result = solve(*mcp, Vec::Constant(T, 0.1), find_preset(name)->method);
        ASSERT_TRUE(result.solved()) << T << ' ' << name << ' ' << result;
        double x = 0.1;
        for (Index t = 0; t < T; ++t) {
          x = 3.8 * (t > 0 ? result.x[t - 1] : 0.1) * (1 - (t > 0 ? result.x[t - 1] : 0.1));
          EXPECT_NEAR(result.x[t], x, 1e-8);
        }
      }
}

// The same as functions of Python are, with J given in full. Catches structure that only a pattern tells.
TEST(BlockByBlock, ZerosOfADenseJacobianAreStructure) {
  for (const Index T : {20, 100}) {
    const auto chain = logistic(T, 3.8, natural(T));
    Functions f{
        .name = "dense", .box = Box::free(T), .pattern = SpMat(Eigen::MatrixXd::Ones(T, T).sparseView()), .F = {}};
    f.F = [&](In x, Out F) { return chain->eval(x, F); };
    f.J = [&](In x, SpMat& J) {
      SpMat sparse = chain->jacobian_pattern();
      chain->jacobian(x, sparse);
      Eigen::Map<Eigen::MatrixXd>(J.valuePtr(), T, T) = sparse;
      return true;
    };
    const auto mcp = make_mcp(std::move(f));
    const Result result = solve(*mcp, Vec::Constant(T, 0.5), automatic());
    EXPECT_TRUE(result.solved()) << T << ' ' << result;
  }
}

/// Blocks of two, a complementarity pair and an equation, on the block before:
///     0 <= a_k  _|_  a_k - s_(k-1),   s_k free: s_k = 3.8 a'(1 - a') with a' = min(a_k, 1).
std::unique_ptr<Mcp> mixed_chain(Index K) {
  Triplets entries;
  for (int k = 0; k < K; ++k) {
    entries.emplace_back(2 * k, 2 * k, 1);
    if (k > 0) entries.emplace_back(2 * k, 2 * k - 1, 1);
    entries.emplace_back(2 * k + 1, 2 * k + 1, 1);
    entries.emplace_back(2 * k + 1, 2 * k, 1);
  }
  Functions f{.name = "mixed", .box = Box::free(2 * K), .pattern = support::from(2 * K, entries), .F = {}};
  for (Index k = 0; k < K; ++k) f.box.lower[2 * k] = 0;
  f.F = [=](In x, Out F) {
    for (Index k = 0; k < K; ++k) {
      F[2 * k] = x[2 * k] - (k > 0 ? x[2 * k - 1] : 0.1);
      F[2 * k + 1] = x[2 * k + 1] - 3.8 * x[2 * k] * (1 - x[2 * k]);
    }
    return true;
  };
  f.J = [=](In x, SpMat& J) {
    for (Index j = 0; j < 2 * K; ++j)
      for (SpMat::InnerIterator it(J, j); it; ++it)
        it.valueRef() = it.row() == j ? 1 : j % 2 == 0 ? -3.8 * (1 - 2 * x[j]) : -1;
    return true;
  };
  return make_mcp(std::move(f));
}

TEST(BlockByBlock, InequalityPairsAreBlocksToo) {
  const auto mcp = mixed_chain(60);
  const Result result = solve(*mcp, Vec::Constant(120, 0.1), path());
  ASSERT_TRUE(result.solved()) << result;
  for (Index k = 0; k < 60; ++k) EXPECT_NEAR(result.x[2 * k], k > 0 ? result.x[2 * k - 1] : 0.1, 1e-8);
}

// x (x - 1) = 0 has two solutions, and y^2 = 2 x - 1 a solution for one of them: from x = 0.1 the blocks end at x = 0,
// all of it at x = 1, or nowhere; but nothing is said to be proven.
TEST(BlockByBlock, AnotherSolutionOfTheFirstBlockIsNeeded) {
  Functions f{.name = "two", .box = Box::free(2), .pattern = support::matrix({{1, 0}, {1, 1}}), .F = {}};
  f.F = [](In x, Out F) {
    F[0] = x[0] * (x[0] - 1);
    F[1] = x[1] * x[1] - 2 * x[0] + 1;
    return true;
  };
  f.J = [](In x, SpMat& J) {
    J.coeffRef(0, 0) = 2 * x[0] - 1;
    J.coeffRef(1, 0) = -2;
    J.coeffRef(1, 1) = 2 * x[1];
    return true;
  };
  const auto mcp = make_mcp(std::move(f));
  const Result result = solve(*mcp, Vec{{0.1, 1}}, path());
  EXPECT_NE(result.status, Status::Infeasible);
  EXPECT_TRUE(solve(*mcp, Vec{{0.9, 0.8}}, path()).solved());
}

// A long chain that no method needs help with costs its blocks little: fewer than 60 evaluations, however long.
TEST(BlockByBlock, LongChainsThatAreEasy) {
  const Index T = 20'000;
  const auto mcp = logistic(T, 0.9, natural(T));
  const Result result = solve(*mcp, Vec::Constant(T, 0.1), path());
  ASSERT_TRUE(result.solved()) << result;
  EXPECT_LT(result.stats.F_evals, 200);
}

/// min sum x_j^4 / 4 + c'x, A x = b, x >= 0, with the rows of A in the order given.
std::unique_ptr<Mcp> program(const Eigen::MatrixXd& A, const Vec& c, const Vec& b, const std::vector<Index>& order) {
  const Index n = A.cols(), m = A.rows();
  Triplets entries;
  for (int j = 0; j < n; ++j) {
    entries.emplace_back(j, j, 1);
    for (int i = 0; i < m; ++i)
      if (A(i, j) != 0) {
        entries.emplace_back(j, static_cast<int>(n) + i, 1);
        entries.emplace_back(static_cast<int>(n) + static_cast<int>(order[at(i)]), j, 1);
      }
  }
  Functions f{.name = "program", .box = Box::free(n + m), .pattern = support::from(n + m, entries), .F = {}};
  f.box.lower.head(n).setZero();
  f.F = [=](In x, Out F) {
    F.head(n) = x.head(n).array().cube().matrix() + c - A.transpose() * x.tail(m);
    const Vec r = A * x.head(n) - b;
    for (Index i = 0; i < m; ++i) F[n + order[at(i)]] = r[i];
    return true;
  };
  f.J = [=](In x, SpMat& J) {
    for (Index j = 0; j < n + m; ++j)
      for (SpMat::InnerIterator it(J, j); it; ++it)
        if (it.row() == j)
          it.valueRef() = 3 * x[j] * x[j];
        else if (j >= n)
          it.valueRef() = -A(j - n, it.row());
    for (Index i = 0; i < m; ++i)
      for (Index j = 0; j < n; ++j)
        if (A(i, j) != 0) J.coeffRef(n + order[at(i)], j) = A(i, j);
    return true;
  };
  return make_mcp(std::move(f));
}

// The order of the equations is nobody's business: the same iterates, whatever it is, and the names of the model.
TEST(EquationsInOrder, OptimalityConditionsOfANonlinearProgram) {
  support::Random random(5);
  const Index n = 12, m = 5;
  const Eigen::MatrixXd A =
      Eigen::MatrixXd::NullaryExpr(m, n, [&] { return random.chance(0.5) ? random.uniform(0.5, 2) : 0.0; });
  const Vec c = Vec::Ones(n), b = A * Vec::Ones(n), start = Vec::Constant(n + m, 0.5);
  const std::vector<Index> rotated{1, 2, 3, 4, 0};
  for (const char* name : {"auto", "path", "interior", "semismooth"}) {
    const Result one = solve(*program(A, c, b, natural(m)), start, find_preset(name)->method);
    const auto mcp = program(A, c, b, rotated);
    const Result other = solve(*mcp, start, find_preset(name)->method);
    ASSERT_TRUE(one.solved() && other.solved()) << name << one << other;
    EXPECT_EQ(one.stats.iterations, other.stats.iterations) << name;
    EXPECT_EQ(one.x, other.x) << name;
  }
}

}  // namespace
}  // namespace perp::ncp

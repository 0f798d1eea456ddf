// SPDX-License-Identifier: Apache-2.0
/// bench/peers/orthant: an Mcp on the orthant has the same solutions, and its Jacobian is that of its function. Every
/// kind of bound has its own sign, shift or multiplier; one of them wrong and a peer would be judged on another
/// problem.
#include "bench/peers/orthant.hpp"

#include <gmock/gmock.h>

#include <random>

#include "collection/collection.hpp"
#include "ncp/problem/residual.hpp"

namespace perp::bench {
namespace {

using ncp::Index;
using ncp::infinity;
using ncp::Vec;

/// F(x) = x .* x .* x + A x - b over free, lower, upper, two-sided and fixed unknowns, with those orders mixed.
std::unique_ptr<ncp::Mcp> cubic(const Vec& lower, const Vec& upper, unsigned seed) {
  const Index n = lower.size();
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(n, n, [&](Index, Index) { return uniform(random); }) +
                            2.0 * Eigen::MatrixXd::Identity(n, n);
  const Vec b = Vec::NullaryExpr(n, [&](Index) { return 6 * uniform(random); });
  return ncp::make_mcp({.name = "cubic",
                        .box = {lower, upper},
                        .pattern = ncp::dense_pattern(n),
                        .F =
                            [A, b](ncp::In x, ncp::Out F) {
                              F = x.array().cube().matrix() + A * x - b;
                              return true;
                            },
                        .J =
                            [A](ncp::In x, ncp::SpMat& J) {
                              for (Index j = 0; j < J.cols(); ++j)
                                for (ncp::SpMat::InnerIterator entry(J, j); entry; ++entry)
                                  entry.valueRef() = A(entry.row(), j) + (entry.row() == j ? 3 * x[j] * x[j] : 0);
                              return true;
                            }});
}

struct Shape {
  Vec lower{{0, -infinity, -1, 2, -infinity, -infinity}};
  Vec upper{{infinity, 1, 1, 2, infinity, -3}};
};

/// The residual on the orthant: max of |G_e| and |min(z_c, G_c)|.
double orthant_residual(const Orthant& problem, const Vec& z) {
  Vec G(problem.size());
  EXPECT_TRUE(problem.eval(z, G));
  double worst = 0;
  for (Index k = 0; k < problem.size(); ++k)
    worst = std::max(worst, std::abs(k < problem.equations() ? G[k] : std::min(z[k], G[k])));
  return worst;
}

/// z of x with the multipliers v = max(0, -F_i) of two-sided bounds.
Vec with_multipliers(const Orthant& problem, const ncp::Mcp& mcp, const Vec& x) {
  Vec z = problem.from(x);
  Vec F(mcp.size());
  mcp.eval(x, F);
  Index place = problem.size() - problem.multipliers();
  for (Index i = 0; i < mcp.size(); ++i) {
    const double l = mcp.box().lower[i];
    const double u = mcp.box().upper[i];
    if (std::isfinite(l) && std::isfinite(u) && l < u) z[place++] = std::max(0.0, -F[i]);
  }
  return z;
}

TEST(Orthant, CountsEquationsMultipliersAndLeavesOutFixedUnknowns) {
  const Shape shape;
  const auto mcp = cubic(shape.lower, shape.upper, 1);
  const Orthant problem(*mcp);
  EXPECT_EQ(problem.equations(), 1);
  EXPECT_EQ(problem.multipliers(), 1);
  EXPECT_EQ(problem.size(), 6);  // 6 unknowns, one fixed, one multiplier
}

TEST(Orthant, PointIsTheInverseOfFromWithinTheBounds) {
  const Shape shape;
  const auto mcp = cubic(shape.lower, shape.upper, 1);
  const Orthant problem(*mcp);
  const Vec x{{0.5, -2, 0.25, 2, -7, -4}};
  EXPECT_LT((problem.point(problem.from(x)) - x).lpNorm<Eigen::Infinity>(), 1e-15);
}

TEST(Orthant, JacobianIsThatOfTheFunction) {
  const Shape shape;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto mcp = cubic(shape.lower, shape.upper, seed);
    Orthant problem(*mcp);
    const Index n = problem.size();
    const Vec z = Vec::LinSpaced(n, 0.3, 1.4);
    Eigen::MatrixXd J(n, n);
    ASSERT_TRUE(problem.jacobian(z, J));
    for (Index j = 0; j < n; ++j) {
      const Vec step = 1e-6 * Vec::Unit(n, j);
      Vec above(n);
      Vec below(n);
      ASSERT_TRUE(problem.eval(z + step, above) && problem.eval(z - step, below));
      EXPECT_LT(((above - below) / 2e-6 - J.col(j)).lpNorm<Eigen::Infinity>(), 1e-7)
          << "seed " << seed << ", column " << j;
    }
  }
}

/// x <= 1: at the bound F <= 0 is right and F > 0 is not. (Both signs turned the wrong way pass the differences above.)
TEST(Orthant, AtAnUpperBoundAloneFHasToBeNegative) {
  for (const double F : {-2.0, 2.0}) {
    const auto mcp = ncp::make_mcp({.box = {Vec{{-infinity}}, Vec{{1}}},
                                    .pattern = ncp::dense_pattern(1),
                                    .F =
                                        [F](ncp::In x, ncp::Out out) {
                                          out[0] = F * x[0];
                                          return true;
                                        },
                                    .J =
                                        [F](ncp::In, ncp::SpMat& J) {
                                          J.valuePtr()[0] = F;
                                          return true;
                                        }});
    const Orthant problem(*mcp);
    EXPECT_EQ(orthant_residual(problem, problem.from(Vec{{1}})), F < 0 ? 0 : 2);
  }
}

TEST(Orthant, KnownSolutionsOfTheCollectionSolveItAndNeighboursDoNot) {
  int checked = 0;
  for (const char* name : {"kojshin", "kehoe", "hs34-kkt", "hs118-kkt", "choi", "mathiesen", "tinloi42"}) {
    const auto problem = ncp::collection::find(name)->make();
    Orthant orthant(*problem.mcp);
    for (const auto& known : problem.solutions) {
      const double tol = std::max(1e-8, 10 * ncp::residual(*problem.mcp, known.x).natural);
      EXPECT_LE(orthant_residual(orthant, with_multipliers(orthant, *problem.mcp, known.x)), tol) << name;
      Vec beside = known.x;
      for (Index i = 0; i < beside.size(); ++i) beside[i] += 0.01 * (1 + std::abs(beside[i]));
      const Vec inside = lcp::project(problem.mcp->box(), beside);
      if (ncp::residual(*problem.mcp, inside).natural > 1e-3) {
        EXPECT_GT(orthant_residual(orthant, with_multipliers(orthant, *problem.mcp, inside)), 1e-6) << name;
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 5);
}

}  // namespace
}  // namespace perp::bench

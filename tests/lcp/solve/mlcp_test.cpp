// SPDX-License-Identifier: Apache-2.0
#include "lcp/solve/mlcp.hpp"

#include <gtest/gtest.h>

#include "lcp/pivoting/block_pivoting.hpp"
#include "lcp/pivoting/pivoting_support.hpp"
#include "lcp/pivoting/principal_pivoting.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::vec;

/// Random blocks of these sizes with the planted solution (u, v, w).
struct PlantedMlcp {
  Mlcp mlcp;
  MlcpPoint solution;
};
PlantedMlcp planted(Index n, Index m, Random& random) {
  const Dense G = random.normals(n + m, n + m);
  const Dense S = random.normals(n + m, n + m);
  const Dense M = G * G.transpose() + 0.5 * Dense::Identity(n + m, n + m) + S - S.transpose();  // positive definite
  Mlcp mlcp{.A = support::sparse(M.topLeftCorner(n, n)),
            .B = support::sparse(M.bottomRightCorner(m, m)),
            .C = support::sparse(M.topRightCorner(n, m)),
            .D = support::sparse(M.bottomLeftCorner(m, n)),
            .a = {},
            .b = {}};
  MlcpPoint s{random.normals(n), Vec::Zero(m), Vec::Zero(m)};
  for (Index i = 0; i < m; ++i) (random.chance(0.5) ? s.v[i] : s.w[i]) = random.uniform(0.1, 2);
  mlcp.a = -(mlcp.A * s.u + mlcp.C * s.v);
  mlcp.b = s.w - mlcp.D * s.u - mlcp.B * s.v;
  return {mlcp, s};
}

void expect_near(const MlcpPoint& point, const MlcpPoint& other, double tol) {
  EXPECT_LT(norm_inf(point.u - other.u), tol);
  EXPECT_LT(norm_inf(point.v - other.v), tol);
  EXPECT_LT(norm_inf(point.w - other.w), tol);
}

// Both ways give the planted solution: catches a block in the wrong corner, a sign of the reduction, a transposed D or
// C (all blocks are of different shapes).
TEST(Mlcp, DirectAndReducedAgree) {
  Random random(1);
  for (int run = 0; run < 60; ++run) {
    const Index n = random.integer(0, 20);
    const Index m = random.integer(0, 20);
    const auto [mlcp, solution] = planted(n, m, random);
    EXPECT_LT(residual(mlcp, solution), 1e-11);
    const AffineMcp direct = to_affine(mlcp);
    const Result d = block_pivoting(direct, Vec::Zero(n + m));
    expect_solved(direct, d, "direct");
    expect_near(from_affine(mlcp, d.z), solution, 1e-8);
    const SchurReduction schur(mlcp);
    ASSERT_EQ(to_string(schur.status()), "ok");
    const Result r = block_pivoting(schur.problem(), Vec::Zero(m));
    expect_solved(schur.problem(), r, "reduced");
    const MlcpPoint point = schur.recover(r.z);
    expect_near(point, solution, 1e-8);
    EXPECT_LT(residual(mlcp, point), 1e-9);
  }
}

// By hand: 2 u + v - 3 = 0, w = -u + v: M = 1 + 1/2, q = 0 - 3/2: v = 1, u = 1, w = 0.
TEST(Mlcp, ByHand) {
  const Mlcp mlcp{matrix({{2}}), matrix({{1}}), matrix({{1}}), matrix({{-1}}), vec({-3}), vec({0})};
  const SchurReduction schur(mlcp);
  EXPECT_EQ(schur.problem().M.coeff(0, 0), 1.5);
  EXPECT_EQ(schur.problem().q[0], -1.5);
  const MlcpPoint point = schur.recover(vec({1}));
  EXPECT_EQ(point.u[0], 1);
  EXPECT_EQ(point.w[0], 0);
  EXPECT_EQ(residual(mlcp, point), 0);
  // No solution: the equation, w and the complementarity each count.
  EXPECT_EQ(residual(mlcp, {vec({2}), vec({1}), vec({-1})}), 2);
  EXPECT_EQ(residual(mlcp, {vec({1}), vec({1}), vec({0.5})}), 0.5);
  const AffineMcp direct = to_affine(mlcp);
  EXPECT_EQ(direct.box.lower, vec({-infinity, 0}));
  EXPECT_EQ(Dense(direct.M), Dense(matrix({{2, 1}, {-1, 1}})));
  EXPECT_EQ(direct.q, vec({-3, 0}));
}

// Singular A: refused with the status, and still solved directly. A saddle point with A = 0: v = 1 from the first row,
// w = 0 = -u + v - 0.5 from the second.
TEST(Mlcp, SingularAIsRefused) {
  const Mlcp mlcp{SpMat(1, 1), matrix({{1}}), matrix({{1}}), matrix({{-1}}), vec({-1}), vec({-0.5})};
  const SchurReduction schur(mlcp);
  EXPECT_EQ(to_string(schur.status()), "singular");
  EXPECT_THROW(static_cast<void>(schur.problem()), std::logic_error);
  EXPECT_THROW(static_cast<void>(schur.recover(vec({1}))), std::logic_error);
  const Result direct = principal_pivoting(to_affine(mlcp), Vec::Zero(2));
  expect_solved(to_affine(mlcp), direct, "direct");
  EXPECT_LT(norm_inf(direct.z - vec({0.5, 1})), 1e-14);
  // Hidden by rounding: rank one in floating point.
  const Mlcp hidden{matrix({{0.1, 0.3}, {0.2, 0.6}}), matrix({{1}}), SpMat(2, 1), SpMat(1, 2), vec({0, 0}), vec({1})};
  EXPECT_EQ(to_string(SchurReduction(hidden).status()), "singular");
}

// A sparse A with many empty columns of C: the reduction is sparse and made without n x m memory.
TEST(Mlcp, SparseReduction) {
  const Index n = 20000;
  const Index m = 2000;
  support::Triplets c;
  for (int k = 0; k < 10; ++k) c.emplace_back(100 * k, 7 * k, 1.0);
  Mlcp mlcp{support::tridiagonal(n, -1, 3, -1),
            support::tridiagonal(m, -1, 3, -1),
            SpMat(n, m),
            SpMat(m, n),
            Vec::Constant(n, -1),
            Vec::Constant(m, -1)};
  mlcp.C.setFromTriplets(c.begin(), c.end());
  mlcp.D = SpMat(-mlcp.C.transpose());
  const SchurReduction schur(mlcp);
  ASSERT_EQ(to_string(schur.status()), "ok");
  EXPECT_LT(schur.problem().M.nonZeros(), 3 * m + 100);
  const Result reduced = block_pivoting(schur.problem(), Vec::Zero(m));
  const Result direct = block_pivoting(to_affine(mlcp), Vec::Zero(n + m));
  expect_solved(to_affine(mlcp), direct, "direct");
  expect_near(schur.recover(reduced.z), from_affine(mlcp, direct.z), 1e-9);
}

TEST(Mlcp, Refusals) {
  const auto why = [](const Mlcp& mlcp) { return mlcp.invalid().value_or("valid"); };
  const Mlcp good{matrix({{2}}), matrix({{1}}), matrix({{1}}), matrix({{-1}}), vec({-3}), vec({0})};
  EXPECT_EQ(why(good), "valid");
  Mlcp bad = good;
  bad.D = SpMat(2, 1);
  EXPECT_EQ(why(bad), "D is 2 x 1, not 1 x 1 (a has 1 entries, b 1)");
  EXPECT_THROW(to_affine(bad), std::invalid_argument);
  EXPECT_THROW(SchurReduction{bad}, std::invalid_argument);
  bad = good;
  bad.C.coeffRef(0, 0) = std::nan("");
  EXPECT_EQ(why(bad), "C(1, 1) is nan");
  bad = good;
  bad.b[0] = infinity;
  EXPECT_EQ(why(bad), "b(1) is inf");
  EXPECT_THROW(from_affine(good, vec({1})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(SchurReduction(good).recover(vec({1, 2}))), std::invalid_argument);
}

}  // namespace
}  // namespace perp::lcp

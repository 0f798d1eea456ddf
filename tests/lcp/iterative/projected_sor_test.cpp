// SPDX-License-Identifier: Apache-2.0
#include "lcp/iterative/projected_sor.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "lcp/pivoting/pivoting_support.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::sparse;
using support::tridiagonal;
using support::vec;

const Limits loose{.tol = 1e-8};

std::vector<ProjectedSor> variants() {
  return {{},
          {.omega = 0.7},
          {.symmetric = true},
          {.block = 2},
          {.omega = 0.8, .symmetric = true, .block = 3},
          {.block = 6, .check_every = 1}};
}

SpMat symmetric_definite(Index n, Random& random) {
  const Dense B = random.normals(n, n);
  return sparse(Dense(B * B.transpose() + 2 * static_cast<double>(n) * Dense::Identity(n, n)));
}

// The classes of the docstring, in boxes of all kinds, degenerate: catches a wrong projection, a sweep that uses old
// values, a block that forgets its neighbours.
TEST(ProjectedSor, ConvergesForItsClasses) {
  Random random(1);
  for (int repeat = 0; repeat < 12; ++repeat) {
    const Index n = random.integer(1, 40);
    for (const SpMat& M : {symmetric_definite(n, random), support::h_plus(n, 3, random)}) {
      const PlantedLinear planted = plant(M, support::mixed_box(n, random), 0.3, random);
      for (const ProjectedSor& options : variants()) {
        const Result result = projected_sor(planted.problem, random.normals(n), options, {.tol = 1e-9});
        expect_solved(planted.problem, result, "n = " + std::to_string(n));
        EXPECT_LE(norm_inf(result.z - planted.solution), 1e-4);
      }
    }
  }
}

// Overrelaxation pays: Laplacian of 60 unknowns, optimal omega = 2 / (1 + sin(pi / 61)) of Young 1954 in the free case.
TEST(ProjectedSor, OverrelaxationPays) {
  AffineMcp problem{.M = tridiagonal(60, -1, 2, -1), .q = Vec::Constant(60, 0.01), .box = Box::free(60)};
  problem.box.lower.setConstant(-20);
  const Result plain = projected_sor(problem, Vec::Zero(60), {}, loose);
  const Result over = projected_sor(problem, Vec::Zero(60), {.omega = 1.9}, loose);
  expect_solved(problem, plain, "omega = 1", 2e-8);
  expect_solved(problem, over, "omega = 1.9", 2e-8);
  EXPECT_LT(4 * over.iterations, plain.iterations);
}

// M = ee' + ... singular: v'Mv = 0 has directions, the minimum is attained (Luo & Tseng 1992).
TEST(ProjectedSor, SingularSemidefinite) {
  Random random(2);
  const Dense B = random.normals(30, 12);
  const Dense M = B * B.transpose();
  const Vec z = random.normals(30).cwiseMax(0);
  Vec F = (z.array() > 0).select(Vec::Zero(30), random.normals(30).cwiseAbs());
  const AffineMcp problem = standard_lcp(sparse(M), F - M * z);
  for (const ProjectedSor& options : {ProjectedSor{}, ProjectedSor{.omega = 1.5}, ProjectedSor{.block = 3}})
    expect_solved(problem, projected_sor(problem, Vec::Zero(30), options), "semidefinite");
}

// A P-matrix that is no H-matrix: I + 2 C, C cyclic. Gauss-Seidel leaves the solution e/3 or cycles; Solved would be a
// lie, an endless loop a hang. A tiny omega makes tiny steps: catches stopping by their length.
TEST(ProjectedSor, StallsHonestly) {
  const AffineMcp cycle = standard_lcp(matrix({{1, 2, 0}, {0, 1, 2}, {2, 0, 1}}), -Vec::Ones(3));
  const Result stalled = projected_sor(cycle, Vec::Zero(3));
  EXPECT_EQ(stalled.status, Status::Stalled);
  EXPECT_LT(stalled.iterations, 10000);
  const AffineMcp easy = standard_lcp(tridiagonal(5, -1, 4, -1), -Vec::Ones(5));
  const Result creeping = projected_sor(easy, Vec::Zero(5), {.omega = 1e-9});
  EXPECT_EQ(creeping.status, Status::Stalled);
  expect_honest(easy, creeping, "creeping");
  // Free equations with a spectral radius beyond one: the iterates overflow.
  const AffineMcp wild{.M = matrix({{1, 10}, {10, 1}}), .q = vec({1, 2}), .box = Box::free(2)};
  for (const ProjectedSor& options : {ProjectedSor{}, ProjectedSor{.check_every = 1000}}) {
    const Result diverged = projected_sor(wild, Vec::Zero(2), options);
    EXPECT_EQ(diverged.status, Status::Stalled);
    EXPECT_NE(diverged.message.find("diverges"), std::string::npos) << diverged.message;
    expect_honest(wild, diverged, "diverged");
  }
  // Infeasible, symmetric semidefinite: z grows without end.
  const AffineMcp infeasible = standard_lcp(matrix({{1, -1}, {-1, 1}}), vec({-1, 0.5}));
  EXPECT_FALSE(projected_sor(infeasible, Vec::Zero(2)).solved());
}

TEST(ProjectedSor, NotApplicable) {
  const AffineMcp zero = standard_lcp(matrix({{1, 1}, {1, 0}}), -Vec::Ones(2));
  const Result result = projected_sor(zero, Vec::Zero(2));
  EXPECT_EQ(result.status, Status::NotApplicable);
  EXPECT_NE(result.message.find("index 2"), std::string::npos) << result.message;
  // Negative diagonal, but the variable is fixed or free: fine.
  AffineMcp odd{.M = matrix({{-2, 0}, {0, -3}}), .q = vec({4, 9}), .box = Box::free(2)};
  odd.box.lower[1] = odd.box.upper[1] = 7;
  const Result solved = projected_sor(odd, Vec::Zero(2));
  expect_solved(odd, solved, "free and fixed");
  EXPECT_NEAR(solved.z[0], 2, 1e-8);
  // A block with a zero diagonal entry has a solution nevertheless, another has none.
  const AffineMcp saddle = standard_lcp(matrix({{1, 1}, {-1, 0}}), vec({-2, 1}));
  expect_solved(saddle, projected_sor(saddle, Vec::Zero(2), {.block = 2}), "saddle point block");
  const AffineMcp none = standard_lcp(matrix({{0, 0}, {0, 1}}), vec({-1, 1}));
  EXPECT_EQ(projected_sor(none, Vec::Zero(2), {.block = 2}).status, Status::NotApplicable);
}

TEST(ProjectedSor, LimitsAndInput) {
  const AffineMcp empty = standard_lcp(SpMat(0, 0), Vec(0));
  EXPECT_TRUE(projected_sor(empty, Vec(0)).solved());
  const AffineMcp problem = standard_lcp(tridiagonal(400, -1, 2, -1), -Vec::Ones(400));
  EXPECT_EQ(projected_sor(problem, Vec::Zero(400), {.max_sweeps = 20}).status, Status::IterationLimit);
  Limits limits;
  int asked = 0;
  limits.interrupted = [&] { return ++asked > 3; };
  EXPECT_EQ(projected_sor(problem, Vec::Zero(400), {}, limits).status, Status::Interrupted);
  for (const ProjectedSor& bad : {ProjectedSor{.omega = 2}, ProjectedSor{.omega = 0}, ProjectedSor{.block = 0},
                                  ProjectedSor{.block = 7}, ProjectedSor{.check_every = 0}})
    EXPECT_THROW(projected_sor(problem, Vec::Zero(400), bad), std::invalid_argument);
  EXPECT_THROW(projected_sor(problem, Vec::Zero(3)), std::invalid_argument);
}

// Entries over sixteen orders of magnitude, by scaling rows and columns: what is called solved is.
TEST(ProjectedSor, BadlyScaled) {
  Random random(4);
  for (int repeat = 0; repeat < 30; ++repeat) {
    const Index n = random.integer(1, 12);
    const Vec scale = Vec::NullaryExpr(n, [&] { return std::pow(10, random.uniform(-4, 4)); });
    const SpMat M = scale.asDiagonal() * support::h_plus(n, 2, random) * scale.asDiagonal();
    const AffineMcp problem{.M = M, .q = random.normals(n), .box = support::mixed_box(n, random)};
    expect_honest(problem, projected_sor(problem, Vec::Zero(n)), "scaled");
    expect_honest(problem, projected_sor(problem, Vec::Zero(n), {.block = 3}), "scaled, blocks");
  }
}

}  // namespace
}  // namespace perp::lcp

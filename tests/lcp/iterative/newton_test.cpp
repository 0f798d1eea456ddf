// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

#include "lcp/iterative/fb_newton.hpp"
#include "lcp/iterative/min_newton.hpp"
#include "lcp/iterative/newton_system.hpp"
#include "lcp/pivoting/pivoting_support.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::matrix;
using support::Random;
using support::sparse;
using support::vec;

struct Named {
  std::string name;
  std::function<Result(const AffineMcp&, In, const Limits&)> run;
};
const std::vector<Named>& newtons() {
  static const std::vector<Named> all{
      {"min", [](const AffineMcp& p, In z, const Limits& l) { return min_newton(p, z, {}, l); }},
      {"fb", [](const AffineMcp& p, In z, const Limits& l) { return fb_newton(p, z, {}, l); }},
      {"min, Klu",
       [](const AffineMcp& p, In z, const Limits& l) { return min_newton(p, z, {.lu = LuBackend::Klu}, l); }},
      {"fb, Klu",
       [](const AffineMcp& p, In z, const Limits& l) { return fb_newton(p, z, {.lu = LuBackend::Klu}, l); }}};
  return all;
}

// Phi = 0 at solutions and only there, for every kind of interval: a wrong sign in the composition for two bounds
// accepts (z, F) = (u, +1), for instance. F is the constant q (M = 0).
TEST(Equations, ZeroExactlyAtSolutions) {
  for (const double l : {-infinity, -1.0, 0.0})
    for (const double u : {0.0, 2.0, infinity})
      for (const double z : {-2.0, -1.0, 0.0, 1.0, 2.0, 3.0})
        for (const double F : {-3.0, 0.0, 3.0}) {
          const AffineMcp problem{.M = SpMat(1, 1), .q = vec({F}), .box = {vec({l}), vec({u})}};
          const bool solution = natural_residual(problem, vec({z})) == 0;
          EXPECT_EQ(fb_equations(problem, vec({z})).Phi[0] == 0, solution) << l << ' ' << u << ' ' << z << ' ' << F;
          EXPECT_EQ(min_equations(problem, vec({z})).Phi[0] == 0, solution) << l << ' ' << u << ' ' << z << ' ' << F;
        }
}

// H = Da + Db M against central differences of Phi at points without kinks.
TEST(FischerBurmeister, Derivatives) {
  Random random(1);
  for (int repeat = 0; repeat < 30; ++repeat) {
    const Index n = 6;
    const AffineMcp problem{
        .M = support::random_sparse(n, 2, random), .q = random.normals(n), .box = support::mixed_box(n, random)};
    const Vec z = random.normals(n);
    for (const auto equations : {fb_equations, min_equations}) {
      const Equations at = equations(problem, z);
      const Dense H = Dense(at.Da.asDiagonal()) + at.Db.asDiagonal() * Dense(problem.M);
      for (Index j = 0; j < n; ++j) {
        const double h = 1e-7;
        const Vec plus = equations(problem, z + h * Vec::Unit(n, j)).Phi;
        const Vec minus = equations(problem, z - h * Vec::Unit(n, j)).Phi;
        EXPECT_LE(norm_inf((plus - minus) / (2 * h) - H.col(j)), 1e-6);
      }
    }
  }
}

// Classes for which theory promises solutions, boxes of all kinds, degenerate: catches a wrong piece, sign or bound.
TEST(Newton, SolvesPMatrices) {
  Random random(2);
  for (int repeat = 0; repeat < 20; ++repeat) {
    const Index n = random.integer(1, 60);
    for (const SpMat& M : {support::h_plus(n, 3, random), support::m_matrix(n, 3, random),
                           SpMat(support::psd_plus_skew(n, 2, random) + support::tridiagonal(n, 0, 0.5, 0))}) {
      const PlantedLinear planted = plant(M, support::mixed_box(n, random), 0.3, random);
      for (const Named& method : newtons()) {
        const Result result = method.run(planted.problem, random.normals(n), {});
        expect_solved(planted.problem, result, method.name + ", n = " + std::to_string(n));
        EXPECT_LE(norm_inf(result.z - planted.solution), 1e-5) << method.name;
      }
    }
  }
}

// Rounding level, not the tolerance: catches an end without the cell's own solve.
TEST(Newton, EndsWithAllDigits) {
  Random random(3);
  const Index n = 400;
  const PlantedLinear planted = plant(support::h_plus(n, 3, random), support::mixed_box(n, random), 0, random);
  for (const Named& method : newtons()) {
    const Result result = method.run(planted.problem, Vec::Zero(n), {});
    expect_solved(planted.problem, result, method.name);
    EXPECT_LE(result.residual, 1e-13 * (1 + norm_inf(planted.problem.q))) << method.name;
    EXPECT_LE(result.iterations, 40) << method.name;
    // From the solution's neighbourhood: the right piece at once.
    const Result near = method.run(planted.problem, planted.solution + 1e-4 * random.normals(n), {});
    EXPECT_LE(near.iterations, 3) << method.name;
  }
}

// Exponential for pivoting rules; the QP-like fathi(32) is ill-conditioned.
TEST(Newton, MurtyAndFathi) {
  const SpMat L = support::murty(32).transpose();
  for (const Named& method : newtons()) {
    for (const AffineMcp& problem : {standard_lcp(support::murty(32), -Vec::Ones(32)),
                                     standard_lcp(SpMat(L * L.transpose()), -Vec::Ones(32)), murty_1978(20)})
      expect_solved(problem, method.run(problem, Vec::Zero(problem.size()), {}), method.name);
  }
}

// Equations alone: one factorization. Fixed variables alone: none needed. n = 0.
TEST(Newton, EdgesOfTheBox) {
  Random random(4);
  const SpMat M = support::random_sparse(50, 3, random);
  const AffineMcp linear{.M = M, .q = random.normals(50), .box = Box::free(50)};
  AffineMcp fixed = linear;
  fixed.box.lower = fixed.box.upper = random.normals(50);
  for (const Named& method : newtons()) {
    const Result result = method.run(linear, Vec::Zero(50), {});
    expect_solved(linear, result, method.name);
    EXPECT_EQ(result.iterations, 1) << method.name;
    expect_solved(fixed, method.run(fixed, Vec::Zero(50), {}), method.name);
    EXPECT_TRUE(method.run(standard_lcp(SpMat(0, 0), Vec(0)), Vec(0), {}).solved());
  }
}

// Infeasible, singular, indefinite, badly scaled: an honest end in bounded time.
TEST(Newton, HonestWhereThereIsNoGuarantee) {
  Random random(5);
  int solved = 0;
  for (int repeat = 0; repeat < 60; ++repeat) {
    const Index n = random.integer(1, 15);
    SpMat M = support::random_sparse(n, 2, random);
    if (repeat % 3 == 1) M = support::psd_plus_skew(n, 1, random);
    if (repeat % 3 == 2) {
      const Vec scale = Vec::NullaryExpr(n, [&] { return std::pow(10, random.uniform(-4, 4)); });
      M = scale.asDiagonal() * M * scale.asDiagonal();
    }
    if (repeat % 5 == 0 && n > 1) M.prune([](Index i, Index, double) { return i != 1; });  // a zero row
    const AffineMcp problem{.M = M, .q = random.normals(n), .box = support::mixed_box(n, random)};
    for (const Named& method : newtons()) {
      const Result result = method.run(problem, random.normals(n), {});
      expect_honest(problem, result, method.name + " " + std::to_string(repeat));
      solved += result.solved();
    }
  }
  EXPECT_GT(solved, 90);
  const AffineMcp infeasible = standard_lcp(matrix({{0, 0}, {0, 0}}), vec({-1, 1}));
  const AffineMcp huge = standard_lcp(matrix({{1e200, 1e200}, {-1e200, 1e-200}}), vec({-1e200, -1}));
  for (const Named& method : newtons()) {
    EXPECT_FALSE(method.run(infeasible, Vec::Zero(2), {}).solved()) << method.name;
    expect_honest(huge, method.run(huge, Vec::Ones(2), {}), method.name);
  }
}

// Without damping Newton cycles 1, 2, 3, 1, ... here, q = e, M = I + 2 C cyclic, from e_1 (Ben Gharbia & Gilbert 2012
// for n = 3 with entries beyond 1): catches an undamped method.
TEST(Newton, DampingBreaksTheCycle) {
  const AffineMcp cycle = standard_lcp(matrix({{1, 0, 2}, {2, 1, 0}, {0, 2, 1}}), Vec::Ones(3));
  for (const Named& method : newtons())
    for (const Vec& start : {vec({1, 0, 0}), vec({0, 1, 0}), vec({1, 1, 1}), vec({5, 1, 0})})
      expect_solved(cycle, method.run(cycle, start, {}), method.name);
}

TEST(Newton, LimitsAndInput) {
  Random random(6);
  const PlantedLinear planted = plant(support::h_plus(50, 3, random), Box::nonnegative(50), 0, random);
  Limits limits;
  limits.interrupted = [] { return true; };
  for (const Named& method : newtons()) {
    EXPECT_EQ(method.run(planted.problem, Vec::Zero(50), limits).status, Status::Interrupted);
    EXPECT_THROW(method.run(planted.problem, Vec::Zero(3), {}), std::invalid_argument);
  }
  EXPECT_EQ(min_newton(planted.problem, Vec::Zero(50), {.max_iterations = 0}).status, Status::IterationLimit);
  EXPECT_EQ(fb_newton(planted.problem, Vec::Zero(50), {.max_iterations = 0}).status, Status::IterationLimit);
  EXPECT_THROW(min_newton(planted.problem, Vec::Zero(50), {.armijo = 0.7}), std::invalid_argument);
  EXPECT_THROW(fb_newton(planted.problem, Vec::Zero(50), {.descent_p = 2}), std::invalid_argument);
}

}  // namespace
}  // namespace perp::lcp

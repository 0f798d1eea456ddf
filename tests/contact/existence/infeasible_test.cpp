// SPDX-License-Identifier: Apache-2.0
/// Certificates of contact problems without a solution. Source: contact/existence/infeasible.hpp, and its argument,
/// y.u_N = r.W'(y e_N) + q_N.y < 0 for every r in K.
#include "contact/existence/infeasible.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "contact/contact_support.hpp"
#include "contact/laws/glocker_support.hpp"
#include "contact/scenes/generators.hpp"
#include "contact/solvers/solve.hpp"
#include "exact_certificate.hpp"
#include "unsolvable.hpp"

namespace perp::contact {
namespace {

using support::matrix;
using support::Random;
using support::vec;
using test::exact_radius;
using test::exactly_infeasible;
using test::make_unsolvable;
using test::one_contact;
using test::solvable_problem;
using test::Unsolvable;
using testing::HasSubstr;

/// PERP_UNSOLVABLE=2000: all of them; fewer where nothing is said.
int asked(int by_default) {
  const char* said = std::getenv("PERP_UNSOLVABLE");
  return said != nullptr ? std::atoi(said) : by_default;
}

Problem plane(SpMat W, Vec q, Vec mu) {
  return {.dimension = 2, .W = std::move(W), .q = std::move(q), .mu = std::move(mu)};
}

/// W e_N = 0 of contact 1, and r = (0.1, 0.1) solves it.
Problem solvable_though_column_zero() { return plane(matrix({{0, 1}, {0, 1}}), vec({-0.1, -0.3}), vec({1})); }

// The generator plants what it says it plants: judged in rationals. Would catch a test that asks for what is not so.
TEST(Infeasible, PlantedCertificatesAreExact) {
  Random random(11);
  for (int k = 0; k < asked(400); ++k) {
    const Unsolvable made = make_unsolvable(k, random);
    EXPECT_TRUE(exactly_infeasible(made.problem, made.y)) << made.problem.name;
    EXPECT_EQ(infeasibility_radius(made.problem, made.y), lcp::infinity) << made.problem.name;
    EXPECT_TRUE(proves_infeasible(made.problem, made.y)) << made.problem.name;
  }
}

// By default nine in ten are proven, none is called solved, and every certificate holds in rationals. Catches a search
// that misses a family, a radius that is claimed and not there.
TEST(Infeasible, FoundByDefault) {
  Random random(11);
  const int problems = asked(280);
  int proven = 0;
  std::string missed;
  for (int k = 0; k < problems; ++k) {
    const Problem problem = make_unsolvable(k, random).problem;
    const Result result = solve(problem, {.max_time = std::chrono::duration<double>(2)});
    EXPECT_NE(result.status, Status::Solved) << problem.name << ": " << result.message;
    EXPECT_NE(result.verdict.existence, Existence::Exists) << problem.name;
    if (result.status != Status::Infeasible) {
      missed += problem.name + "; ";
      continue;
    }
    ++proven;
    const Verdict& verdict = result.verdict;
    EXPECT_EQ(verdict.existence, Existence::None);
    if (verdict.radius == lcp::infinity)
      EXPECT_TRUE(exactly_infeasible(problem, verdict.certificate)) << problem.name;
    else
      EXPECT_GE(exact_radius(problem, verdict.certificate), verdict.radius) << problem.name;
    EXPECT_THAT(result.message, HasSubstr("no solution exists"));
  }
  EXPECT_GE(proven, 0.9 * problems) << missed;
}

// The radius is never larger than in 400 bits, and near it, whatever y, mu and the sizes of W and q are. Catches a part
// against K* that is rounded down, an underflow that passes for zero.
TEST(Infeasible, RadiusIsALowerBound) {
  Random random(12);
  int finite = 0;
  for (int k = 0; k < 4000; ++k) {
    const int d = random.integer(2, 3);
    Problem problem = solvable_problem(d, random.integer(1, 4), random.integer(1, 8), random, 0.2);
    problem.W.given() *= std::ldexp(1.0, random.integer(-300, 300));
    problem.q *= std::ldexp(1.0, random.integer(-300, 300));
    for (double& mu : problem.mu) mu *= std::pow(10.0, random.integer(-8, 8));
    Vec y = Vec::NullaryExpr(problem.contacts(), [&] { return random.chance(0.3) ? 0 : random.uniform(0, 2); });
    if (random.chance(0.5)) problem.W = SpMat(-problem.W.matrix());
    if (random.chance(0.5)) problem.q = -problem.q.cwiseAbs();
    const double exact = exact_radius(problem, y);
    const double claimed = infeasibility_radius(problem, y);
    if (claimed < lcp::infinity) {
      EXPECT_LE(claimed, exact) << k;
    } else {
      EXPECT_TRUE(exact == lcp::infinity) << k;
    }
    if (exact > 1e-290 && exact < 1e290) {
      ++finite;
      EXPECT_GE(claimed, 0.999 * exact) << k;
    }
  }
  EXPECT_GT(finite, 500);
}

// On the border of K*: exactly there, an ulp inside, an ulp outside, in 3D by squares: |g_T|^2 = 3^2 + 4^2. Catches a
// border that is decided by rounding.
TEST(Infeasible, TheBorderIsExact) {
  for (const double scale : {1.0, 0x1p-500, 0x1p400}) {
    Problem problem = one_contact(vec({-1, 0, 0}), 0.5);
    problem.W = scale * matrix({{-2.5, 3, 4}, {0, 1, 0}, {0, 0, 1}});
    EXPECT_EQ(infeasibility_radius(problem, vec({1})), lcp::infinity) << scale;
    problem.W.given().coeffRef(0, 0) = scale * std::nextafter(-2.5, 0);
    EXPECT_LT(infeasibility_radius(problem, vec({1})), lcp::infinity) << scale;
    EXPECT_LE(infeasibility_radius(problem, vec({1})), exact_radius(problem, vec({1}))) << scale;
    problem.W.given().coeffRef(0, 0) = scale * std::nextafter(-2.5, -3);
    EXPECT_EQ(infeasibility_radius(problem, vec({1})), lcp::infinity) << scale;
  }
}

// What proves nothing. Catches signs, and the condition that is right for symmetric W alone.
TEST(Infeasible, WhatProvesNothing) {
  const Problem still = one_contact(vec({-1, 0.5, 0}), 0.3);
  Problem none = still;
  none.W = SpMat(3, 3);
  EXPECT_EQ(infeasibility_radius(none, vec({1})), lcp::infinity);
  EXPECT_EQ(infeasibility_radius(none, vec({0})), 0);
  EXPECT_EQ(infeasibility_radius(none, vec({-1})), 0);
  EXPECT_EQ(infeasibility_radius(none, vec({lcp::infinity})), 0);
  EXPECT_THROW(infeasibility_radius(none, vec({1, 1})), std::invalid_argument);
  none.q[0] = 0;
  EXPECT_EQ(infeasibility_radius(none, vec({1})), 0);
  EXPECT_FALSE(proves_infeasible(solvable_though_column_zero(), vec({1})));
  EXPECT_FALSE(find_infeasibility(solvable_though_column_zero()).has_value());
  EXPECT_TRUE(solve(solvable_though_column_zero()).solved());
  // A radius beyond 1e12 that is no rounding: r_N = (1, 1e20) solves it.
  Problem far = plane(SpMat(4, 4), vec({-1, 0, -1, 0}), vec({0, 0}));
  far.W.given().coeffRef(0, 0) = 1;
  far.W.given().coeffRef(2, 2) = 1e-20;
  far.W.given().makeCompressed();
  EXPECT_GT(infeasibility_radius(far, vec({0, 1})), 1e19);
  EXPECT_FALSE(proves_infeasible(far, vec({0, 1})));
  EXPECT_FALSE(find_infeasibility(far).has_value());
}

// Problems with solutions are never refused, at any scale: random ones with v in the interior of the dual cone,
// singular and not; unsymmetric ones with planted r. Catches a threshold that takes a stiff problem for an impossible
// one.
TEST(Infeasible, NeverOfSolvableProblems) {
  Random random(13);
  for (int k = 0; k < 3000; ++k) {
    const int d = random.integer(2, 3);
    const Index n = random.integer(1, 8);
    Problem problem = solvable_problem(d, n, random.integer(1, static_cast<int>(d * n)), random, 0.3);
    if (random.chance(0.5)) {  // r sticks or is zero, u = 0 or inside: a solution for any W
      for (Index j = 0; j < problem.W.matrix().outerSize(); ++j)
        for (SpMat::InnerIterator it(problem.W.given(), j); it; ++it) it.valueRef() *= random.uniform(0.5, 2);
      Vec r = Vec::Zero(d * n);
      Vec u = Vec::Zero(d * n);
      for (Index a = 0; a < n; ++a) {
        if (random.chance(0.7))
          r[d * a] = std::ldexp(random.uniform(0.5, 1), random.integer(-20, 20));
        else
          u[d * a] = random.uniform(0, 1);
      }
      problem.q = u - problem.W * r;
    }
    for (Index j = 0; j < problem.W.matrix().outerSize(); ++j) {  // units of each contact
      const double unit = std::ldexp(1.0, static_cast<int>(j / d) * (k % 5) * 3);
      for (SpMat::InnerIterator it(problem.W.given(), j); it; ++it)
        it.valueRef() *= unit * std::ldexp(1.0, static_cast<int>(it.row() / d) * (k % 5) * 3);
    }
    for (Index i = 0; i < problem.q.size(); ++i) problem.q[i] *= std::ldexp(1.0, static_cast<int>(i / d) * (k % 5) * 3);
    const std::optional<Infeasible> found = find_infeasibility(problem);
    EXPECT_FALSE(found.has_value()) << k;
  }
}

TEST(Infeasible, NeverOfScenesAndRecordedProblems) {
  for (const char* scene : {"stack", "spheres", "arch", "chain", "wall", "incline"})
    for (const Index size : {10, 40, 200}) {
      const Problem problem = make_scene(scene, size, 1).problem();
      EXPECT_FALSE(find_infeasibility(problem).has_value()) << scene << size;
    }
  SKIP_WITHOUT_RECORDED_PROBLEMS();
  for (const auto& entry : std::filesystem::directory_iterator(recorded_folder)) {
    const std::string file = entry.path().filename().string();
    if (!entry.is_regular_file() || (!file.ends_with(".dat") && !file.ends_with(".hdf5"))) continue;
    const Problem problem = recorded(file);
    EXPECT_FALSE(find_infeasibility(problem, {.max_time = std::chrono::duration<double>(0.5)}).has_value()) << file;
  }
}

// Ten thousand contacts: bodies in a row, one of them squeezed. Catches a dense matrix.
TEST(Infeasible, OneSqueezedBodyAmongThousands) {
  const Problem scene = make_scene("stack", 10000, 1).problem();
  Problem problem = scene;
  problem.global = nullptr;
  problem.rounding = {};
  const Index before = scene.q.size();
  std::vector<Eigen::Triplet<double>> entries;
  for (Index j = 0; j < before; ++j)
    for (SpMat::InnerIterator it(scene.W.matrix(), j); it; ++it)
      entries.emplace_back(static_cast<int>(it.row()), static_cast<int>(j), it.value());
  const auto N = static_cast<int>(before);
  for (const auto& [i, j, value] : {std::tuple{0, 0, 1.0}, {3, 3, 1.0}, {0, 3, -1.0}, {3, 0, -1.0}})
    entries.emplace_back(N + i, N + j, value);
  problem.W = SpMat(before + 6, before + 6);
  problem.W.given().setFromTriplets(entries.begin(), entries.end());
  problem.q.conservativeResize(before + 6);
  problem.q.tail(6) << -1, 0, 0, 0, 0.5, 0;
  problem.mu.conservativeResize(problem.mu.size() + 2);
  problem.mu.tail(2).setConstant(0.5);
  const std::optional<Infeasible> found = find_infeasibility(problem);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->radius, lcp::infinity);
  EXPECT_EQ((found->y.array() > 0).count(), 2);
}

}  // namespace
}  // namespace perp::contact

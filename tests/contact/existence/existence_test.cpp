// SPDX-License-Identifier: Apache-2.0
/// What is said of the existence of solutions. Source: Acary, Cadoux, Lemarechal & Malick, ZAMM 91 (2011) 155;
/// contact/existence/existence.hpp.
#include "contact/existence/existence.hpp"

#include <gtest/gtest.h>

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
using test::exactly_inside;
using test::exactly_semidefinite;
using test::solvable_problem;

// Random problems with v inside the dual cones by construction, W of any rank: found in nearly all, and what is found
// holds in rationals, W as well. Catches a witness on the border, a W that is called semidefinite and is not.
TEST(Existence, WitnessesHoldExactly) {
  Random random(21);
  int found = 0;
  constexpr int problems = 150;
  for (int k = 0; k < problems; ++k) {
    const int d = random.integer(2, 3);
    const Index n = random.integer(1, 5);
    const Problem problem = solvable_problem(d, n, random.integer(1, static_cast<int>(d * n)), random, 0.2);
    const std::optional<Witness> witness = find_witness(problem);
    if (!witness) continue;
    ++found;
    EXPECT_GT(witness->margin, 0);
    EXPECT_TRUE(exactly_inside(problem, witness->r)) << k;
    EXPECT_TRUE(exactly_semidefinite(problem, witness->shift)) << k;
    EXPECT_TRUE(examine_witness(problem, witness->r).has_value());
    EXPECT_FALSE(find_infeasibility(problem).has_value()) << k;
  }
  EXPECT_GE(found, 0.9 * problems);
}

// Nothing is said where the theorem says nothing: W unsymmetric by an ulp, indefinite, with a zero on the diagonal in a
// row that is not; where no velocities are inside; where one would have to be bought by the rounding of W.
TEST(Existence, OnlyWhereTheTheoremHolds) {
  const auto plane = [](const SpMat& W, const Vec& q) {
    return Problem{.dimension = 2, .W = W, .q = q, .mu = Vec::Constant(q.size() / 2, 0.5)};
  };
  const Vec away = vec({1, 0, 1, 0});
  const SpMat I = matrix({{1, 0, 0.5, 0}, {0, 1, 0, 0}, {0.5, 0, 1, 0}, {0, 0, 0, 1}});
  EXPECT_TRUE(find_witness(plane(I, -away)).has_value());
  SpMat W = I;
  W.coeffRef(0, 2) = std::nextafter(0.5, 1);
  EXPECT_FALSE(find_witness(plane(W, -away)).has_value());
  EXPECT_FALSE(examine_witness(plane(W, away), Vec::Zero(4)).has_value());
  W = I;
  W.coeffRef(0, 2) = W.coeffRef(2, 0) = 2;
  EXPECT_FALSE(find_witness(plane(W, -away)).has_value());
  W = I;
  W.coeffRef(2, 2) = 0;
  EXPECT_FALSE(find_witness(plane(W, -away)).has_value());
  EXPECT_FALSE(find_witness(plane(SpMat(4, 4), -away)).has_value());
  EXPECT_FALSE(find_witness(plane(SpMat(2, 2), vec({1, 2}))).has_value());
  EXPECT_TRUE(find_witness(plane(SpMat(2, 2), vec({2, 1}))).has_value());
  // Singular but for an ulp: only impulses of 1e16 separate both contacts.
  W = matrix({{1, 0, -1, 0}, {0, 1, 0, 0}, {-1, 0, std::nextafter(1, 2), 0}, {0, 0, 0, 1}});
  EXPECT_FALSE(find_witness(plane(W, -away)).has_value());
}

// Problems without a solution never have one, at any rate of that kind. Catches a contradiction of the two verdicts.
TEST(Existence, NeverOfUnsolvableProblems) {
  Random random(11);
  for (int k = 0; k < 105; ++k) {
    const Problem problem = test::make_unsolvable(k, random).problem;
    EXPECT_FALSE(find_witness(problem).has_value()) << problem.name;
  }
}

// A solver that may not do enough says that there is a solution; one that is stopped by hand asks nothing.
TEST(Existence, SaidWhereASolveIsGivenUp) {
  const Problem problem = make_scene("stack", 40).problem();
  const GlockerHomotopy weak{.max_iterations = 1};
  const Result result = solve(problem, {.method = weak});
  EXPECT_EQ(result.status, Status::NoProgress);
  EXPECT_EQ(result.verdict.existence, Existence::Exists);
  EXPECT_NE(result.message.find("a solution exists"), std::string::npos);
  EXPECT_TRUE(exactly_inside(problem, result.verdict.witness.r));
  const std::atomic<bool> now{true};
  EXPECT_EQ(solve(problem, {.interrupt = &now}).verdict.existence, Existence::Undecided);
  EXPECT_EQ(existence(problem).existence, Existence::Exists);
}

}  // namespace
}  // namespace perp::contact

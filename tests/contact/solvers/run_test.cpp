// SPDX-License-Identifier: Apache-2.0
/// Every law of friction by name, on contacts that do not act on each other: W = I, so that with q = (-1, s) r_N = 1
/// and r_T is the projection of -s on the law's friction set.
#include "contact/solvers/run.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "contact/contact_support.hpp"
#include "contact/scenes/generators.hpp"

namespace perp::contact {
namespace {

using perp::support::vec;

/// Open; sticking; slipping to r = (1, -0.3, -0.4) with u_T = (0.9, 1.2).
Problem three_contacts() {
  Problem problem{.W = SpMat(9, 9), .q = vec({1, 0, 0, -1, 0.3, 0, -1, 1.2, 1.6}), .mu = vec({0.5, 0.5, 0.5})};
  problem.W.given().setIdentity();
  return problem;
}

// Would catch a law that is solved by another's solver, and a run that calls a polygon's solution Coulomb's.
TEST(Run, EveryLaw) {
  const Problem problem = three_contacts();
  for (const char* name :
       {"glocker", "glocker+homotopy", "glocker+path", "glocker+interior/A", "ncp1", "ncp1+semismooth", "inner:8",
        "inner:8+lemke/mixed", "outer:8", "outer:8+path", "frictionless"}) {
    const Variant variant = variant_of(name);
    const auto run = contact::run(problem, variant);
    EXPECT_TRUE(run.solved) << name << ": " << run.message;
    EXPECT_EQ(run.status, Status::Solved) << name;
    EXPECT_FALSE(run.solved_by.empty()) << name;
    EXPECT_EQ(run.in_state(State::Open), 1) << name;
    EXPECT_EQ(run.residual.siconos, residual(problem, run.solution.r).siconos) << name;
    if (variant.exact())
      EXPECT_TRUE(accepted(run.residual, 1e-8)) << name;
    else
      EXPECT_GT(run.residual.siconos, 1e-3) << name;
    EXPECT_NEAR(run.solution.r[3], 1, 1e-7) << name;
  }
}

// Would catch limits and the observer that do not reach the solver.
TEST(Run, LimitsReachTheSolver) {
  const Problem problem = make_scene("spheres", 60, 1).problem();
  for (const char* name : {"glocker", "ncp1"}) {
    int better = 0;
    EXPECT_TRUE(run(problem, variant_of(name), {.better = [&better](const Vec&) { ++better; }}).solved) << name;
    EXPECT_GT(better, 1) << name;
  }
  for (const char* name : {"glocker+homotopy", "ncp1", "inner:8"})
    EXPECT_EQ(run(problem, variant_of(name), {.seconds = 0}).status, Status::TimeLimit) << name;
}

// Friction of a slipping contact in units of mu r_N, against its velocity: 1 by Coulomb's law. A polygon's share is the
// width of the polygon in that direction: within [cos(pi / K), 1] inside of the disk and [1, 1 / cos(pi / K)] about it,
// so that the two bracket the law, and both ends tend to 1. Would catch a polygon of another size or on the wrong side.
TEST(Run, PolygonsBracketTheExactLaw) {
  int slipping = 0;
  for (const char* scene : {"incline:12", "spheres:20", "arch:20"}) {
    const std::string name(scene);
    const auto colon = name.find(':');
    Problem problem = make_scene(name.substr(0, colon), std::stol(name.substr(colon + 1))).problem();
    problem.mu *= 0.4;  // something slips
    for (const int K : {4, 8, 16})
      for (const char* side : {"inner:", "outer:"})
        for (const char* method : {"+lemke/mixed", "+path"}) {
          const std::string text = side + std::to_string(K) + method;
          const auto run = contact::run(problem, variant_of(text));
          ASSERT_TRUE(run.solved) << scene << ' ' << text << ": " << run.message;
          const double least = std::cos(std::numbers::pi / K);
          const double fastest = problem.q.lpNorm<Eigen::Infinity>();
          const double hardest = run.solution.r.lpNorm<Eigen::Infinity>();
          for (Index a = 0; a < problem.contacts(); ++a) {
            const auto r = run.solution.r.segment<3>(3 * a);
            const auto u_T = run.solution.u.segment<2>(3 * a + 1);
            if (u_T.norm() < 1e-3 * fastest || r[0] < 1e-3 * hardest) continue;
            const double share = -r.tail(2).dot(u_T) / (problem.mu[a] * r[0] * u_T.norm());
            EXPECT_GE(share, (text[0] == 'i' ? least : 1) - 1e-5) << scene << ' ' << text << " contact " << a;
            EXPECT_LE(share, (text[0] == 'i' ? 1 : 1 / least) + 1e-5) << scene << ' ' << text << " contact " << a;
            ++slipping;
          }
        }
  }
  EXPECT_GE(slipping, 100);
}

// A method that gives up says what theory promises of it here: W of the arch is singular.
TEST(Run, SaysWhyTheoryDoesNotApply) {
  const Problem problem = make_scene("arch", 20).problem();
  Variant variant = variant_of("inner:8+lemke");
  std::get<lcp::Lemke>(std::get<lcp::Method>(variant.solver)).options.max_pivots = 1;
  const auto run = contact::run(problem, variant);
  EXPECT_FALSE(run.solved);
  EXPECT_NE(run.message.find("W has the rank"), std::string::npos) << run.message;
  EXPECT_NE(run.message.find("positive definite W alone"), std::string::npos) << run.message;
}

// Would catch a variant put together by hand that runs as something else.
TEST(Run, RefusesASolverOfAnotherLaw) {
  const Problem problem = three_contacts();
  Variant variant = variant_of("inner:8");
  variant.solver = Auto{};
  EXPECT_THROW(run(problem, variant), std::invalid_argument);
  variant = variant_of("glocker");
  variant.solver = EncodingAuto{};
  EXPECT_THROW(run(problem, variant), std::invalid_argument);
  variant.law = Variant::Law::Ncp1;
  EXPECT_THROW(run(problem, variant), std::invalid_argument);
}

// A start that is solved already, and whose cell has a singular matrix: the path has a zero of the normal map and no
// factors. Catches a simplified Newton step with those, which ended the program.
TEST(Run, GoesOnFromAPathWithoutFactors) {
  Problem problem{.W = SpMat(3, 3), .q = Vec::Zero(3), .mu = vec({0.5})};
  problem.W = SpMat(std::ldexp(1.0, -488) * support::matrix({{-4, -2, -3}, {-2, -1, -4}, {-3, -4, 0}}));
  EXPECT_NO_THROW(static_cast<void>(contact::run(problem, variant_of("ncp1"))));
}

}  // namespace
}  // namespace perp::contact

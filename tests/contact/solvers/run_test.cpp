// SPDX-License-Identifier: Apache-2.0
/// Every law of friction by name, on contacts that do not act on each other: W = I, so that with q = (-1, s) r_N = 1
/// and r_T is the projection of -s on the law's friction set.
#include "contact/solvers/run.hpp"

#include <gtest/gtest.h>

#include "contact/contact_support.hpp"
#include "contact/scenes/generators.hpp"

namespace perp::contact {
namespace {

using perp::support::vec;

/// Open; sticking; slipping to r = (1, -0.3, -0.4) with u_T = (0.9, 1.2).
Problem three_contacts() {
  Problem problem{.W = SpMat(9, 9), .q = vec({1, 0, 0, -1, 0.3, 0, -1, 1.2, 1.6}), .mu = vec({0.5, 0.5, 0.5})};
  problem.W.setIdentity();
  return problem;
}

// Would catch a law that is solved by another's solver, and a run that calls a polygon's solution Coulomb's.
TEST(Run, EveryLaw) {
  const Problem problem = three_contacts();
  for (const char* name : {"glocker", "glocker+homotopy", "glocker+path", "glocker+interior/A", "ncp1",
                           "ncp1+semismooth", "inner:8", "inner:8+lemke/mixed", "outer:8", "frictionless"}) {
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

}  // namespace
}  // namespace perp::contact

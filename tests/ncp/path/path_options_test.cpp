// SPDX-License-Identifier: Apache-2.0
/// The options of PathSearch: each ingredient turned off, values that make no sense.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collection/collection.hpp"
#include "ncp/strategy/solve.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::Counting;
using support::NamedMethod;
using support::nan;
using support::Random;
using support::vec;
using testing::AllOf;
using testing::HasSubstr;
using testing::Optional;
using testing::ThrowsMessage;

template <class Change>
PathSearch changed(Change change) {
  PathSearch kernel;
  change(kernel);
  return kernel;
}
/// The method as a user gets it.
template <class Change>
Method with(Change change) {
  return path(changed(change));
}

PathSearch bare() {
  return changed([](PathSearch& m) {
    m.crash.on = m.nms.on = m.proximal_adaptive = false;
    m.search = Searchtype::Line;
    m.chord_steps = m.gradient_step_limit = 0;
  });
}

/// The default with one ingredient less, and with none of them.
std::vector<NamedMethod> ablations() {
  return {{"no crash", with([](PathSearch& m) { m.crash.on = false; })},
          {"crash of one step", with([](PathSearch& m) { m.crash.iteration_limit = 1; })},
          {"monotone", with([](PathSearch& m) { m.nms.on = false; })},
          {"no unchecked steps", with([](PathSearch& m) { m.nms.mstep_frequency = 1; })},
          {"no watchdogs", with([](PathSearch& m) { m.nms.maximum_watchdogs = 0; })},
          {"line", with([](PathSearch& m) { m.search = Searchtype::Line; })},
          {"arc", with([](PathSearch& m) { m.search = Searchtype::Arc; })},
          {"normal map", with([](PathSearch& m) { m.merit = PathMerit::NormalMap; })},
          {"no adaptive proximal terms", with([](PathSearch& m) { m.proximal_adaptive = false; })},
          {"proximal terms", with([](PathSearch& m) { m.proximal_perturbation = 1; })},
          {"no restarts", path({}, 0)},
          {"no chord steps", with([](PathSearch& m) { m.chord_steps = 0; })},
          {"five chord steps", with([](PathSearch& m) { m.chord_steps = 5; })},
          {"no presolve", PathSearch{}},
          {"presolve alone", on(Form::Presolved, PathSearch{})},
          {"no gradient steps", with([](PathSearch& m) { m.gradient_step_limit = 0; })},
          {"no backtracking", with([](PathSearch& m) { m.max_backtracks = 0; })},
          {"ray at first", with([](PathSearch& m) { m.start = PathStart::First; })},
          {"rays", with([](PathSearch& m) { m.start = PathStart::Always; })},
          {"impatient", with([](PathSearch& m) { m.patience = 1; })},
          {"bare", bare()}};
}

// Solved means solved, whatever is left out; and the easy half of the collection needs no ingredient in particular.
// Catches an ingredient that the others rely on for more than speed, and a verdict of something else than the judge.
TEST(PathOptions, EachIngredientCanBeLeftOut) {
  for (const auto& [label, method] : ablations()) {
    int starts = 0;
    int solved = 0;
    for (const collection::Entry& entry : collection::entries()) {
      if (entry.size > 60) continue;
      const collection::Problem problem = entry.make();
      for (std::size_t k = 0; k < problem.starts.size(); ++k) {
        const Result result = solve(*problem.mcp, problem.starts[k], method);
        const double violation = support::violation(*problem.mcp, result.x);
        EXPECT_EQ(result.solved(), violation <= 1e-8)
            << label << ", " << entry.name << " " << k + 1 << ": " << result << ", " << violation;
        EXPECT_TRUE(problem.no_solution.empty() || !result.solved()) << label << ", " << entry.name;
        EXPECT_LE(result.stats.iterations, 2000) << label << ", " << entry.name;
        if (problem.no_solution.empty()) ++starts, solved += result.solved();
      }
    }
    EXPECT_GE(solved, starts * (label == "bare" ? 60 : 80) / 100) << label << ": " << solved << " of " << starts;
  }
}

// What is left out is not done. Catches options that nothing looks at.
TEST(PathOptions, WhatIsLeftOutIsNotCounted) {
  Random random(1);
  Stats all;
  Stats without;
  for (int k = 0; k < 12; ++k) {
    const auto [functions, solution] = support::planted(6, 0.3, random);
    const auto mcp = make_mcp(functions);
    const Vec x0 = 20 * random.normals(6);
    all += solve(*mcp, x0, path()).stats;
    without += solve(*mcp, x0, bare()).stats;
  }
  EXPECT_GT(all.crash_iterations, 0);
  EXPECT_GT(all.presolved, 0);
  EXPECT_GT(all.chord_steps, 0);
  EXPECT_EQ(without.crash_iterations, 0);
  EXPECT_EQ(without.presolved, 0);
  EXPECT_EQ(without.chord_steps, 0);
  EXPECT_EQ(without.gradient_steps, 0);
  EXPECT_EQ(without.proximal_steps, 0);
  EXPECT_EQ(without.unchecked_steps, 0);
  EXPECT_EQ(without.watchdogs, 0);
  EXPECT_EQ(without.restarts, 0);
  EXPECT_EQ(without.ray_starts, 0);
  EXPECT_GT(
      solve(*make_mcp(support::kojima_shindo()), Vec::Zero(4), path({.start = PathStart::Always})).stats.ray_starts, 0);
}

template <class Change>
std::optional<std::string> why(Change change) {
  return invalid(Method(changed(change)));
}

// Every option by its name and value. Catches an option that is not looked at: a beta of 1 would loop, a NaN compares
// false with everything.
TEST(PathOptions, InvalidOnesAreNamed) {
  const auto names = [](const char* option, const char* value) {
    return Optional(HasSubstr(std::string(option) + " is " + value));
  };
  using P = PathSearch;
  EXPECT_EQ(invalid(path()), std::nullopt);
  EXPECT_THAT(why([](P& m) { m.stop.tol = 0; }), names("convergence_tolerance", "0"));
  EXPECT_THAT(why([](P& m) { m.stop.max_iterations = -1; }), names("major_iteration_limit", "-1"));
  EXPECT_THAT(why([](P& m) { m.sigma = 0; }), names("sigma", "0"));
  EXPECT_THAT(why([](P& m) { m.sigma = 1; }), names("sigma", "1"));
  EXPECT_THAT(why([](P& m) { m.beta = 1; }), names("beta", "1"));
  EXPECT_THAT(why([](P& m) { m.beta = nan; }), names("beta", "nan"));
  EXPECT_THAT(why([](P& m) { m.max_backtracks = -2; }), names("max_backtracks", "-2"));
  EXPECT_THAT(why([](P& m) { m.crash.iteration_limit = -1; }), names("crash_iteration_limit", "-1"));
  EXPECT_THAT(why([](P& m) { m.nms.memory = 0; }), names("nms_memory_size", "0"));
  EXPECT_THAT(why([](P& m) { m.nms.mstep_frequency = 0; }), names("nms_mstep_frequency", "0"));
  EXPECT_THAT(why([](P& m) { m.nms.initial_reference_factor = 0.5; }), names("nms_initial_reference_factor", "0.5"));
  EXPECT_THAT(why([](P& m) { m.nms.initial_reference_factor = infinity; }),
              names("nms_initial_reference_factor", "inf"));
  EXPECT_THAT(why([](P& m) { m.nms.maximum_watchdogs = -1; }), names("nms_maximum_watchdogs", "-1"));
  EXPECT_THAT(why([](P& m) { m.chord_steps = -1; }), names("chord_steps", "-1"));
  EXPECT_THAT(why([](P& m) { m.proximal_perturbation = -0.1; }), names("proximal_perturbation", "-0.1"));
  EXPECT_THAT(why([](P& m) { m.proximal_perturbation = nan; }), names("proximal_perturbation", "nan"));
  EXPECT_THAT(why([](P& m) { m.gradient_step_limit = -1; }), names("gradient_step_limit", "-1"));
  EXPECT_THAT(invalid(path({}, -1)), names("restart_limit", "-1"));
  EXPECT_THAT(why([](P& m) { m.stop.max_pivots = 0; }), names("cumulative_iteration_limit", "0"));
  EXPECT_THAT(why([](P& m) { m.patience = 0; }), names("patience", "0"));
  EXPECT_THAT(why([](P& m) { m.lemke.max_pivots = -1; }), names("minor_iteration_limit", "-1"));
  const auto mcp = make_mcp(support::kojima_shindo());
  const Counting counted(*mcp);
  EXPECT_THAT([&] { solve(counted, Vec::Zero(4), path({.beta = 7})); },
              ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("path"), HasSubstr("beta is 7"))));
  EXPECT_EQ(counted.F_evals, 0);
}

}  // namespace
}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
/// Global problems: methods that are given M and H work on them.
#include <gtest/gtest.h>

#include "contact/classics/trial.hpp"
#include "contact/model/jointed.hpp"
#include "contact/scenes/generators.hpp"
#include "contact/solvers/referee.hpp"

namespace perp::contact {
namespace {

/// Scenes, one with bilateral constraints, and one whose inertia is symmetric but for its rounding.
std::vector<Problem> global_problems() {
  std::vector<Problem> all;
  for (const char* name : {"wall", "spheres", "arch", "chain"}) all.push_back(make_scene(name, 60).problem());
  all.push_back(test::jointed("wall", 60, 10));
  all.push_back(test::jointed("spheres", 60, 0, 1e-13));
  return all;
}

// Each part of the default method alone, and all of them with attempts too short to end: Gauss-Seidel, the paths over
// the cones, Glocker's homotopy, Newton steps, other settings, the proximal loop. Catches a part that asks for the
// entries of W or W~, which fill up with the contacts of a body, or a search for what is known of solutions that does.
TEST(GlobalProblem, TheDefaultMethodDoesNotFormW) {
  std::vector<Auto> settings(5);
  settings[1].sweeps = 0;
  settings[2].cones = false;
  settings[2].sweeps = 0;
  settings[3] = {.homotopy = {.max_iterations = 3}, .sweeps = 0, .cones = false};
  settings[4] = {.homotopy = {.max_iterations = 1}, .sweeps = 0, .cones = false, .polish = false};
  for (const Problem& problem : global_problems()) {
    const std::string& name = problem.name;
    for (const Auto& method : settings) {
      const Scaled coordinates = scaled(problem, true, WForm::Parts);
      ASSERT_TRUE(coordinates.W.parts()) << name;
      const Options options{.max_time = std::chrono::seconds(2)};
      Referee referee(problem, coordinates, options);
      run_auto(referee, coordinates, method, Vec());
      EXPECT_FALSE(coordinates.W.formed()) << name;
      const bool solved = referee.result("").solved();
      EXPECT_FALSE(problem.W.formed()) << name;
      EXPECT_TRUE(solved || &method != &settings.front()) << name;
    }
  }
}

/// Over after so many iterations.
class ThreeIterations final : public Trial {
 public:
  bool judge_iterate(In /*r*/, const TrialStep& /*step*/) override { return over(++iterations_); }
  bool over() override { return over(iterations_); }
  bool no_solution() override { return false; }
  int iterations() const { return iterations_; }

 private:
  static bool over(int iterations) { return iterations >= 3; }
  int iterations_ = 0;
};

// Three iterations of the methods of contact/classics. Catches one that asks for the entries.
TEST(GlobalProblem, TheClassicsDoNotFormW) {
  for (const Problem& problem : global_problems()) {
    const std::string& name = problem.name;
    for (const MethodEntry& entry : methods()) {
      if (entry.glocker) continue;
      const Scaled coordinates = scaled(problem, true, WForm::Parts);
      ThreeIterations trial;
      const auto run = [&](const auto& method) {
        if constexpr (Classic<std::decay_t<decltype(method)>>) iterate(trial, coordinates, method, Vec());
      };
      std::visit(run, entry.method);
      EXPECT_FALSE(coordinates.W.formed()) << name << ' ' << entry.name;
      EXPECT_GT(trial.iterations(), 0) << name << ' ' << entry.name;
      EXPECT_FALSE(problem.W.formed()) << name << ' ' << entry.name;
    }
  }
}

}  // namespace
}  // namespace perp::contact

// SPDX-License-Identifier: Apache-2.0
/// Global problems: methods work on M and H.
#include <gtest/gtest.h>

#include "contact/scenes/generators.hpp"
#include "contact/solvers/referee.hpp"

namespace perp::contact {
namespace {

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
  for (const char* name : {"wall", "spheres", "arch", "chain"}) {
    const Problem problem = make_scene(name, 60).problem();
    for (const Auto& method : settings) {
      const Scaled coordinates = scaled(problem);
      ASSERT_TRUE(coordinates.W.parts()) << name;
      const Options options{.max_time = std::chrono::seconds(2)};
      Referee referee(problem, coordinates, options);
      referee.guard([&] { run_auto(referee, coordinates, method, Vec()); });
      EXPECT_FALSE(coordinates.W.formed()) << name;
      const bool solved = referee.result("").solved();
      EXPECT_FALSE(problem.W.formed()) << name;
      EXPECT_TRUE(solved || &method != &settings.front()) << name;
    }
  }
}

// The methods of contact/classics, as far as they come in a short time. Catches one that asks for the entries.
TEST(GlobalProblem, TheClassicsDoNotFormW) {
  for (const char* name : {"wall", "spheres", "arch", "chain"}) {
    const Problem problem = make_scene(name, 60).problem();
    for (const MethodEntry& entry : methods()) {
      if (entry.glocker) continue;
      const Scaled coordinates = scaled(problem);
      const Options options{.max_time = std::chrono::duration<double>(0.2)};
      Referee referee(problem, coordinates, options);
      const auto run = [&](const auto& method) {
        if constexpr (Classic<std::decay_t<decltype(method)>>) iterate(referee, coordinates, method, Vec());
      };
      referee.guard([&] { std::visit(run, entry.method); });
      EXPECT_FALSE(coordinates.W.formed()) << name << ' ' << entry.name;
      EXPECT_GT(referee.result("").stats.iterations, 0) << name << ' ' << entry.name;
      EXPECT_FALSE(problem.W.formed()) << name << ' ' << entry.name;
    }
  }
}

}  // namespace
}  // namespace perp::contact

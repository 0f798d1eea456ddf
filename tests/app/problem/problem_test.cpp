// SPDX-License-Identifier: Apache-2.0
/// What the command line names: problems of any size.
#include "app/problem/problem.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/program/program.hpp"

namespace perp::app {
namespace {

using testing::HasSubstr;

std::string refusal(const std::string& argument) {
  try {
    load_problem(argument);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SizedProblem, NameAndSizeMakeIt) {
  const LoadedProblem problem = load_problem("obstacle:3x5");
  EXPECT_EQ(problem.mcp->size(), 15);
  EXPECT_EQ(problem.label, "obstacle:3x5");
  EXPECT_EQ(problem.x0.size(), 15);
  EXPECT_EQ(load_problem("bratu-own:1x20").mcp->variable_name(19), "v[20,1]");
}

// The command line's errors are input errors (exit code 2), wherever a size is refused:
// tests/collection/test_sized.cpp has the cases. Catches: a refusal that ends the program, a colon that hides a
// suggestion.
TEST(SizedProblem, RefusesWhatIsNoSize) {
  for (const char* argument : {"obstacle:", "obstacle:3", "obstacle:3x", "obstacle:3x4x5", "obstacle:axb"})
    EXPECT_THAT(refusal(argument), HasSubstr("expected obstacle:MxN, as in obstacle:300x300")) << argument;
  EXPECT_THAT(refusal("obstacle:0x4"), HasSubstr("M is 0"));
  EXPECT_THAT(refusal("torsion:30000x4"), HasSubstr("30000"));
  EXPECT_THAT(refusal("kojshin:3x4"), HasSubstr("'kojshin' comes in one size"));
  EXPECT_THAT(refusal("walras-own-1000:3x4"), HasSubstr("'walras-own-1000' comes in one size"));
  EXPECT_THAT(refusal("no-such:3x4"), HasSubstr("neither a file"));
}

TEST(SizedProblem, TakesASeedAndTheStart) {
  const LoadedProblem problem = load_problem("walras-own:12x5x7:3", 2);
  EXPECT_EQ(problem.mcp->size(), 24);
  EXPECT_EQ(problem.start, 2);
  EXPECT_EQ(problem.solutions.size(), 1u);
  EXPECT_THAT(refusal("lq-control-own"), "");
  EXPECT_THROW(load_problem("lq-control-own:9", 4), InputError);
}

}  // namespace
}  // namespace perp::app

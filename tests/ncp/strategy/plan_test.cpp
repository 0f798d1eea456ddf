// SPDX-License-Identifier: Apache-2.0
// Strategies: what is read and written, and laws that hold for whatever is put together: every record is of the problem
// that was given, numbers of iterations only grow, limits hold in all, only the judge calls a point solved.
#include "ncp/strategy/plan.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <stdexcept>

#include "collection/collection.hpp"
#include "ncp/strategy/presets.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::ncp {
namespace {

using testing::HasSubstr;

collection::Problem problem(std::string_view name) { return collection::find(name)->make(); }

std::string refusal(std::string_view text) {
  try {
    (void)method_of(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Plan, WordsAreReadAndWritten) {
  EXPECT_EQ(name(method_of("first( path ,scaled(smooth), escape(semismooth) )")),
            "first(path, on(scaled, smooth), escape(semismooth))");
  EXPECT_EQ(name(method_of("presolved(first(newton-min, proxi))")), "on(presolved, first(newton-min, proxi))");
  EXPECT_EQ(name(first({path(), on(Form::Scaled, Smoothing{})})), "first(path, on(scaled, smooth))");
  for (const char* text : {"path", "on(scaled, smooth)", "on(rescaled, on(blocks, first(lmmcp, escape(interior))))"}) {
    EXPECT_EQ(name(method_of(text)), text);
  }
}

TEST(Plan, RefusalsNameThePlace) {
  EXPECT_THAT(refusal("first(path, sooth)"), HasSubstr("character 18: there is no method 'sooth'"));
  EXPECT_THAT(refusal("first()"), HasSubstr("a method is missing"));
  EXPECT_THAT(refusal("first(path"), HasSubstr("a ')' is missing"));
  EXPECT_THAT(refusal("first(path))"), HasSubstr("')' follows the end"));
  EXPECT_THAT(refusal("first"), HasSubstr("needs methods in parentheses"));
  EXPECT_THAT(refusal("path(smooth)"), HasSubstr("none of first, on, escape, presolved, scaled"));
  EXPECT_THAT(refusal("scaled(path, smooth)"), HasSubstr("takes one method"));
  EXPECT_THAT(refusal(std::string(30, '(')), HasSubstr("none of first, on, escape, presolved, scaled"));
  std::string deep = "path";
  for (int i = 0; i < 30; ++i) deep.insert(0, "scaled(").append(")");
  EXPECT_THAT(refusal(deep), HasSubstr("nested"));
  EXPECT_THAT(refusal("on(skaled, path)"), HasSubstr("'skaled' is none of"));
  EXPECT_THAT(refusal("on(scaled)"), HasSubstr("a ',' and a method are missing"));
  EXPECT_THROW(first({}), std::invalid_argument);
  const auto any = problem("josephy");
  EXPECT_THROW(solve(*any.mcp, any.starts[0], First{}), std::invalid_argument);
}

// Catches an outline that says other than what is done.
TEST(Plan, OutlinesSayWhatIsTried) {
  const auto what = [](const Method& method) {
    std::string all;
    for (const OutlineLine& line : outline(method)) all += line.method + "; ";
    return all;
  };
  EXPECT_EQ(what(method_of("first(newton-min, on(scaled, lmmcp))")), "newton-min; on(scaled, lmmcp); ");
  EXPECT_EQ(what(MinNewton{}), "newton-min; ");
  EXPECT_EQ(what(find_preset("semicomp")->method),
            "semismooth; on(rescaled, escape(semismooth)); on(scaled, escape(semismooth)); escape(semismooth); ");
  const auto billups = problem("billups");
  for (const int restarts : {0, 1, 20}) {
    const Method method = path({}, restarts);
    std::vector<std::string> tried;
    (void)solve(*billups.mcp, billups.starts[0], method, [&](const Iteration& it) {
      if (!it.attempt.empty()) tried.push_back(it.attempt);
      return Next::Continue;
    });
    EXPECT_EQ(tried.size() > 1, restarts > 0);
    const std::string all = what(method);
    for (const std::string& name : tried)
      EXPECT_TRUE(name == "proximal escape" || name.starts_with("path from") || all.find(name) != std::string::npos)
          << name;
  }
}

// An option reaches every kernel in every composition, with a prefix those of that name alone. Catches a composition
// that hides its options, and an entry's own value that a general one overwrites.
TEST(Plan, OptionsReachEveryKernel) {
  Method method = method_of("first(path, on(scaled, smooth), escape(semismooth))");
  Fields fields;
  describe(method, fields);
  for (const char* key :
       {"crash_method", "restart_limit", "preprocess", "smoothing_schedule", "escape_rounds", "sigma"})
    EXPECT_NE(fields.find(key), nullptr) << key;
  const std::vector<Method*> parts = parts_named(method, "semismooth");
  ASSERT_FALSE(parts.empty());
  for (Method* part : parts) std::get<SemismoothNewton>(*part).search.sigma = 0.25;
  Method copy = method;  // a value: what is set in one is not set in the other
  std::get<SemismoothNewton>(*parts_named(copy, "semismooth").front()).search.sigma = 0.125;
  EXPECT_EQ(std::get<SemismoothNewton>(*parts.front()).search.sigma, 0.25);
  Method two = first({PathSearch{}, PathSearch{.crash = {.on = false}}, PathSearch{}});
  Fields of_two;
  describe(two, of_two);
  EXPECT_EQ(of_two.find("beta")->also.size(), 2U);
  EXPECT_EQ(of_two.find("crash_method")->also.size(), 1U) << "the second one's is its own";
}

// Newton on the min function stays in a local minimum of billups, which escapes leave and path solves.
TEST(Plan, TheNextOneGoesOnWhereOneIsStuck) {
  const auto billups = problem("billups");
  MinNewton bare;
  const Result alone = solve(*billups.mcp, billups.starts[0], bare);
  ASSERT_FALSE(alone.solved());
  const Result result = solve(*billups.mcp, billups.starts[0], first({bare, path()}));
  EXPECT_TRUE(result.solved());
  EXPECT_THAT(result.message, HasSubstr("after a restart: path"));
  EXPECT_GE(result.stats.iterations, alone.stats.iterations);
  const Result escaped = solve(*billups.mcp, billups.starts[0], escaping(bare));
  EXPECT_TRUE(escaped.solved());
  EXPECT_THAT(escaped.message, HasSubstr("proximal escape"));
}

// Presolve for a method that has none of its own: a fixed variable goes.
TEST(Plan, PresolvedForAnyMethod) {
  const auto kehoe = problem("kehoe");
  for (const char* text : {"presolved(semismooth)", "presolved(interior)", "presolved(scaled(josephy))"}) {
    const Result result = solve(*kehoe.mcp, kehoe.starts[0], method_of(text));
    EXPECT_TRUE(result.solved()) << text << ": " << result.message;
    EXPECT_GT(result.stats.presolved, 0) << text;
    EXPECT_EQ(result.x.size(), kehoe.mcp->size());
  }
}

class Laws : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Strategies, Laws,
                         testing::Values("first(semismooth, scaled(smooth), path)", "presolved(escape(newton-min))",
                                         "scaled(path)", "scaled(josephy)",
                                         "first(scaled(newton-min), presolved(interior))",
                                         "escape(first(newton-min, semismooth-min))"));

TEST_P(Laws, RecordsAreOfTheProblemItself) {
  for (const char* name : {"billups", "kojshin", "nash10", "powell-badly-scaled"}) {
    const auto given = problem(name);
    int last = -1;
    Method method = method_of(GetParam());
    stop(method).max_iterations = 300;
    const Result result = solve(*given.mcp, given.starts[0], method, [&](const Iteration& it) {
      EXPECT_EQ(it.problem, given.mcp.get());
      EXPECT_GE(it.k, last);
      last = it.k;
      EXPECT_EQ(it.x->size(), given.mcp->size());
      Vec F = Vec::Zero(given.mcp->size());
      const Vec z = lcp::project(given.mcp->box(), *it.x);
      if (given.mcp->eval(z, F) && F.allFinite()) {
        EXPECT_NEAR(it.residual, residual(given.mcp->box(), z, F).natural, 1e-6 * (1 + it.residual)) << name;
      }
      return Next::Continue;
    });
    EXPECT_LE(result.stats.iterations, 300);
    EXPECT_LE(last, result.stats.iterations);
    Vec F = Vec::Zero(given.mcp->size());
    ASSERT_TRUE(given.mcp->eval(result.x, F));
    if (result.solved()) {
      EXPECT_LE(residual(given.mcp->box(), result.x, F).natural, 1e-8) << name;
    }
  }
}

TEST_P(Laws, LimitsHoldInAll) {
  const auto given = problem("billups");
  for (const int most : {0, 1, 7, 40}) {
    Method method = method_of(GetParam());
    stop(method).max_iterations = most;
    const Result result = solve(*given.mcp, given.starts[0], method);
    EXPECT_LE(result.stats.iterations, most);
    EXPECT_EQ(result.x.size(), given.mcp->size());
  }
  Method late = method_of(GetParam());
  stop(late).max_time = std::chrono::seconds(0);
  EXPECT_EQ(solve(*given.mcp, given.starts[0], late).status, Status::TimeLimit);
  int records = 0;
  const Result stopped = solve(*given.mcp, given.starts[0], method_of(GetParam()),
                               [&](const Iteration&) { return ++records == 2 ? Next::Stop : Next::Continue; });
  EXPECT_EQ(stopped.status, Status::Interrupted);
  EXPECT_EQ(records, 2);
}

}  // namespace
}  // namespace perp::ncp

/// The systems that Billups, Dirkse & Ferris (1997) compare, by name, on the collection.
#include <gtest/gtest.h>

#include <string>

#include "ncp/collection/collection.hpp"
#include "ncp/presets.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

using support::vec;

TEST(Presets, AreKnownByName) {
  const auto mcp = make_mcp(support::kojima_shindo(true));
  for (const char* name : {"miles", "path", "nesqp", "qpcomp", "smooth", "proxi", "semismooth", "semicomp", "auto"}) {
    const Preset* preset = find_preset(name);
    ASSERT_NE(preset, nullptr) << name;
    EXPECT_TRUE(solve(*mcp, Vec::Ones(4), preset->method).solved()) << name;
  }
  for (const Preset& preset : presets()) {
    EXPECT_EQ(find_preset(preset.name), &preset) << "named twice: " << preset.name;
    EXPECT_EQ(invalid(preset.method), std::nullopt) << preset.name;
    EXPECT_FALSE(preset.what.empty() || preset.reference.empty()) << preset.name;
  }
  EXPECT_EQ(find_preset("milles"), nullptr);
}

// Shares of the solvable (problem, start) pairs, some below what is measured (bench_presets; README.md has the table).
// Catches a change that costs a system its problems, and every false "solved".
TEST(Presets, SolveTheirShareOfTheCollection) {
  struct Share {
    const char* name;
    double least;
  };
  for (const Share& share :
       {Share{"miles", 0.93}, Share{"semismooth", 0.9}, Share{"semicomp", 0.95}, Share{"proxi", 0.9},
        Share{"nesqp", 0.75}, Share{"qpcomp", 0.88}, Share{"smooth", 0.92}, Share{"path", 1}, Share{"auto", 1}}) {
    int runs = 0;
    int solved = 0;
    std::string failures;
    for (const collection::Entry& entry : collection::entries()) {
      if (entry.size > 60) continue;  // for time
      const collection::Problem problem = entry.make();
      for (const Vec& x0 : problem.starts) {
        const Result result = solve(*problem.mcp, x0, find_preset(share.name)->method);
        const bool good = result.solved() && support::violation(*problem.mcp, result.x) <= 1e-8;
        EXPECT_EQ(good, result.solved()) << share.name << " on " << entry.name << ": " << result;
        if (!problem.no_solution.empty()) {
          EXPECT_FALSE(result.solved()) << share.name << " on " << entry.name;
          continue;
        }
        ++runs;
        solved += good ? 1 : 0;
        if (!good) failures.append(" ").append(entry.name);
      }
    }
    EXPECT_GE(solved, share.least * runs) << share.name << " fails on" << failures;
  }
}

// Newton steps near a regular solution: the residuals square. Josephy's problem at (sqrt(6)/2, 0, 0, 1/2). Catches a
// direction that is not Newton's, and a search that cuts the last steps.
TEST(Presets, ConvergeQuadratically) {
  const auto mcp = make_mcp(support::kojima_shindo(true));
  for (const char* name : {"miles", "path", "nesqp", "smooth", "semismooth", "newton-min", "semismooth-penalised",
                           "robinson", "josephy"}) {
    std::vector<Iteration> records;
    const Vec x0 = vec({std::sqrt(6) / 2 + 0.02, 0.01, 0.01, 0.51});
    Method method = find_preset(name)->method;
    stop(method).tol = 1e-13;
    const Result result = solve(*mcp, x0, method, record(records));
    ASSERT_TRUE(result.solved()) << name << ": " << result;
    ASSERT_LE(result.stats.iterations, 7) << name;
    for (std::size_t k = 1; k < records.size(); ++k) {
      const double before = records[k - 1].residual;
      EXPECT_LE(records[k].residual, std::max(20 * before * before, 1e-13)) << name << " iteration " << k;
    }
  }
}

}  // namespace
}  // namespace perp::ncp

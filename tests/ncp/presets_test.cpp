/// The systems that Billups, Dirkse & Ferris (1997) compare, by name, on the collection.
#include <gtest/gtest.h>

#include <string>

#include "ncp/collection/collection.hpp"
#include "ncp/presets.hpp"
#include "support/collection.hpp"
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

struct Count {
  int runs = 0;
  int solved = 0;
  std::string failures{};
};

/// The solvable (problem, start) pairs among the entries chosen. A run that says it has solved must have; where there
/// is no solution none may say so.
Count run_preset(const char* name, bool (*chosen)(const collection::Entry&)) {
  Count count;
  for (const collection::Entry& entry : collection::entries()) {
    if (entry.size > 60 || !chosen(entry)) continue;  // for time
    const collection::Problem problem = entry.make();
    for (std::size_t k = 0; k < problem.starts.size(); ++k) {
      const Result result = solve(*problem.mcp, problem.starts[k], find_preset(name)->method);
      const bool good = result.solved() && support::violation(*problem.mcp, result.x) <= 1e-8;
      EXPECT_EQ(good, result.solved()) << name << " on " << entry.name << ": " << result;
      if (!problem.no_solution.empty()) {
        EXPECT_FALSE(result.solved()) << name << " on " << entry.name;
        continue;
      }
      ++count.runs;
      count.solved += good ? 1 : 0;
      if (!good) count.failures.append(" ").append(entry.name).append(":").append(std::to_string(k + 1));
    }
  }
  return count;
}

// Shares of the solvable (problem, start) pairs, some below what is measured (bench_presets; README.md has the table).
// Catches a change that costs a system its problems, and every false "solved".
TEST(Presets, SolveTheirShareOfTheCollection) {
  struct Share {
    const char* name;
    double least;
    double least_set_apart;
  };
  for (const Share& share :
       {Share{"miles", 0.93, 0.88}, Share{"semismooth", 0.9, 0.83}, Share{"semicomp", 0.95, 0.93},
        Share{"proxi", 0.92, 0.95}, Share{"nesqp", 0.73, 0.7}, Share{"qpcomp", 0.92, 0.94}, Share{"smooth", 0.97, 0.95},
        Share{"interior", 0.92, 0.85}, Share{"path", 1, 1}, Share{"auto", 1, 1}}) {
    const Count most =
        run_preset(share.name, [](const collection::Entry& entry) { return !support::set_apart(entry); });
    EXPECT_GE(most.solved, share.least * most.runs) << share.name << " fails on" << most.failures;
    const Count apart = run_preset(share.name, support::set_apart);
    EXPECT_GE(apart.solved, share.least_set_apart * apart.runs) << share.name << " fails on" << apart.failures;
    // For the tables, with --gtest_output=json.
    RecordProperty(std::string("solved_by_") + share.name,
                   std::to_string(most.solved) + " of " + std::to_string(most.runs) + ", " +
                       std::to_string(apart.solved) + " of " + std::to_string(apart.runs));
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

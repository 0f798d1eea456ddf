// SPDX-License-Identifier: Apache-2.0
// The methods for nonlinear problems, by preset, where a request for memory fails.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <sstream>

#include "collection/collection.hpp"
#include "faults/harness.hpp"
#include "ncp/problem/residual.hpp"
#include "ncp/strategy/presets.hpp"

namespace perp::faults {
namespace {

using ncp::Preset;
using ncp::Status;

std::string text_of(const ncp::Result& result) {
  std::ostringstream all;
  all << to_string(result.status) << ": " << result.message << "; " << result.advice << "; " << std::hexfloat
      << result.residual.natural << ", " << result.residual.worst << ", " << result.relative << ", "
      << result.stats.iterations << ", " << result.stats.F_evals << ", " << result.stats.factorizations << "; "
      << result.x.transpose() << "; " << result.F.transpose();
  for (const auto& note : result.notes) all << "; " << note;
  return all.str();
}

/// The point, its F and its residual belong together.
bool whole(const ncp::Mcp& mcp, const ncp::Result& result) {
  if (result.x.size() != mcp.size() || result.F.size() != mcp.size() || lcp::project(mcp.box(), result.x) != result.x)
    return false;
  if (!result.F.allFinite()) return !result.solved() && result.residual.natural == lcp::infinity;
  ncp::Vec F = ncp::Vec::Zero(mcp.size());
  if (!mcp.eval(result.x, F)) return false;
  const double size = 1 + F.lpNorm<Eigen::Infinity>();
  return (F - result.F).lpNorm<Eigen::Infinity>() <= 1e-9 * size &&
         ncp::residual(mcp.box(), result.x, result.F).natural == result.residual.natural;
}

Scenario solving(const ncp::Mcp& mcp, const ncp::Vec& start, const ncp::Method& method) {
  return [&mcp, start, method, usual = std::optional<Status>()](long k) mutable {
    ncp::Result result;
    Outcome outcome;
    outcome.out_of_memory = !attempt(k, [&] { result = ncp::solve(mcp, start, method); });
    outcome.all = text_of(result);
    if (outcome.out_of_memory) return outcome;
    if (!usual) usual = result.status;
    outcome.out_of_memory = result.status == Status::OutOfMemory;
    outcome.right = result.accepted() || result.status == *usual;
    if (!whole(mcp, result)) outcome = {false, false, "point, F and residual differ: " + outcome.all};
    return outcome;
  };
}

class NcpFaults : public testing::TestWithParam<const Preset*> {};

std::vector<const Preset*> all_presets() {
  std::vector<const Preset*> all;
  for (const auto& preset : ncp::presets()) all.push_back(&preset);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Presets, NcpFaults, testing::ValuesIn(all_presets()), [](const auto& preset) {
  std::string name(preset.param->name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

void all_of(const Preset& preset, std::string_view name) {
  const auto* entry = ncp::collection::find(name);
  ASSERT_NE(entry, nullptr) << name;
  const auto problem = entry->make();
  every_request_fails_once(std::string(preset.name) + ", " + std::string(name),
                           solving(*problem.mcp, problem.starts[0], preset.method));
}

TEST_P(NcpFaults, Josephy) { all_of(*GetParam(), "josephy"); }
// Where some methods get stuck, and go on to their escapes.
TEST_P(NcpFaults, Billups) { all_of(*GetParam(), "billups"); }
TEST_P(NcpFaults, Harder) { all_of(*GetParam(), "nash10"); }
// Equations.
TEST_P(NcpFaults, Free) { all_of(*GetParam(), "wood"); }

// GSL: its allocators' error handler ends the process, and its factorization uses what it was not given.
TEST(MultirootFaults, EverySolver) {
  using ncp::MultirootSolver;
  const auto problem = ncp::collection::find("wood")->make();
  const auto bounded = ncp::collection::find("josephy")->make();
  for (const auto solver :
       {MultirootSolver::Hybridsj, MultirootSolver::Hybridj, MultirootSolver::Newton, MultirootSolver::Gnewton}) {
    const std::string name(to_string(solver));
    const ncp::Multiroot method{.solver = solver};
    every_request_fails_once(name + ", wood", solving(*problem.mcp, problem.starts[0], method));
    every_request_fails_once(name + ", josephy", solving(*bounded.mcp, bounded.starts[0], method));
  }
}

// Larger: UMFPACK, presolve, scaling.
TEST(LargerNcpFaults, ObstacleBump) {
  const auto problem = ncp::collection::find("american-put-own")->make();
  for (const char* name : {"path", "semismooth", "interior"})
    every_request_fails_once(std::string(name) + ", american-put-own",
                             solving(*problem.mcp, problem.starts[0], ncp::find_preset(name)->method), 12);
}

}  // namespace
}  // namespace perp::faults

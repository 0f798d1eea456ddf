// SPDX-License-Identifier: Apache-2.0
/// The affine problems of tests/lcp/adversarial_support.hpp as nonlinear ones, by every preset, judged in rational
/// numbers. PERP_ADVERSARIAL=2000 takes so many problems and prints a table by preset.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "lcp/adversarial_support.hpp"
#include "lcp/exact_judge.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/strategy/presets.hpp"

namespace perp::ncp {
namespace {

using lcp::adversarial::Problem;
namespace exact = lcp::exact;
using Clock = std::chrono::steady_clock;

struct Tally {
  int runs = 0;
  int solved = 0;
  int to_rounding = 0;
  int infeasible = 0;
  int unknown = 0;  ///< of these: neither known nor decided
  int other = 0;
  int missed = 0;  ///< of these: a solution was planted
  int false_solved = 0;
  int false_rounding = 0;
  int false_infeasible = 0;
  int internal = 0;
};

std::optional<bool> solvable(const Problem& problem) {
  if (problem.solution) return true;
  if (problem.certificate) return false;
  if (problem.mcp.size() > 8) return std::nullopt;
  const exact::Verdict verdict = exact::decide(problem.mcp);
  return verdict.decided ? std::optional(verdict.solvable) : std::nullopt;
}

/// What is false of the result; empty if nothing is.
std::string judge(const Problem& problem, const Result& result, double tol, Tally& tally) {
  const lcp::Box& box = problem.mcp.box;
  if (result.x.size() != problem.mcp.size() || !result.x.allFinite() || result.x != lcp::project(box, result.x)) {
    ++tally.internal;
    return "x is not finite or not in the box";
  }
  if (result.solved()) {
    ++tally.solved;
    const mpq_class residual = exact::residual(problem.mcp, result.x);
    if (residual <= mpq_class(tol)) return {};
    ++tally.false_solved;
    return "false Solved, residual " + std::to_string(residual.get_d() / tol) + " tol";
  }
  if (result.status == Status::SolvedToRounding) {
    ++tally.to_rounding;
    if (exact::solved_to_rounding(problem.mcp, result.x)) return {};
    ++tally.false_rounding;
    return "false SolvedToRounding";
  }
  if (result.status != Status::Infeasible) {
    ++tally.other;
    tally.missed += problem.solution ? 1 : 0;
    return {};
  }
  ++tally.infeasible;
  const auto exists = solvable(problem);
  if (!exists) ++tally.unknown;
  if (!exists.value_or(false)) return {};
  ++tally.false_infeasible;
  return "false Infeasible: " + result.message;
}

std::string run(const Problem& problem, const Mcp& mcp, const Preset& preset, double tol, Tally& tally) {
  ++tally.runs;
  Method method = preset.method;
  stop(method).tol = tol;
  stop(method).max_time = std::chrono::seconds(2);
  stop(method).max_iterations = std::min(stop(method).max_iterations, 100);
  const auto begin = Clock::now();
  try {
    const Result result = solve(mcp, problem.start, method);
    if (Clock::now() - begin > std::chrono::seconds(20)) {
      ++tally.internal;
      return "ran far beyond its time";
    }
    return judge(problem, result, tol, tally);
  } catch (const std::exception& thrown) {
    ++tally.internal;
    return std::string("threw: ") + thrown.what();
  }
}

void print(const std::map<std::string, Tally>& tallies) {
  std::printf("%-20s%8s%8s%9s%11s%9s%8s%8s | false%8s%9s%11s%9s\n", "", "runs", "solved", "rounding", "infeasible",
              "unknown", "other", "missed", "solved", "rounding", "infeasible", "internal");
  for (const auto& [name, t] : tallies)
    std::printf("%-20s%8d%8d%9d%11d%9d%8d%8d |      %8d%9d%11d%9d\n", name.c_str(), t.runs, t.solved, t.to_rounding,
                t.infeasible, t.unknown, t.other, t.missed, t.false_solved, t.false_rounding, t.false_infeasible,
                t.internal);
}

// Catches a claim that is false by the tolerance's meaning (absolute, exact), a presolve or a restart that says so, an
// exception or a point outside the box, of any preset.
TEST(Adversarial, NothingFalse) {
  const char* asked = std::getenv("PERP_ADVERSARIAL");
  const int count = asked == nullptr ? 500 : std::atoi(asked);
  constexpr std::array tolerances{1e-6, 1e-8, 1e-12};
  std::map<std::string, Tally> tallies;
  int shown = 0;
  for (int k = 0; k < count; ++k) {
    const Problem problem = lcp::adversarial::make(static_cast<std::uint64_t>(1'000'000 + k));
    if (problem.mcp.invalid()) continue;  // scaled beyond the range of doubles
    const double tol = tolerances[static_cast<std::size_t>(k) % tolerances.size()];
    const std::unique_ptr<Mcp> mcp = make_affine_mcp(problem.mcp, "adversarial");
    for (const Preset& preset : presets()) {
      const std::string wrong = run(problem, *mcp, preset, tol, tallies[std::string(preset.name)]);
      if (wrong.empty()) continue;
      if (++shown <= 20 || !wrong.starts_with("false Solved"))
        ADD_FAILURE() << preset.name << ", tol " << tol << ": " << wrong << " (" << problem.what << ")";
    }
  }
  EXPECT_EQ(shown, 0) << "false claims in all";
  int settled = 0;
  for (const auto& [name, t] : tallies) settled += t.solved + t.to_rounding + t.infeasible;
  EXPECT_GE(settled, count * static_cast<int>(presets().size()) / 3);
  if (asked != nullptr) print(tallies);
}

}  // namespace
}  // namespace perp::ncp

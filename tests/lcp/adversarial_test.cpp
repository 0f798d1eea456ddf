// SPDX-License-Identifier: Apache-2.0
/// Every method on problems made to fool it, judged in rational numbers: what is called Solved is, what is called
/// Infeasible has no solution, and nothing is thrown, not finite or outside the box. PERP_ADVERSARIAL=20000 takes so
/// many problems and prints a table by method.
#include "lcp/adversarial_support.hpp"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "lcp/exact_judge.hpp"
#include "lcp/solve/solve.hpp"

namespace perp::lcp {
namespace {

using adversarial::Problem;
using Clock = std::chrono::steady_clock;

int count_of_problems() {
  const char* asked = std::getenv("PERP_ADVERSARIAL");
  return asked == nullptr ? 2000 : std::atoi(asked);
}

struct Tally {
  int runs = 0;
  int solved = 0;
  int to_rounding = 0;
  int infeasible = 0;
  int by_radius = 0;  ///< of these: the certificate excludes solutions within a radius only
  int unproven = 0;   ///< of these: neither known nor decided
  int other = 0;
  int missed = 0;  ///< of these: a solution was planted, or a certificate that there is none
  int false_solved = 0;
  int false_rounding = 0;
  int false_infeasible = 0;
  int internal = 0;
};

/// Whether a solution exists, as far as it is known; small problems are decided by the referee when asked.
class Truth {
 public:
  explicit Truth(const Problem& problem) : problem_(problem) {
    if (problem.solution) known_ = true;
    if (problem.certificate) known_ = false;
  }
  std::optional<bool> solvable() {
    if (!known_ && !tried_ && problem_.mcp.size() <= 8) {
      tried_ = true;
      const exact::Verdict verdict = exact::decide(problem_.mcp);
      if (verdict.decided) known_ = verdict.solvable;
    }
    return known_;
  }

 private:
  const Problem& problem_;
  std::optional<bool> known_;
  bool tried_ = false;
};

/// What is false of the result; empty if nothing is.
std::string judge(const Problem& problem, const Result& result, double tol, Truth& truth, Tally& tally) {
  const AffineMcp& mcp = problem.mcp;
  if (result.z.size() != mcp.size() || !result.z.allFinite() || result.z != project(mcp.box, result.z)) {
    ++tally.internal;
    return "z is not finite or not in the box";
  }
  const Status status = result.status;
  if (status == Status::Solved) {
    ++tally.solved;
    const mpq_class residual = exact::residual(mcp, result.z);
    if (residual <= mpq_class(tol)) return {};
    ++tally.false_solved;
    return "false Solved, residual " + std::to_string(residual.get_d() / tol) + " tol";
  }
  if (status == Status::SolvedToRounding) {
    ++tally.to_rounding;
    if (exact::solved_to_rounding(mcp, result.z)) return {};
    ++tally.false_rounding;
    return "false SolvedToRounding";
  }
  if (result.status != Status::Infeasible) {
    ++tally.other;
    tally.missed += problem.solution || problem.certificate ? 1 : 0;
    return {};
  }
  ++tally.infeasible;
  if (result.certificate.size() > 0) {
    const exact::Proof proof = exact::proof(mcp, result.certificate);
    if (proof.proves_all()) return {};
    ++tally.by_radius;
  }
  const auto solvable = truth.solvable();
  if (!solvable) ++tally.unproven;
  if (!solvable.value_or(false)) return {};
  ++tally.false_infeasible;
  return result.certificate.size() > 0 ? "false Infeasible, with a certificate"
                                       : "false Infeasible, without certificate";
}

std::string run(const Problem& problem, const MethodEntry& entry, double tol, Truth& truth, Tally& tally) {
  ++tally.runs;
  Limits limits;
  limits.tol = tol;
  limits.deadline = Clock::now() + std::chrono::seconds(5);
  try {
    const Result result = solve(problem.mcp, problem.start, entry.method, limits);
    if (Clock::now() > limits.deadline + std::chrono::seconds(10)) {
      ++tally.internal;
      return "ran far beyond its deadline";
    }
    return judge(problem, result, tol, truth, tally);
  } catch (const std::exception& thrown) {
    ++tally.internal;
    return std::string("threw: ") + thrown.what();
  }
}

void print(const std::map<std::string, Tally>& tallies) {
  std::printf("%-20s%8s%8s%9s%11s%8s%9s%8s%8s | false%8s%9s%11s%9s\n", "", "runs", "solved", "rounding", "infeasible",
              "radius", "unknown", "other", "missed", "solved", "rounding", "infeasible", "internal");
  for (const auto& [name, t] : tallies)
    std::printf("%-20s%8d%8d%9d%11d%8d%9d%8d%8d |      %8d%9d%11d%9d\n", name.c_str(), t.runs, t.solved, t.to_rounding,
                t.infeasible, t.by_radius, t.unproven, t.other, t.missed, t.false_solved, t.false_rounding,
                t.false_infeasible, t.internal);
}

// Catches a claim that is false by the tolerance's meaning (absolute, exact), a proof of infeasibility that rounding
// made, an exception or a point outside the box, of any method.
TEST(Adversarial, NothingFalse) {
  const int count = count_of_problems();
  constexpr std::array tolerances{1e-6, 1e-9, 1e-12};
  std::map<std::string, Tally> tallies;
  int shown = 0;
  for (int seed = 0; seed < count; ++seed) {
    const Problem problem = adversarial::make(static_cast<std::uint64_t>(seed));
    const double tol = tolerances[static_cast<std::size_t>(seed) % tolerances.size()];
    Truth truth(problem);
    for (const MethodEntry& entry : methods()) {
      const std::string wrong = run(problem, entry, tol, truth, tallies[std::string(entry.name)]);
      if (wrong.empty()) continue;
      if (++shown <= 20 || !wrong.starts_with("false Solved"))
        ADD_FAILURE() << entry.name << ", tol " << tol << ": " << wrong << " (" << problem.what << ")";
    }
  }
  EXPECT_EQ(shown, 0) << "false claims in all";
  int settled = 0;
  for (const auto& [name, t] : tallies) settled += t.solved + t.to_rounding + t.infeasible;
  EXPECT_GE(settled, 5 * count) << "of " << methods().size() * static_cast<std::size_t>(count) << " runs";
  if (std::getenv("PERP_ADVERSARIAL") != nullptr) print(tallies);
}

// The generator keeps its word: planted points have residual 0, certificates prove, exactly; and the referee, which
// knows neither, finds a solution there and none here.
TEST(Adversarial, TheGeneratorIsExact) {
  int planted = 0;
  int unsolvable = 0;
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    const Problem problem = adversarial::make(seed);
    ASSERT_EQ(problem.mcp.invalid(), std::nullopt) << problem.what;
    if (problem.solution) {
      ++planted;
      ASSERT_EQ(*problem.solution, project(problem.mcp.box, *problem.solution)) << problem.what;
      ASSERT_EQ(sgn(exact::residual(problem.mcp, *problem.solution)), 0) << problem.what;
    }
    if (problem.certificate) {
      ++unsolvable;
      ASSERT_TRUE(exact::proof(problem.mcp, *problem.certificate).proves_all()) << problem.what;
    }
    if (seed % 5 != 0 || problem.mcp.size() > 6) continue;
    const exact::Verdict verdict = exact::decide(problem.mcp);
    if (!verdict.decided) continue;
    EXPECT_FALSE(problem.solution && !verdict.solvable) << problem.what;
    EXPECT_FALSE(problem.certificate && verdict.solvable) << problem.what;
  }
  EXPECT_GE(planted, 1800);
  EXPECT_GE(unsolvable, 200);
}

}  // namespace
}  // namespace perp::lcp

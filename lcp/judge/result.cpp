// SPDX-License-Identifier: Apache-2.0
#include "lcp/judge/result.hpp"

#include <cmath>
#include <utility>

#include "lcp/judge/judge.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {

std::optional<Status> Limits::reached() const {
  if (interrupted && interrupted()) return Status::Interrupted;
  if (deadline != std::chrono::steady_clock::time_point::max() && std::chrono::steady_clock::now() >= deadline)
    return Status::TimeLimit;
  return std::nullopt;
}

bool solves(const AffineMcp& problem, In z, double tol) {
  return natural_residual(problem, z) <= tol && judge(problem, z).natural <= tol;
}

namespace {

bool to_rounding(const AffineMcp& problem, In z, const Judgement& judgement) {
  return judgement.accuracy.to_rounding && rounds_a_solution(problem, z, judgement.F, judgement.terms);
}

}  // namespace

bool accepts(const AffineMcp& problem, In z, double tol) {
  const Judgement judgement = judge(problem, z);
  return judgement.natural <= tol || to_rounding(problem, z, judgement);
}

Result judged(const AffineMcp& problem, In z, const Limits& limits, Status otherwise, std::string message) {
  Result result{.status = otherwise, .message = std::move(message), .z = project(problem.box, z)};
  const Judgement judgement = judge(problem, result.z);
  result.residual = judgement.natural;
  result.relative = judgement.accuracy.relative;
  const bool disproved = otherwise == Status::Infeasible;
  if (judgement.natural <= limits.tol) {
    result.status = Status::Solved;
    result.message.clear();
  } else if (!disproved && to_rounding(problem, result.z, judgement)) {
    result.status = Status::SolvedToRounding;
    result.message = "every row's residual is within the rounding of its terms, which is more than the tolerance";
  }
  return result;
}

void check_input(const char* method, const AffineMcp& problem, In start) {
  if (const auto why = problem.invalid()) refuse_input(method, ": ", *why);
  if (start.size() != problem.size())
    refuse_input(method, ": the start has ", start.size(), " entries, the problem ", problem.size());
  for (Index i = 0; i < start.size(); ++i)
    if (!std::isfinite(start[i])) refuse_input(method, ": the start of index ", i, " is ", start[i]);
}

void check_input(const char* method, const AffineMcp& problem, In start, const Limits& limits) {
  check_input(method, problem, start);
  if (limits.tol > 0 && !std::isinf(limits.tol)) return;
  refuse_input(method, ": the tolerance is ", limits.tol, ", not a positive number");
}

}  // namespace perp::lcp

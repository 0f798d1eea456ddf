/// PathSearch on the presolved problem: the way there and back.
#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "ncp/methods.hpp"
#include "ncp/normal_map.hpp"
#include "ncp/presolve.hpp"
#include "ncp/run.hpp"

namespace perp::ncp {
namespace {

/// The cells of all variables: those that stayed as they are, the others by where they ended.
std::vector<lcp::Cell> expanded(const Presolved& pre, const Box& box, In x, const std::vector<lcp::Cell>& reduced) {
  if (reduced.empty()) return {};
  std::vector<lcp::Cell> cells = cells_at(box, x);
  for (std::size_t k = 0; k < reduced.size(); ++k) cells[static_cast<std::size_t>(pre.columns()[k])] = reduced[k];
  return cells;
}

std::vector<lcp::Cell> shrunk(const Presolved& pre, const std::vector<lcp::Cell>& basis) {
  std::vector<lcp::Cell> cells;
  if (!basis.empty())
    for (const Index j : pre.columns()) cells.push_back(basis[static_cast<std::size_t>(j)]);
  return cells;
}

/// A point of the reduced normal map in the full one's coordinates.
Vec expanded(const Presolved& pre, const Vec& x) {
  Vec full = pre.postsolve(lcp::project(pre.problem().box(), x));
  for (std::size_t k = 0; k < pre.columns().size(); ++k) full[pre.columns()[k]] = x[static_cast<Index>(k)];
  return full;
}

/// The user's observer sees the records of the full problem.
Observer in_full(const Mcp& mcp, const Presolved& pre, const Observer& observer) {
  if (!observer) return {};
  return [&](const Iteration& it) {
    Iteration shown = it;
    shown.problem = &mcp;
    if (it.worst >= 0) shown.worst = pre.rows()[static_cast<std::size_t>(it.worst)];
    Vec x;
    if (it.x != nullptr) shown.x = &(x = pre.postsolve(lcp::project(pre.problem().box(), *it.x)));
    WayTaken way;
    if (it.way != nullptr) {
      way = *it.way;
      for (lcp::Breakpoint& kink : way.kinks) kink.x = expanded(pre, kink.x);
      shown.way = &way;
    }
    return observer(shown);
  };
}

Result infeasible(const Mcp& mcp, In x0, const Presolved& pre, const Stop& stop, const Observer& observer) {
  Run run(mcp, stop, observer);
  Point point;
  if (run.start(x0, point))
    run.end(Status::Infeasible, "proven to have no solution: " + pre.infeasible(), "look for a mistake in the model");
  return run.result();
}

}  // namespace

Result run_path(const Mcp& mcp, In x0, const PathSearch& method, const Observer& observer) {
  if (!method.preprocess) return run_attempts(mcp, x0, method, observer);
  const auto begin = std::chrono::steady_clock::now();
  const auto elapsed = [begin] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin); };
  const Presolved pre = presolve(mcp, lcp::project(mcp.box(), x0));
  if (!pre.infeasible().empty()) return infeasible(mcp, x0, pre, method.stop, observer);
  if (&pre.problem() == &mcp) return run_attempts(mcp, x0, method, observer);

  PathSearch reduced = method;
  reduced.basis = shrunk(pre, method.basis);
  Result result = run_attempts(pre.problem(), pre.start(), reduced, in_full(mcp, pre, observer));
  result.x = pre.postsolve(result.x);
  result.basis = expanded(pre, mcp.box(), result.x, result.basis);
  result.stats.presolved = static_cast<int>(pre.counts().total());
  result.stats.F_evals += pre.F_evals();
  result.stats.J_evals += pre.J_evals();
  const bool accepted = result.accepted();
  judge_here(mcp, method.stop, result);
  if (accepted && !result.solved()) {
    // What was computed afterwards amplifies the residual: the last digits are the full problem's.
    PathSearch full = method;
    full.basis = result.basis;
    full.stop.max_iterations = std::max(0, method.stop.max_iterations - result.stats.iterations);
    full.stop.max_F_evals = std::max(1, method.stop.max_F_evals - result.stats.F_evals);
    full.cumulative_iteration_limit = std::max(1, method.cumulative_iteration_limit - result.stats.pivots);
    full.stop.max_time = std::max(std::chrono::duration<double>(0), method.stop.max_time - elapsed());
    const Stats before = result.stats;
    result = run_attempts(mcp, result.x, full, observer);
    result.stats += before;
  }
  result.stats.time = elapsed();
  return result;
}

}  // namespace perp::ncp

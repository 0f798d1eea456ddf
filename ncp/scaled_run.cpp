/// One attempt of PathSearch on the scaled problem.
#include <algorithm>
#include <utility>
#include <vector>

#include "ncp/methods.hpp"
#include "ncp/run.hpp"
#include "ncp/scaling.hpp"

namespace perp::ncp {
namespace {

/// What is demanded of the scaled residual where less could not be reached in double precision.
constexpr double least_tolerance = 1e-13;

/// x of the original normal map: z = C z' in the box, and beyond it (x' - z') / R, as F.
Vec unscaled(const ScaledMcp& scaled, const Scaling& factors, const Vec& x) {
  const Vec z = lcp::project(scaled.box(), x);
  return scaled.to_original(z) + (x - z).cwiseQuotient(factors.rows);
}

/// The user's observer sees the records of the problem as it is.
Observer in_original(const Mcp& mcp, const ScaledMcp& scaled, const Scaling& factors, const Observer& observer) {
  if (!observer) return {};
  return [&](const Iteration& it) {
    Iteration shown = it;
    shown.problem = &mcp;
    Vec x;
    if (it.x != nullptr) {
      shown.x = &(x = unscaled(scaled, factors, *it.x));
      const Vec z = lcp::project(mcp.box(), x);
      Vec F;
      CountedMcp guarded(mcp);  // for the observer: what the run itself evaluates is counted
      const Residual judged = guarded.eval(z, F) ? residual(mcp.box(), z, F) : Residual{};
      shown.residual = judged.natural;
      shown.worst = judged.worst;
    }
    WayTaken way;
    if (it.way != nullptr) {
      way = *it.way;
      for (lcp::Breakpoint& kink : way.kinks) kink.x = unscaled(scaled, factors, kink.x);
      shown.way = &way;
    }
    return observer(shown);
  };
}

}  // namespace

Result run_scaled(const Mcp& mcp, const Scaling& factors, In x0, const PathSearch& method, const Observer& observer) {
  const ScaledMcp scaled(mcp, factors);
  Stop limits = method.stop;
  limits.tol = std::max(least_tolerance, scaled.tolerance(method.stop.tol));
  const Observer shown = in_original(mcp, scaled, factors, observer);
  Run run(scaled, limits, shown);
  Point point;
  std::vector<lcp::Cell> basis;
  if (run.start(scaled.to_scaled(x0), point)) path_search(run, method, std::move(point), basis);
  Result result = run.result();
  result.basis = std::move(basis);
  result.x = lcp::project(mcp.box(), scaled.to_original(result.x));
  CountedMcp guarded(mcp);
  ++result.stats.F_evals;
  result.residual = guarded.eval(result.x, result.F) ? residual(mcp.box(), result.x, result.F) : Residual{};
  if (result.solved() && !(result.residual.natural <= method.stop.tol)) {
    result.status = Status::NoProgress;
    result.message = "the scaled problem was solved, but not to the tolerance of the problem itself";
    result.advice = "scale the model, or try a larger tolerance";
  }
  return result;
}

}  // namespace perp::ncp

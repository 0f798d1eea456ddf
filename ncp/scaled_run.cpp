/// Attempts on the scaled problem, and the retries that methods are given there.
#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <variant>
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

/// The user's observer sees the records of the problem as it is. Iterates are points of the normal map, or of R^n.
Observer in_original(const Mcp& mcp, const ScaledMcp& scaled, const Scaling& factors, bool normal_map,
                     const Observer& observer) {
  if (!observer) return {};
  return [&mcp, &scaled, &factors, normal_map, &observer](const Iteration& it) {
    Iteration shown = it;
    shown.problem = &mcp;
    Vec x;
    if (it.x != nullptr) {
      shown.x = &(x = normal_map ? unscaled(scaled, factors, *it.x) : scaled.to_original(*it.x));
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

Result run_scaled(const Mcp& mcp, const Scaling& factors, In x0, const Method& method, const RunMethod& run,
                  const Observer& observer) {
  const ScaledMcp scaled(mcp, factors);
  Method inner = method;
  const double tol = stop(method).tol;
  stop(inner).tol = std::max(least_tolerance, scaled.tolerance(tol));
  const bool normal_map = std::holds_alternative<PathSearch>(method);
  Result result = run(scaled, scaled.to_scaled(x0), inner, in_original(mcp, scaled, factors, normal_map, observer));
  result.x = lcp::project(mcp.box(), scaled.to_original(result.x));
  judge_here(mcp, stop(method), result);
  return result;
}

std::optional<Scaling> factors_at(Run& run, const Vec& x) {
  SpMat J = run.mcp().jacobian_pattern();
  if (!run.counted().jacobian(x, J)) return std::nullopt;
  Scaling factors = scaling(run.mcp(), J);
  return factors.after < factors.before ? std::optional(factors) : std::nullopt;
}

Result retry_scaled(const Mcp& mcp, In x0, const Method& method, int rescalings, Result stuck_at, const RunMethod& base,
                    const Observer& observer) {
  Stop limits = stop(method);
  limits.max_time = std::max(limits.max_time - stuck_at.stats.time, std::chrono::duration<double>(0));
  Run run(mcp, limits, observer);
  run.take(stuck_at);
  const Vec scaled_at[] = {stuck_at.x, lcp::project(mcp.box(), x0)};
  const char* const names[] = {"rows and columns scaled as at the best point", "rows and columns scaled"};
  int tried = 0;
  std::string last;
  for (int k = 0; k < std::min(rescalings, 2) && run.ended() && stuck(run.status()); ++k) {
    const std::optional<Scaling> factors = factors_at(run, scaled_at[k]);
    if (!factors) continue;
    const Run::Verdict before = run.verdict();
    Method limited = method;
    stop(limited) = run.left();
    run.resume(last = names[k]);
    run.take(run_scaled(mcp, *factors, x0, limited, base, run.counting_on()));
    ++tried;
    if (stuck(run.status())) run.replace_verdict(before);
  }
  run.stats().restarts += tried;
  if (tried > 0 && run.ended() && stuck(run.status()))
    run.remark(quantity(tried, "run") + " on the scaled problem " + (tried == 1 ? "has" : "have") +
               " not led to a solution either");
  Result result = run.result();
  result.stats.time += stuck_at.stats.time;
  if (result.solved() && tried > 0) result.message += ", after a restart: " + last;
  return result;
}

}  // namespace perp::ncp

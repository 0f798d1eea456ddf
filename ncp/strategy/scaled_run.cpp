// SPDX-License-Identifier: Apache-2.0
/// The retries on the scaled problem that methods are given.
#include <algorithm>
#include <optional>
#include <string>

#include "ncp/strategy/strategies.hpp"
#include "ncp/transforms/scale_transform.hpp"

namespace perp::ncp {

std::optional<Scaling> factors_at(Run& run, const Vec& x) {
  SpMat J = run.mcp().jacobian_pattern();
  if (!run.counted().jacobian(x, J)) return std::nullopt;
  Scaling factors = scaling(run.mcp(), J);
  return factors.after < factors.before ? std::optional(factors) : std::nullopt;
}

void retry_scaled(Run& run, In x0, int rescalings, const Body& base) {
  const Vec scaled_at[] = {run.best(), lcp::project(run.box(), x0)};
  constexpr std::string_view names[] = {scaled_at_best, scaled_at_start};
  int tried = 0;
  std::string last;
  for (int k = 0; k < std::min(rescalings, 2) && stuck(run) && !run.stalled(); ++k) {
    const std::optional<Scaling> factors = factors_at(run, scaled_at[k]);
    if (!factors) continue;
    const Run::Verdict before = run.verdict();
    run.resume(last = names[k]);
    run.take(run.within(ScaleTransform(run.mcp(), *factors), {}, x0, base));
    ++tried;
    if (stuck(run)) run.replace_verdict(before);
  }
  run.stats().restarts += tried;
  if (tried == 0) return;
  if (stuck(run))
    run.remark(quantity(tried, "run") + " on the scaled problem " + (tried == 1 ? "has" : "have") +
               " not led to a solution either");
  else if (run.status() == Status::Solved)
    run.remark("after a restart: " + last);
}

}  // namespace perp::ncp

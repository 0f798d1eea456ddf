// SPDX-License-Identifier: Apache-2.0
/// Methods on the presolved problem: the way there and back.

#include "ncp/strategy/strategies.hpp"
#include "ncp/transforms/presolve_transform.hpp"

namespace perp::ncp {

void run_presolved(Run& run, In x0, const std::vector<lcp::Cell>& basis,
                   const std::function<void(Run&, In, const std::vector<lcp::Cell>&)>& body) {
  const Vec start = lcp::project(run.box(), x0);
  const Presolved pre = presolve(run.mcp(), start);
  if (!pre.infeasible().empty()) {
    Point point;
    if (!run.start(x0, point) || run.ended() || run.disprove({}, pre.infeasible())) return;
    return body(run, x0, basis);  // rounding may have made the contradiction
  }
  if (&pre.problem() == &run.mcp()) return body(run, x0, basis);

  const PresolveTransform way(run.mcp(), pre);
  const std::vector<lcp::Cell> reduced = way.there(basis);
  bool accepted = false;
  const Result result = run.within(
      way, {}, start, [&](Run& inner, In z0) { body(inner, z0, reduced); }, &accepted);
  run.take(result);
  run.stats().presolved = static_cast<int>(pre.counts().total());
  run.stats().F_evals += pre.F_evals();
  run.stats().J_evals += pre.J_evals();
  if (!accepted || result.solved()) return;
  // What was computed afterwards amplifies the residual: the last digits are the full problem's.
  run.resume("on the problem that was not presolved");
  body(run, result.x, result.basis);
}

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#include "ncp/path/newton_robinson.hpp"

#include <algorithm>
#include <string>

#include "ncp/path/newton_point.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {
void iterate(Run& run, const NewtonRobinson& method, Point point) {
  const lcp::LemkeOptions options = linearised_options(run, method.lemke);
  Vec y = normal_point(run.box(), point.x, point.F);
  Iteration it{.k = 0, .kind = 'I'};
  it.merit = 0.5 * (point.F + y - point.x).squaredNorm();

  while (run.go_on(point, it)) {
    const lcp::PivotResult path = path_or_rays(linearised(run.box(), point, 0), y, options);
    run.stats().factorizations += path.refactorizations;
    it = {.k = it.k + 1, .step = 1, .pivots = path.pivots, .kind = 'N'};
    if (stopped(path)) continue;  // the run says so
    if (!path.solved()) {
      run.end(Status::SubproblemFailed,
              "the linearised problem could not be solved (" + std::string(lcp::to_string(path.end)) + ")",
              "try the method path, which searches along the way to such points, or another start");
      break;
    }
    point.x = lcp::project(run.box(), path.x);
    y = path.x;
    if (!run.evaluate(point)) {
      run.end(Status::EvaluationFailed, "F or its Jacobian is not defined at the Newton point",
              "try the method path, which shortens such steps, or another start");
      break;
    }
    it.merit = 0.5 * (point.F + y - point.x).squaredNorm();
  }
}

void describe(NewtonRobinson& m, Fields& f) {
  describe_start(m.lemke.start, f);
  describe(m.lemke, f);
}

}  // namespace perp::ncp

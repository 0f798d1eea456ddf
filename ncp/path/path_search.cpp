// SPDX-License-Identifier: Apache-2.0
#include "ncp/path/path_search.hpp"

#include "ncp/path/crash.hpp"
#include "ncp/path/path_steps.hpp"

namespace perp::ncp {
namespace {

/// An iterate beyond this, relative to 1 + |start|, that is no solution has left for infinity.
constexpr double far_away = 1e15;

bool ran_off(Run& run, const Point& point, double start) {
  Index i = 0;
  if (point.x.size() == 0 || point.x.cwiseAbs().maxCoeff(&i) <= far_away * (1 + start)) return false;
  run.end(Status::Unbounded,
          "variable " + run.mcp().variable_name(i) + " has run off to " + number(point.x[i]) + " without a solution",
          "bound it, or look for a mistake in the model: it may have no solution");
  return true;
}

}  // namespace

void iterate(Run& run, const PathSearch& method, Point point) {
  lcp::SharedLu lu{lcp::SparseLu(lcp::LuBackend::Auto)};  // of J_II
  lu.lu.reuse_pivots();  // in affine problems, too: their crash is the same one, observed or not
  Iteration it{.k = 0, .kind = 'I', .normal_map = true};
  it.crash = method.crash.on && run.box().size() >= method.crash.minimum_dimension;
  it.merit = merit(fischer_merit(), run.box(), point.x, point.F);
  if (!run.go_on(point, it)) return;
  const CrashEnd crashed = crash(run, method.crash, point, it, lu.lu);
  if (crashed == CrashEnd::Over) return;
  const double start = point.x.size() > 0 ? point.x.lpNorm<Eigen::Infinity>() : 0;
  PathSteps steps(run, method, point, crashed, lu);
  do {
    if (ran_off(run, point, start)) break;
    if (steps.stalled(method.patience)) {
      run.end(Status::NoProgress, "the merit function has stopped falling", "try another start");
      break;
    }
    if (!steps.iterate(it)) {
      run.go_on(point, it);
      break;
    }
  } while (run.go_on(point, it));
  run.keep_basis(steps.basis());
}

}  // namespace perp::ncp

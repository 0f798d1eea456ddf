// SPDX-License-Identifier: Apache-2.0
#include "ncp/reformulation/line_search.hpp"

#include <utility>

namespace perp::ncp {

SearchOutcome line_search(Run& run, const CFunction& c, const Armijo& rule, In d, double slope, double reference,
                          bool projected, Point& point, double longest) {
  SearchOutcome out;
  Point trial;
  double t = longest;
  for (; out.backtracks <= rule.max_backtracks; ++out.backtracks, t *= rule.beta) {
    trial.x = point.x + t * d;
    if (projected) trial.x = trial.x.cwiseMax(run.box().lower).cwiseMin(run.box().upper);  // without a copy
    if (trial.x == point.x) break;  // t d has vanished in rounding
    if (!run.counted().eval(trial.x, trial.F)) {
      ++out.undefined;
      continue;
    }
    out.merit = merit(c, run.box(), trial.x, trial.F);
    if (!(out.merit <= reference + rule.sigma * t * slope)) continue;
    if (run.mcp().is_affine()) {
      trial.J.swap(point.J);  // it is constant
    } else if (!run.counted().jacobian(trial.x, trial.J)) {
      ++out.undefined;
      continue;
    }
    std::swap(point, trial);
    out.found = true;
    out.t = t;
    return out;
  }
  return out;
}

bool Searches::along(In d, double slope, Point& point) {
  last_ = line_search(run_, c_, rule_, d, slope, reference_, true, point);
  it_.backtracks += last_.backtracks;
  undefined_ += last_.undefined;
  return last_.found;
}

}  // namespace perp::ncp

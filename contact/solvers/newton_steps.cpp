// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/newton_steps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace perp::contact {

template <int Size>
bool newton_steps(Referee& referee, const Scaled& problem, AlartCurnierOf<Size>& newton, Vec r,
                  const NewtonSteps& steps) {
  double last = natural_map(problem, r);
  double lowest = last;
  for (int k = 0, since = 0; k < steps.most && since < steps.patience && last <= steps.most_growth * lowest; ++k) {
    Vec to;
    if (!newton.step(r, r, steps.alpha, to)) return false;
    ++referee.stats.newton_steps;
    Vec d = to - r;
    double least = lcp::infinity;
    int halved = 0;
    for (int i = 0; i <= steps.halvings && !(least <= steps.decrease * last); ++i, d *= 0.5) {
      const double now = natural_map(problem, r + d);
      if (!(now < least)) continue;
      least = now;
      halved = i;
      to = r + d;
    }
    if (!std::isfinite(least)) return false;
    r = std::move(to);
    last = least;
    const Origin by = halved > 0 ? Origin::DampedNewton : steps.full;
    if (referee.judge(r, {.by = by, .alpha = steps.alpha})) return true;
    since = last <= steps.decrease * lowest ? 0 : since + 1;
    lowest = std::min(lowest, last);
  }
  return false;
}

template bool newton_steps<3>(Referee&, const Scaled&, AlartCurnierOf<3>&, Vec, const NewtonSteps&);
template bool newton_steps<5>(Referee&, const Scaled&, AlartCurnierOf<5>&, Vec, const NewtonSteps&);

}  // namespace perp::contact

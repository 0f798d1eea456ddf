// SPDX-License-Identifier: Apache-2.0
#include "ncp/methods/active_set_step.hpp"

#include <algorithm>
#include <utility>

#include "lcp/linalg/blocks.hpp"

namespace perp::ncp {

using lcp::BoundState;

std::vector<BoundState> active_set(const Box& box, const Point& point) {
  std::vector<BoundState> active(static_cast<std::size_t>(point.x.size()), BoundState::Free);
  for (Index i = 0; i < point.x.size(); ++i) {
    const double t = point.x[i] - point.F[i];
    if (t <= box.lower[i] || box.lower[i] == box.upper[i])
      active[static_cast<std::size_t>(i)] = BoundState::AtLower;
    else if (t >= box.upper[i])
      active[static_cast<std::size_t>(i)] = BoundState::AtUpper;
  }
  return active;
}

bool active_set_step(Run& run, const Point& point, const std::vector<BoundState>& active, lcp::LuBackend backend,
                     Vec& to) {
  const Index n = point.x.size();
  const Box& box = run.box();
  Vec d = Vec::Zero(n);
  std::vector<Index> I;
  for (Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (active[k] == BoundState::AtLower) d[i] = box.lower[i] - point.x[i];
    if (active[k] == BoundState::AtUpper) d[i] = box.upper[i] - point.x[i];
    if (active[k] == BoundState::Free) I.push_back(i);
  }
  const auto m = static_cast<Index>(I.size());
  if (m > 0) {
    const Vec moved = point.F + point.J * d;
    Vec rhs(m);
    for (Index k = 0; k < m; ++k) rhs[k] = -moved[I[static_cast<std::size_t>(k)]];
    ++run.stats().factorizations;
    lcp::SparseLu lu(backend, run.deadline());
    if (!lu.try_factor(lcp::principal_block(point.J, I))) return false;
    Vec free(m);
    lu.solve(rhs, free);
    if (!free.allFinite()) return false;
    for (Index k = 0; k < m; ++k) d[I[static_cast<std::size_t>(k)]] = free[k];
  }
  to = lcp::project(box, point.x + d);
  return true;
}

bool ActiveSetFinish::step(Run& run, const Point& point, lcp::LuBackend backend, Point& to) {
  constexpr double share = 0.5;
  std::vector<lcp::BoundState> now = active_set(run.box(), point);
  const bool settled = now == active_;
  active_ = std::move(now);
  if (!settled || pause_-- > 0) return false;
  if (active_set_step(run, point, active_, backend, to.x) && run.counted().eval(to.x, to.F) &&
      residual(run.box(), to.x, to.F).natural <= share * residual(run.box(), point.x, point.F).natural &&
      run.counted().jacobian(to.x, to.J)) {
    pause_ = 0;
    return true;
  }
  pause_ = 1 << std::min(failures_++, 5);
  return false;
}

}  // namespace perp::ncp

#include "ncp/active_set_step.hpp"

#include "lcp/blocks.hpp"

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
    lcp::SparseLu lu(backend);
    if (lu.factor(lcp::principal_block(point.J, I)) != lcp::LuStatus::Ok) return false;
    Vec free(m);
    lu.solve(rhs, free);
    if (!free.allFinite()) return false;
    for (Index k = 0; k < m; ++k) d[I[static_cast<std::size_t>(k)]] = free[k];
  }
  to = lcp::project(box, point.x + d);
  return true;
}

}  // namespace perp::ncp

#include "ncp/residual.hpp"

#include <algorithm>
#include <cmath>

namespace perp::ncp {

Residual residual(const Box& box, In x, In F) {
  Residual r;
  r.natural = 0;
  for (Index i = 0; i < x.size(); ++i) {
    if (!std::isfinite(F[i]) || !std::isfinite(x[i])) {
      r.natural = infinity;
      r.worst = i;
      return r;
    }
    const double natural = std::abs(x[i] - lcp::project(box, i, x[i] - F[i]));
    if (natural > r.natural || r.worst < 0) {
      r.natural = natural;
      r.worst = i;
    }
    r.bounds = std::max(r.bounds, std::abs(x[i] - lcp::project(box, i, x[i])));
    r.complementarity = std::max({r.complementarity, std::min(std::max(x[i] - box.lower[i], 0.0), std::max(F[i], 0.0)),
                                  std::min(std::max(box.upper[i] - x[i], 0.0), std::max(-F[i], 0.0))});
  }
  return r;
}

Residual residual(const Mcp& mcp, In x) {
  Vec F = Vec::Zero(x.size());
  if (mcp.eval(x, F)) return residual(mcp.box(), x, F);
  Residual r = residual(mcp.box(), x, F);  // finds an undefined row if one was marked
  if (std::isfinite(r.natural)) r = Residual{};
  return r;
}

}  // namespace perp::ncp

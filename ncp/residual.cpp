#include "ncp/residual.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace perp::ncp {

Residual residual(const Box& box, In x, In F) {
  if (x.size() != box.size() || F.size() != box.size())
    throw std::invalid_argument("residual: x has " + std::to_string(x.size()) + " entries, F " +
                                std::to_string(F.size()) + ", the box " + std::to_string(box.size()));
  Residual r;
  r.natural = 0;
  for (Index i = 0; i < x.size(); ++i) {
    if (!std::isfinite(F[i]) || !std::isfinite(x[i])) {
      r.natural = infinity;
      r.worst = i;
      return r;
    }
    // x - mid(l, x - F, u) = mid(x - u, F, x - l), which does not lose F beside a large x.
    const double natural = std::abs(std::min(std::max(F[i], x[i] - box.upper[i]), x[i] - box.lower[i]));
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
  if (x.size() != mcp.size()) return residual(mcp.box(), x, F);  // refuses it
  if (mcp.eval(x, F)) return residual(mcp.box(), x, F);
  Residual r = residual(mcp.box(), x, F);  // finds an undefined row if one was marked
  if (std::isfinite(r.natural)) r = Residual{};
  return r;
}

}  // namespace perp::ncp

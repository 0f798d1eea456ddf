#pragma once
/// The one judge. r(x) = || x - mid(l, x - F(x), u) ||_inf is zero exactly at the solutions of MCP(l, u, F); it knows
/// no method, no merit function and no scaling, and nothing else may call a point solved.
#include "ncp/mcp.hpp"

namespace perp::ncp {

struct Residual {
  double natural = infinity;   ///< || x - mid(l, x - F, u) ||_inf; +inf where F is not defined
  Index worst = -1;            ///< index of the largest entry; of the first undefined equation where F is not defined
  double bounds = 0;           ///< || x - mid(l, x, u) ||_inf
  double complementarity = 0;  ///< || min(x - l, F+) ||_inf and || min(u - x, F-) ||_inf: the larger
};

/// Of given values F = F(x). A NaN or infinity in x or F gives natural = +inf at that index. Throws
/// std::invalid_argument if x, F and the box have not one length.
Residual residual(const Box& box, In x, In F);
/// Evaluates F itself.
Residual residual(const Mcp& mcp, In x);

}  // namespace perp::ncp

#pragma once
/// The methods' entry points behind solve(); private to ncp/.
#include "ncp/solve.hpp"

namespace perp::ncp {

Result run_semismooth_newton(const Mcp& mcp, In x0, const SemismoothNewton& method, const Observer& observer);
Result run_newton_josephy(const Mcp& mcp, In x0, const NewtonJosephy& method, const Observer& observer);
Result run_affine(const Mcp& mcp, In x0, const Affine& method, const Observer& observer);

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#include "lcp/box.hpp"

#include <algorithm>
#include <sstream>

namespace perp::lcp {

Box Box::free(Index n) { return {Vec::Constant(n, -infinity), Vec::Constant(n, infinity)}; }

Box Box::nonnegative(Index n) { return {Vec::Zero(n), Vec::Constant(n, infinity)}; }

std::optional<Index> Box::first_invalid() const {
  for (Index i = 0; i < size(); ++i)
    if (!(lower[i] <= upper[i]) || lower[i] == infinity || upper[i] == -infinity) return i;
  return std::nullopt;
}

std::optional<std::string> Box::invalid() const {
  if (lower.size() != upper.size()) {
    std::ostringstream why;
    why << "the box has " << lower.size() << " lower bounds and " << upper.size() << " upper bounds";
    return why.str();
  }
  if (const auto i = first_invalid()) {
    std::ostringstream why;
    why.precision(17);
    why << "[lower, upper] of index " << *i << " is [" << lower[*i] << ", " << upper[*i]
        << "], which is not an interval";
    return why.str();
  }
  return std::nullopt;
}

double project(const Box& box, Index i, double z) {
  return z < box.lower[i] ? box.lower[i] : z > box.upper[i] ? box.upper[i] : z;
}

Vec project(const Box& box, In z) { return z.cwiseMax(box.lower).cwiseMin(box.upper); }

Cell cell_of(const Box& box, Index i, double z, double tol) {
  if (box.lower[i] == box.upper[i]) return Cell::Fixed;
  const double above_lower = z - box.lower[i];
  const double below_upper = box.upper[i] - z;
  if (!(std::min(above_lower, below_upper) <= tol)) return Cell::Inside;
  return above_lower <= below_upper ? Cell::Below : Cell::Above;
}

}  // namespace perp::lcp

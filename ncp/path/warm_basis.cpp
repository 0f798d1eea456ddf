// SPDX-License-Identifier: Apache-2.0
#include "ncp/path/warm_basis.hpp"

#include <cmath>

namespace perp::ncp {
namespace {

/// Does the box have the bound that the cell is beyond?
bool allowed(const lcp::Box& box, lcp::Index i, lcp::Cell cell) {
  const bool fixed = box.lower[i] == box.upper[i];
  switch (cell) {
    case lcp::Cell::Below:
      return !fixed && std::isfinite(box.lower[i]);
    case lcp::Cell::Inside:
      return !fixed;
    case lcp::Cell::Above:
      return !fixed && std::isfinite(box.upper[i]);
    case lcp::Cell::Fixed:
      return fixed;
  }
  return false;
}

/// That of the value.
lcp::Cell cell_at(const lcp::Box& box, lcp::Index i, double x) {
  if (box.lower[i] == box.upper[i]) return lcp::Cell::Fixed;
  if (x <= box.lower[i]) return lcp::Cell::Below;
  return x >= box.upper[i] ? lcp::Cell::Above : lcp::Cell::Inside;
}

}  // namespace

lcp::Index fit_basis(const lcp::Box& box, lcp::In x, std::vector<lcp::Cell>& basis) {
  lcp::Index adapted = 0;
  for (lcp::Index i = 0; i < box.size(); ++i)
    if (lcp::Cell& cell = basis[lcp::at(i)]; !allowed(box, i, cell)) {
      cell = cell_at(box, i, x[i]);
      ++adapted;
    }
  return adapted;
}

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A basis of an earlier run, for a box that may have changed since.
#include <vector>

#include "lcp/box.hpp"
#include "lcp/pivoting/lemke.hpp"

namespace perp::ncp {

/// Cells that the box does not allow any more, such as Below of a variable without a lower bound, become those of x.
/// How many. Pre: a cell and an entry of x for each variable.
lcp::Index fit_basis(const lcp::Box& box, lcp::In x, std::vector<lcp::Cell>& basis);

}  // namespace perp::ncp

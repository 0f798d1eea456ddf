// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Smallest sets of demands (ncp/analysis/demands.hpp) that contradict each other. Private to ncp/. Reference:
/// Chinneck, Feasibility and Infeasibility in Optimization (2008), chapters 2 and 6.
#include <optional>

#include "lcp/deadline.hpp"
#include "lcp/judge/refutation.hpp"
#include "ncp/analysis/demands.hpp"
#include "ncp/problem/mcp.hpp"
#include "ncp/run/result.hpp"

namespace perp::ncp {

struct Conflict {
  Demands demands{};
  bool smallest = false;  ///< without any one of them no contradiction was found
  /// With the certificate; none: the numbers say so, and no exact proof was found.
  Infeasibility proof{};
};

/// A smallest set of demands that contradict each other, by deletion of halves, quarters, ... and at last of single
/// ones, each time down to the multipliers of a new proof. Begins with `first`; nothing if these can be met.
std::optional<Conflict> smallest_conflict(const LinearDemands& all, Demands first, lcp::Deadline deadline);

/// The same for proofs that need complementarity: rows that propagation of bounds refutes (lcp/judge/propagation.hpp).
Conflict smallest_conflict(const lcp::AffineMcp& problem, const lcp::Refutation& certificate, double tol,
                           lcp::Deadline deadline);

/// The same for proofs by ranges of F (ncp/analysis/no_solution.hpp), of rows and the bounds over which they are taken;
/// nothing: that proves nothing.
std::optional<Conflict> smallest_conflict(const Mcp& mcp, double tol, lcp::Deadline deadline);

}  // namespace perp::ncp

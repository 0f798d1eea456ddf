// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Methods on what the structure of J makes of a problem. Private to ncp/.
#include "ncp/run/run.hpp"

namespace perp::ncp {

/// Runs `body` on the problem with its equations in the order that lcp::equation_order() finds, if there is another
/// one.
void run_in_order(Run& run, In x0, const Body& body);

/// Returns whether J of a nonlinear problem is block triangular, in some order of its equations: its pattern, or what
/// of it is not zero near x0.
bool block_triangular(Run& run, In x0);
/// Solves the diagonal blocks one after the other by `body`, several together as long as that goes well. Blocks with
/// inequalities are complementarity problems of their own.
void run_blocks(Run& run, In x0, const Body& body);

}  // namespace perp::ncp

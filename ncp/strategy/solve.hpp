// SPDX-License-Identifier: Apache-2.0
#pragma once
/// solve(): runs a method (ncp/strategy/plan.hpp). Only the judge (ncp/problem/residual.hpp) may call the outcome
/// Solved.
#include <vector>

#include "ncp/run/observe.hpp"
#include "ncp/run/result.hpp"
#include "ncp/strategy/lists.hpp"
#include "ncp/strategy/plan.hpp"

namespace perp::ncp {

/// Solves the MCP from the projection of x0 on the box. Throws std::invalid_argument for wrong input: what
/// check_input() and invalid(method) refuse, a J that does not keep its pattern, a basis of another size. Every other
/// outcome is a Status with a message. Out of memory, std::bad_alloc leaves solve() (lcp::NotEnoughMemory where an
/// estimate says so), and objects may only be destroyed. A time limit is honoured between two factorizations. The first
/// PathSearch in the method begins with `basis`, Result::basis of a nearby problem.
Result solve(const Mcp& mcp, In x0, const Method& method, const Observer& observer = {},
             const std::vector<lcp::Cell>& basis = {});

}  // namespace perp::ncp

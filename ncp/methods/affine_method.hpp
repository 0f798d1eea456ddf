// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lcp/solve/solve.hpp"
#include "ncp/problem/mcp.hpp"
#include "ncp/run/options.hpp"

namespace perp::ncp {

/// Affine problems (Mcp::is_affine) only, by a method of lcp/. Stop::max_iterations has no meaning but 0.
struct Affine {
  Stop stop{};
  lcp::Method method{};
};
void describe(Affine& method, Fields& fields);
inline std::string_view name_of(const Affine& method) { return lcp::name(method.method); }
/// Its loop is in lcp/: one iteration.
void affine(Run& run, In x0, const Affine& method);

}  // namespace perp::ncp

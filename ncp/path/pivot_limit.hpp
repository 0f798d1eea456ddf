// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How long paths of linearised problems may become.
#include "lcp/types.hpp"

namespace perp::ncp {

using lcp::Index;

/// Returns 1000 + 20 n, the most pivots that a linearised problem of n variables may take; a regular path takes a small
/// multiple of n. In the nonlinear methods LemkeOptions::max_pivots has no effect above this limit.
int worthwhile_pivots(Index n);

}  // namespace perp::ncp

#pragma once
/// How long paths of linearised problems may become.
#include "lcp/types.hpp"

namespace perp::ncp {

using lcp::Index;

/// 1000 + 20 n: more pivots than a linearised problem of n variables is worth, since a regular path takes a small
/// multiple of n. LemkeOptions::max_pivots of the nonlinear methods has no effect above it.
int worthwhile_pivots(Index n);

}  // namespace perp::ncp

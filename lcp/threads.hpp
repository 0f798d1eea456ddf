// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Many instances in threads.
#include <functional>

#include "lcp/types.hpp"

namespace perp::lcp {

/// Calls one(k) once for each k < count. Every thread makes its own `one`, and so has memory of its own. threads 0: as
/// many as there are processors. Throws what a thread threw first; the others then end early.
void in_threads(Index count, int threads, const std::function<std::function<void(Index)>()>& make);

}  // namespace perp::lcp

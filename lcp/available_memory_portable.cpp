// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <limits>

#include "lcp/memory.hpp"

namespace perp::lcp {

// Not known, but addresses reach no further. Where a system gives no memory that it does not have, as Windows and
// WebAssembly, its refusal is enough.
double available_memory() { return static_cast<double>(std::numeric_limits<std::size_t>::max()); }

}  // namespace perp::lcp

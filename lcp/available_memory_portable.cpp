// SPDX-License-Identifier: Apache-2.0
#include "lcp/memory.hpp"

namespace perp::lcp {

// Not known. Where a system gives no memory that it does not have, as Windows and WebAssembly, its refusal is enough.
double available_memory() { return 9007199254740992; }

}  // namespace perp::lcp

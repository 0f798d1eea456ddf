// SPDX-License-Identifier: Apache-2.0
#include <windows.h>

#include <algorithm>

#include "lcp/memory.hpp"

namespace perp::lcp {

/// Memory that is free, and that Windows would still promise this process, files for paging included.
double available_memory() {
  MEMORYSTATUSEX memory{};
  memory.dwLength = sizeof memory;
  if (GlobalMemoryStatusEx(&memory) == 0) return 9007199254740992;  // 2^53 bytes: not known
  return static_cast<double>(std::min({memory.ullAvailPhys, memory.ullAvailPageFile, memory.ullAvailVirtual}));
}

}  // namespace perp::lcp

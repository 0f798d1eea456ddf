// SPDX-License-Identifier: Apache-2.0
#pragma once
/// METIS works for one thread at a time: it draws from rand(), which is the process', so that two could get other
/// orderings than each alone, and it exchanges the process' handlers of SIGABRT and SIGTERM. Private to lcp/.
#include <mutex>

namespace perp::lcp {

/// To be held where CHOLMOD or UMFPACK may call METIS.
inline std::mutex& metis_lock() {
  static std::mutex lock;
  return lock;
}

}  // namespace perp::lcp

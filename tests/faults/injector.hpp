// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Makes one call of malloc, calloc, realloc, the aligned ones or operator new fail. The program's own definitions of
/// these (injector.cpp) stand before the C library's, and before a sanitizer's, and hand on to them.
///
/// Counted are calls of the thread that armed, made from the program itself (perp, Eigen), SuiteSparse and GSL; and
/// operator new from the C++ library too, where the strings and streams of perp live.
#include <cstddef>

namespace perp::faults {

/// While it lives, call number `k` of those counted fails, from 1; 0: none does. One at a time.
class Armed {
 public:
  explicit Armed(long k);
  Armed(const Armed&) = delete;
  Armed& operator=(const Armed&) = delete;
  ~Armed();
  /// Counted so far.
  static long calls();
  /// Whether one has failed.
  static bool failed();
};

/// Prints where the call comes from that fails.
void trace(bool on);

/// Counts, in place of the above, what the module whose file name begins so asks for; empty: back.
void count_only(const char* module);

}  // namespace perp::faults

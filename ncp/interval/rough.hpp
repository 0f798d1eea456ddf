// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Ranges that are good enough to see that there is nothing to prove. Private to ncp/.

namespace perp::ncp {

/// While one lives, this thread's exp, log, log10, sin, cos and power of intervals come from the C library's functions,
/// right to a few units in the last place instead of rounded outwards: by MPFI they take hundreds of times as long.
/// Such ranges prove nothing.
class RoughRanges {
 public:
  RoughRanges();
  ~RoughRanges();
  RoughRanges(const RoughRanges&) = delete;
  RoughRanges& operator=(const RoughRanges&) = delete;

 private:
  bool before_;
};

}  // namespace perp::ncp

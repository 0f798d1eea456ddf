// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "lcp/types.hpp"

namespace perp::lcp {

/// Whether J = J' up to tol max(|J_ij|, |J_ji|, sqrt|J_ii J_jj|), entry by entry; the default allows for the rounding
/// of assembling each entry twice. Ends at the first entry that is not; O(entries) time, O(n) memory.
bool symmetric(const SpMat& J, double tol = 1e-13);

}  // namespace perp::lcp

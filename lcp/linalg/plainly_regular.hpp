// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Tells small matrices that are far from singular. A dense factorization says so of most Jacobians at solutions, and
/// takes fewer instructions than what looks for a reason.
#include "lcp/types.hpp"

namespace perp::lcp {

/// True: the reciprocal condition number is above 1e-9, far from what is called singular anywhere. False: it is not, or
/// B is larger than 40 x 40, where sparse factorizations are as quick.
bool plainly_regular(const SpMat& B);

}  // namespace perp::lcp

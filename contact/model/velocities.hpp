// SPDX-License-Identifier: Apache-2.0
#pragma once
/// u = W r + q and the sizes of what is added up in it, for the judge: in twice the working precision, and
/// without rounding in rows where that is not enough, so that q is not lost beside a huge W r. O(entries of W).
/// Private to contact/.
#include "contact/model/problem.hpp"

namespace perp::contact {

struct Velocities {
  Vec u;      ///< W r + q, each entry to a few eps of itself
  Vec terms;  ///< |W| |r| + |q|
};
/// Infinite or NaN where a product overflows.
Velocities exact_velocities(const Problem& problem, In r);

}  // namespace perp::contact

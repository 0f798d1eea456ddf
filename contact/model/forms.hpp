// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Choice between the entries of W = H' M^-1 H and its parts (delassus.hpp), made before any number of either is
/// computed. Private to contact/.
#include "contact/model/scaling.hpp"

namespace perp::contact {

/// Tells whether W has few entries beside those of H, M and M's factor.
bool entries_take_less(const DelassusParts& parts, const std::vector<Scaled::Block>& blocks);

}  // namespace perp::contact

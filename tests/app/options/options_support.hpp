// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Options as the tests give them.
#include <vector>

#include "app/options/options.hpp"

namespace perp::app::test {

inline Applied applied(std::vector<Assignment> assignments, Unknown unknown = Unknown::Refuse) {
  for (Assignment& given : assignments)
    if (given.source.empty()) given.source = "test";
  return apply_options(assignments, unknown);
}

}  // namespace perp::app::test

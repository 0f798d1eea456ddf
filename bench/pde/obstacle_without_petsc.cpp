// SPDX-License-Identifier: Apache-2.0
#include "obstacle.hpp"

namespace perp::bench {

std::vector<Measurement> petsc(const lcp::AffineMcp&, const lcp::Vec&, double, const std::vector<std::string>&) {
  return {};
}

}  // namespace perp::bench

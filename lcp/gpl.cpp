// SPDX-License-Identifier: Apache-2.0
#include "lcp/gpl.hpp"

namespace perp::lcp {

bool left_out(std::string_view name) { return !gpl_linked() && (name == "umfpack" || name.starts_with("gsl-")); }

std::string not_in_this_build(std::string_view name) {
  return std::string(name) + " is not in this build: built with PERP_GPL=OFF";
}

}  // namespace perp::lcp

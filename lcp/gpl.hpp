// SPDX-License-Identifier: Apache-2.0
#pragma once
/// CMake's option PERP_GPL decides which files are compiled: those over UMFPACK, CHOLMOD and GSL, whose licence is the
/// GPL, or others of the same interface.
#include <string>
#include <string_view>

namespace perp::lcp {

/// Whether this build has the former.
bool gpl_linked();
/// Whether this is a name of an option's value or a method that only a build with them has: "umfpack", "gsl-hybridsj".
bool left_out(std::string_view name);
/// "umfpack is not in this build: built with PERP_GPL=OFF".
std::string not_in_this_build(std::string_view name);

}  // namespace perp::lcp

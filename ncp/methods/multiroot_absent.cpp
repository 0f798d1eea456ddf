// SPDX-License-Identifier: Apache-2.0
/// GSL's solvers in a build without GSL.
#include "lcp/gpl.hpp"
#include "ncp/methods/multiroot.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {

void iterate(Run& run, const Multiroot& method, Point point) {
  if (!run.ended()) run.end(Status::NotApplicable, lcp::not_in_this_build(to_string(method.solver)), "--method path");
  (void)run.go_on(point, {.k = 0, .kind = 'I'});
}

}  // namespace perp::ncp

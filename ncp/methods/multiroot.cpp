// SPDX-License-Identifier: Apache-2.0
#include "ncp/methods/multiroot.hpp"

#include <array>

#include "ncp/run/run.hpp"

namespace perp::ncp {

std::string_view to_string(MultirootSolver solver) {
  constexpr std::array<std::string_view, 4> names{"gsl-hybridsj", "gsl-hybridj", "gsl-newton", "gsl-gnewton"};
  return names[static_cast<std::size_t>(solver)];
}

void describe(Multiroot& m, Fields& f) {
  using enum MultirootSolver;
  f.choice("gsl_solver", &m.solver,
           {{"hybridsj", Hybridsj}, {"hybridj", Hybridj}, {"newton", Newton}, {"gnewton", Gnewton}},
           "gsl: hybridsj (Powell's hybrid method, scaled), hybridj (unscaled), newton (undamped) or gnewton (damped)");
}

}  // namespace perp::ncp

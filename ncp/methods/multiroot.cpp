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
  f.add("gsl_mu", &m.mu, strictly_between(0, 1e100), "gsl: first mu of the smoothed equations");
  f.add("gsl_shrink", &m.shrink, strictly_between(0, 1), "gsl: factor of mu from stage to stage");
  f.add("gsl_mu_end", &m.mu_end, strictly_between(0, 1e100), "gsl: last mu; at most gsl_mu");
  f.add("gsl_max_size", &m.max_size, at_least(0), "gsl: problems of more variables are refused");
  f.check(m.mu_end <= m.mu, "gsl_mu_end", m.mu_end, "at most gsl_mu");
}

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#include "pde.hpp"

namespace perp::bench {

std::vector<std::string> petsc_solvers() { return {}; }
PdeRun petsc(const std::string& solver, const ncp::Mcp&, const ncp::Vec& x0, double, double) {
  return {.solver = solver, .x = x0, .remark = "no PETSc in this build"};
}

}  // namespace perp::bench

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The problems that pde.cpp measures, and what a solver of one reports.
#include <string>
#include <vector>

#include "ncp/problem/mcp.hpp"

namespace perp::bench {

struct PdeRun {
  std::string solver;
  double seconds = 0;
  int iterations = 0;  ///< Newton steps, or steps on the finest grid
  ncp::Vec x{};
  std::string remark{};
};

/// The names of PETSc's solvers for complementarity problems, each with one linear solver; none in a build without it.
std::vector<std::string> petsc_solvers();
/// One of them, from x0, until the natural residual is at most tol, for at most `limit` seconds.
PdeRun petsc(const std::string& solver, const ncp::Mcp& mcp, const ncp::Vec& x0, double tol, double limit);

}  // namespace perp::bench

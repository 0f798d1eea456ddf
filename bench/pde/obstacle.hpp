// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The obstacle problem that obstacle.cpp measures, and what a solver of it reports.
#include <string>
#include <vector>

#include "lcp/affine_mcp.hpp"

namespace perp::bench {

/// Unit square, v = 0 on its boundary, N x N interior points (x_i, y_j) = (i h, j h), h = 1 / (N + 1):
///     v >= psi,   psi = 0.1 - (x - 1/2)^2 - (y - 1/2)^2,   -Laplace v >= -1e-6, one of the two with equality at a
///     point.
/// M is the five-point stencil times h^2 (4 and -1), q = 1e-6 h^2.
lcp::AffineMcp obstacle(int N);
/// max(0, psi).
lcp::Vec obstacle_start(const lcp::AffineMcp& problem);

struct Measurement {
  std::string solver;
  double seconds = 0;
  lcp::Vec z;
  std::string remark;
};

/// PETSc's solvers for variational inequalities and bound-constrained programs, each to a natural residual of at most
/// `tol`; those that `skip` names are left out. Empty in a build without PETSc.
std::vector<Measurement> petsc(const lcp::AffineMcp& problem, const lcp::Vec& start, double tol,
                               const std::vector<std::string>& skip);

}  // namespace perp::bench

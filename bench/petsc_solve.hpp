// SPDX-License-Identifier: Apache-2.0
#pragma once
/// PETSc's methods for complementarity problems, SNESVI and TAO: what petsc_peer, bench_pde and bench_obstacle share.
#include "bench/peers/peer.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::bench {

/// The method and its linear solver are what PETSc's options say.
struct PetscTask {
  bool tao = false;     ///< TAO, else SNESVI
  bool natural = true;  ///< until the natural residual is at most tol, else by PETSc's own tests with tol
  /// F is affine with a symmetric positive definite matrix: TAO minimises the quadratic function whose gradient F is.
  bool gradient = false;
  double tol = 1e-8;
  int iterations = 500;  ///< at most so many
  double seconds = 1e8;  ///< looked at once an iteration
};

struct PetscAnswer {
  PeerAnswer peer{};
  int iterations = 0;
  double seconds = 0;  ///< of the solve, from the first evaluation on
};

/// Starts PETSc in this process, alone and without its handlers of signals and errors; does nothing if it runs already.
void start_petsc();

/// Solves from x0, after start_petsc().
PetscAnswer petsc_solve(const ncp::Mcp& mcp, ncp::In x0, const PetscTask& task);

}  // namespace perp::bench

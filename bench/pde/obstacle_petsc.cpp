// SPDX-License-Identifier: Apache-2.0
/// PETSc on the obstacle problem: SNESVI (reduced-space and semismooth Newton) and TAO's bound-constrained methods.
#include <petsc.h>

#include <algorithm>
#include <utility>

#include "bench/petsc_solve.hpp"
#include "ncp/problem/affine.hpp"
#include "obstacle.hpp"

namespace perp::bench {
namespace {

struct Solver {
  const char* name;
  bool tao;  ///< TAO, else SNES
  const char* options;
};

// Each kind with the direct solver MUMPS, with hypre's algebraic multigrid or with PETSc's default for it. PETSc's own
// GAMG is not among them: SNESVI stopped with it in the first step (PETSc 3.18).
constexpr Solver solvers[] = {
    {"PETSc SNESVI rsls, MUMPS", false,
     "-snes_type vinewtonrsls -ksp_type preonly -pc_type cholesky "
     "-pc_factor_mat_solver_type mumps"},
    {"PETSc SNESVI rsls, CG + BoomerAMG", false, "-snes_type vinewtonrsls -ksp_type cg -pc_type hypre -ksp_rtol 1e-3"},
    {"PETSc SNESVI ssls, GMRES + BoomerAMG", false, "-snes_type vinewtonssls -ksp_type gmres -pc_type hypre"},
    {"PETSc TAO gpcg", true, "-tao_type gpcg"},
    {"PETSc TAO gpcg, BoomerAMG", true, "-tao_type gpcg -pc_type hypre"},
    {"PETSc TAO tron", true, "-tao_type tron"},
    {"PETSc TAO tron, BoomerAMG", true, "-tao_type tron -pc_type hypre"},
    {"PETSc TAO bntr", true, "-tao_type bntr"},
    {"PETSc TAO bncg", true, "-tao_type bncg"},
};

}  // namespace

std::vector<Measurement> petsc(const lcp::AffineMcp& problem, const lcp::Vec& start, double tol,
                               const std::vector<std::string>& skip) {
  start_petsc();
  const auto mcp = ncp::make_affine_mcp(problem, "obstacle");
  std::vector<Measurement> results;
  for (const Solver& solver : solvers) {
    if (std::ranges::find(skip, solver.name) != skip.end()) continue;
    PetscOptionsClear(nullptr);
    PetscOptionsInsertString(nullptr, solver.options);
    PetscAnswer answer = petsc_solve(
        *mcp, start, {.tao = solver.tao, .gradient = true, .tol = tol, .iterations = solver.tao ? 1000 : 500});
    results.push_back({.solver = solver.name,
                       .seconds = answer.seconds,
                       .z = std::move(answer.peer.x),
                       .remark = std::to_string(answer.iterations) + " iterations, " + answer.peer.words});
  }
  return results;
}

}  // namespace perp::bench

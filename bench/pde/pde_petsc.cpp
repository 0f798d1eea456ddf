// SPDX-License-Identifier: Apache-2.0
/// PETSc on complementarity problems: TAO's semismooth methods and SNESVI, each with several linear solvers.
#include <petsc.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "bench/petsc_solve.hpp"
#include "pde.hpp"

namespace perp::bench {
namespace {

struct Linear {
  const char* name;
  const char* options;
};
constexpr Linear mumps{"MUMPS", "-ksp_type preonly -pc_type lu -pc_factor_mat_solver_type mumps"};
constexpr std::array general{mumps, Linear{"GMRES + ILU", "-ksp_type gmres -pc_type ilu -ksp_rtol 1e-5"},
                             Linear{"GMRES + BoomerAMG", "-ksp_type gmres -pc_type hypre -ksp_rtol 1e-5"}};
constexpr std::array symmetric{mumps, Linear{"CG + ILU", "-ksp_type cg -pc_type icc -ksp_rtol 1e-5"},
                               Linear{"CG + BoomerAMG", "-ksp_type cg -pc_type hypre -ksp_rtol 1e-5"},
                               Linear{"CG + BoomerAMG 1e-3", "-ksp_type cg -pc_type hypre -ksp_rtol 1e-3"}};

struct Solver {
  std::string name;
  bool tao;  ///< TAO, else SNES
  std::string options;
};

std::vector<Solver> solvers() {
  std::vector<Solver> all;
  const auto add = [&](const std::string& name, bool tao, const std::string& type, std::span<const Linear> linear) {
    for (const Linear& l : linear) all.push_back({name + ", " + l.name, tao, type + " " + l.options});
  };
  for (const std::string type : {"ssils", "ssfls", "asils", "asfls"})
    add("TAO " + type, true, "-tao_type " + type, general);
  add("SNESVI rsls", false, "-snes_type vinewtonrsls", symmetric);
  add("SNESVI ssls", false, "-snes_type vinewtonssls", general);
  return all;
}

}  // namespace

std::vector<std::string> petsc_solvers() {
  std::vector<std::string> names;
  for (Solver& solver : solvers()) names.push_back(std::move(solver.name));
  return names;
}

PdeRun petsc(const std::string& name, const ncp::Mcp& mcp, const ncp::Vec& x0, double tol, double limit) {
  start_petsc();
  const std::vector<Solver> all = solvers();
  const Solver& solver = *std::ranges::find(all, name, &Solver::name);
  PetscOptionsClear(nullptr);
  PetscOptionsInsertString(nullptr, solver.options.c_str());
  const PetscAnswer answer = petsc_solve(mcp, x0, {.tao = solver.tao, .tol = tol, .seconds = limit});
  return {.solver = name,
          .seconds = answer.seconds,
          .iterations = answer.iterations,
          .x = answer.peer.x,
          .remark = answer.peer.words};
}

}  // namespace perp::bench

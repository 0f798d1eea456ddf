// SPDX-License-Identifier: Apache-2.0
/// PETSc for `perp-compare --external`: SNESVI (reduced space, semismooth) and TAO's semismooth methods.
#include <petsc.h>

#include <algorithm>
#include <cstdlib>

#include "bench/petsc_solve.hpp"
#include "peer.hpp"

namespace perp::bench {
namespace {

/// The user's PETSC_OPTIONS come last and win.
void set_options(const std::string& solver, const std::string& linear) {
  const bool tao = solver != "rsls" && solver != "ssls";
  std::string text = tao ? "-tao_type " + solver : "-snes_type vinewton" + solver;
  PetscBool mumps = PETSC_FALSE;
  PetscHasExternalPackage("mumps", &mumps);
  text += linear == "direct" ? " -ksp_type preonly -pc_type lu" : " -ksp_type gmres -pc_type ilu -ksp_rtol 1e-5";
  if (linear == "direct" && mumps) text += " -pc_factor_mat_solver_type mumps";
  PetscOptionsInsertString(nullptr, text.c_str());
  if (const char* own = std::getenv("PETSC_OPTIONS")) PetscOptionsInsertString(nullptr, own);
}

PeerAnswer solve(const ncp::Mcp& mcp, ncp::In x0, const PeerOptions& options) {
  start_petsc();
  const std::string& solver = options.text("solver");
  set_options(solver, options.text("linear"));
  PetscAnswer answer = petsc_solve(mcp, x0,
                                   {.tao = solver != "rsls" && solver != "ssls",
                                    .natural = options.text("test") == "natural",
                                    .tol = options.number("tol"),
                                    .iterations = static_cast<int>(std::min(options.number("iterations"), 1e9)),
                                    .seconds = std::min(options.number("time"), 1e8)});
  PetscFinalize();
  PeerAnswer& told = answer.peer;
  told.words =
      solver + ", " + options.text("linear") + ": " + told.words + ", iteration " + std::to_string(answer.iterations);
  return told;
}

std::string version() {
  PetscInt major = 0, minor = 0, patch = 0, release = 0;
  PetscGetVersionNumber(&major, &minor, &patch, &release);
  return "PETSc " + std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

}  // namespace
}  // namespace perp::bench

int main(int argc, char** argv) {
  using namespace perp::bench;
  return run_peer(
      {.name = "petsc_peer",
       .version = version(),
       .options =
           {{"solver",
             "ssils",
             {"rsls", "ssls", "ssils", "ssfls", "asils", "asfls"},
             "SNESVI: rsls, ssls; TAO: the others"},
            {"linear", "direct", {"direct", "gmres"}, "MUMPS (or PETSc's LU), or GMRES with ILU"},
            {"test", "natural", {"natural", "own"}, "natural residual <= tol (inf-norm), or PETSc's test with tol"},
            {"tol", "1e-6", {}, "absolute tolerance"},
            {"iterations", "500", {}, "at most so many"},
            {"time", "1e8", {}, "seconds, looked at once an iteration"}},
       .solve = solve},
      argc, argv);
}

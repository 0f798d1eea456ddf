// SPDX-License-Identifier: Apache-2.0
#pragma once
/// `perp-mpi solve`: the affine problem F(x) = M x + q, lower <= x <= upper, by SNES type perp, in perp's words.
#include <string>
#include <vector>

#include "lcp/status.hpp"
#include "petsc/snes_perp.hpp"

namespace perp::petsc {

/// What the command line says.
struct Task {
  std::string matrix, vector;
  std::string lower = "0";  ///< a number for all variables, or a file
  std::string upper = "inf";
  std::string start;         ///< a file; empty: 0, projected on the box
  double tol = 1e-8;         ///< on the natural residual max_i |x_i - mid(l_i, x_i - F_i, u_i)|
  int max_iterations = 500;  ///< active-set steps
  double time_limit = 3600;  ///< seconds; looked at once an iteration
  std::string petsc;         ///< options of PETSc's, e.g. "-ksp_type cg -pc_type gamg"
  std::string json;          ///< a file, or - for standard output; empty: none
  std::string solution;      ///< a file for x, in PETSc's binary format
  bool quiet = false;        ///< no log
};

/// A line of the log.
struct Record {
  PetscInt k = 0;
  PetscReal residual = 0;
  PetscInt row = -1;
  PetscInt F_evals = 0, J_evals = 0, krylov = 0;
  PetscInt64 face = 0;
};

/// What rank 0 reports.
struct Outcome {
  Status status = Status::Stalled;
  std::string message, advice;
  PetscInt size = 0;
  double nonzeros = 0;
  int ranks = 1;
  Counts counts{};
  PetscReal bounds = 0;           ///< the largest distance of an x_i from its bounds
  PetscReal complementarity = 0;  ///< the largest of all min(x_i - l_i, F_i+) and min(u_i - x_i, F_i-)
  PetscInt iterations = 0, F_evals = 0, krylov = 0;
  double read_seconds = 0, seconds = 0;
  double memory = 0;  ///< bytes, the most that a rank has had
  std::vector<Record> records;
};

/// Solves on all ranks; the log goes to `log` on rank 0. `refused` says on every rank what is wrong with the input.
PetscErrorCode run(const Task& task, std::FILE* log, Outcome& outcome, std::string& refused);

/// The report, on rank 0.
std::string report_text(const Outcome& outcome);
std::string report_json(const Task& task, const Outcome& outcome);

}  // namespace perp::petsc

// SPDX-License-Identifier: Apache-2.0
/// perp-mpi: complementarity problems on the ranks of mpiexec.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <iostream>

#include "petsc/mpi/run.hpp"

namespace {

using namespace perp::petsc;

constexpr const char* about =
    "Solve F(x) = M x + q, lower <= x <= upper on several ranks: find x with F_i >= 0 where x_i = l_i,\n"
    "F_i <= 0 where x_i = u_i, F_i = 0 between. Every rank has its own rows; nothing is gathered on one.";
constexpr const char* examples =
    "Examples:\n"
    "  mpiexec -n 4 perp-mpi solve M.petsc q.petsc --lower l.petsc --json result.json\n"
    "  mpiexec -n 2 perp-mpi solve M.mtx q.mtx --upper 1 --petsc '-pc_type gamg -ksp_monitor'\n"
    "SIGINT and SIGTERM on any rank end the run with the best point so far. Exit code 0: solved, 1: not, 2: refused.\n"
    "Pivoting (Lemke, path search) stays on one machine: perp solve.";

/// CLI11's own check lets NaN pass.
const CLI::Validator not_negative(
    [](const std::string& text) {
      double value = 0;
      const bool number = CLI::detail::lexical_cast(text, value);
      return number && value >= 0 ? std::string() : text + " is no number of zero or more";
    },
    "NUMBER >= 0");

void add_options(CLI::App& solve, Task& task) {
  solve.add_option("MATRIX", task.matrix, "M: a file in PETSc's binary format, or Matrix Market (.mtx)")->required();
  solve.add_option("VECTOR", task.vector, "q, likewise")->required();
  solve.add_option("--lower", task.lower, "the lower bounds: a number or a file (default 0)");
  solve.add_option("--upper", task.upper, "the upper bounds (default inf)");
  solve.add_option("--start-at", task.start, "start from the point in this file");
  solve.add_option("--tol", task.tol, "tolerance on the natural residual")->check(not_negative);
  solve.add_option("--max-iterations", task.max_iterations, "give up after so many")->check(not_negative);
  solve.add_option("--time-limit", task.time_limit, "give up after so many seconds")->check(not_negative);
  solve.add_option("--petsc", task.petsc, "options of PETSc's, in one text");
  solve.add_option("--solution", task.solution, "write x, in PETSc's binary format");
  solve.add_option("--json", task.json,
                   "write the result as JSON; - is standard output, the log then goes to standard error");
  solve.add_flag("--quiet", task.quiet, "no log");
}

/// Rank 0 writes; the others have the same to say.
int write(const Task& task, std::FILE* log, const Outcome& outcome) {
  if (!task.quiet) std::fputs(report_text(outcome).c_str(), log);
  if (task.json == "-") {
    std::cout << report_json(task, outcome) << std::flush;
  } else if (!task.json.empty()) {
    std::ofstream file(task.json);
    file << report_json(task, outcome) << std::flush;
    if (!file) {
      std::cerr << "perp-mpi: " << task.json << " cannot be written\n";
      return 1;
    }
  }
  return outcome.status == perp::Status::Solved ? 0 : 1;
}

int solve(const Task& task, int rank) {
  Outcome outcome;
  std::string refused;
  std::FILE* log = task.json == "-" ? stderr : stdout;
  const PetscErrorCode code = run(task, rank == 0 && !task.quiet ? log : nullptr, outcome, refused);
  if (code != 0) return code == PETSC_ERR_ARG_OUTOFRANGE ? 2 : 1;  // PETSc has said what it was
  if (!refused.empty() && rank == 0) std::cerr << "perp-mpi: " << refused << '\n';
  if (!refused.empty()) return 2;
  return rank == 0 ? write(task, log, outcome) : 0;
}

int parse_and_run(int argc, char** argv, int rank) {
  Task task;
  CLI::App app{"Perp on several ranks", "perp-mpi"};
  app.set_version_flag("--version", "perp " PERP_VERSION);
  app.require_subcommand(1);
  CLI::App& command = *app.add_subcommand("solve", about);
  command.footer(examples);
  add_options(command, task);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (rank == 0) return app.exit(error) == 0 ? 0 : 2;
    return error.get_exit_code() == 0 ? 0 : 2;
  }
  return solve(task, rank);
}

/// One line on rank 0 or on the rank that has the error, and the code: the ranks end together, not by MPI_Abort.
PetscErrorCode say(MPI_Comm, int, const char*, const char*, PetscErrorCode code, PetscErrorType type, const char* text,
                   void* rank) {
  if (type == PETSC_ERROR_INITIAL && *static_cast<int*>(rank) == 0) std::cerr << "perp-mpi: " << text << '\n';
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  int none = 1;
  char** name = argv;
  if (PetscInitialize(&none, &name, nullptr, nullptr) != 0) return 1;
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  PetscPopSignalHandler();
  PetscPushErrorHandler(say, &rank);
  int code = register_snes_perp() == 0 ? parse_and_run(argc, argv, rank) : 1;
  MPI_Allreduce(MPI_IN_PLACE, &code, 1, MPI_INT, MPI_MAX, PETSC_COMM_WORLD);
  PetscFinalize();
  return code;
}

// SPDX-License-Identifier: Apache-2.0
/// perp-mpi: the affine problem F(x) = M x + q, lower <= x <= upper, on the ranks of mpiexec, by SNES type perp, in
/// perp's words. Each rank has its own rows of a matrix in PETSc's binary format; rank 0 reads a Matrix Market file and
/// sends the rows.
#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <csignal>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "lcp/io/matrix_market.hpp"
#include "lcp/status.hpp"
#include "petsc/box.hpp"
#include "petsc/snes_perp.hpp"

namespace {

using namespace perp::petsc;
using perp::Status;
using Json = nlohmann::ordered_json;

struct Run {
  std::string matrix, vector, lower = "0", upper = "inf", start, petsc, json, solution;
  double tol = 1e-8, time_limit = 3600;
  int max_iterations = 500;
  bool quiet = false;

  OwnMat M;
  OwnVec q, l, u, x, F;
  int rank = 0;
  bool late = false, interrupted = false, reading = true;
  double started = 0;
};
Run& run_of(void* data) { return *static_cast<Run*>(data); }

volatile std::sig_atomic_t noted = 0;  // a handler can reach nothing but globals
void note(int signal) {
  noted = 1;
  std::signal(signal, SIG_DFL);
}

/// Ends all ranks: where the error is of one rank, the others would wait for it.
PetscErrorCode end(MPI_Comm, int, const char*, const char*, PetscErrorCode code, PetscErrorType type, const char* text,
                   void* data) {
  const Run& run = run_of(data);
  if (type != PETSC_ERROR_INITIAL) return code;
  std::cerr << "perp-mpi: " << text << std::endl;
  MPI_Abort(PETSC_COMM_WORLD, run.reading || code == PETSC_ERR_ARG_OUTOFRANGE ? 2 : 1);
  return code;
}

bool is_text(const std::string& path) { return path.ends_with(".mtx"); }

PetscErrorCode load(const std::string& path, void* object, bool matrix) {
  PetscViewer file = nullptr;
  PetscCall(PetscViewerBinaryOpen(PETSC_COMM_WORLD, path.c_str(), FILE_MODE_READ, &file));
  PetscCall(matrix ? MatLoad(static_cast<Mat>(object), file) : VecLoad(static_cast<Vec>(object), file));
  return PetscViewerDestroy(&file);
}

/// The entries of a Matrix Market file, on rank 0.
PetscErrorCode read_text(const Run& run, Mat M) {
  std::vector<PetscInt> rows, columns;
  perp::lcp::SpMat A;
  PetscInt size[2] = {0, 0};
  if (run.rank == 0) {
    A = perp::lcp::read_matrix(run.matrix);
    size[0] = static_cast<PetscInt>(A.rows());
    size[1] = static_cast<PetscInt>(A.cols());
    for (perp::lcp::Index j = 0; j < A.cols(); ++j)
      for (perp::lcp::SpMat::InnerIterator it(A, j); it; ++it) {
        rows.push_back(static_cast<PetscInt>(it.row()));
        columns.push_back(static_cast<PetscInt>(j));
      }
  }
  PetscCallMPI(MPI_Bcast(size, 2, MPIU_INT, 0, PETSC_COMM_WORLD));
  PetscCall(MatSetSizes(M, PETSC_DECIDE, PETSC_DECIDE, size[0], size[1]));
  PetscCall(MatSetPreallocationCOO(M, static_cast<PetscCount>(rows.size()), rows.data(), columns.data()));
  return MatSetValuesCOO(M, A.valuePtr(), INSERT_VALUES);
}

/// A square matrix whose pattern has the whole diagonal.
PetscErrorCode read_matrix(Run& run) {
  PetscInt rows = 0;
  PetscInt columns = 0;
  PetscReal norm = 0;
  PetscCall(MatCreate(PETSC_COMM_WORLD, run.M.out()));
  PetscCall(MatSetType(run.M, MATAIJ));
  PetscCall(is_text(run.matrix) ? read_text(run, run.M) : load(run.matrix, run.M, true));
  PetscCall(MatGetSize(run.M, &rows, &columns));
  PetscCall(MatNorm(run.M, NORM_FROBENIUS, &norm));
  PetscCheck(rows == columns, PETSC_COMM_WORLD, PETSC_ERR_ARG_OUTOFRANGE, "%s: is %d x %d, not square",
             run.matrix.c_str(), static_cast<int>(rows), static_cast<int>(columns));
  PetscCheck(!std::isnan(norm), PETSC_COMM_WORLD, PETSC_ERR_ARG_OUTOFRANGE, "%s: an entry is not a number",
             run.matrix.c_str());
  OwnVec zero;
  PetscCall(MatCreateVecs(run.M, nullptr, zero.out()));
  PetscCall(VecSet(zero, 0));
  PetscCall(MatSetOption(run.M, MAT_NEW_NONZERO_LOCATION_ERR, PETSC_FALSE));
  PetscCall(MatSetOption(run.M, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  return MatDiagonalSet(run.M, zero, ADD_VALUES);
}

/// A number for all rows, or a file. Sizes of 1e20 and more are infinite bounds.
PetscErrorCode read_vector(const Run& run, const std::string& text, bool bounds, OwnVec& v) {
  PetscInt rows = 0;
  double value = 0;
  PetscCall(MatCreateVecs(run.M, nullptr, v.out()));
  PetscCall(VecGetSize(v, &rows));
  const auto [last, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool number = bounds && error == std::errc() && last == text.data() + text.size();
  PetscCall(VecSet(v, value));
  if (!number && is_text(text) && run.rank == 0) {
    const perp::lcp::Vec values = perp::lcp::read_vector(text, bounds);
    PetscCheck(values.size() == rows, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
               "%s: has %d entries, the matrix %d rows", text.c_str(), static_cast<int>(values.size()),
               static_cast<int>(rows));
    for (PetscInt i = 0; i < rows; ++i) PetscCall(VecSetValue(v, i, values[i], INSERT_VALUES));
  }
  PetscCall(VecAssemblyBegin(v));
  PetscCall(VecAssemblyEnd(v));
  if (!number && !is_text(text)) PetscCall(load(text, v, false));
  Values values(v);
  PetscInt n = 0;
  PetscCall(VecGetLocalSize(v, &n));
  for (PetscInt i = 0; i < n; ++i) {
    if (bounds && std::abs(values[i]) >= infinite) values[i] = values[i] > 0 ? PETSC_INFINITY : PETSC_NINFINITY;
    PetscCheck(std::isfinite(values[i]), PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE, "%s: an entry is not finite",
               text.c_str());
  }
  return ok;
}

PetscErrorCode evaluate(SNES, Vec x, Vec F, void* data) { return MatMultAdd(run_of(data).M, x, run_of(data).q, F); }
PetscErrorCode same_matrix(SNES, Vec, Mat, Mat, void*) { return ok; }

/// Perp's test, by the largest entry of the natural residual; the time and signals; the same on every rank.
PetscErrorCode test(SNES snes, PetscInt, PetscReal, PetscReal, PetscReal, SNESConvergedReason* reason, void* data) {
  Run& run = run_of(data);
  Counts counts;
  PetscCall(counts_of(snes, &counts));
  int stop[2] = {MPI_Wtime() - run.started > run.time_limit ? 1 : 0, noted};
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, stop, 2, MPI_INT, MPI_MAX, PETSC_COMM_WORLD));
  run.late = stop[0] != 0;
  run.interrupted = stop[1] != 0;
  *reason = counts.worst <= run.tol       ? SNES_CONVERGED_FNORM_ABS
            : run.late || run.interrupted ? SNES_DIVERGED_MAX_IT
                                          : SNES_CONVERGED_ITERATING;
  return ok;
}

Status status_of(SNESConvergedReason reason, const Run& run, const Counts& counts) {
  if (counts.worst <= run.tol) return Status::Solved;
  if (run.interrupted) return Status::Interrupted;
  if (run.late) return Status::TimeLimit;
  if (reason == SNES_CONVERGED_SNORM_RELATIVE) return Status::SolvedToRounding;
  if (reason == SNES_DIVERGED_MAX_IT) return Status::IterationLimit;
  if (reason == SNES_DIVERGED_LINEAR_SOLVE) return Status::LinearAlgebraFailed;
  return reason == SNES_DIVERGED_FNORM_NAN ? Status::EvaluationFailed : Status::NoProgress;
}

/// The result as JSON; every rank makes the same.
PetscErrorCode report(SNES snes, const Run& run, Json& json, Status& status) {
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  const char* words = nullptr;
  Counts c;
  PetscInt size = 0;
  PetscInt iterations = 0;
  int ranks = 1;
  PetscCall(SNESGetConvergedReason(snes, &reason));
  PetscCall(SNESGetConvergedReasonString(snes, &words));
  PetscCall(SNESGetIterationNumber(snes, &iterations));
  PetscCall(counts_of(snes, &c));
  PetscCall(VecGetSize(run.x, &size));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  status = status_of(reason, run, c);
  json["program"] = "perp";
  json["version"] = PERP_VERSION;
  json["schema"] = "perp/solve-mpi/2";
  json["problem"] = run.matrix;
  json["size"] = size;
  json["ranks"] = ranks;
  json["status"] = to_string(status);
  json["exit_code"] = status == Status::Solved ? 0 : 1;
  json["message"] = status == Status::Solved ? "solution found" : std::string("PETSc's reason: ") + words;
  json["residual"]["natural"] = std::isfinite(c.worst) ? Json(c.worst) : Json(std::to_string(c.worst));
  json["residual"]["worst_index"] = c.row >= 0 ? Json(c.row) : Json(nullptr);
  json["stats"]["iterations"] = iterations;
  json["stats"]["semismooth_steps"] = c.semismooth;
  json["stats"]["preconditioners"] = c.faces;
  json["stats"]["time_s"] = MPI_Wtime() - run.started;
  if (run.rank == 0 && !run.quiet)
    std::cerr << to_string(status) << ": the natural residual is " << c.worst << " (row " << c.row + 1 << ") after "
              << iterations << " steps\n";
  return ok;
}

PetscErrorCode solve(Run& run, Json& json, Status& status) {
  Handle<SNES, SNESDestroy> snes;
  PetscCall(PetscOptionsInsertString(nullptr, run.petsc.c_str()));
  PetscCall(read_matrix(run));
  PetscCall(read_vector(run, run.vector, false, run.q));
  PetscCall(read_vector(run, run.lower, true, run.l));
  PetscCall(read_vector(run, run.upper, true, run.u));
  PetscCall(VecDuplicate(run.q, run.x.out()));
  PetscCall(VecDuplicate(run.q, run.F.out()));
  PetscCall(VecSet(run.x, 0));
  if (!run.start.empty()) PetscCall(read_vector(run, run.start, false, run.x));
  run.reading = false;
  run.started = MPI_Wtime();
  PetscCall(SNESCreate(PETSC_COMM_WORLD, snes.out()));
  PetscCall(SNESSetType(snes, snes_type));
  PetscCall(SNESSetFunction(snes, run.F, evaluate, &run));
  PetscCall(SNESSetJacobian(snes, run.M, run.M, same_matrix, nullptr));
  PetscCall(SNESVISetVariableBounds(snes, run.l, run.u));
  PetscCall(SNESSetTolerances(snes, run.tol, 0, 0, run.max_iterations, PETSC_MAX_INT));
  PetscCall(SNESSetFromOptions(snes));
  PetscCall(SNESSetConvergenceTest(snes, test, &run, nullptr));
  PetscCall(SNESSolve(snes, nullptr, run.x));
  PetscCall(report(snes, run, json, status));
  if (run.solution.empty()) return ok;
  PetscViewer file = nullptr;
  PetscCall(PetscViewerBinaryOpen(PETSC_COMM_WORLD, run.solution.c_str(), FILE_MODE_WRITE, &file));
  PetscCall(VecView(run.x, file));
  return PetscViewerDestroy(&file);
}

void add_options(CLI::App& solve, Run& run) {
  const CLI::Range not_negative(0.0, std::numeric_limits<double>::max());
  solve.add_option("MATRIX", run.matrix, "M: a file in PETSc's binary format, or Matrix Market (.mtx)")->required();
  solve.add_option("VECTOR", run.vector, "q, likewise")->required();
  solve.add_option("--lower", run.lower, "the lower bounds: a number or a file (default 0)");
  solve.add_option("--upper", run.upper, "the upper bounds (default inf)");
  solve.add_option("--start-at", run.start, "start from the point in this file");
  solve.add_option("--tol", run.tol, "tolerance on the natural residual")->check(not_negative);
  solve.add_option("--max-iterations", run.max_iterations, "give up after so many")->check(not_negative);
  solve.add_option("--time-limit", run.time_limit, "give up after so many seconds")->check(not_negative);
  solve.add_option("--petsc", run.petsc, "options of PETSc's, in one text");
  solve.add_option("--solution", run.solution, "write x, in PETSc's binary format");
  solve.add_option("--json", run.json, "write the result as JSON; - is standard output");
  solve.add_flag("--quiet", run.quiet, "no line on standard error");
}

int main_of(int argc, char** argv, Run& run) {
  CLI::App app{"Perp on several ranks", "perp-mpi"};
  app.set_version_flag("--version", "perp " PERP_VERSION);
  app.require_subcommand(1);
  add_options(*app.add_subcommand("solve",
                                  "Solve F(x) = M x + q, lower <= x <= upper. Exit code 0: solved, 1: not, "
                                  "2: refused. SIGINT and SIGTERM end the run with the point so far."),
              run);
  Json json;
  Status status = Status::Stalled;
  try {
    app.parse(argc, argv);
    if (!(run.tol >= 0 && run.time_limit >= 0)) throw CLI::ValidationError("--tol, --time-limit", "nan is no number");
    if (solve(run, json, status) != ok) return 1;
  } catch (const CLI::ParseError& error) {
    const int code = run.rank == 0 ? app.exit(error) : error.get_exit_code();
    return code == 0 ? 0 : 2;
  } catch (const std::exception& error) {  // of a file, on rank 0
    return end(PETSC_COMM_WORLD, 0, "", "", PETSC_ERR_FILE_READ, PETSC_ERROR_INITIAL, error.what(), &run);
  }
  if (run.rank == 0 && !run.json.empty()) {
    std::ofstream file(run.json == "-" ? "/dev/stdout" : run.json);
    file << json.dump(2, ' ', false, Json::error_handler_t::replace) << std::endl;
    if (!file) std::cerr << "perp-mpi: " << run.json << " cannot be written\n";
    if (!file) return 1;
  }
  return status == Status::Solved ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  int none = 1;
  int code = 1;
  if (PetscInitialize(&none, &argv, nullptr, nullptr) != ok) return code;
  {
    Run run;
    MPI_Comm_rank(PETSC_COMM_WORLD, &run.rank);
    PetscPopSignalHandler();
    PetscPushErrorHandler(end, &run);
    std::signal(SIGINT, note);
    std::signal(SIGTERM, note);
    if (register_snes_perp() == ok) code = main_of(argc, argv, run);
  }
  MPI_Allreduce(MPI_IN_PLACE, &code, 1, MPI_INT, MPI_MAX, PETSC_COMM_WORLD);
  PetscFinalize();
  return code;
}

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// `perp list`, `perp export` and `perp cfunctions`: the collection and the C-functions.
#include <string>
#include <vector>

#include "app/problem/problem.hpp"
#include "app/program/program.hpp"

namespace perp::app {

struct ListRequest {
  std::string name{};                  ///< "" for the table of all
  std::vector<std::string> classes{};  ///< of these alone; each may be several, comma-separated; empty: of all
  bool json = false;
};

/// Exit code 2 with a suggestion for a name or class that does not exist.
ExitCode list(const ListRequest& request, Streams streams);

// `perp export`: a problem as AMPL model that `perp solve F.nl` and other solvers read, or, if affine, as Matrix Market
// files that `perp solve M.mtx q.mtx` reads back; digit for digit.

struct ExportRequest {
  ProblemSource source{};
  /// "F.nl", beside which F.col and F.row have the names; or "F.mtx": the vectors are F-q.mtx, F-lower.mtx, F-upper.mtx
  /// and, of the start, F-start.mtx.
  std::string file{};
  bool nl = false;     ///< an .nl file, whatever `file` is; "" for NAME.nl
  bool force = false;  ///< overwrite files
};

/// Writes the files, and says how they are solved. Exit code 2, and no file, for a problem that the format cannot hold,
/// paths that cannot be written and, without force, files that exist.
ExitCode export_problem(const ExportRequest& request, Streams streams);

// `perp judge`: the natural residual of a point, evaluated by nothing that a method could influence.

struct JudgeRequest {
  ProblemSource source{};
  std::string point{};  ///< a file with the point; "" for the start
  double tol = 1e-8;
  std::string json{};  ///< "" for none, "-" for standard output (and the text to `err`)
  bool full = false;   ///< bounds and point in the JSON
};

/// exit_solved if the point is a solution to the tolerance, exit_unsolved if not, exit_input if there is no verdict.
ExitCode judge(const JudgeRequest& request, Streams streams);

// `perp cfunctions`: the catalogue of C-functions and smoothings.

/// Prints formula, parameter with range, properties and reference of each.
int print_cfunctions(Streams streams);

}  // namespace perp::app

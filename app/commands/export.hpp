#pragma once
/// `perp export`: an affine problem as Matrix Market files that `perp solve M.mtx q.mtx` reads back, digit for digit.
#include <string>

#include "app/problem/problem.hpp"
#include "app/program/program.hpp"

namespace perp::app {

struct ExportRequest {
  ProblemSource source{};
  std::string file{};  ///< "F.mtx"; the vectors are F-q.mtx, F-lower.mtx, F-upper.mtx and, of the start, F-start.mtx
  bool force = false;  ///< overwrite files
};

/// Writes M, q, the bounds and the start, and says how they are solved. Exit code 2, and no file, for a problem that is
/// not affine, paths that cannot be written and, without force, files that exist.
ExitCode export_problem(const ExportRequest& request, Streams streams);

}  // namespace perp::app

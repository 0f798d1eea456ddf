// SPDX-License-Identifier: Apache-2.0
#pragma once
/// PATH's C library, loaded at run time: libpath47.so of a checkout of ampl/pathlib, up to 300 variables and 2000
/// nonzeros unless the environment variable PATH_LICENSE_STRING has a licence. For measurements only; nothing of it is
/// part of this project.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ncp/problem/mcp.hpp"

namespace perp::bench {

/// What PATH_LIBRARY of the environment names, else `built_with`: another version, or a stand-in.
std::string library_to_load(const char* built_with);

struct PathAnswer {
  bool claimed = false;  ///< PATH says that it has solved the problem
  std::string status;    ///< "Solved", "NoProgress", ... of PATH's MCP_Termination
  ncp::Vec x;
  int majors = 0;
  int minors = 0;
  int crash = 0;
  int gradient_steps = 0;
  int restarts = 0;
  int F_evals = 0;  ///< counted in the callbacks, those within a Jacobian's included
  int J_evals = 0;
  double seconds = 0;  ///< of everything from the creation of options to the solution
};

using PathOptions = std::vector<std::pair<std::string, std::string>>;  ///< ("crash_method", "none"), ...

/// The library keeps global state: one object a process, and one solve at a time (the object does not lock).
class PathLibrary {
 public:
  /// `stub`: a library that stands in for libgfortran.so.3, which libpath47.so names but imports nothing from; empty if
  /// that is installed. Throws std::runtime_error with the loader's words.
  PathLibrary(const std::string& library, const std::string& stub);
  ~PathLibrary();

  std::string version() const;
  bool takes(ncp::Index n, ncp::Index nonzeros) const;  ///< with the licence there is
  /// Solves from x0, silently, with PATH's default options but for `options`. Throws std::runtime_error if PATH refuses
  /// one of them or reports an internal error, after which the object is of no use.
  PathAnswer solve(const ncp::Mcp& mcp, ncp::In x0, const PathOptions& options) const;

 private:
  struct Functions;
  std::unique_ptr<Functions> path_;
};

}  // namespace perp::bench

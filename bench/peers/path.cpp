// SPDX-License-Identifier: Apache-2.0
/// PATH for `perp-compare --external`: the user's own library, loaded at run time.
#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include "bench/path_library.hpp"
#include "peer.hpp"

namespace perp::bench {
namespace {

End end_of(const PathAnswer& answer) {
  if (answer.claimed) return End::Claimed;
  if (answer.status == "Infeasible") return End::Infeasible;
  if (answer.status == "MajorLimit" || answer.status == "MinorLimit") return End::IterationLimit;
  if (answer.status == "TimeLimit") return End::TimeLimit;
  if (answer.status == "DomainError") return End::Undefined;
  if (answer.status == "LicenseError") return End::NotTaken;
  return End::Failed;
}

PeerAnswer solve(const ncp::Mcp& mcp, ncp::In x0, const PeerOptions& options) {
  const PathLibrary path(library_to_load(PERP_PATH_LIBRARY), PERP_PATH_STUB);
  const ncp::Index nonzeros = mcp.jacobian_pattern().nonZeros();
  if (!path.takes(mcp.size(), nonzeros))
    return {.end = End::NotTaken,
            .words = std::to_string(mcp.size()) + " variables and " + std::to_string(nonzeros) +
                     " nonzeros are more than its licence allows (without one 300 and 2000)"};
  PathOptions settings{{"convergence_tolerance", options.text("tol")}, {"time_limit", options.text("time")}};
  if (options.text("crash") == "none") settings.emplace_back("crash_method", "none");
  const PathAnswer answer = path.solve(mcp, x0, settings);
  return {.end = end_of(answer),
          .words = answer.status + ", " + std::to_string(answer.majors) + " major and " +
                   std::to_string(answer.minors) + " minor iterations, " + std::to_string(answer.restarts) +
                   " restarts (" + path.version() + ")",
          .x = answer.x};
}

}  // namespace
}  // namespace perp::bench

int main(int argc, char** argv) {
  using namespace perp::bench;
  return run_peer({.name = "path_peer",
                   .version = "PATH",
                   .options = {{"tol", "1e-6", {}, "convergence_tolerance, of PATH's own merit function"},
                               {"crash", "default", {"default", "none"}, "crash_method"},
                               {"time", "3600", {}, "seconds"}},
                   .solve = solve},
                  argc, argv);
}

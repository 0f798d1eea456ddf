// SPDX-License-Identifier: Apache-2.0
#include "app/program/program.hpp"

#include <Eigen/Core>
#include <ostream>

#include "lcp/gpl.hpp"

// The date of AMPL's solver library as YYYYMMDD: a symbol of the library itself, declared here because its header may
// be included below ncp/ampl only.
extern "C" long ASLdate_ASL;  // NOLINT(google-runtime-int)

namespace perp::app {

ExitCode say_refused(const Streams& streams, std::string_view why) {
  streams.err << "perp: " << why << '\n';
  return exit_input;
}

std::string out_of_memory(const std::string& problem) {
  return fmt::format("'{}': out of memory: the problem is too large for this machine, or for the limit set (ulimit -v)",
                     problem);
}

std::string shell_quoted(const std::string& word) {
  if (!word.empty() && word.find_first_of(" \t\n^'\"$`\\&|;<>()*?[]#~!{}") == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + "'";
}

std::string_view version_number() { return PERP_VERSION; }

std::string version_line() { return fmt::format("perp {} (AMPL/MCP) ASL({})", version_number(), ASLdate_ASL); }

std::vector<std::string> library_versions() {
  return {fmt::format("Eigen {}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION),
          fmt::format("{} of SuiteSparse {}", lcp::gpl_linked() ? "UMFPACK and KLU" : "KLU", PERP_SUITESPARSE_VERSION),
          fmt::format("AMPL solver library of {}", ASLdate_ASL)};
}

std::string licence_line() {
  return lcp::gpl_linked() ? "Perp is under the Apache License 2.0; with UMFPACK, CHOLMOD and GSL linked, the whole is "
                             "under the GNU GPL, version 3 or later."
                           : "Perp is under the Apache License 2.0; KLU, BTF, MPFI, MPFR and GMP, which are linked, "
                             "are under the GNU LGPL, AMD and COLAMD under the BSD licence.";
}

std::string version_text() {
  return fmt::format(
      "{}\n"
      "{}\n"
      "There is NO WARRANTY, to the extent permitted by law.\n"
      "Linked: {}\n",
      version_line(), licence_line(), fmt::join(library_versions(), ", "));
}

}  // namespace perp::app

// SPDX-License-Identifier: Apache-2.0
/// bench_contact_siconos SOLVER FILE [TOL]: one of Siconos' solvers of frictional contact on a recorded problem, W in
/// blocks of 3 x 3 as Siconos' own simulations have it. README.md says how to read it.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string_view>

#include "contact/io/read.hpp"
#include "contact/model/residual.hpp"
#include "siconos_friction.hpp"

namespace {

using namespace perp;

void run(const bench::SiconosSolver& solver, const char* file, double tol) {
  const contact::Problem problem = contact::read_problem(file);
  bench::SiconosProblem siconos(problem);
  contact::Vec r = contact::Vec::Zero(problem.q.size());
  const auto begin = std::chrono::steady_clock::now();
  const int iterations = siconos.solve(solver, tol, r);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const contact::Residual residual = contact::residual(problem, r);
  std::printf("%s,%s,%ld,%s,%s,%.5f,%d,%.1e,%.1e,%.1e\n", file, solver.name, static_cast<long>(problem.contacts()),
              residual.siconos <= tol * (1 + 1e-6) ? "solved" : "failed",
              contact::accepted(residual, tol) ? "accepted" : "refused", seconds, iterations, residual.siconos,
              residual.rr9118, std::max({residual.cone_share, residual.normal_share, residual.slip_share}));
}

}  // namespace

int main(int argc, char** argv) try {
  constexpr auto& solvers = bench::siconos_solvers;
  const std::string_view name = argc > 2 ? argv[1] : "";
  const auto* solver =
      std::find_if(solvers.begin(), solvers.end(), [&](const bench::SiconosSolver& s) { return name == s.name; });
  if (solver == solvers.end()) {
    std::fputs("usage: bench_contact_siconos SOLVER FILE [TOL]; the solvers are", stderr);
    for (const bench::SiconosSolver& s : solvers) std::fprintf(stderr, " %s", s.name);
    std::fputc('\n', stderr);
    return 2;
  }
  run(*solver, argv[2], argc > 3 ? std::atof(argv[3]) : 1e-8);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "bench_contact_siconos: %s\n", error.what());
  return 1;
}

// SPDX-License-Identifier: Apache-2.0
/// Obstacle-type problems on fine grids: the methods of Perp beside PETSc's, all until the natural residual is at most
/// 1e-8, in one process. README.md tells how to read it.
///     pde [LIMIT [PROBLEM:MxN ...]]       LIMIT: seconds that a solver gets
///     pde --memory PROBLEM:MxN METHOD     one solve and its peak of memory
#include "pde.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <utility>

#include "collection/sized.hpp"
#include "ncp/problem/residual.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::bench {
namespace {

constexpr double tol = 1e-8;

std::optional<ncp::collection::Problem> problem_called(const std::string& text) {
  const std::size_t colon = text.find(':');
  const ncp::collection::Family* family = ncp::collection::find_family(text.substr(0, colon));
  if (family == nullptr || colon == std::string::npos) return std::nullopt;
  try {
    return ncp::collection::make(*family, text.substr(colon + 1));
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

struct Own {
  const char* name;
  ncp::Method method;
};

std::vector<Own> methods(double limit) {
  const ncp::Stop stop{.tol = tol, .max_time = std::chrono::duration<double>(limit)};
  return {{"josephy", ncp::NewtonJosephy{.stop = stop}},
          {"auto for affine problems (bound_qp)", ncp::Affine{.stop = stop, .method = lcp::Auto{}}},
          {"semismooth, Krylov", ncp::SemismoothNewton{.stop = stop, .linear = ncp::LinearSolver::Krylov}},
          {"semismooth, LU", ncp::SemismoothNewton{.stop = stop, .linear = ncp::LinearSolver::Direct}},
          {"semismooth-min, Krylov",
           ncp::SemismoothNewton{.stop = stop, .cfunction = ncp::natural_min(), .linear = ncp::LinearSolver::Krylov}},
          {"path", ncp::path({.stop = stop})}};
}

bool line(const ncp::Mcp& mcp, const PdeRun& run) {
  const double residual = ncp::residual(mcp, lcp::project(mcp.box(), run.x)).natural;
  const bool solved = residual <= tol;
  std::printf("| %-38s | %-6s | %10d | %8.3f | %8.1e | %s |\n", run.solver.c_str(), solved ? "yes" : "no",
              run.iterations, run.seconds, residual, run.remark.c_str());
  std::fflush(stdout);
  return solved;
}

/// The least iterations and seconds, of one solver each.
struct Best {
  double iterations = lcp::infinity;
  double seconds = lcp::infinity;
  void take(const PdeRun& run) {
    iterations = std::min(iterations, static_cast<double>(run.iterations));
    seconds = std::min(seconds, run.seconds);
  }
};

void measure(const std::string& name, double limit) {
  const auto problem = problem_called(name);
  if (!problem) {
    std::fprintf(stderr, "%s is no PROBLEM:MxN\n", name.c_str());
    std::exit(2);
  }
  const ncp::Mcp& mcp = *problem->mcp;
  std::printf("\n%s, n = %ld\n| solver | solved | iterations | seconds | residual | |\n|---|---|---|---|---|---|\n",
              name.c_str(), static_cast<long>(mcp.size()));
  std::vector<std::pair<PdeRun, bool>> own;
  Best theirs;
  for (const Own& o : methods(limit)) {
    if (std::holds_alternative<ncp::Affine>(o.method) && !mcp.is_affine()) continue;
    const auto begin = std::chrono::steady_clock::now();
    const ncp::Result found = ncp::solve(mcp, problem->starts[0], o.method);
    PdeRun run{.solver = o.name,
               .seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
               .iterations = found.stats.iterations + found.stats.crash_iterations,
               .x = found.x,
               .remark = std::string(to_string(found.status))};
    // A linearised problem of an affine problem is the problem itself: its steps on the finest grid are what counts.
    if (std::holds_alternative<ncp::NewtonJosephy>(o.method)) {
      run.remark += ", " + std::to_string(found.stats.pivots) + " steps of bound_qp";
      if (found.stats.chord_steps > 0) run.remark += ", " + std::to_string(found.stats.chord_steps) + " chord steps";
      if (mcp.is_affine()) run.iterations = found.stats.pivots;
    }
    if (found.stats.krylov_iterations > 0)
      run.remark += ", " + std::to_string(found.stats.krylov_iterations) + " Krylov iterations";
    const bool solved = line(mcp, run);
    own.emplace_back(std::move(run), solved);
  }
  for (const std::string& solver : petsc_solvers()) {
    const PdeRun run = petsc(solver, mcp, problem->starts[0], tol, limit);
    if (line(mcp, run)) theirs.take(run);
  }
  // Ours: the one method that is ahead by the larger factor in both.
  double factor = 0;
  const PdeRun* best = nullptr;
  for (const auto& [run, solved] : own) {
    const double ahead = std::min(theirs.iterations / std::max(1, run.iterations), theirs.seconds / run.seconds);
    if (solved && ahead > factor) {
      factor = ahead;
      best = &run;
    }
  }
  if (best != nullptr && theirs.seconds < lcp::infinity)
    std::printf("%s: %s, %d iterations, %.3f s; PETSc's least: %.0f iterations, %.3f s: ratios %.1f and %.1f\n",
                name.c_str(), best->solver.c_str(), best->iterations, best->seconds, theirs.iterations, theirs.seconds,
                theirs.iterations / std::max(1, best->iterations), theirs.seconds / best->seconds);
}

long peak_kilobytes() {
  std::ifstream status("/proc/self/status");
  for (std::string text; std::getline(status, text);)
    if (text.starts_with("VmHWM:")) return std::strtol(text.c_str() + 6, nullptr, 10);
  return -1;
}

int memory(const std::string& name, const std::string& method) {
  const auto problem = problem_called(name);
  if (!problem) return 2;
  for (const Own& o : methods(3600)) {
    if (method != o.name) continue;
    const long before = peak_kilobytes();
    const ncp::Result found = ncp::solve(*problem->mcp, problem->starts[0], o.method);
    std::printf("%s, %s: %s, residual %.1e, %d iterations, %.2f s, peak %.1f MB above the problem's %.1f MB\n",
                name.c_str(), o.name, std::string(to_string(found.status)).c_str(), found.residual.natural,
                found.stats.iterations, found.stats.time.count(), static_cast<double>(peak_kilobytes() - before) / 1024,
                static_cast<double>(before) / 1024);
    return found.solved() ? 0 : 1;
  }
  std::fprintf(stderr, "METHOD is one of:\n");
  for (const Own& o : methods(3600)) std::fprintf(stderr, "  %s\n", o.name);
  return 2;
}

}  // namespace
}  // namespace perp::bench

int main(int argc, char** argv) {
  if (argc == 4 && std::string(argv[1]) == "--memory") return perp::bench::memory(argv[2], argv[3]);
  const double limit = argc > 1 ? std::atof(argv[1]) : 120;
  std::vector<std::string> names(argv + std::min(argc, 2), argv + argc);
  if (names.empty())
    for (const char* size : {"100x100", "300x300"})
      for (const char* problem : {"obstacle", "bratu-own", "journal-bearing", "torsion"})
        names.push_back(std::string(problem) + ":" + size);
  for (const std::string& name : names) perp::bench::measure(name, limit);
}

// SPDX-License-Identifier: Apache-2.0
/// Siconos for `perp-compare --external`: its solvers for NCPs, MCPs (equations and the orthant) and LCPs.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <string>

#include "LCP_Solvers.h"
#include "LinearComplementarityProblem.h"
#include "MCP_Solvers.h"
#include "MCP_cst.h"
#include "MixedComplementarityProblem.h"
#include "NonSmoothDrivers.h"
#include "NumericsMatrix.h"
#include "SolverOptions.h"
#include "lcp_cst.h"
#include "orthant.hpp"
#include "peer.hpp"
#if __has_include("NonlinearComplementarityProblem.h")
#include "NCP_cst.h"
#include "NonlinearComplementarityProblem.h"
#else
// Debian's package leaves these headers out: what the library exports.
struct NonlinearComplementarityProblem {
  unsigned n;
  void (*compute_F)(void* env, int n, double* z, double* F);
  void (*compute_nabla_F)(void* env, int n, double* z, NumericsMatrix* J);
  NumericsMatrix* nabla_F;
  void* env;
};
extern "C" NonlinearComplementarityProblem* newNCP(void);
extern "C" void freeNCP(NonlinearComplementarityProblem* ncp);
enum { SICONOS_NCP_NEWTON_FB_FBLSA = 900, SICONOS_NCP_NEWTON_MIN_FBLSA = 901, SICONOS_NCP_PATHSEARCH = 902 };
#endif

namespace perp::bench {
namespace {

constexpr ncp::Index largest = 3000;  // matrices are dense here: 72 MB each

enum class Kind { Ncp, Mcp, Lcp };

struct Solver {
  const char* name;
  Kind kind;
  int id;
};

constexpr std::array solvers{
    Solver{"mcp-fb", Kind::Mcp, SICONOS_MCP_NEWTON_FB_FBLSA},
    Solver{"mcp-min", Kind::Mcp, SICONOS_MCP_NEWTON_MIN_FBLSA},
    Solver{"ncp-fb", Kind::Ncp, SICONOS_NCP_NEWTON_FB_FBLSA},
    Solver{"ncp-min", Kind::Ncp, SICONOS_NCP_NEWTON_MIN_FBLSA},
    Solver{"ncp-pathsearch", Kind::Ncp, SICONOS_NCP_PATHSEARCH},
    Solver{"lcp-lemke", Kind::Lcp, SICONOS_LCP_LEMKE},
    Solver{"lcp-pivot", Kind::Lcp, SICONOS_LCP_PIVOT},
    Solver{"lcp-pathsearch", Kind::Lcp, SICONOS_LCP_PATHSEARCH},
    Solver{"lcp-fb", Kind::Lcp, SICONOS_LCP_NEWTON_FB_FBLSA},
    Solver{"lcp-min", Kind::Lcp, SICONOS_LCP_NEWTON_MIN_FBLSA},
    Solver{"lcp-pgs", Kind::Lcp, SICONOS_LCP_PGS},
};

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Orthant& form(void* env) { return *static_cast<Orthant*>(env); }

/// NaN where F is not defined: there is no other way to say it.
void evaluate(void* env, int n, double* z, double* G) {
  Eigen::Map<ncp::Vec> values(G, n);
  if (!form(env).eval(Eigen::Map<const ncp::Vec>(z, n), values)) values.setConstant(nan);
}

void differentiate(void* env, int n, double* z, NumericsMatrix* J) {
  Eigen::Map<Eigen::MatrixXd> values(J->matrix0, n, n);
  if (!form(env).jacobian(Eigen::Map<const ncp::Vec>(z, n), values)) values.setConstant(nan);
}

int solve_ncp(Orthant& problem, ncp::Vec& z, ncp::Vec& G, SolverOptions& options) {
  const auto n = static_cast<int>(problem.size());
  const std::unique_ptr<NonlinearComplementarityProblem, decltype(&freeNCP)> p(newNCP(), &freeNCP);
  p->n = static_cast<unsigned>(n);
  p->compute_F = evaluate;
  p->compute_nabla_F = differentiate;
  p->nabla_F = NM_create(NM_DENSE, n, n);
  p->env = &problem;
  return ncp_driver(p.get(), z.data(), G.data(), &options);
}

int solve_mcp(Orthant& problem, ncp::Vec& z, ncp::Vec& G, SolverOptions& options) {
  const auto n = static_cast<int>(problem.size());
  const std::unique_ptr<MixedComplementarityProblem, decltype(&mixedComplementarityProblem_free)> p(
      mixedComplementarityProblem_new(), &mixedComplementarityProblem_free);
  p->n1 = static_cast<int>(problem.equations());
  p->n2 = n - p->n1;
  p->compute_Fmcp = evaluate;
  p->compute_nabla_Fmcp = differentiate;
  p->nabla_Fmcp = NM_create(NM_DENSE, n, n);
  p->env = &problem;
  return mcp_driver(p.get(), z.data(), G.data(), &options);
}

int solve_lcp(Orthant& problem, ncp::Vec& z, ncp::Vec& w, SolverOptions& options) {
  const auto n = static_cast<int>(problem.size());
  ncp::Vec q(n);
  LinearComplementarityProblem p{};
  p.size = n;
  p.M = NM_create(NM_DENSE, n, n);
  ncp::Vec zero = ncp::Vec::Zero(n);
  evaluate(&problem, n, zero.data(), q.data());
  differentiate(&problem, n, zero.data(), p.M);
  p.q = q.data();
  // Its LCP solvers measure errors relative to || q ||_2.
  if (const double norm = q.norm(); norm > 0) options.dparam[SICONOS_DPARAM_TOL] /= norm;
  const int info = linearComplementarity_driver(&p, z.data(), w.data(), &options);
  NM_clear(p.M);
  std::free(p.M);
  return info;
}

/// Why not; empty if it is for it.
std::string objection(const Solver& solver, const ncp::Mcp& mcp, const Orthant& problem) {
  const std::string name = solver.name;
  if (solver.kind == Kind::Lcp && !mcp.is_affine()) return name + " is for affine problems, and this one is not";
  if (solver.kind != Kind::Mcp && problem.equations() > 0)
    return name + " is for variables with bounds, and " + std::to_string(problem.equations()) + " are free";
  if (problem.size() > largest)
    return "the problem has " + std::to_string(problem.size()) + " unknowns; dense matrices allow " +
           std::to_string(largest);
  if (problem.size() == 0) return "the problem has no unknowns";
  return "";
}

PeerAnswer solve(const ncp::Mcp& mcp, ncp::In x0, const PeerOptions& asked) {
  const Solver& solver =
      *std::ranges::find_if(solvers, [&](const Solver& s) { return asked.text("solver") == s.name; });
  Orthant problem(mcp);
  if (const std::string why = objection(solver, mcp, problem); !why.empty())
    return {.end = End::NotTaken, .words = why};
  const std::unique_ptr<SolverOptions, decltype(&solver_options_delete)> options(solver_options_create(solver.id),
                                                                                 &solver_options_delete);
  options->dparam[SICONOS_DPARAM_TOL] = asked.number("tol");
  if (const double most = asked.number("iterations"); most > 0)
    options->iparam[SICONOS_IPARAM_MAX_ITER] = static_cast<int>(std::min(most, 1e9));
  // Else it frees what it has not initialised (4.4).
  if (solver.id == SICONOS_NCP_PATHSEARCH) options->iparam[SICONOS_IPARAM_PREALLOC] = 1;
  ncp::Vec z = problem.from(x0);
  ncp::Vec w = ncp::Vec::Zero(problem.size());
  int info = -1;
  if (solver.kind == Kind::Ncp)
    info = solve_ncp(problem, z, w, *options);
  else if (solver.kind == Kind::Mcp)
    info = solve_mcp(problem, z, w, *options);
  else
    info = solve_lcp(problem, z, w, *options);
  std::array<char, 160> text{};
  const int done = options->iparam[SICONOS_IPARAM_ITER_DONE];
  std::snprintf(text.data(), text.size(),
                "%s, %d equations, %d on the orthant (%d for upper bounds): info %d, %d iterations", solver.name,
                static_cast<int>(problem.equations()), static_cast<int>(problem.size() - problem.equations()),
                static_cast<int>(problem.multipliers()), info, done);
  const bool limit = done >= options->iparam[SICONOS_IPARAM_MAX_ITER];
  return {.end = info == 0 ? End::Claimed : (limit ? End::IterationLimit : End::Failed),
          .words = text.data(),
          .x = problem.point(z)};
}

}  // namespace
}  // namespace perp::bench

int main(int argc, char** argv) {
  using namespace perp::bench;
  std::vector<std::string> names;
  names.reserve(solvers.size());
  for (const Solver& solver : solvers) names.emplace_back(solver.name);
  return run_peer(
      {.name = "siconos_peer",
       .version = "Siconos (" PERP_SICONOS_LIBRARY ")",
       .options = {{"solver", "mcp-fb", names, "mcp-*: any bounds; ncp-*: no free variables; lcp-*: affine, too"},
                   {"tol", "1e-6", {}, "absolute tolerance of the error in the 2-norm"},
                   {"iterations", "own", {}, "at most so many"}},
       .solve = solve},
      argc, argv);
}

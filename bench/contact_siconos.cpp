/// Siconos' solvers of frictional contact, W in blocks of 3 x 3 as Siconos' own simulations have it.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "CSparseMatrix_internal.h"
#include "FrictionContactProblem.h"
#include "Friction_cst.h"
#include "NonSmoothDrivers.h"
#include "NumericsMatrix.h"
#include "SolverOptions.h"
#include "SparseBlockMatrix.h"
#include "contact_peers.hpp"

namespace perp::bench {
namespace {

struct Solver {
  const char* name;
  int id;
  bool hybrid;
  int iterations;
};

constexpr int sweeps = std::numeric_limits<int>::max() / 2;
constexpr std::array solvers{
    Solver{"NSGS", SICONOS_FRICTION_3D_NSGS, false, sweeps}, Solver{"NSN_AC", SICONOS_FRICTION_3D_NSN_AC, false, 2000},
    Solver{"NSN_AC_HYBRID", SICONOS_FRICTION_3D_NSN_AC, true, 2000},
    Solver{"NSN_FB", SICONOS_FRICTION_3D_NSN_FB, false, 2000}, Solver{"ADMM", SICONOS_FRICTION_3D_ADMM, false, sweeps}};

/// Whole blocks; Siconos leaves out zeros, so those within a block are given as the smallest number.
NumericsMatrix* blocks_of(const contact::SpMat& W) {
  const contact::SpMat& A = W;
  std::vector<CS_INT> p{0};
  std::vector<CS_INT> i;
  std::vector<double> x;
  const auto n = A.cols();
  const auto nb = n / 3;
  std::vector<char> touched(static_cast<std::size_t>(nb), 0);
  std::vector<double> column(static_cast<std::size_t>(n), 0.0);
  for (contact::Index j = 0; j < n; ++j) {
    std::fill(touched.begin(), touched.end(), char{0});
    for (contact::Index k = 3 * (j / 3); k < 3 * (j / 3) + 3; ++k)
      for (contact::SpMat::InnerIterator it(A, k); it; ++it) touched[static_cast<std::size_t>(it.row() / 3)] = 1;
    touched[static_cast<std::size_t>(j / 3)] = 1;
    for (contact::SpMat::InnerIterator it(A, j); it; ++it) column[static_cast<std::size_t>(it.row())] = it.value();
    for (contact::Index b = 0; b < nb; ++b)
      if (touched[static_cast<std::size_t>(b)] != 0)
        for (contact::Index k = 3 * b; k < 3 * b + 3; ++k) {
          double& value = column[static_cast<std::size_t>(k)];
          i.push_back(k);
          x.push_back(value == 0 ? 1e-300 : value);
          value = 0;
        }
    p.push_back(static_cast<CS_INT>(i.size()));
  }
  CSparseMatrix C;
  std::memset(&C, 0, sizeof C);
  C.m = C.n = n;
  C.nz = -1;
  C.nzmax = static_cast<CS_INT>(i.size());
  C.p = p.data();
  C.i = i.data();
  C.x = x.data();
  NumericsMatrix* M = NM_create(NM_SPARSE_BLOCK, static_cast<int>(n), static_cast<int>(n));
  SBM_from_csparse(3, &C, M->matrix1);
  return M;
}

}  // namespace

std::vector<std::string> contact_peers() {
  std::vector<std::string> names;
  for (const Solver& solver : solvers) names.emplace_back(solver.name);
  return names;
}

PeerRun run_contact_peer(const std::string& name, const contact::Problem& problem, double tol) {
  if (problem.dimension != 3) throw std::invalid_argument(name + " is for contacts in 3D");
  for (const Solver& solver : solvers) {
    if (name != solver.name) continue;
    contact::Vec q = problem.q;
    contact::Vec mu = problem.mu;
    FrictionContactProblem fc;
    std::memset(&fc, 0, sizeof fc);
    fc.dimension = 3;
    fc.numberOfContacts = static_cast<int>(problem.contacts());
    fc.M = blocks_of(problem.W);
    fc.q = q.data();
    fc.mu = mu.data();
    SolverOptions* options = solver_options_create(solver.id);
    options->dparam[SICONOS_DPARAM_TOL] = tol;
    options->iparam[SICONOS_IPARAM_MAX_ITER] = solver.iterations;
    if (solver.hybrid)
      options->iparam[SICONOS_FRICTION_3D_NSN_HYBRID_STRATEGY] = SICONOS_FRICTION_3D_NSN_HYBRID_STRATEGY_VI_EG_NSN;
    PeerRun run;
    run.r = contact::Vec::Zero(q.size());
    contact::Vec u = contact::Vec::Zero(q.size());
    const auto begin = std::chrono::steady_clock::now();
    fc3d_driver(&fc, run.r.data(), u.data(), options);
    run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    run.iterations = options->iparam[SICONOS_IPARAM_ITER_DONE];
    return run;
  }
  throw std::invalid_argument("no solver is called " + name);
}

}  // namespace perp::bench

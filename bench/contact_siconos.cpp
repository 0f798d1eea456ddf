// SPDX-License-Identifier: Apache-2.0
/// bench_contact_siconos SOLVER FILE [TOL]: one of Siconos' solvers of frictional contact on a recorded problem, W in
/// blocks of 3 x 3 as Siconos' own simulations have it. README.md says how to read it.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "CSparseMatrix_internal.h"
#include "FrictionContactProblem.h"
#include "Friction_cst.h"
#include "NonSmoothDrivers.h"
#include "NumericsMatrix.h"
#include "SolverOptions.h"
#include "SparseBlockMatrix.h"
#include "contact/io/read.hpp"
#include "contact/model/residual.hpp"

namespace {

using namespace perp;

struct Solver {
  const char* name;
  int id;
  bool hybrid;
  int iterations;
};

constexpr int sweeps = std::numeric_limits<int>::max() / 2;
constexpr std::array solvers{Solver{"NSGS", SICONOS_FRICTION_3D_NSGS, false, sweeps},
                             Solver{"NSN_AC", SICONOS_FRICTION_3D_NSN_AC, false, 2000},
                             Solver{"NSN_AC_HYBRID", SICONOS_FRICTION_3D_NSN_AC, true, 2000},
                             Solver{"NSN_FB", SICONOS_FRICTION_3D_NSN_FB, false, 2000},
                             Solver{"NSN_NM", SICONOS_FRICTION_3D_NSN_NM, false, 2000},
                             Solver{"VI_FPP", SICONOS_FRICTION_3D_VI_FPP, false, sweeps},
                             Solver{"VI_EG", SICONOS_FRICTION_3D_VI_EG, false, sweeps},
                             Solver{"FPP", SICONOS_FRICTION_3D_FPP, false, sweeps},
                             Solver{"EG", SICONOS_FRICTION_3D_EG, false, sweeps},
                             Solver{"HP", SICONOS_FRICTION_3D_HP, false, sweeps},
                             Solver{"TFP", SICONOS_FRICTION_3D_TFP, false, sweeps},
                             Solver{"PFP", SICONOS_FRICTION_3D_PFP, false, sweeps},
                             Solver{"ACLMFP", SICONOS_FRICTION_3D_ACLMFP, false, sweeps},
                             Solver{"ADMM", SICONOS_FRICTION_3D_ADMM, false, sweeps}};

/// Whole blocks; Siconos leaves out zeros, so those within a block are given as the smallest number.
NumericsMatrix* blocks_of(const contact::SpMat& A) {
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

void run(const Solver& solver, const char* file, double tol) {
  const contact::Problem problem = contact::read_problem(file);
  if (problem.dimension != 3) throw std::invalid_argument("Siconos' solvers are for contacts in 3D");
  contact::Vec q = problem.q;
  contact::Vec mu = problem.mu;
  FrictionContactProblem fc;
  std::memset(&fc, 0, sizeof fc);
  fc.dimension = 3;
  fc.numberOfContacts = static_cast<int>(problem.contacts());
  fc.M = blocks_of(problem.W.matrix());
  fc.q = q.data();
  fc.mu = mu.data();
  SolverOptions* options = solver_options_create(solver.id);
  options->dparam[SICONOS_DPARAM_TOL] = tol;
  options->iparam[SICONOS_IPARAM_MAX_ITER] = solver.iterations;
  if (solver.hybrid)
    options->iparam[SICONOS_FRICTION_3D_NSN_HYBRID_STRATEGY] = SICONOS_FRICTION_3D_NSN_HYBRID_STRATEGY_VI_EG_NSN;
  contact::Vec r = contact::Vec::Zero(q.size());
  contact::Vec u = contact::Vec::Zero(q.size());
  const auto begin = std::chrono::steady_clock::now();
  fc3d_driver(&fc, r.data(), u.data(), options);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (!r.allFinite()) r.setZero();
  const contact::Residual residual = contact::residual(problem, r);
  std::printf("%s,%s,%ld,%s,%s,%.5f,%d,%.1e,%.1e,%.1e\n", file, solver.name, static_cast<long>(problem.contacts()),
              residual.siconos <= tol * (1 + 1e-6) ? "solved" : "failed",
              contact::accepted(residual, tol) ? "accepted" : "refused", seconds,
              options->iparam[SICONOS_IPARAM_ITER_DONE], residual.siconos, residual.rr9118,
              std::max({residual.cone_share, residual.normal_share, residual.slip_share}));
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string_view name = argc > 2 ? argv[1] : "";
  const auto* solver = std::find_if(solvers.begin(), solvers.end(), [&](const Solver& s) { return name == s.name; });
  if (solver == solvers.end()) {
    std::fputs("usage: bench_contact_siconos SOLVER FILE [TOL]; the solvers are", stderr);
    for (const Solver& s : solvers) std::fprintf(stderr, " %s", s.name);
    std::fputc('\n', stderr);
    return 2;
  }
  run(*solver, argv[2], argc > 3 ? std::atof(argv[3]) : 1e-8);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "bench_contact_siconos: %s\n", error.what());
  return 1;
}

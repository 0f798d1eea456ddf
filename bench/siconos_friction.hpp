// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Siconos' solvers of contact problems in 3D (Debian: libsiconos-numerics-dev), on Perp's problems.
#include <array>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include "CSparseMatrix_internal.h"
#include "FrictionContactProblem.h"
#include "Friction_cst.h"
#include "NonSmoothDrivers.h"
#include "NumericsMatrix.h"
#include "SolverOptions.h"
#include "SparseBlockMatrix.h"
#include "contact/model/problem.hpp"

namespace perp::bench {

struct SiconosSolver {
  const char* name;
  int id;
  bool hybrid;
  int iterations;
};

inline constexpr int siconos_sweeps = std::numeric_limits<int>::max() / 2;
inline constexpr std::array siconos_solvers{SiconosSolver{"NSGS", SICONOS_FRICTION_3D_NSGS, false, siconos_sweeps},
                                            SiconosSolver{"NSN_AC", SICONOS_FRICTION_3D_NSN_AC, false, 2000},
                                            SiconosSolver{"NSN_AC_HYBRID", SICONOS_FRICTION_3D_NSN_AC, true, 2000},
                                            SiconosSolver{"NSN_FB", SICONOS_FRICTION_3D_NSN_FB, false, 2000},
                                            SiconosSolver{"NSN_NM", SICONOS_FRICTION_3D_NSN_NM, false, 2000},
                                            SiconosSolver{"VI_FPP", SICONOS_FRICTION_3D_VI_FPP, false, siconos_sweeps},
                                            SiconosSolver{"VI_EG", SICONOS_FRICTION_3D_VI_EG, false, siconos_sweeps},
                                            SiconosSolver{"FPP", SICONOS_FRICTION_3D_FPP, false, siconos_sweeps},
                                            SiconosSolver{"EG", SICONOS_FRICTION_3D_EG, false, siconos_sweeps},
                                            SiconosSolver{"HP", SICONOS_FRICTION_3D_HP, false, siconos_sweeps},
                                            SiconosSolver{"TFP", SICONOS_FRICTION_3D_TFP, false, siconos_sweeps},
                                            SiconosSolver{"PFP", SICONOS_FRICTION_3D_PFP, false, siconos_sweeps},
                                            SiconosSolver{"ACLMFP", SICONOS_FRICTION_3D_ACLMFP, false, siconos_sweeps},
                                            SiconosSolver{"ADMM", SICONOS_FRICTION_3D_ADMM, false, siconos_sweeps}};

/// Whole blocks; Siconos leaves out zeros, so those within a block are given as the smallest number.
inline NumericsMatrix* blocks_of(const contact::SpMat& A) {
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

/// A problem in Siconos' form, W by blocks.
class SiconosProblem {
 public:
  explicit SiconosProblem(const contact::Problem& problem) : q_(problem.q), mu_(problem.mu) {
    if (problem.dimension != 3) throw std::invalid_argument("Siconos' solvers are for contacts in 3D");
    std::memset(&problem_, 0, sizeof problem_);
    problem_.dimension = 3;
    problem_.numberOfContacts = static_cast<int>(problem.contacts());
    problem_.M = blocks_of(problem.W.matrix());
    problem_.q = q_.data();
    problem_.mu = mu_.data();
  }
  ~SiconosProblem() { NM_free(problem_.M); }
  SiconosProblem(const SiconosProblem&) = delete;
  SiconosProblem& operator=(const SiconosProblem&) = delete;

  /// From r, which is 0 afterwards where Siconos leaves what is no number. Returns the iterations.
  int solve(const SiconosSolver& solver, double tol, contact::Vec& r) {
    const std::unique_ptr<SolverOptions, void (*)(SolverOptions*)> options(solver_options_create(solver.id),
                                                                           solver_options_delete);
    options->dparam[SICONOS_DPARAM_TOL] = tol;
    options->iparam[SICONOS_IPARAM_MAX_ITER] = solver.iterations;
    if (solver.hybrid)
      options->iparam[SICONOS_FRICTION_3D_NSN_HYBRID_STRATEGY] = SICONOS_FRICTION_3D_NSN_HYBRID_STRATEGY_VI_EG_NSN;
    contact::Vec u = contact::Vec::Zero(q_.size());
    fc3d_driver(&problem_, r.data(), u.data(), options.get());
    if (!r.allFinite()) r.setZero();
    return options->iparam[SICONOS_IPARAM_ITER_DONE];
  }

 private:
  contact::Vec q_, mu_;
  FrictionContactProblem problem_;
};

}  // namespace perp::bench

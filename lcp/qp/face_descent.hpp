// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Descends on  1/2 z'A z + q'z  over the box [l, u], with A symmetric, positive definite, positive diagonal. A step is
///  1. a projected Gauss-Seidel sweep forth and back, z_i <- mid(l_i, z_i - g_i / a_ii, u_i), g = A z + q;
///  2. the face: z_i is held where it is at a bound and g_i pushes it there, else free;
///  3. d with A_FF d_F = -g_F approximately, by conjugate gradients preconditioned by B, d = 0 where held;
///  4. z <- mid(l, z + t d, u) with t = 1, 1/2, ... until the objective falls by a part of what the slope promises.
/// No step raises the objective. The sweeps alone converge from any start (Luo & Tseng, J. Optim. Theory Appl. 72
/// (1992) 7). They find the face of a solution where z_i = l_i, u_i only with g_i != 0. What 3 and 4 add is speed, in
/// the manner of monotone multigrid (Kornhuber, Numer. Math. 69 (1994) 167) and GPCG (More & Toraldo, SIAM J. Optim. 1
/// (1991) 93). Private to lcp/.
#include "lcp/judge/result.hpp"
#include "lcp/linalg/face_preconditioner.hpp"

namespace perp::lcp {

struct BoxQp {
  const SparseRows* A = nullptr;
  const Vec* diagonal = nullptr;  ///< of A; unknowns with 0 have l = u
  Vec q;
  Vec lower;
  Vec upper;
};

struct Descent {
  enum class End {
    Solved,             ///< residual at rounding level
    Settled,            ///< the face has come twice, if that was enough
    NegativeCurvature,  ///< direction'A direction < 0 beyond rounding
    Flat,               ///< direction'A direction is 0 up to rounding on a face
    Slow,               ///< conjugate gradients needed more than cg_limit iterations
    OutOfMemory,        ///< for the preconditioner
    Limit,              ///< step_limit
    Stopped,            ///< limits.reached()
  };

  bool settle_only = false;  ///< end when the face has settled: for the coarse grids
  double loose = 0.1;        ///< reduction of the energy norm of the error on a face that has not settled
  Index step_limit = 1000;   ///< steps
  Index cg_limit = 1000;     ///< iterations a face
  const Limits* limits = nullptr;

  End run(const BoxQp& qp, FacePreconditioner& B, Vec& z);

  // What the last run() did.
  long steps = 0;
  long cg_iterations = 0;
  double omega = 0;  ///< max_i |z_i - mid(l_i, z_i - g_i / a_ii, u_i)| a_ii / (|A| |z| + |q|)_i
  Vec direction{};
};

}  // namespace perp::lcp

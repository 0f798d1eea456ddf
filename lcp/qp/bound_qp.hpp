// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The affine MCP with symmetric positive semidefinite M as the quadratic program that it is the optimality condition
/// of,
///     min phi(z) = 1/2 z'M z + q'z   over l <= z <= u,
/// for up to millions of unknowns. On a face of the box (the unknowns not held at a bound by the sign of M z + q) the
/// equations M_FF d_F = -(M z + q)_F are solved by preconditioned conjugate gradients; the step is projected on the
/// box; projected Gauss-Seidel sweeps before each face give convergence from any start (face_descent.hpp has the
/// iteration).
///
/// Three preconditioners:
///  * Multilevel: an algebraic multigrid V-cycle, truncated to the face (lcp/linalg/multilevel.hpp), for M with mostly
///    negative entries off the diagonal (discretized second-order elliptic operators). The problem is first solved on
///    the coarse unknowns, from the coarsest grid to the finest. This places the free boundary of an obstacle problem
///    within a cell or two, at a small part of the cost on the finest grid.
///  * Cholesky: a factor of M_FF.
///  * GaussSeidel: a symmetric sweep. It needs no memory but that of M, and converges for every M, slowly if M is
///    ill-conditioned.
///
/// Terminates at a solution, with the residual at the level of rounding, for every positive definite M whose condition
/// leaves it digits, by the sweeps alone if need be (Luo & Tseng 1992, theorem 2.1). If M is singular the method of
/// proximal points (Rockafellar 1976) takes over: z+ solves the problem with eps D added to M, D its diagonal, and
/// -eps D z to q. It converges to a solution if there is one; else z+ - z tends to a direction d with M d = 0, q'd < 0
/// along which the box is unbounded (Pazy 1971; Banjac et al. 2019), and that is the certificate.
///
/// Answers: Solved (by the judge alone). NotApplicable: M is not symmetric (the message names the entry), or has d'M d
/// < 0 (the message has the value). A problem that is solved before the negative curvature is met is Solved
/// nevertheless. Infeasible: with `certificate` d, checked by proves_infeasible. Stalled, IterationLimit, TimeLimit,
/// Interrupted: z is the point reached, with the lowest phi met. OutOfMemory: not even a sweep fits.
///
/// References: Luo & Tseng, J. Optim. Theory Appl. 72 (1992) 7. Ruge & Stueben 1987. Kornhuber, Numer. Math. 69 (1994)
/// 167. More & Toraldo, SIAM J. Optim. 1 (1991) 93. Rockafellar, SIAM J. Control Optim. 14 (1976) 877. Pazy, Israel J.
/// Math. 9 (1971) 235. Banjac, Goulart, Stellato & Boyd, J. Optim. Theory Appl. 183 (2019) 490.
#include "lcp/judge/result.hpp"

namespace perp::lcp {

struct BoundQp {
  enum class Preconditioner {
    Auto,  ///< Multilevel for more than `direct` unknowns and M with mostly negative entries; else Cholesky
    Multilevel,
    Cholesky,
    GaussSeidel,
  };
  Preconditioner preconditioner = Preconditioner::Auto;

  /// With Multilevel: start from the solutions on coarser grids, unless phi is lower at the start given. 500 x 500
  /// obstacle problem: 0.45 s with it, 1.3 s without.
  bool nested = true;
  /// Up to this many unknowns Auto factors; the coarsest grid has not more.
  Index direct = 1000;
  /// Steps (a sweep forth and back and a face) in all.
  Index step_limit = 10000;
};
void describe(BoundQp& method, Fields& fields);

/// Result::iterations counts steps on the finest grid, Result::factorizations those of coarsest grids too.
Result bound_qp(const AffineMcp& problem, In start, const BoundQp& options = {}, const Limits& limits = {});

}  // namespace perp::lcp

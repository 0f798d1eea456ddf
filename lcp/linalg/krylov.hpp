// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Inexact solution of  H d = b,  H = Da + Db J  (Da, Db diagonal, J sparse, n x n): the systems of semismooth Newton
/// methods, in memory that is a small multiple of J's.
///
/// A row with Db_i max_j |J_ij| negligible beside Da_i says d_i = b_i / Da_i: such unknowns, held at a bound, are known
/// and leave. The others' rows are divided by Db_i,
///     (D + J) d = b / Db,   D = Da / Db,
/// so that what remains of a symmetric J is symmetric, and positive definite if J is and D >= 0. Then conjugate
/// gradients preconditioned by an algebraic multigrid V-cycle of that very block (multilevel.hpp) are tried where most
/// entries off the diagonal are negative. Everything else, and what those fail at, gets BiCGSTAB with an incomplete LU
/// factorization ILUT(drop, fill) of H's block (Eigen's). Both stop at
///     ||H d - b||_2 <= eta ||b||_2.
/// References: van der Vorst, SIAM J. Sci. Stat. Comput. 13 (1992) 631; Saad, Numer. Linear Algebra Appl. 1 (1994) 387
/// (ILUT); Stueben 2001 (multigrid); Paige & Saunders, ACM TOMS 8 (1982) 43 (damped least squares).
#include <memory>

#include "lcp/judge/result.hpp"

namespace perp::lcp {

struct KrylovOptions {
  int max_iterations = 300;  ///< of one solve with one preconditioner
  double strength = 0.25;    ///< multigrid: as BoundQp::strength
  Index coarsest = 500;      ///< multigrid: unknowns of the coarsest grid
  double drop = 1e-4;        ///< ILUT: entries below drop times their row's norm go
  int fill = 8;              ///< ILUT: entries a row, in units of J's mean
};

enum class KrylovEnd {
  Solved,
  NotConverged,  ///< max_iterations, or the residual has stopped falling
  Stopped,       ///< by the limits
};
enum class KrylovKind { None, ConjugateGradients, BiCgStab };  ///< None: every unknown was known

struct KrylovResult {
  KrylovEnd end = KrylovEnd::NotConverged;
  KrylovKind kind = KrylovKind::None;  ///< that gave d
  int iterations = 0;                  ///< of all that were tried
  double reduction = 1;                ///< ||H d - b|| / ||b||, evaluated
  Vec d;
  bool solved() const { return end == KrylovEnd::Solved; }
};

/// One matrix H with its preconditioners, made when they are first needed and kept for other right-hand sides.
class KrylovSystem {
 public:
  /// J is not copied and must live as long. Of the limits, deadline and interrupted are looked at before each
  /// preconditioner is made and each iteration. Pre: square with n rows, as have Da and Db.
  KrylovSystem(const SpMat& J, In Da, In Db, const KrylovOptions& options = {}, const Limits& limits = {});
  ~KrylovSystem();
  KrylovSystem(KrylovSystem&&) noexcept;
  KrylovSystem& operator=(KrylovSystem&&) noexcept;

  /// Pre: b has n rows, 0 < eta < 1. Never Solved if Da_i = Db_i = 0 in a row.
  KrylovResult solve(In b, double eta);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// d approximately minimising ||H d - b||^2 + nu ||d||^2, by conjugate gradients on the normal equations (CGLS) scaled
/// by the norms of H's columns, until their residual has fallen to `eta`, after `iterations` or at the limits' deadline
/// or interrupt. From d = 0 every iterate is a descent direction of 1/2 ||H d - b||^2, whatever H.
Vec damped_least_squares(const SpMat& J, In Da, In Db, In b, double nu, double eta, int iterations,
                         const Limits& limits = {});

}  // namespace perp::lcp

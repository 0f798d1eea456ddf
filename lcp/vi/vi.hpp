// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Affine variational inequalities over polyhedra (polyhedron.hpp), and the judge of all variational inequalities over
/// them: the natural map of C itself,
///     r(x) = || x - p*(x - F(x)) ||_inf,   p* the projection on C (projection.hpp),
/// which is zero exactly at the solutions, and knows no multipliers, which need not be unique. What is called Solved
/// has r(x) <= tol with the projection's error in it, and of affine F that of F.
///
///     perp::lcp::ViResult r = perp::lcp::solve_vi({M, q, {A, rows, box}});
#include "lcp/vi/projection.hpp"

namespace perp::lcp {

struct Judgement;  // lcp/judge/judge.hpp

struct ViResult {
  Status status = Status::Stalled;
  std::string message;                 ///< what happened
  Vec x;                               ///< the best point met
  Vec F;                               ///< there
  double residual = infinity;          ///< r(x) is at most this
  double projection_error = infinity;  ///< so much of it bounds the errors of the projection and of affine F
  Index worst = -1;                    ///< where |x - p| is largest
  Vec multipliers;                     ///< lambda, of the rows
  Vec reduced;                         ///< nu = F(x) - A'lambda of the active bounds; 0 elsewhere
  Face face;                           ///< the projection's: the active rows and bounds
  bool empty = false;                  ///< Infeasible because C is empty
  Vec certificate{};    ///< Infeasible: proves_infeasible(lifted(vi), certificate), if it is of that kind
  long iterations = 0;  ///< pivots, or what the method for the lifted problem counts
  bool solved() const { return status == Status::Solved; }
  bool accepted() const { return solved() || status == Status::SolvedToRounding; }
};

struct ViOptions {
  enum class Method {
    Auto,   ///< Faces, then Lifted where that does not solve it
    Faces,  ///< face_pivoting.hpp: dense, M positive definite
    Lifted  ///< the MCP with multipliers, by lcp::solve()
  };
  Method method = Method::Auto;
};

/// Throws std::invalid_argument for malformed input.
ViResult solve_vi(const AffineVi& vi, const ViOptions& options = {}, const Limits& limits = {});

/// Judges x of an affine VI, whose F at x is the judged M x + q, nearest doubles. Not Solved where F overflows.
ViResult judge_affine_vi(Projector& projector, In x, const Judgement& of_F, Face face, const Limits& limits);
/// Judges x: everything but status Infeasible and iterations. `F_error` bounds the error of F in the 2-norm,
/// `terms` has the sizes of what F's entries are the rest of. Begins to look for the projection on `face`.
ViResult judge_vi(Projector& projector, In x, In F, double F_error, In terms, Face face, const Limits& limits);

}  // namespace perp::lcp

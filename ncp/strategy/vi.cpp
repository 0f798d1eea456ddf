// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/vi.hpp"

#include "lcp/words.hpp"
#include "ncp/problem/lifted_vi.hpp"

namespace perp::ncp {
namespace {

/// Josephy's steps: two or three add all digits, or none.
constexpr int josephy_steps = 5;

class ProjectionJudge {
 public:
  ProjectionJudge(const Mcp& mcp, const SpMat& A, const Box& rows, const lcp::Limits& limits)
      : mcp_(mcp), limits_(limits), projector_({A, rows, mcp.box()}), J_(mcp.jacobian_pattern()) {}

  lcp::ViResult operator()(In x, const lcp::Face& face) {
    Vec F(mcp_.size());
    lcp::ViResult refused;
    refused.x = x;
    if (!mcp_.eval(x, F) || !F.allFinite() || !mcp_.jacobian(x, J_)) {
      refused.status = Status::EvaluationFailed;
      refused.message = "F is not defined at the point reached";
      return refused;
    }
    return lcp::judge_vi(projector_, x, F, 0, row_terms(J_, x, F).size, face, limits_);
  }
  /// The affine VI at the point judged last.
  lcp::AffineVi linearised(const lcp::ViResult& at) const { return {J_, at.F - J_ * at.x, projector_.polyhedron()}; }

 private:
  const Mcp& mcp_;
  const lcp::Limits& limits_;
  lcp::Projector projector_;
  SpMat J_;
};

}  // namespace

lcp::ViResult solve_vi(const Mcp& mcp, const SpMat& A, const Box& rows, In x0, const LiftedSolve& solve,
                       const lcp::Limits& limits) {
  if (const lcp::AffineMcp* affine = mcp.affine())
    return lcp::solve_vi({affine->M, affine->q, {A, rows, mcp.box()}}, {}, limits);
  const std::unique_ptr<Mcp> problem = lifted(mcp, A, rows);
  const Result found = solve(*problem, lifted_start(*problem, A, x0));
  ProjectionJudge judge(mcp, A, rows, limits);
  lcp::ViResult best = judge(found.x.head(mcp.size()), {});
  for (int step = 0; step < josephy_steps && !best.solved() && best.F.size() > 0; ++step) {
    const lcp::ViResult next = lcp::solve_vi(judge.linearised(best), {}, limits);
    if (next.x.size() != mcp.size() || !next.x.allFinite()) break;
    lcp::ViResult judged = judge(next.x, next.face);
    if (!(judged.residual < 0.5 * best.residual)) break;
    best = std::move(judged);
  }
  best.iterations = found.stats.iterations;
  if (best.accepted()) return best;
  if (!found.accepted()) best.status = found.status;
  best.message = found.accepted() ? best.message + ", though the problem with multipliers is solved" : found.message;
  if (found.status == Status::Infeasible || limits.reached()) return best;
  // The projection of x says whether C is empty; a proof is the affine one.
  const Index n = mcp.size();
  SpMat identity(n, n);
  identity.setIdentity();
  const lcp::ViResult nearest = lcp::solve_vi({identity, Vec(-best.x), {A, rows, mcp.box()}}, {}, limits);
  if (nearest.status != Status::Infeasible) return best;
  best.status = Status::Infeasible;
  best.message = nearest.message;
  best.empty = nearest.empty;
  best.certificate = nearest.certificate;
  return best;
}

lcp::ViResult solve_vi(const Mcp& mcp, const SpMat& A, const Box& rows, In x0, const Stop& stop) {
  lcp::Limits limits{.tol = stop.tol, .deadline = lcp::deadline_after(stop.max_time)};
  if (stop.interrupt != nullptr) limits.interrupted = [flag = stop.interrupt] { return flag->load(); };
  const Method method = automatic(stop);
  return solve_vi(
      mcp, A, rows, x0, [&](const Mcp& problem, const Vec& z0) { return solve(problem, z0, method); }, limits);
}

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/vi.hpp"

#include "ncp/problem/affine.hpp"
#include "ncp/problem/lifted_vi.hpp"

namespace perp::ncp {
namespace {

/// Josephy's steps: two or three add all digits, or none.
constexpr int josephy_steps = 5;

/// The first rows and columns.
SpMat leading(const SpMat& M, Index n) { return M.topLeftCorner(n, n); }

class ProjectionJudge {
 public:
  ProjectionJudge(const Mcp& lifted, const lcp::Limits& limits)
      : lifted_(lifted), limits_(limits), projector_(*lifted.polyhedron()), J_(lifted.jacobian_pattern()) {}

  lcp::ViResult operator()(In x, const lcp::Face& face) {
    const Index n = x.size();
    Vec z = Vec::Zero(lifted_.size()), F(z.size());
    z.head(n) = x;
    lcp::ViResult refused;
    refused.x = x;
    if (!lifted_.eval(z, F) || !F.allFinite()) {
      refused.status = Status::EvaluationFailed;
      refused.message = "F is not defined at the point reached";
      return refused;
    }
    const Vec F_x = F.head(n);
    has_J_ = lifted_.jacobian(z, J_);
    const Vec terms = has_J_ ? row_terms(leading(J_, n), x, F_x).size : Vec(F_x.cwiseAbs());
    return lcp::judge_vi(projector_, x, F_x, 0, terms, face, limits_);
  }
  bool has_jacobian() const { return has_J_; }  ///< at the point judged last
  /// The affine VI there.
  lcp::AffineVi linearised(const lcp::ViResult& at) const {
    SpMat J = leading(J_, at.x.size());
    Vec q = at.F - J * at.x;
    return {std::move(J), std::move(q), projector_.polyhedron()};
  }

 private:
  const Mcp& lifted_;
  const lcp::Limits& limits_;
  lcp::Projector projector_;
  SpMat J_;
  bool has_J_ = false;
};

}  // namespace

lcp::ViResult solve_vi(const Mcp& lifted, const std::function<Result()>& solve, const lcp::Limits& limits) {
  const lcp::Polyhedron& C = *lifted.polyhedron();
  const Index n = C.size();
  if (const auto affine = affine_part(lifted))
    return lcp::solve_vi({leading(affine->M, n), affine->q.head(n), C}, {}, limits);
  const Result found = solve();
  ProjectionJudge judge(lifted, limits);
  lcp::ViResult best = judge(found.x.head(n), {});
  for (int step = 0; step < josephy_steps && !best.solved() && judge.has_jacobian(); ++step) {
    const lcp::ViResult next = lcp::solve_vi(judge.linearised(best), {}, limits);
    if (next.x.size() != n || !next.x.allFinite()) break;
    lcp::ViResult judged = judge(next.x, next.face);
    if (!(judged.residual < 0.5 * best.residual)) break;
    best = std::move(judged);
  }
  best.iterations = found.stats.iterations;
  if (best.accepted()) return best;
  if (!found.accepted()) best.status = found.status;
  best.message +=
      found.accepted() ? ", though the problem with multipliers is solved" : "; with multipliers: " + found.message;
  if (limits.reached()) return best;
  // The projection of x says whether C is empty; a proof is the affine one.
  SpMat identity(n, n);
  identity.setIdentity();
  const lcp::ViResult nearest = lcp::solve_vi({identity, Vec(-best.x), C}, {}, limits);
  if (nearest.status != Status::Infeasible) return best;
  best.status = Status::Infeasible;
  best.message = nearest.message;
  best.empty = nearest.empty;
  best.certificate = nearest.certificate;
  return best;
}

lcp::ViResult solve_vi(const Mcp& mcp, const SpMat& A, const Box& rows, In x0, const Stop& stop) {
  if (const lcp::AffineMcp* affine = mcp.affine())
    return lcp::solve_vi({affine->M, affine->q, {A, rows, mcp.box()}}, {}, vi_limits(stop));
  const Method method = automatic(stop);
  const std::unique_ptr<Mcp> problem = lifted(mcp, A, rows);
  return solve_vi(
      *problem, [&] { return solve(*problem, lifted_point(*problem, x0, Vec::Zero(A.rows())), method); },
      vi_limits(stop));
}

lcp::Limits vi_limits(const Stop& stop) {
  lcp::Limits limits{.tol = stop.tol, .deadline = lcp::deadline_after(stop.max_time)};
  if (stop.interrupt != nullptr) limits.interrupted = [flag = stop.interrupt] { return flag->load(); };
  return limits;
}

lcp::ViResult judge_vi(const Mcp& lifted, In x, const lcp::Limits& limits) {
  return ProjectionJudge(lifted, limits)(x, {});
}

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
/// Variational inequalities over polyhedra.
#include <utility>

#include "capi/describe.hpp"
#include "capi/guard.hpp"
#include "capi/matrix.hpp"
#include "capi/solve.hpp"
#include "ncp/problem/lifted_vi.hpp"
#include "ncp/settings/session.hpp"

namespace perp::capi {

namespace {

settings::Outcome vi_outcome(Work& work, const perp_problem& problem, const SpMat& A, const lcp::Box& rows,
                             const Vec& x0) {
  const settings::Settings& settings = work.solver().options.settings;
  if (const lcp::AffineMcp* affine = problem.mcp.affine()) {  // needs no problem with multipliers
    lcp::Limits limits = ncp::vi_limits(ncp::stop(settings.method));
    limits.interrupted = [&work] { return work.stop()->load(); };
    return {.vi = lcp::solve_vi({affine->M, affine->q, {A, rows, problem.mcp.box()}}, {}, limits)};
  }
  const std::unique_ptr<ncp::Mcp> lifted = ncp::lifted(problem.mcp, A, rows, problem.mcp.first());
  const Vec z0 = ncp::lifted_point(*lifted, x0, Vec::Zero(A.rows()));
  return settings::Session{.mcp = *lifted, .x0 = z0, .settings = settings, .interrupt = work.stop()}.run();
}

Part vi_solved(Work& work, const perp_problem& problem, const SpMat& A, const lcp::Box& rows, const Vec& x0) {
  settings::Outcome outcome = work.watch().over([&] { return vi_outcome(work, problem, A, rows, x0); });
  lcp::ViResult& result = *outcome.vi;
  work.watch().check();
  if (!result.accepted() && *work.stop()) {
    result.status = Status::Interrupted;
    result.message = "interrupted";
  }
  Part part = std::make_unique<perp_result>();
  part->status = static_cast<std::int32_t>(result.status);
  part->add("status", to_string(result.status))
      .add("success", result.solved())
      .add("message", result.message)
      .add("x", std::move(result.x))
      .add("F", std::move(result.F))
      .add("residual", result.residual)
      .add("projection_error", result.projection_error)
      .add("worst", result.worst)
      .add("multipliers", std::move(result.multipliers))
      .add("reduced", std::move(result.reduced))
      .add("rows", result.face.rows)
      .add("bounds", result.face.bounds)
      .add("empty", result.empty)
      .add("certificate", std::move(result.certificate))
      .add("iterations", result.iterations);
  if (problem.mcp.affine() == nullptr) part->add("stats", part_of(outcome.result.stats, problem.callbacks));
  return part;
}

}  // namespace

}  // namespace perp::capi

using namespace perp::capi;  // NOLINT(google-build-using-namespace): what follows is the interface of C

int32_t perp_vi(perp_solver* solver, const perp_problem* problem, const perp_matrix* A, const double* lower,
                const double* upper, const double* x0, perp_result** result, perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    require(problem, "problem");
    require(A, "A");
    const auto rows = matrix_of(A, "A", -1, problem->mcp.size()).entries;
    Work work(solver, problem->callbacks);
    return vi_solved(work, *problem, rows, box_of(lower, upper, rows.rows()), start_of(*problem, x0, "x0"));
  });
}

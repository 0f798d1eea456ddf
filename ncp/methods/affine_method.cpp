// SPDX-License-Identifier: Apache-2.0
#include "ncp/methods/affine_method.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <variant>

#include "ncp/problem/affine.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {
namespace {

/// A method that does not get there is no progress, a ray or a singular matrix is its reason.
Status status_of(Status affine) {
  if (affine == Status::Singular) return Status::LinearAlgebraFailed;
  return affine == Status::Ray || affine == Status::Stalled ? Status::NoProgress : affine;
}

const char* advice(Status status, bool automatic) {
  if (status == Status::TimeLimit) return "raise the time limit";
  return automatic ? "the problem may have no solution; a nonlinear method (semismooth) may still find one"
                   : "try --method auto";
}

}  // namespace

void affine(Run& run, In x0, const Affine& method) {
  const Mcp& mcp = run.mcp();
  const auto problem = affine_part(mcp);
  if (!problem)
    throw std::invalid_argument(mcp.name() + ": method " + std::string(lcp::name(method.method)) +
                                " is for affine problems, and this one does not say it is one");
  Point point;
  if (!run.start(x0, point, false)) return;
  Iteration it{.k = 0, .kind = 'I'};
  if (!run.go_on(point, it)) return;
  lcp::Limits limits{.tol = run.tol(), .deadline = run.deadline()};
  limits.interrupted = [&run] { return run.interrupted(); };
  const lcp::Result found = lcp::solve(*problem, point.x, method.method, limits);
  run.stats().factorizations += found.factorizations;
  point.x = found.z;
  it = {.k = 1, .kind = 'A'};
  const bool open = !run.counted().eval(point.x, point.F) || run.go_on(point, it);
  if (open && found.status == Status::Infeasible)
    run.end_infeasible({.residual_bound = found.refutation->tolerance,
                        .certificate = found.refutation,
                        .multipliers = found.certificate},
                       found.message);
  else if (open)
    run.end(found.accepted() ? Status::NoProgress : status_of(found.status), found.message,
            advice(found.status, std::holds_alternative<lcp::Auto>(method.method)));
  run.stats().iterations = static_cast<int>(std::min<long>(found.iterations, std::numeric_limits<int>::max()));
  if (run.status() == Status::Solved) run.remark(found.message);
}

void describe(Affine& method, Fields& f) {
  std::visit([&](auto& m) { describe(m, f); }, method.method);
}

}  // namespace perp::ncp

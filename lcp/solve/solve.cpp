// SPDX-License-Identifier: Apache-2.0
#include "lcp/solve/solve.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "lcp/judge/judge.hpp"
#include "lcp/judge/shared_options.hpp"
#include "lcp/linalg/equation_order.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {

std::span<const MethodEntry> methods() {
  static const std::array table{
      MethodEntry{"auto", "chooses from the structure of M, says why, and falls back on the others", "perp", Auto{}},
      MethodEntry{"lemke", "complementary pivoting along a ray, sparse, any box", "Lemke 1965; Dirkse & Ferris 1995",
                  Lemke{}},
      MethodEntry{"lemke-howson", "complementary pivoting with a missing label: bimatrix games and their like",
                  "Lemke & Howson 1964", LemkeHowson{}},
      MethodEntry{"principal-pivoting", "drives one variable after the other to feasibility; sufficient matrices",
                  "Cottle & Dantzig 1968; Cottle, Pang & Stone 1992", PrincipalPivoting{}},
      MethodEntry{"block-pivoting", "exchanges all infeasible variables at once; finite for P-matrices",
                  "Kostreva 1978; Judice & Pires 1994", BlockPivoting{}},
      MethodEntry{"least-index", "exchanges the first infeasible variable; finite for P-matrices", "Murty 1974",
                  BlockPivoting{.p_max = 0, .components = false}},
      MethodEntry{"psor", "projected successive over-relaxation: symmetric positive definite or H-matrices",
                  "Cryer 1971; Mangasarian 1977", ProjectedSor{}},
      MethodEntry{"interior-point", "infeasible predictor-corrector primal-dual interior points; monotone problems",
                  "Mehrotra 1992; Wright 1997", InteriorPoint{}},
      MethodEntry{"qp", "symmetric positive semidefinite M: active sets, conjugate gradients, multigrid",
                  "Kornhuber 1994; More & Toraldo 1991", BoundQp{}},
      MethodEntry{"enumeration",
                  "all complementary cells, for at most 20 bounded variables: finds a solution or proves "
                  "there is none",
                  "Murty 1988", Enumeration{}},
  };
  return table;
}

std::string_view name(const Method& method) {
  if (const auto* block = std::get_if<BlockPivoting>(&method); block != nullptr && block->p_max == 0)
    return "least-index";
  const auto entry =
      std::ranges::find_if(methods(), [&](const MethodEntry& e) { return e.method.index() == method.index(); });
  return entry == methods().end() ? "?" : entry->name;
}

void describe(Lemke& m, Fields& f) {
  describe_start(m.options.start, f);
  describe(m.options, f);
}

namespace {

/// A path ends within the tolerance relative to q. Where that is more than the one asked for, new ones from its end:
/// they take a few pivots, through cells that rounding had confused. What Harris' tolerance lets a variable overstep in
/// the equilibrated units may be more than the tolerance in the problem's own, so there is none.
PivotResult to_tolerance(const AffineMcp& problem, LemkeOptions options, double tol, PivotResult path) {
  constexpr int tries = 2;
  options.start = LemkeStart::Regular;
  options.feasibility_tol = 0;
  for (int k = 0; k < tries && path.solved() && path.residual > tol && path.pivots < options.max_pivots; ++k) {
    options.cells = path.cells;
    options.max_pivots -= path.pivots;
    PivotResult again = lemke(problem, path.x, options);
    again.pivots += path.pivots;
    again.refactorizations += path.refactorizations;
    if (!again.solved() || again.residual >= path.residual) {
      path.pivots = again.pivots;
      path.refactorizations = again.refactorizations;
    } else {
      path = std::move(again);
    }
    options.seed += 1;
  }
  return path;
}

Result by_lemke(const AffineMcp& problem, In start, const Lemke& method, const Limits& limits) {
  LemkeOptions options = method.options;
  options.residual_tol = limits.tol;
  options.deadline = std::min(options.deadline, limits.deadline);
  if (limits.interrupted) options.interrupted = limits.interrupted;
  const PivotResult path = to_tolerance(problem, options, limits.tol, lemke(problem, start, options));
  const auto [status, message] = [&]() -> std::pair<Status, std::string> {
    switch (path.end) {
      case PivotEnd::Ray:
        if (path.certificate.size() > 0)
          return {Status::Infeasible,
                  "the path ends on a ray whose direction proves that there is no solution (the certificate)"};
        return {Status::Ray, "the path ends on a ray, which proves nothing for this matrix"};
      case PivotEnd::Loop:
        return {Status::Stalled, "the path is closed"};
      case PivotEnd::SingularBasis:
        return {Status::Singular, "a basis on the path is singular"};
      case PivotEnd::PivotLimit:
        return {Status::IterationLimit, "the limit of " + std::to_string(options.max_pivots) + " pivots was reached"};
      case PivotEnd::TimeLimit:
        return {Status::TimeLimit, "the time limit was reached"};
      case PivotEnd::Interrupted:
        return {Status::Interrupted, "interrupted"};
      case PivotEnd::Solved:
      case PivotEnd::Inaccurate:
        break;
    }
    return {Status::Stalled, "the path's end is not accurate to the tolerance"};
  }();
  Result result = judged(problem, path.z, limits, status, message);
  if (result.status == Status::Infeasible) result.certificate = path.certificate;
  result.iterations = path.pivots;
  result.factorizations = path.refactorizations;
  return result;
}

}  // namespace

Result lemke_method(const AffineMcp& problem, In start, const Lemke& method, const Limits& limits) {
  check_input("lemke", problem, start, limits);
  return by_lemke(problem, start, method, limits);
}

namespace {

/// At the door of a solution the last digits may be had.
void refine(const AffineMcp& problem, const Limits& limits, Result& result) {
  if (result.status != Status::SolvedToRounding && result.status != Status::Stalled) return;
  if (!worth_refining(judge(problem, result.z), limits.tol)) return;
  Result better = judged(problem, refined(problem, result.z, limits.tol), limits, result.status, result.message);
  ++result.factorizations;
  if (!better.accepted()) return;
  result.status = better.status;
  result.message = better.message.empty() ? "after refinement" : better.message;
  result.z = better.z;
  result.residual = better.residual;
  result.relative = better.relative;
}

}  // namespace

namespace {

/// Infeasible means that no point has a residual of at most the tolerance: a proof of less is no answer.
void prove(const AffineMcp& problem, const Limits& limits, Result& result) {
  if (result.status != Status::Infeasible) return;
  if (!result.refutation)
    result.refutation = std::make_shared<const Refutation>(refute(problem, result.certificate, limits.tol));
  const double excluded = result.refutation->tolerance;
  if (excluded >= limits.tol) return;
  result.status = Status::Stalled;
  result.message = excluded > 0
                       ? text_of(
                             "the numbers of the problem contradict each other, but by less than the tolerance: no "
                             "point has a residual below ",
                             excluded)
                       : "the method found a contradiction that rounding may have made";
  result.refutation.reset();
  result.certificate.resize(0);
}

}  // namespace

Result solve_in_order(const AffineMcp& problem, In start, const Method& method, const Limits& limits) {
  const Overloaded run{[&](const Auto& m) { return automatic(problem, start, m, limits); },
                       [&](const Lemke& m) { return lemke_method(problem, start, m, limits); },
                       [&](const LemkeHowson& m) { return lemke_howson(problem, start, m, limits); },
                       [&](const PrincipalPivoting& m) { return principal_pivoting(problem, start, m, limits); },
                       [&](const BlockPivoting& m) { return block_pivoting(problem, start, m, limits); },
                       [&](const ProjectedSor& m) { return projected_sor(problem, start, m, limits); },
                       [&](const InteriorPoint& m) { return interior_point(problem, start, m, limits); },
                       [&](const BoundQp& m) { return bound_qp(problem, start, m, limits); },
                       [&](const Enumeration& m) { return enumeration(problem, start, m, limits); }};
  Result result = std::visit(run, method);
  refine(problem, limits, result);
  prove(problem, limits, result);
  return result;
}

Result solve(const AffineMcp& problem, In start, const Method& method, const Limits& limits) {
  const auto order = problem.invalid() ? std::nullopt : equation_order(problem.M, problem.box);
  if (!order) return solve_in_order(problem, start, method, limits);
  Result result = solve_in_order(order->apply(problem), start, method, limits);
  if (result.certificate.size() > 0) result.certificate = order->multipliers_back(result.certificate);
  if (result.refutation) result.refutation = std::make_shared<const Refutation>(order->back(*result.refutation));
  return result;
}

}  // namespace perp::lcp

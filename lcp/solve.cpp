#include "lcp/solve.hpp"

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

namespace perp::lcp {

std::span<const MethodEntry> methods() {
  static const std::array table{
      MethodEntry{"auto", "chooses from the structure of M, says why, and falls back on the others", "perp", Auto{}},
      MethodEntry{"lemke", "complementary pivoting along a ray, sparse, any box", "Lemke 1965; Dirkse & Ferris 1995",
                  Lemke{}},
      MethodEntry{"block-pivoting", "exchanges all infeasible variables at once; finite for P-matrices",
                  "Kostreva 1978; Judice & Pires 1994", BlockPivoting{}},
      MethodEntry{"least-index", "exchanges the first infeasible variable; finite for P-matrices", "Murty 1974",
                  LeastIndex{}},
      MethodEntry{"qp", "symmetric positive semidefinite M: active sets, conjugate gradients, multigrid",
                  "Kornhuber 1994; More & Toraldo 1991", BoundQp{}},
  };
  return table;
}

std::string_view name(const Method& method) {
  const auto entry =
      std::ranges::find_if(methods(), [&](const MethodEntry& e) { return e.method.index() == method.index(); });
  return entry == methods().end() ? "?" : entry->name;
}

Result lemke_method(const AffineMcp& problem, In start, const Lemke& method, const Limits& limits) {
  check_input("lemke", problem, start, limits);
  LemkeOptions options = method.options;
  options.residual_tol = limits.tol;
  options.deadline = std::min(options.deadline, limits.deadline);
  if (limits.interrupted) options.interrupted = limits.interrupted;
  const PivotResult path = lemke(problem, start, options);
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

Result solve(const AffineMcp& problem, In start, const Method& method, const Limits& limits) {
  return std::visit(
      [&](const auto& m) {
        using M = std::remove_cvref_t<decltype(m)>;
        if constexpr (std::is_same_v<M, Auto>)
          return automatic(problem, start, m, limits);
        else if constexpr (std::is_same_v<M, Lemke>)
          return lemke_method(problem, start, m, limits);
        else if constexpr (std::is_same_v<M, BlockPivoting>)
          return block_pivoting(problem, start, m, limits);
        else if constexpr (std::is_same_v<M, LeastIndex>)
          return least_index(problem, start, m, limits);
        else
          return bound_qp(problem, start, m, limits);
      },
      method);
}

}  // namespace perp::lcp

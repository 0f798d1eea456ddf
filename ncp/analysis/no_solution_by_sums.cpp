// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <memory>
#include <vector>

#include "lcp/exact_sum.hpp"
#include "lcp/judge/infeasible.hpp"
#include "lcp/judge/refutation.hpp"
#include "ncp/analysis/demands.hpp"
#include "ncp/analysis/no_solution.hpp"
#include "ncp/analysis/row_sums.hpp"
#include "ncp/interval/exact_multipliers.hpp"

namespace perp::ncp {
namespace {

/// A proof within a radius is one of variables below it; terms may be beyond, as exp(72) is beyond 1e31. Of them it
/// needs the right sign of y'B where their range is infinite.
bool terms_keep_their_sign(const RowSums& sums, Index n, const lcp::Refutation& proof) {
  if (proof.radius == infinity) return true;
  if (!proof.proof.assumptions.empty()) return false;
  const Index all = sums.problem.size();
  std::vector<lcp::ExactSum> along(at(all - n));
  const SpMat by_row = sums.problem.M.transpose();
  for (const auto& [row, high, low] : proof.proof.y)
    for (SpMat::InnerIterator it(by_row, row); it; ++it)
      if (it.row() >= n) {
        along[at(it.row() - n)].add_product(it.value(), high);
        along[at(it.row() - n)].add_product(it.value(), low);
      }
  for (Index j = n; j < all; ++j) {
    const lcp::ExactSum& g = along[at(j - n)];
    if (!g.exact() || (g.sign() > 0 && sums.problem.box.upper[j] == infinity) ||
        (g.sign() < 0 && sums.problem.box.lower[j] == -infinity))
      return false;
  }
  return true;
}

lcp::Refutation exact_refutation(const lcp::AffineMcp& problem, In y) {
  lcp::Refutation proof;
  const std::optional<lcp::TwoPartVector> exact = exact_multipliers(problem, y);
  if (!exact) return proof;
  const lcp::Exclusion excluded = lcp::exclusion(problem, *exact);
  if (!(excluded.margin > 0) || excluded.wrong > 0) return proof;
  for (Index i = 0; i < y.size(); ++i)
    if (exact->value[i] != 0) proof.proof.y.push_back({i, exact->value[i], exact->rest[i]});
  lcp::raise_tolerance(problem, proof, excluded.margin / excluded.size);
  return proof;
}

}  // namespace

std::optional<Infeasibility> no_solution_by_sums(const Mcp& mcp, double tol, lcp::Deadline deadline) {
  using namespace std::chrono_literals;
  std::optional<RowSums> sums = row_sums(mcp);
  if (!sums) return std::nullopt;
  const LinearDemands all(sums->problem, sums->rows);
  Demands demands = all.all();
  std::erase_if(demands, [](const Demand& d) { return d.of != Demand::Row; });
  const auto found = all.elastic(demands, sums->problem.box, std::min(deadline, std::chrono::steady_clock::now() + 1s));
  if (!found || !(found->total > 0)) return std::nullopt;
  Vec y = Vec::Zero(sums->problem.size());
  for (std::size_t k = 0; k < demands.size(); ++k) y[demands[k].index] = found->y[k];
  if (const Vec exact = lcp::exact_certificate(sums->problem, y, tol); exact.size() > 0) y = exact;
  const auto proves = [&](const lcp::Refutation& proof) {
    return proof.tolerance >= tol && lcp::holds(sums->problem, proof) &&
           terms_keep_their_sign(*sums, mcp.size(), proof);
  };
  lcp::Refutation proof = lcp::refute(sums->problem, y, tol, sums->rows);
  if (!proves(proof)) proof = exact_refutation(sums->problem, y);
  if (!proves(proof)) return std::nullopt;
  return Infeasibility{.residual_bound = proof.tolerance,
                       .within_bounds = true,
                       .certificate = std::make_shared<const lcp::Refutation>(std::move(proof)),
                       .sums = std::make_shared<const lcp::AffineMcp>(std::move(sums->problem)),
                       .multipliers = y.head(mcp.size())};
}

}  // namespace perp::ncp

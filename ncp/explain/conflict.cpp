// SPDX-License-Identifier: Apache-2.0
#include "ncp/explain/conflict.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "lcp/judge/infeasible.hpp"
#include "ncp/analysis/no_solution.hpp"

namespace perp::ncp {
namespace {

bool late(lcp::Deadline deadline) { return std::chrono::steady_clock::now() >= deadline; }

/// Returns whether the demands contradict each other; then only those with multipliers are left.
bool contradict(const LinearDemands& all, Demands& demands, Vec& y, lcp::Deadline deadline) {
  const auto found = all.elastic(demands, deadline);
  if (!found || !(found->total > 0)) return false;
  y = Vec::Zero(all.problem().size());
  for (std::size_t k = 0; k < demands.size(); ++k)
    if (demands[k].of == Demand::Row) y[demands[k].index] = found->y[k];
  demands = LinearDemands::support(demands, *found);
  return true;
}

/// Deletes parts of `items` as long as `contradicts` says that the rest, which it may make smaller, still does. Returns
/// whether there was time to try each one alone.
template <class Items, class Contradicts>
bool delete_what_can_go(Items& items, Contradicts contradicts, lcp::Deadline deadline) {
  for (std::size_t chunk = items.size() / 2; chunk > 0;) {
    bool smaller = false;
    for (std::size_t begin = 0; begin < items.size();) {
      if (late(deadline)) return false;
      Items rest = items;
      const auto first = rest.begin() + static_cast<std::ptrdiff_t>(begin);
      rest.erase(first, first + static_cast<std::ptrdiff_t>(std::min(chunk, items.size() - begin)));
      if (!rest.empty() && contradicts(rest)) {
        items = std::move(rest);
        smaller = true;
        chunk = std::min(chunk, std::max<std::size_t>(1, items.size() / 2));
      } else {
        begin += chunk;
      }
    }
    if (!smaller || chunk > 1) chunk /= 2;
  }
  return true;
}

}  // namespace

std::optional<Conflict> smallest_conflict(const LinearDemands& all, Demands first, lcp::Deadline deadline) {
  Vec y;
  if (!contradict(all, first, y, deadline)) return std::nullopt;
  Conflict out;
  out.smallest = all.has_one_proof(first) || delete_what_can_go(
                                                 first,
                                                 [&](Demands& rest) {
                                                   Vec found;
                                                   if (!contradict(all, rest, found, deadline)) return false;
                                                   y = std::move(found);
                                                   return true;
                                                 },
                                                 deadline);
  out.demands = std::move(first);
  Vec shown = Vec::Zero(y.size());
  for (const auto& [of, i] : out.demands)
    if (of == Demand::Row) shown[i] = y[i];
  if (const Vec exact = lcp::exact_certificate(all.problem(), shown);
      exact.size() > 0 && all.proves(out.demands, exact))
    if (lcp::Refutation proof = lcp::refutation_by(all.problem(), exact); proof.tolerance > 0)
      out.proof.certificate = std::make_shared<const lcp::Refutation>(std::move(proof));
  return out;
}

Conflict smallest_conflict(const lcp::AffineMcp& problem, const lcp::Refutation& certificate, double tol,
                           lcp::Deadline deadline) {
  Conflict out{.proof = {.certificate = std::make_shared<const lcp::Refutation>(certificate)}};
  std::vector<Index> rows = lcp::rows_of(certificate);
  std::vector<char> known;
  const auto refuted = [&](std::vector<Index>& rest) {
    known.assign(at(problem.size()), 0);
    for (const Index i : rest) known[at(i)] = 1;
    lcp::Refutation proof = lcp::refute(problem, Vec(), tol, known);
    if (!(proof.tolerance >= tol)) return false;
    rest = lcp::rows_of(proof);
    out.proof.certificate = std::make_shared<const lcp::Refutation>(std::move(proof));
    return true;
  };
  std::vector<Index> begin = rows;
  if (refuted(begin)) {
    rows = std::move(begin);
    out.smallest = delete_what_can_go(rows, refuted, deadline);
  }
  const auto has = [&](Index i) { return std::ranges::binary_search(rows, i); };
  for (const Index i : rows) out.demands.push_back({Demand::Row, i});
  for (Index j = 0; j < problem.size(); ++j) {
    bool met = has(j);
    for (SpMat::InnerIterator it(problem.M, j); it && !met; ++it) met = it.value() != 0 && has(it.row());
    if (met && problem.box.has_lower(j)) out.demands.push_back({Demand::Lower, j});
    if (met && problem.box.has_upper(j)) out.demands.push_back({Demand::Upper, j});
  }
  return out;
}

std::optional<Conflict> smallest_conflict(const Mcp& mcp, double tol, lcp::Deadline deadline) {
  const Box& box = mcp.box();
  Demands demands;
  for (Index i = 0; i < mcp.size(); ++i) {
    demands.push_back({Demand::Row, i});
    if (box.has_lower(i)) demands.push_back({Demand::Lower, i});
    if (box.has_upper(i)) demands.push_back({Demand::Upper, i});
  }
  const auto refuted = [&](const Demands& rest) {
    std::vector<char> rows(at(mcp.size()), 0);
    Box X = Box::free(mcp.size());
    for (const auto& [of, i] : rest) {
      if (of == Demand::Row) rows[at(i)] = 1;
      if (of == Demand::Lower) X.lower[i] = box.lower[i];
      if (of == Demand::Upper) X.upper[i] = box.upper[i];
    }
    return no_solution(mcp, tol, rows, X).has_value();
  };
  if (!refuted(demands)) return std::nullopt;
  const bool smallest = delete_what_can_go(demands, refuted, deadline);
  return Conflict{.demands = std::move(demands), .smallest = smallest};
}

}  // namespace perp::ncp

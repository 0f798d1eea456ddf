// SPDX-License-Identifier: Apache-2.0
#include "ncp/explain/conflict.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "lcp/solve/solve.hpp"
#include "ncp/analysis/no_solution.hpp"

namespace perp::ncp {
namespace {

/// Share of the largest multiplier below which there is only rounding of the methods, which stop at 1e-9.
constexpr double no_share = 1e-6;
/// Size of a miss, beside the constant of a scaled demand, below which it is rounding.
constexpr double missed_at_all = 1e-7;

bool late(lcp::Deadline deadline) { return std::chrono::steady_clock::now() >= deadline; }

}  // namespace

std::string_view to_string(Demand::Of of) {
  return of == Demand::Row ? "row" : of == Demand::Lower ? "lower bound" : "upper bound";
}

std::string name_of(const Mcp& mcp, const Demand& demand) {
  return demand.of == Demand::Row ? mcp.equation_name(demand.index) : mcp.variable_name(demand.index);
}

LinearDemands::LinearDemands(const lcp::AffineMcp& problem, const std::vector<char>& rows)
    : problem_(problem), rows_(rows), by_row_(problem.M.transpose()) {}

Demands LinearDemands::all() const {
  std::vector<Index> rows(at(problem_.size()));
  for (Index i = 0; i < problem_.size(); ++i) rows[at(i)] = i;
  return of_rows(rows);
}

Demands LinearDemands::of_rows(const std::vector<Index>& rows) const {
  const Box& box = problem_.box;
  std::vector<char> met(at(problem_.size()), 0);
  Demands out;
  for (const Index i : rows) {
    if (!known(i) || (box.has_lower(i) && box.has_upper(i))) continue;
    out.push_back({Demand::Row, i});
    for (SpMat::InnerIterator it(by_row_, i); it; ++it)
      if (it.value() != 0) met[at(it.row())] = 1;
  }
  for (Index j = 0; j < problem_.size(); ++j) {
    if (met[at(j)] == 0) continue;
    if (box.has_lower(j)) out.push_back({Demand::Lower, j});
    if (box.has_upper(j)) out.push_back({Demand::Upper, j});
  }
  return out;
}

std::optional<LinearDemands::Elastic> LinearDemands::elastic(const Demands& demands, lcp::Deadline deadline) const {
  return solve(demands, Box::free(problem_.size()), deadline);
}

std::optional<LinearDemands::Elastic> LinearDemands::repaired(const Demands& demands, lcp::Deadline deadline) const {
  Box hard = Box::free(problem_.size());
  for (Index j = 0; j < problem_.size(); ++j) {
    if (problem_.box.lower[j] == 0) hard.lower[j] = 0;
    if (problem_.box.upper[j] == 0) hard.upper[j] = 0;
  }
  Demands soft = demands;
  std::erase_if(soft, [&](const Demand& d) {
    return d.of != Demand::Row && (d.of == Demand::Lower ? problem_.box.lower : problem_.box.upper)[d.index] == 0;
  });
  std::optional<Elastic> found = solve(soft, hard, deadline);
  if (!found) return found;
  Elastic all{.z = std::move(found->z),
              .y = std::vector<double>(demands.size(), 0),
              .share = std::vector<double>(demands.size(), 0),
              .missed = std::vector<double>(demands.size(), 0),
              .total = found->total};
  for (std::size_t k = 0, s = 0; k < demands.size(); ++k) {
    if (s == soft.size() || !(soft[s] == demands[k])) continue;
    all.y[k] = found->y[s];
    all.share[k] = found->share[s];
    all.missed[k] = found->missed[s++];
  }
  return all;
}

std::optional<LinearDemands::Elastic> LinearDemands::solve(const Demands& demands, const Box& hard,
                                                           lcp::Deadline deadline) const {
  if (late(deadline)) return std::nullopt;
  const Box& box = problem_.box;
  std::vector<int> number(at(problem_.size()), -1);
  std::vector<Index> columns;
  const auto column = [&](Index j) {
    if (number[at(j)] < 0) {
      number[at(j)] = static_cast<int>(columns.size());
      columns.push_back(j);
    }
    return number[at(j)];
  };
  struct Entry {
    std::size_t demand;
    int column;
    double a;
  };
  std::vector<Entry> entries;
  const std::size_t m = demands.size();
  Vec scale = Vec::Ones(std::ssize(demands)), c(std::ssize(demands));
  for (std::size_t k = 0; k < m; ++k) {
    const auto& [of, i] = demands[k];
    const auto r = static_cast<Index>(k);
    if (of == Demand::Row) {
      double largest = 0;
      for (SpMat::InnerIterator it(by_row_, i); it; ++it) largest = std::max(largest, std::abs(it.value()));
      if (largest > 0) scale[r] = 1 / largest;
      for (SpMat::InnerIterator it(by_row_, i); it; ++it)
        if (it.value() != 0) entries.push_back({k, column(it.row()), scale[r] * it.value()});
      c[r] = scale[r] * problem_.q[i];
    } else {
      entries.push_back({k, column(i), 1});
      c[r] = -(of == Demand::Lower ? box.lower : box.upper)[i];
    }
  }
  const auto n = std::ssize(columns), size = n + std::ssize(demands);
  lcp::AffineMcp lp{.M = SpMat(size, size), .q = Vec::Zero(size), .box = Box::free(size)};
  std::vector<Eigen::Triplet<double>> triplets;
  for (const Entry& e : entries) {
    const auto row = static_cast<int>(n) + static_cast<int>(e.demand);
    triplets.emplace_back(row, e.column, e.a);
    triplets.emplace_back(e.column, row, -e.a);
  }
  lp.M.setFromTriplets(triplets.begin(), triplets.end());
  lp.q.tail(c.size()) = c;
  for (Index j = 0; j < n; ++j) {
    lp.box.lower[j] = hard.lower[columns[at(j)]];
    lp.box.upper[j] = hard.upper[columns[at(j)]];
  }
  for (std::size_t k = 0; k < m; ++k) {
    const auto& [of, i] = demands[k];
    const bool least = of == Demand::Lower || (of == Demand::Row && !box.has_upper(i));
    const bool most = of == Demand::Upper || (of == Demand::Row && !box.has_lower(i));
    // Hardly different weights: of changes with the same sum those of few demands are the least.
    const double golden = 0.618 * static_cast<double>(k), weight = 1 + 1e-4 * (golden - std::floor(golden));
    lp.box.lower[n + static_cast<Index>(k)] = most ? -weight : 0;
    lp.box.upper[n + static_cast<Index>(k)] = least ? weight : 0;
  }
  lcp::Limits limits;
  limits.deadline = deadline;
  const lcp::Result found = lcp::solve(lp, lcp::project(lp.box, Vec::Zero(size)), lcp::Auto{}, limits);
  if (!found.accepted()) return std::nullopt;
  Elastic out{.z = lcp::project(box, Vec::Zero(problem_.size())),
              .y = std::vector<double>(m),
              .share = std::vector<double>(m),
              .missed = std::vector<double>(m, 0)};
  for (Index j = 0; j < n; ++j) out.z[columns[at(j)]] = found.z[j];
  const Vec F = lp.M * found.z + lp.q;
  for (std::size_t k = 0; k < m; ++k) {
    const Index r = n + static_cast<Index>(k);
    out.share[k] = found.z[r];
    out.y[k] = found.z[r] * scale[static_cast<Index>(k)];
    const double value = F[r];
    const bool misses = (value < 0 && lp.box.upper[r] > 0) || (value > 0 && lp.box.lower[r] < 0);
    if (!misses || std::abs(value) <= missed_at_all * (1 + std::abs(c[static_cast<Index>(k)]))) continue;
    out.missed[k] = -value / scale[static_cast<Index>(k)];
    out.total += std::abs(value);
  }
  return out;
}

bool LinearDemands::has_one_proof(const Demands& demands) const {
  std::vector<char> bounded(at(problem_.size()), 0);
  std::vector<Index> rows;
  for (const auto& [of, i] : demands) of == Demand::Row ? rows.push_back(i) : void(bounded[at(i)] = 1);
  constexpr Index most = 1000;  // a dense matrix of so many rows takes seconds
  const auto m = std::ssize(rows);
  if (m == 0 || m > most) return false;
  SpMat A(problem_.size(), m);  // its columns are the rows, of length 1
  std::vector<Eigen::Triplet<double>> entries;
  for (Index k = 0; k < m; ++k) {
    double size = 0;
    for (SpMat::InnerIterator it(by_row_, rows[at(k)]); it; ++it) size = std::hypot(size, it.value());
    for (SpMat::InnerIterator it(by_row_, rows[at(k)]); it; ++it)
      if (!bounded[at(it.row())]) entries.emplace_back(it.row(), static_cast<int>(k), it.value() / size);
  }
  A.setFromTriplets(entries.begin(), entries.end());
  const Eigen::MatrixXd G = A.transpose() * A;
  const Vec values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(G, Eigen::EigenvaluesOnly).eigenvalues();
  constexpr double zero = 1e-10;
  return m == 1 ? values[0] <= zero : values[0] <= zero && values[1] > 1e3 * zero;
}

Demands LinearDemands::support(const Demands& demands, const Elastic& found) {
  double largest = 0;
  for (const double y : found.share) largest = std::max(largest, std::abs(y));
  Demands out;
  for (std::size_t k = 0; k < demands.size(); ++k)
    if (std::abs(found.share[k]) > no_share * largest) out.push_back(demands[k]);
  return out;
}

bool LinearDemands::proves(const Demands& demands, In y) const {
  const Box& box = problem_.box;
  Box Z = Box::free(problem_.size()), W = Box::free(problem_.size());
  for (const auto& [of, i] : demands) {
    if (of == Demand::Lower) Z.lower[i] = box.lower[i];
    if (of == Demand::Upper) Z.upper[i] = box.upper[i];
    if (of != Demand::Row) continue;
    if (!box.has_upper(i)) W.lower[i] = 0;
    if (!box.has_lower(i)) W.upper[i] = 0;
  }
  const lcp::Exclusion found = lcp::exclusion(problem_.M, problem_.q, Z, W, lcp::TwoPartVector(Vec(y)));
  return found.margin > lcp::proof_radius * found.wrong;
}

namespace {

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

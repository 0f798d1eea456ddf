// SPDX-License-Identifier: Apache-2.0
#include "ncp/analysis/demands.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lcp/dense_factors.hpp"
#include "lcp/judge/infeasible.hpp"
#include "lcp/solve/solve.hpp"

namespace perp::ncp {
namespace {

/// Share of the largest multiplier below which there is only rounding of the methods, which stop at 1e-9.
constexpr double no_share = 1e-6;
/// Size of a miss, beside the constant of a scaled demand, below which it is rounding.
constexpr double missed_at_all = 1e-7;

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
  return elastic(demands, Box::free(problem_.size()), deadline);
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
  std::optional<Elastic> found = elastic(soft, hard, deadline);
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

std::optional<LinearDemands::Elastic> LinearDemands::elastic(const Demands& demands, const Box& hard,
                                                             lcp::Deadline deadline) const {
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

}  // namespace perp::ncp

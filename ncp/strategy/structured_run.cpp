// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/structured_run.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lcp/linalg/block_triangular.hpp"
#include "lcp/linalg/blocks.hpp"
#include "lcp/linalg/equation_order.hpp"
#include "lcp/linalg/structure.hpp"
#include "ncp/strategy/run_plan.hpp"
#include "ncp/transforms/part_transform.hpp"

namespace perp::ncp {
namespace {

/// The pattern of J with ones.
SpMat ones(const SpMat& pattern) {
  SpMat P = pattern;
  P.coeffs().setOnes();
  return P;
}

std::vector<Index> free_variables(const Box& box) {
  std::vector<Index> free;
  for (Index i = 0; i < box.size(); ++i)
    if (box.is_free(i)) free.push_back(i);
  return free;
}

/// Equations that hold one free variable define it, v = g(x), and stand beside it with the sign that makes its
/// coefficient positive: then row factors may make J quasi-definite (lcp/linalg/quasi_definite.hpp). Nothing where they
/// stand there.
std::optional<lcp::EquationOrder> definitions(const SpMat& J, const Box& box) {
  const Index n = box.size();
  const std::vector<Index> free = free_variables(box);
  std::vector<Index> holds(at(n), 0), row(at(n), -1);  // of equations: their free variables; of those: the row
  lcp::EquationOrder order{.row_of = std::vector<Index>(at(n)), .sign = Vec::Ones(n)};
  for (const Index j : free)
    for (SpMat::InnerIterator it(J, j); it; ++it) ++holds[at(it.row())];
  for (const Index j : free)
    for (SpMat::InnerIterator it(J, j); it; ++it)
      if (box.is_free(it.row()) && holds[at(it.row())] == 1 && (row[at(j)] < 0 || it.row() == j)) {
        row[at(j)] = it.row();
        order.sign[j] = it.value() < 0 ? -1 : 1;
      }
  std::vector<char> taken(at(n), 0);
  for (const Index j : free)
    if (row[at(j)] >= 0) taken[at(row[at(j)])] = 1;
  for (const Index j : free)  // the others stay where they can
    if (row[at(j)] < 0 && !taken[at(j)]) row[at(j)] = j, taken[at(j)] = 1;
  auto next = free.begin();
  for (const Index j : free) {
    if (row[at(j)] >= 0) continue;
    while (taken[at(*next)]) ++next;
    row[at(j)] = *next++;
  }
  bool same = true;
  for (Index j = 0; j < n; ++j) {
    order.row_of[at(j)] = box.is_free(j) ? row[at(j)] : j;
    same = same && order.row_of[at(j)] == j && order.sign[j] > 0;
  }
  return same ? std::nullopt : std::optional(order);
}

/// By the values of J at x, which are asked for only where its pattern is not symmetric as it is, or F is affine.
std::optional<lcp::EquationOrder> order_of_equations(Run& run, const Vec& x) {
  const Mcp& mcp = run.mcp();
  if (free_variables(mcp.box()).empty()) return std::nullopt;
  if (!mcp.is_affine()) {
    const SpMat P = ones(mcp.jacobian_pattern());
    const SpMat D = P - SpMat(P.transpose());
    if (D.coeffs().isZero(0)) return std::nullopt;
  }
  SpMat J = mcp.jacobian_pattern();
  if (!run.counted().jacobian(x, J)) return std::nullopt;
  auto order = lcp::equation_order(J, mcp.box());
  return order || mcp.is_affine() ? order : definitions(J, mcp.box());
}

/// The rows beside the variables, as many of the free ones as can be in rows that they are in.
std::vector<Index> matched_rows(const Mcp& mcp, const SpMat& pattern) {
  std::vector<Index> row_of(at(mcp.size()));
  std::iota(row_of.begin(), row_of.end(), Index{0});
  const std::vector<Index> free = free_variables(mcp.box());
  if (free.empty()) return row_of;
  const lcp::Matching matching = lcp::maximum_matching(lcp::principal_block(pattern, free), lcp::Entries::Stored);
  std::vector<Index> alone;  // rows, those beside a variable that is alone as well last
  for (std::size_t k = 0; k < free.size(); ++k)
    if (matching.column_of_row[k] < 0 && matching.row_of_column[k] >= 0) alone.push_back(free[k]);
  for (std::size_t k = 0; k < free.size(); ++k) {
    const Index row = matching.row_of_column[k];
    if (row >= 0) {
      row_of[at(free[k])] = free[at(row)];
    } else if (matching.column_of_row[k] >= 0) {
      row_of[at(free[k])] = alone.back();
      alone.pop_back();
    }
  }
  return row_of;
}

/// J is block lower triangular in this order: rows of block k depend on the columns of the blocks up to it alone.
struct Blocks {
  lcp::Components components;
  std::vector<Index> row_of;
};

Blocks blocks_of(const Mcp& mcp, const SpMat& pattern) {
  Blocks blocks{.components = {}, .row_of = matched_rows(mcp, pattern)};
  const lcp::EquationOrder order{.row_of = blocks.row_of, .sign = Vec::Ones(mcp.size())};
  blocks.components = lcp::strong_components(order.apply({.M = pattern, .q = Vec::Zero(mcp.size()), .box = mcp.box()}));
  return blocks;
}

/// Ones where J is not zero at x0 or at a point near it: functions whose J is dense give no other pattern. What it
/// misses the judge sees. Nothing where J is not defined.
std::optional<SpMat> entries_near(Run& run, In x0) {
  const Box& box = run.box();
  Vec x = lcp::project(box, x0);
  SpMat entries = run.mcp().jacobian_pattern();
  entries.coeffs().setZero();
  for (const bool moved : {false, true}) {
    if (moved)
      for (Index j = 0; j < x.size(); ++j)
        x[j] += 0.1 * std::max(1.0, std::abs(x[j])) * std::sin(1.7 * static_cast<double>(j + 1));
    SpMat J = run.mcp().jacobian_pattern();
    if (!run.counted().jacobian(lcp::project(box, x), J)) return std::nullopt;
    entries.coeffs() = entries.coeffs().max((J.coeffs() != 0).cast<double>());
  }
  entries.prune([](Index, Index, double value) { return value != 0; });
  return entries;
}

/// Finds them by the pattern; where that is one block, by the entries near x0.
Blocks blocks_of(Run& run, In x0) {
  Blocks blocks = blocks_of(run.mcp(), ones(run.mcp().jacobian_pattern()));
  if (blocks.components.count() > 1) return blocks;
  if (const auto entries = entries_near(run, x0)) return blocks_of(run.mcp(), *entries);
  return blocks;
}

/// Several blocks together are tried for so many iterations: about twice what Newton's method takes from afar.
constexpr int joint_iterations = 30;

class Sweep {
 public:
  Sweep(Run& run, In x0, const Body& body, const Blocks& blocks)
      : run_(run), body_(body), blocks_(blocks), count_(blocks.components.count()), x_(lcp::project(run.box(), x0)) {}

  /// Whether all of it is solved. A limit of the run may end it.
  bool settles() {
    // More of them after so many successes; twice as many from each failure on, so that failures stay few.
    int patience = 1, successes = 0;
    for (Index done = 0, size = 1; done < count_;) {
      size = std::min(size, count_ - done);
      const bool last = done + size == count_;
      if (solve(done, size, last)) {
        done += size;
        if (++successes < patience) continue;
        size *= 2;
      } else if (run_.ended() || size == 1) {
        return false;
      } else {
        size /= 2;
        patience = std::min(2 * patience, 64);
      }
      successes = 0;
    }
    return run_.accepted();
  }

 private:
  /// An iteration on a part of the problem is that part of an iteration.
  void weigh(Stats& stats, std::size_t part) {
    weighed_ += static_cast<double>(stats.iterations) * static_cast<double>(part) / static_cast<double>(x_.size());
    stats.iterations = static_cast<int>(std::ceil(weighed_)) - counted_;
    counted_ += stats.iterations;
  }

  bool solve(Index first, Index size, bool last) {
    const auto& [order, begin] = blocks_.components;
    std::vector<Index> columns(order.begin() + begin[at(first)], order.begin() + begin[at(first + size)]);
    std::sort(columns.begin(), columns.end());
    std::vector<Index> rows;
    rows.reserve(columns.size());
    for (const Index j : columns) rows.push_back(blocks_.row_of[at(j)]);
    Point point;
    point.x = x_;
    const std::size_t part = columns.size();
    const PartTransform way(run_.mcp(), std::move(point), std::move(columns), std::move(rows));
    Share share = part_of_left(run_, false);
    if (size > 1) share.iterations = std::min(share.iterations, joint_iterations);
    bool accepted = false;
    Result result = run_.within(way, share, x_, body_, &accepted);
    weigh(result.stats, part);
    if (last && result.accepted())
      run_.take(result);
    else
      run_.charge(result);
    if (accepted) x_ = result.x;
    return accepted;
  }

  Run& run_;
  const Body& body_;
  const Blocks& blocks_;
  Index count_;
  Vec x_;
  double weighed_ = 0;
  int counted_ = 0;
};

}  // namespace

void run_in_order(Run& run, In x0, const Body& body) {
  Point point;
  point.x = lcp::project(run.box(), x0);
  std::optional<lcp::EquationOrder> order = order_of_equations(run, point.x);
  if (!order) return body(run, x0);
  std::vector<Index> all(at(run.mcp().size()));
  std::iota(all.begin(), all.end(), Index{0});
  const PartTransform way(run.mcp(), std::move(point), std::move(all), std::move(order->row_of), order->sign);
  std::string said;
  run.take(run.within(way, {}, x0, [&](Run& inner, In z0) {
    body(inner, z0);
    if (inner.ended()) said = inner.verdict().message;
  }));
  // The verdict is this run's, with what was remarked on the way.
  if (const auto remarks = said.find("; "); run.accepted() && remarks != std::string::npos)
    run.remark(said.substr(remarks + 2));
}

bool block_triangular(Run& run, In x0) { return !run.mcp().is_affine() && blocks_of(run, x0).components.count() > 1; }

void run_blocks(Run& run, In x0, const Body& body) {
  const Blocks blocks = blocks_of(run, x0);
  if (blocks.components.count() <= 1) return body(run, x0);
  if (!Sweep(run, x0, body, blocks).settles() && !run.ended())
    run.end(Status::NoProgress,
            "a block was not solved, for which another solution of those before it may be the cause", "");
  if (run.accepted()) run.keep_basis(cells_at(run.box(), run.best()));
}

}  // namespace perp::ncp

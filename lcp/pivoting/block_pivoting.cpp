// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/block_pivoting.hpp"

#include <algorithm>
#include <limits>
#include <unordered_set>
#include <utility>

#include "lcp/judge/cell.hpp"
#include "lcp/judge/shared_options.hpp"
#include "lcp/linalg/block_triangular.hpp"
#include "lcp/pivoting/coarse_problem.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

// A problem of at least so many unknowns that is not solved in so many rounds asks the coarser problem for cells.
constexpr Index coarse_from = 2000;
constexpr int rounds_before_coarse = 5;
constexpr Index coarse_rounds = 50;
// Signs within this x the size of the terms they come from are not violated.
constexpr double degenerate = 1e-11;
// Indices tried one by one where a block's matrix is singular: each takes a factorization.
constexpr std::size_t singular_tries = 20;

class BlockRun {
 public:
  BlockRun(const AffineMcp& problem, In start, const BlockPivoting& options, const Limits& limits,
           int rounds_alone = rounds_before_coarse)
      : problem_(problem),
        options_(options),
        limits_(limits),
        cell_(problem, options.lu, degenerate),
        cells_(cells_of(problem.box, start)),
        best_(problem, start),
        rounds_alone_(rounds_alone) {}

  Result run() {
    if (enter() != LuStatus::Ok) return singular("the start's block M_FF");
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    int patience = options_.p_max;
    for (;; ++rounds_) {
      const bool better = best_.offer(cell_.z());
      const std::vector<Index> V = cell_.all_violated(cells_);
      if (V.empty()) return end(Status::Stalled, "no sign is violated, but the residual is above the tolerance");
      if (rounds_ == options_.max_iterations) return end(Status::IterationLimit, left(V.size()));
      if (const auto reached = limits_.reached()) return end(*reached, left(V.size()));
      if (rounds_ == rounds_alone_ && from_coarser()) continue;

      if (V.size() < fewest) {
        fewest = V.size();
        patience = options_.p_max;
        seen_by_least_index_.clear();
      } else if (better) {
        patience = options_.p_max;
      } else if (patience > 0) {
        --patience;
      }
      if (!seen_.insert(key_of(cells_)).second) patience = 0;
      const bool block = patience > 0;
      if (!block && !seen_by_least_index_.insert(key_of(cells_)).second)
        return end(Status::Stalled, "the least-index rule cycles: M is not a P-matrix, or rounding; " + left(V.size()));
      if (const LuStatus status = exchange(V, block); status != LuStatus::Ok)
        return singular("every block M_FF that the exchanges lead to");
    }
  }

 private:
  LuStatus enter() {
    const LuStatus status = cell_.solve(cells_);
    if (status != LuStatus::Singular) return status;
    cells_ = all_inside(problem_.box);
    return cell_.solve(cells_);
  }

  /// Exchanges all of V or its least index; where that block is singular, the first of V that gives a regular one.
  LuStatus exchange(const std::vector<Index>& V, bool block) {
    const Cells before = cells_;
    Cells after = before;
    for (const Index i : V) after[static_cast<std::size_t>(i)] = cell_.exchanged(before, i);
    if (block && V.size() > 1) {
      cells_ = after;
      if (const LuStatus status = cell_.solve(cells_); status != LuStatus::Singular) return status;
    }
    ++least_index_;
    LuStatus status = LuStatus::Singular;
    const std::size_t tries = std::min(V.size(), singular_tries);
    for (std::size_t k = 0; k < tries && status == LuStatus::Singular; ++k) {
      cells_ = before;
      cells_[static_cast<std::size_t>(V[k])] = after[static_cast<std::size_t>(V[k])];
      status = cell_.solve(cells_);
    }
    return status;
  }

  /// Takes the cells of the coarser problem's solution, if there are such.
  bool from_coarser() {
    if (problem_.size() < coarse_from) return false;
    const auto coarse = coarser(problem_);
    if (!coarse) return false;
    BlockPivoting brief = options_;  // P'MP need not be a P-matrix, where rounds might go on
    brief.max_iterations = std::min(brief.max_iterations, coarse_rounds);
    BlockRun run(coarse->problem, lcp::project(coarse->problem.box, best_.z()(coarse->fine_of)), brief, limits_, 0);
    const Result result = run.run();
    coarse_factorizations_ += result.factorizations;
    if (!result.accepted()) return false;
    const Cells before = std::exchange(cells_, coarse->finer(run.cells_, problem_.box));
    if (cell_.solve(cells_) == LuStatus::Ok) return true;
    cells_ = before;
    return cell_.solve(cells_) == LuStatus::Ok;  // as it was
  }

  std::string left(std::size_t violated) const {
    return text_of(violated, violated == 1 ? " sign is" : " signs are", " violated");
  }

  Result singular(const std::string& which) { return end(Status::Singular, which + " is singular"); }

  Result end(Status status, const std::string& what) {
    Result result = judged(problem_, best_.z(), limits_, status, what);
    result.iterations = rounds_;
    result.factorizations = cell_.factorizations() + coarse_factorizations_;
    result.message += text_of((result.message.empty() ? "" : "; "), quantity(least_index_, "least-index step"), " in ",
                              quantity(rounds_, "round"));
    return result;
  }

  const AffineMcp& problem_;
  const BlockPivoting& options_;
  const Limits& limits_;
  CellSolver cell_;
  Cells cells_;
  Best best_;
  long rounds_ = 0;
  long least_index_ = 0;
  int rounds_alone_;
  int coarse_factorizations_ = 0;
  std::unordered_set<std::uint64_t> seen_;
  std::unordered_set<std::uint64_t> seen_by_least_index_;  ///< since |V| was smallest
};

Result by_components(const AffineMcp& problem, In start, const BlockPivoting& options, const Limits& limits) {
  Result result = solve_by_components(
      problem, start,
      [&](const AffineMcp& part, In at, const Limits& stop) { return BlockRun(part, at, options, stop).run(); },
      limits);
  result.message +=
      text_of((result.message.empty() ? "" : "; "), "by components: ", quantity(result.iterations, "round"));
  return result;
}

}  // namespace

void describe(BlockPivoting& m, Fields& f) {
  describe_iterations(m.max_iterations, f);
  f.add("block_rounds", &m.p_max, at_least(0), {});  // least-index is the method with 0
  describe_lu(m.lu, f);
}

Result block_pivoting(const AffineMcp& problem, In start, const BlockPivoting& options, const Limits& limits) {
  check_input("block_pivoting", problem, start, limits);
  refuse_invalid("block_pivoting", options);
  if (!options.components || strong_components(problem).count() <= 1)
    return BlockRun(problem, start, options, limits).run();
  Result parts = by_components(problem, start, options, limits);
  if (parts.accepted() || limits.reached()) return parts;
  Result whole = BlockRun(problem, start, options, limits).run();
  whole.iterations += parts.iterations;
  whole.factorizations += parts.factorizations;
  return whole;
}

}  // namespace perp::lcp

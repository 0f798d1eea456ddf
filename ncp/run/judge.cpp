// SPDX-License-Identifier: Apache-2.0
#include "ncp/run/judge.hpp"

#include <cmath>
#include <utility>

#include "ncp/problem/affine.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {
namespace {

/// Evaluations of F for moving entries to their bounds.
constexpr int most_moves = 24;

/// The bound that decides row i of a solution, where x_i is not on it.
std::optional<double> bound_of(const Box& box, Index i, double x, double F) {
  if (x > box.lower[i] && F > x - box.lower[i]) return box.lower[i];
  if (x < box.upper[i] && F < x - box.upper[i]) return box.upper[i];
  return std::nullopt;
}

}  // namespace

const lcp::AffineMcp* ExactValues::problem() {
  if (!std::exchange(affine_known_, true)) affine_ = affine_part(mcp_);
  return affine_.get();
}

const Vec& ExactValues::F(const Vec& x) {
  if (F_.size() == 0 || x_ != x) {
    F_ = lcp::judge(*affine_, x).F;
    x_ = x;
  }
  return F_;
}

void Judge::evaluate(Judged& point) {
  const Box& box = counted_.mcp().box();
  if (!counted_.eval(point.x, point.F)) {
    point.residual = Residual{};
    return;
  }
  if (exact_->problem() != nullptr) point.F = exact_->F(point.x);
  point.residual = residual(box, point.x, point.F);
}

/// Whether F, as it was evaluated, and the rounding of its sums leave the residual below the tolerance.
bool Judge::meets_without_doubt(const Judged& point, const SpMat* J) const {
  if (!counted_.mcp().is_affine()) return true;
  const SpMat& pattern = counted_.mcp().jacobian_pattern();
  if (J == nullptr || J->rows() != pattern.rows() || J->nonZeros() != pattern.nonZeros()) return false;
  return point.residual.natural + lcp::largest_rounding(row_terms(*J, point.x, point.F)) <= stop_.tol;
}

bool Judge::solved(Judged& point, const SpMat* J) {
  if (!meets(point)) return false;
  return word_ == Word::Preliminary && meets_without_doubt(point, J) ? snapped(point) : solved_at(point);
}

bool Judge::solved_at(Judged& point) {
  evaluate(point);
  return meets(point) && snapped(point);
}

/// Entries moved to their bounds; what is asked of the rows then.
bool Judge::snapped(Judged& point) {
  std::vector<Index> which;
  for (Index i = 0; i < point.x.size(); ++i)
    if (bound_of(counted_.mcp().box(), i, point.x[i], point.F[i])) which.push_back(i);
  if (which.empty()) return balanced(point);
  Judged moved = point;
  int tries = most_moves;
  moved_to_bounds(moved, which, tries);
  if (!balanced(moved)) return false;
  point = std::move(moved);
  return true;
}

/// All of them at once, or where that is no solution, each half of them.
bool Judge::moved_to_bounds(Judged& point, const std::vector<Index>& which, int& tries) {
  if (which.empty() || tries-- <= 0) return false;
  Judged moved = point;
  for (const Index i : which)
    if (const auto bound = bound_of(counted_.mcp().box(), i, point.x[i], point.F[i])) moved.x[i] = *bound;
  evaluate(moved);
  if (meets(moved)) {
    point = std::move(moved);
    return true;
  }
  if (which.size() == 1) return false;
  const auto middle = which.begin() + static_cast<std::ptrdiff_t>(which.size() / 2);
  const bool first = moved_to_bounds(point, {which.begin(), middle}, tries);
  return moved_to_bounds(point, {middle, which.end()}, tries) || first;
}

/// |F_i| <= tol_relative t_i in every row whose variable is not at its bound.
bool Judge::balanced(const Judged& point) {
  if (stop_.tol_relative == lcp::infinity) return true;
  const Box& box = counted_.mcp().box();
  SpMat J = counted_.mcp().jacobian_pattern();
  if (!counted_.jacobian(point.x, J)) return false;
  const lcp::RowTerms terms = row_terms(J, point.x, point.F);
  for (Index i = 0; i < point.x.size(); ++i)
    if (!at_its_bound(box, i, point.x[i], point.F[i]) && !(std::abs(point.F[i]) <= stop_.tol_relative * terms.size[i]))
      return false;
  return true;
}

bool Judge::to_rounding(const Judged& point) {
  if (!std::isfinite(point.residual.natural)) return false;
  if (const lcp::AffineMcp* exact = exact_->problem()) {
    const lcp::Judgement there = lcp::judge(*exact, point.x);
    return there.accuracy.to_rounding && lcp::rounds_a_solution(*exact, point.x, there.F, there.terms);
  }
  SpMat J = counted_.mcp().jacobian_pattern();
  if (!counted_.jacobian(point.x, J)) return false;
  const Box& box = counted_.mcp().box();
  if (!accuracy(box, point.x, point.F, J).to_rounding) return false;
  const Vec q = point.F - J * point.x;
  return q.allFinite() && lcp::rounds_a_solution({J, q, box}, point.x, point.F, row_terms(J, point.x, point.F));
}

void Judge::refine(Judged& point) {
  const lcp::AffineMcp* exact = exact_->problem();
  if (exact == nullptr || !std::isfinite(point.residual.natural)) return;
  evaluate(point);  // the method's own sums may hide that it is a solution
  if (!lcp::worth_refining(lcp::judge(*exact, point.x), stop_.tol)) return;
  point.x = lcp::refined(*exact, point.x, stop_.tol);
  evaluate(point);
}

void judge_here(const Mcp& mcp, const Stop& stop, Result& result, std::shared_ptr<ExactValues> exact) {
  CountedMcp counted(mcp);
  Judge judge(counted, stop, std::move(exact));
  Judged point{.x = std::move(result.x), .F = {}, .residual = {}};
  const bool solved = judge.solved_at(point);
  if (result.accepted()) {
    if (solved) {
      result.status = Status::Solved;
      result.message = solution_found(point.residual);
    } else if (judge.to_rounding(point)) {
      result.status = Status::SolvedToRounding;
    } else {
      result.status = Status::NoProgress;
      result.message = "another form of the problem was solved, but not the problem itself to its tolerance";
      result.advice = "scale the model, or try a larger tolerance";
    }
  }
  result.x = std::move(point.x);
  result.F = std::move(point.F);
  result.residual = point.residual;
  result.stats.F_evals += counted.F_evals();
  result.stats.J_evals += counted.J_evals();
}

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#include "lcp/solve/dense.hpp"

#include <cmath>

#include "lcp/solve/solve.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {

const Result& DenseSolver::solve(const Matrix& M, In q, In lower, In upper, const Limits& limits) {
  take(M, q, lower, upper, limits.tol);
  enter();
  const bool ended = pivoting_.run(problem_, cells_, limits);
  const int rounds = pivoting_.rounds(), factorizations = pivoting_.factorizations();
  if (!ended || !judged_solution(limits.tol)) {
    const AffineMcp sparse{problem_.M.sparseView(), problem_.q, problem_.box};
    result_ = lcp::solve(sparse, project(sparse.box, Vec::Zero(sparse.size())), Auto{}, limits);
    cells_ = result_.solved() ? cells_of(problem_.box, result_.z) : Cells{};
  } else {
    result_.iterations = 0;
    result_.factorizations = 0;
  }
  result_.iterations += rounds;
  result_.factorizations += factorizations;
  return result_;
}

void DenseSolver::take(const Matrix& M, In q, In lower, In upper, double tol) {
  const Index n = q.size();
  if (M.rows() != n || M.cols() != n) refuse_input("M: is ", M.rows(), " x ", M.cols(), ", and q has ", n, " entries");
  problem_.q = q;
  problem_.box.lower = lower;
  problem_.box.upper = upper;
  if (const auto why = problem_.box.invalid()) refuse_input("lower, upper: ", *why);
  if (lower.size() != n) refuse_input("lower: has ", lower.size(), " entries, and q has ", n);
  if (!(tol > 0) || tol == infinity) refuse_input("tol: is ", tol, ", not a positive number");
  for (Index i = 0; i < n; ++i)
    if (!std::isfinite(q[i])) refuse_input("q: entry [", i, "] is ", q[i], ", no finite number");
  if (problem_.M.rows() == n && problem_.M == M) return;
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i)
      if (!std::isfinite(M(i, j))) refuse_input("M: entry [", i, ", ", j, "] is ", M(i, j), ", no finite number");
  problem_.M = M;
  pivoting_.renew(problem_.M);
}

/// Keeps the cells that the bounds allow; the others are at a finite bound, or inside where there is none.
void DenseSolver::enter() {
  if (static_cast<Index>(cells_.size()) != problem_.size()) cells_.assign(at(problem_.size()), Cell::Below);
  for (Index i = 0; i < problem_.size(); ++i) {
    Cell& cell = cells_[at(i)];
    if (problem_.box.is_fixed(i)) cell = Cell::Below;
    if (cell == Cell::Below && !problem_.box.has_lower(i)) cell = Cell::Above;
    if (cell == Cell::Above && !problem_.box.has_upper(i))
      cell = problem_.box.has_lower(i) ? Cell::Below : Cell::Inside;
  }
}

/// Takes the point of the last cell for the result, refined once if that is needed, if the judge calls it solved.
bool DenseSolver::judged_solution(double tol) {
  result_.z = project(problem_.box, pivoting_.z());
  Judgement judgement = judge(problem_, result_.z);
  if (judgement.natural > tol && judgement.F.size() > 0) {
    Vec refined = result_.z;
    pivoting_.correct(judgement.F, refined);
    result_.z = project(problem_.box, refined);
    judgement = judge(problem_, result_.z);
  }
  if (!(judgement.natural <= tol)) return false;
  result_.status = Status::Solved;
  result_.message.clear();
  result_.residual = judgement.natural;
  result_.relative = judgement.accuracy.relative;
  result_.certificate.resize(0);
  result_.refutation.reset();
  return true;
}

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#include "lcp/judge/judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "lcp/exact_sum.hpp"
#include "lcp/judge/cell.hpp"
#include "lcp/judge/dense_judge.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {

double row_residual(const Box& box, Index i, double z, double F) {
  return std::abs(std::min(std::max(F, z - box.upper[i]), z - box.lower[i]));
}

namespace {

double row_rounding(const RowTerms& terms, Index i) {
  return 8.0 * (terms.entries[i] + 2) * std::numeric_limits<double>::epsilon() * terms.size[i];
}

}  // namespace

double largest_rounding(const RowTerms& terms) {
  double largest = 0;
  for (Index i = 0; i < terms.size.size(); ++i) {
    if (!std::isfinite(terms.size[i])) return infinity;
    largest = std::max(largest, row_rounding(terms, i));
  }
  return largest;
}

Accuracy accuracy(In row_residuals, const RowTerms& terms) {
  Accuracy out{.relative = 0, .worst = -1, .to_rounding = true};
  for (Index i = 0; i < row_residuals.size(); ++i) {
    const double r = row_residuals[i];
    const double t = terms.size[i];
    const double relative = r == 0 ? 0 : r / t;
    if (!(relative <= out.relative) || out.worst < 0) {
      out.relative = relative;
      out.worst = i;
    }
    if (!(r <= row_rounding(terms, i)) || !std::isfinite(t)) out.to_rounding = false;
  }
  return out;
}

namespace {

/// add(i, M_ij, z_j) for each entry of M that is not 0.
template <class Add>
void for_terms(const AffineMcp& problem, In z, Add add) {
  for (Index j = 0; j < problem.size(); ++j)
    for (SpMat::InnerIterator it(problem.M, j); it; ++it)
      if (it.value() != 0) add(it.row(), it.value(), z[j]);
}
template <class Add>
void for_terms(const DenseMcp& problem, In z, Add add) {
  for (Index j = 0; j < problem.size(); ++j)
    for (Index i = 0; i < problem.size(); ++i)
      if (const double a = problem.M(i, j); a != 0) add(i, a, z[j]);
}

/// The rows that shorter sums have not settled.
template <class Problem>
void sum_exactly(const Problem& problem, In z, const std::vector<Index>& rows, Vec& F) {
  std::vector<int> place(at(problem.size()), -1);
  std::vector<ExactSum> sums(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    place[at(rows[k])] = static_cast<int>(k);
    sums[k].add(problem.q[rows[k]]);
  }
  for_terms(problem, z, [&](Index i, double a, double zj) {
    if (const int k = place[at(i)]; k >= 0) sums[at(k)].add_product(a, zj);
  });
  for (std::size_t k = 0; k < rows.size(); ++k) F[rows[k]] = sums[k].value();
}

/// M z + q, each the double nearest to the exact sum; and the terms.
template <class Problem>
Vec exact_values(const Problem& problem, In z, RowTerms& terms) {
  const Index n = problem.size();
  terms = {.size = problem.q.cwiseAbs(), .entries = Eigen::VectorXi::Zero(n)};
  std::vector<TripleSum> sums(problem.q.begin(), problem.q.end());
  for_terms(problem, z, [&](Index i, double a, double zj) {
    ++terms.entries[i];
    if (zj == 0) return;
    sums[at(i)].add_product(a, zj);
    terms.size[i] += std::abs(a * zj);
  });
  Vec F(n);
  std::vector<Index> open;
  for (Index i = 0; i < n; ++i) {
    if (!sums[at(i)].settle()) open.push_back(i);
    F[i] = sums[at(i)].value();
  }
  if (!open.empty()) sum_exactly(problem, z, open, F);
  return F;
}

/// The same of a dense problem, for some rows at once.
Vec exact_values(const DenseMcp& problem, In z, RowTerms& terms) {
  constexpr Index width = 64;  // some arrays of it stay in the first cache
  const Index n = problem.size();
  terms = {.size = Vec(n), .entries = Eigen::VectorXi(n)};
  Vec F(n);
  std::vector<Index> open;
  for (Index first = 0; first < n; first += width) {
    const Index count = std::min(width, n - first);
    TripleSums<width> sums(problem.q.data() + first, at(count));
    std::array<double, width> entries;  // counted in doubles, as vectors of one width are
    std::fill_n(entries.begin(), count, 0.0);
    for (Index j = 0; j < n; ++j) {
      const double* column = problem.M.col(j).data() + first;
      for (std::size_t i = 0; i < at(count); ++i) entries[i] += column[i] != 0 ? 1.0 : 0.0;
      if (z[j] != 0) sums.add_products(column, z[j]);
    }
    sums.settle();
    for (Index i = 0; i < count; ++i) {
      if (!sums.settled_at(at(i))) open.push_back(first + i);
      F[first + i] = sums.value(at(i));
      terms.size[first + i] = sums.size(at(i));
      terms.entries[first + i] = static_cast<int>(entries[at(i)]);
    }
  }
  if (!open.empty()) sum_exactly(problem, z, open, F);
  return F;
}

template <class Problem>
Judgement judge_any(const Problem& problem, In z) {
  const Index n = problem.size();
  if (z.size() != n) {
    refuse_input("judge: z has ", z.size(), " entries, the problem ", n);
  }
  Judgement out;
  if (!z.allFinite()) return out;
  out.F = exact_values(problem, z, out.terms);
  out.rows.resize(n);
  out.natural = 0;
  for (Index i = 0; i < n; ++i) {
    out.rows[i] = row_residual(problem.box, i, z[i], out.F[i]);
    if (!std::isfinite(out.F[i])) out.rows[i] = infinity;
    if (out.rows[i] > out.natural || out.worst < 0) {
      out.natural = out.rows[i];
      out.worst = i;
    }
  }
  out.accuracy = accuracy(out.rows, out.terms);
  return out;
}

}  // namespace

Judgement judge(const AffineMcp& problem, In z) { return judge_any(problem, z); }
Judgement judge(const DenseMcp& problem, In z) { return judge_any(problem, z); }

namespace {

/// The cell of z where each variable is on the side of its pair that is the smaller: z_i - l_i against F_i in units of
/// the row's terms over its largest entry.
Cells cells_of(const AffineMcp& problem, In z, In F) {
  const Box& box = problem.box;
  Vec largest = Vec::Zero(problem.size());
  for (Index j = 0; j < problem.M.cols(); ++j)
    for (SpMat::InnerIterator it(problem.M, j); it; ++it)
      largest[it.row()] = std::max(largest[it.row()], std::abs(it.value()));
  Cells cells = all_inside(box);
  for (Index i = 0; i < problem.size(); ++i) {
    const double unit = largest[i] > 0 ? largest[i] : 1;
    if (F[i] > unit * (z[i] - box.lower[i])) cells[static_cast<std::size_t>(i)] = Cell::Below;
    if (F[i] < unit * (z[i] - box.upper[i])) cells[static_cast<std::size_t>(i)] = Cell::Above;
  }
  return cells;
}

}  // namespace

bool rounds_a_solution(const AffineMcp& problem, In z, In F, const RowTerms& terms) {
  constexpr double share = 1e-4;
  CellSolver cell(problem, LuBackend::Auto, 1e-13);
  if (cell.solve(cells_of(problem, z, F)) != LuStatus::Ok) return false;
  Vec there = z;
  if (!cell.correct(F, there)) return true;  // nothing is inside its bounds
  Vec moved = Vec::Zero(problem.size());
  for (Index j = 0; j < problem.size(); ++j)
    for (SpMat::InnerIterator it(problem.M, j); it; ++it) moved[it.row()] += std::abs(it.value() * (there[j] - z[j]));
  return (moved.array() <= share * terms.size.array()).all();
}

bool worth_refining(const Judgement& judgement, double tol) {
  constexpr double near = 1e-6;
  if (judgement.natural <= tol || !std::isfinite(judgement.natural)) return false;
  return (judgement.rows.array() <= (near * judgement.terms.size.array()).max(tol)).all();
}

Vec refined(const AffineMcp& problem, In z, double tol) {
  const auto rank = [tol](const Judgement& j) { return j.natural <= tol ? 0 : j.accuracy.to_rounding ? 1 : 2; };
  Vec best = project(problem.box, z);
  Judgement now = judge(problem, best);
  if (!std::isfinite(now.natural)) return best;
  CellSolver cell(problem, LuBackend::Auto, 1e-13);
  if (cell.solve(cells_of(problem, best, now.F)) != LuStatus::Ok) return best;
  Vec x = project(problem.box, cell.z());
  for (int step = 0; step < 4; ++step) {
    Judgement there = judge(problem, x);
    if (!std::isfinite(there.natural)) break;
    Vec next = x;
    const bool further = cell.correct(there.F, next);
    if (std::pair(rank(there), there.natural) < std::pair(rank(now), now.natural)) {
      best = x;
      now = std::move(there);
    }
    if (!further) break;
    x = project(problem.box, next);
  }
  return best;
}

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#include "lcp/judge/judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lcp/exact_sum.hpp"
#include "lcp/judge/cell.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {

double row_residual(const Box& box, Index i, double z, double F) {
  return std::abs(std::min(std::max(F, z - box.upper[i]), z - box.lower[i]));
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
    const double rounding = 8.0 * (terms.entries[i] + 2) * std::numeric_limits<double>::epsilon() * t;
    if (!(r <= rounding) || !std::isfinite(t)) out.to_rounding = false;
  }
  return out;
}

Judgement judge(const AffineMcp& problem, In z) {
  const Index n = problem.size();
  if (z.size() != n) {
    refuse_input("judge: z has ", z.size(), " entries, the problem ", n);
  }
  Judgement out;
  if (!z.allFinite()) return out;
  const Eigen::SparseMatrix<double, Eigen::RowMajor> rows = problem.M;
  out.terms = {.size = problem.q.cwiseAbs(), .entries = Eigen::VectorXi::Zero(n)};
  out.rows.resize(n);
  out.F.resize(n);
  out.natural = 0;
  for (Index i = 0; i < n; ++i) {
    ExactSum F;
    F.add(problem.q[i]);
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(rows, i); it; ++it) {
      if (it.value() == 0) continue;
      F.add_product(it.value(), z[it.col()]);
      out.terms.size[i] += std::abs(it.value() * z[it.col()]);
      ++out.terms.entries[i];
    }
    out.F[i] = F.value();
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

namespace {

/// The cell of z where each variable is on the side of its pair that is the smaller: z_i - l_i against F_i in units of
/// the row's terms over its largest entry.
Places cell_of(const AffineMcp& problem, In z, In F) {
  const Box& box = problem.box;
  Vec largest = Vec::Zero(problem.size());
  for (Index j = 0; j < problem.M.cols(); ++j)
    for (SpMat::InnerIterator it(problem.M, j); it; ++it)
      largest[it.row()] = std::max(largest[it.row()], std::abs(it.value()));
  Places places = all_inside(box);
  for (Index i = 0; i < problem.size(); ++i) {
    const double unit = largest[i] > 0 ? largest[i] : 1;
    if (F[i] > unit * (z[i] - box.lower[i])) places[static_cast<std::size_t>(i)] = Place::Lower;
    if (F[i] < unit * (z[i] - box.upper[i])) places[static_cast<std::size_t>(i)] = Place::Upper;
  }
  return places;
}

}  // namespace

bool rounds_a_solution(const AffineMcp& problem, In z, In F, const RowTerms& terms) {
  constexpr double share = 1e-4;
  CellSolver cell(problem, LuBackend::Auto, 1e-13);
  if (cell.solve(cell_of(problem, z, F)) != LuStatus::Ok) return false;
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
  if (cell.solve(cell_of(problem, best, now.F)) != LuStatus::Ok) return best;
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

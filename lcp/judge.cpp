#include "lcp/judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "lcp/cell.hpp"
#include "lcp/exact_sum.hpp"

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
    std::ostringstream what;
    what << "judge: z has " << z.size() << " entries, the problem " << n;
    throw std::invalid_argument(what.str());
  }
  Judgement out;
  if (!z.allFinite()) return out;
  const Eigen::SparseMatrix<double, Eigen::RowMajor> rows = problem.M;
  RowTerms terms{.size = problem.q.cwiseAbs(), .entries = Eigen::VectorXi::Zero(n)};
  Vec residuals(n);
  out.F.resize(n);
  out.natural = 0;
  for (Index i = 0; i < n; ++i) {
    ExactSum F;
    F.add(problem.q[i]);
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(rows, i); it; ++it) {
      if (it.value() == 0) continue;
      F.add_product(it.value(), z[it.col()]);
      terms.size[i] += std::abs(it.value() * z[it.col()]);
      ++terms.entries[i];
    }
    out.F[i] = F.value();
    residuals[i] = row_residual(problem.box, i, z[i], out.F[i]);
    if (!std::isfinite(out.F[i])) residuals[i] = infinity;
    if (residuals[i] > out.natural || out.worst < 0) {
      out.natural = residuals[i];
      out.worst = i;
    }
  }
  out.accuracy = accuracy(residuals, terms);
  return out;
}

namespace {

/// The cell of z where each variable is on the side of its pair that is the smaller: z_i - l_i against F_i in units of
/// the row's terms over its largest entry.
Places cell_of(const AffineMcp& problem, In z, const Vec& F) {
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

Vec refined(const AffineMcp& problem, In z) {
  Vec best = project(problem.box, z);
  Judgement now = judge(problem, best);
  if (now.F.size() == 0 || !now.F.allFinite()) return best;
  const Places places = cell_of(problem, best, now.F);
  CellSolver cell(problem, LuBackend::Auto, 1e-13);
  if (cell.solve(places) != LuStatus::Ok) return best;
  Vec x = project(problem.box, cell.z());
  for (int step = 0; step < 4; ++step) {
    const Judgement there = judge(problem, x);
    if (!(there.natural < now.natural)) break;
    best = x;
    now = there;
    if (!cell.correct(there.F, x)) break;
    x = project(problem.box, x);
  }
  return best;
}

}  // namespace perp::lcp

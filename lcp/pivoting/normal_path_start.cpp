// SPDX-License-Identifier: Apache-2.0
/// Where paths begin: the cells and the basis of the start.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <new>
#include <numeric>
#include <utility>

#include "lcp/pivoting/normal_path.hpp"

namespace perp::lcp {
namespace {

SpMat with_residual_column(const SpMat& M) {
  if (!M.isCompressed()) {
    SpMat compressed = M;
    compressed.makeCompressed();
    return with_residual_column(compressed);
  }
  const Index n = M.rows();
  const Index entries = M.nonZeros();
  SpMat A(n, n + 1);
  A.resizeNonZeros(entries + n);
  std::copy_n(M.outerIndexPtr(), n + 1, A.outerIndexPtr());
  std::copy_n(M.innerIndexPtr(), entries, A.innerIndexPtr());
  std::copy_n(M.valuePtr(), entries, A.valuePtr());
  A.outerIndexPtr()[n + 1] = static_cast<int>(entries + n);
  std::iota(A.innerIndexPtr() + entries, A.innerIndexPtr() + entries + n, 0);
  std::fill_n(A.valuePtr() + entries, n, 0.0);  // r / s, when it is known
  return A;
}

}  // namespace

NormalPath::NormalPath(const AffineMcp& problem, In start, const LemkeOptions& options)
    : NormalPath(problem, equilibrated(problem), start, options) {}

NormalPath::NormalPath(const AffineMcp& problem, Equilibrated&& scaled, In start, const LemkeOptions& options)
    : original_(problem),
      scaling_(std::move(scaled.scaling)),
      problem_(std::move(scaled.problem)),
      options_(options),
      n_(problem.size()),
      x_(scaling_.to_scaled(problem.box, start)),
      low_(n_),
      high_(n_),
      cells_(at(n_)),
      A_(with_residual_column(problem_.M)),
      factor_(A_, options.basis),
      waiting_(at(n_), none),
      d_(n_) {}

/// The cell the start lies in, or the warm basis; from a ray the one beyond a finite bound for every variable that has
/// one.
void NormalPath::choose_cells() {
  const Box& box = problem_.box;
  const bool outside = options_.start == LemkeStart::Ray;
  for (Index i = 0; i < n_; ++i) {
    Cell& cell = cells_[at(i)];
    const bool has_lower = box.lower[i] > -infinity;
    const bool has_upper = box.upper[i] < infinity;
    if (box.lower[i] == box.upper[i])
      cell = Cell::Fixed;  // both cells outside have the column e_i and nothing lies between them
    else if (outside && (has_lower || has_upper))
      cell = has_lower ? Cell::Below : Cell::Above;
    else if (!outside && !options_.cells.empty()) {
      cell = options_.cells[at(i)];
      if (cell == Cell::Fixed || (cell == Cell::Below && !has_lower) || (cell == Cell::Above && !has_upper))
        cell = Cell::Inside;
    } else
      cell = x_[i] < box.lower[i] ? Cell::Below : x_[i] > box.upper[i] ? Cell::Above : Cell::Inside;
    set_interval(i);
    x_[i] = std::clamp(x_[i], low_[i], high_[i]);
  }
}

/// Moves the start to a random nearby point in the interior of its cell.
void NormalPath::perturb() {
  if (options_.perturbation == 0) return;
  for (Index i = 0; i < n_; ++i) {
    double step = options_.perturbation * (1 + std::abs(x_[i])) * generic();
    const double to_low = x_[i] - low_[i];
    const double to_high = high_[i] - x_[i];
    step = std::min(step, 0.25 * (high_[i] - low_[i]));
    x_[i] += to_low <= to_high ? step : -step;
  }
}

/// d > 0 in the equilibrated units, in general position.
Vec NormalPath::covering() {
  const auto spread = [this] { return std::exp(std::log(31.6) * 2 * (generic() - 1)); };
  Vec d(n_);
  for (Index i = 0; i < n_; ++i) switch (options_.cover) {
      case Cover::Generic:
        d[i] = generic();
        break;
      case Cover::Spread:
        d[i] = spread();
        break;
      case Cover::Ones:
        d[i] = scaling_.rows[i] * (1 + options_.perturbation * generic());
        break;
      case Cover::Given:
        d[i] = scaling_.rows[i] * options_.covering[i] * (1 + options_.perturbation * generic());
        break;
    }
  return d;
}

/// For a ray start: x with G(x) = 0 in the linear piece of the start cell (up to rows of artificials), then every
/// bounded variable pushed beyond its bound along the covering vector.
void NormalPath::place_outside() {
  Vec y(n_);
  factor_.ftran(constant(), y);
  Vec x0 = Vec::Zero(n_);
  for (Index p = 0; p < n_; ++p)
    if (const Index i = head(p); i < n_) x0[i] = y[p];
  const Vec d = covering();
  const double unit = 1 + problem_.q.lpNorm<::Eigen::Infinity>();
  double z0 = unit;
  const auto beyond = [&](Index i) {  // how far y lies on the wrong side of the bound
    return cells_[at(i)] == Cell::Below ? x0[i] - problem_.box.lower[i] : problem_.box.upper[i] - x0[i];
  };
  const bool by_row = options_.cover == Cover::Generic || options_.cover == Cover::Spread;
  for (Index i = 0; i < n_; ++i)
    if (!inside(i) && cells_[at(i)] != Cell::Fixed && !by_row) z0 = std::max(z0, 2 * beyond(i) / d[i]);
  for (Index i = 0; i < n_; ++i) {
    const Cell c = cells_[at(i)];
    const double push = z0 * d[i] + (by_row ? std::max(0.0, c == Cell::Fixed ? 0.0 : inside(i) ? 0.0 : beyond(i)) : 0);
    x_[i] = c == Cell::Below ? x0[i] - push : c == Cell::Above ? x0[i] + push : x0[i];
  }
}

/// -(the part of G that does not depend on x in the present cells).
Vec NormalPath::constant() const {
  Vec bounds = Vec::Zero(n_);
  for (Index i = 0; i < n_; ++i)
    if (!inside(i)) bounds[i] = cells_[at(i)] == Cell::Above ? problem_.box.upper[i] : problem_.box.lower[i];
  return bounds - problem_.q - problem_.M * bounds;
}

void NormalPath::set_residual_column() {
  const Vec z = project(problem_.box, x_);
  const Vec r = problem_.M * z + problem_.q + x_ - z;
  scale_ = r.lpNorm<::Eigen::Infinity>();
  if (!(scale_ > 0)) scale_ = 1;
  Eigen::Map<Vec>(A_.valuePtr() + A_.outerIndexPtr()[n_], n_) = r / scale_;
}

LuStatus NormalPath::factor_basis() {
  std::vector<Index> columns(head_.size());
  std::transform(head_.begin(), head_.end(), columns.begin(), [this](Index i) { return column(i); });
  return factor_.factor(columns);
}

/// The basis of all x_i in their present cells, t nonbasic; artificials in the places of dependent columns.
bool NormalPath::factor_start(PivotResult& result) {
  head_.resize(at(n_));
  for (Index i = 0; i < n_; ++i) head(i) = i;
  driver_ = n_;
  direction_ = 1;
  distrusted_ = true;  // stays so where the path does not begin: it may end at once, solved and without factors
  LuStatus status = factor_basis();
  if (status == LuStatus::Ok && (factor_.surely_regular() || factor_.rcond() >= options_.singular_rcond)) {
    distrusted_ = false;
    return true;
  }
  if (!options_.repair || (status != LuStatus::Ok && status != LuStatus::Singular)) return false;
  std::vector<BasisFactor::Dependency> replaced;
  const std::vector<Index> columns = factor_.basis();
  if (factor_.factor_repaired(columns, replaced) != LuStatus::Ok) return false;
  for (const BasisFactor::Dependency& dependent : replaced) {
    waiting_[at(dependent.row)] = head(dependent.position);
    head(dependent.position) = n_ + 1 + dependent.row;
  }
  result.repaired = static_cast<int>(replaced.size());
  distrusted_ = false;
  return true;
}

std::vector<Index> NormalPath::waiting() const {
  std::vector<Index> variables;
  std::copy_if(waiting_.begin(), waiting_.end(), std::back_inserter(variables), [](Index i) { return i != none; });
  std::sort(variables.begin(), variables.end());
  return variables;
}

bool NormalPath::begin(PivotResult& result) {
  choose_cells();
  start_ = cells_;
  if (options_.start == LemkeStart::Regular) perturb();
  best_x_ = x_;
  if (!factor_start(result)) {
    result.end = PivotEnd::SingularBasis;
    return false;
  }
  if (options_.start == LemkeStart::Ray) place_outside();
  set_residual_column();
  return true;
}

}  // namespace perp::lcp

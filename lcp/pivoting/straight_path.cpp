// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/straight_path.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lcp/pivoting/last_piece.hpp"

namespace perp::lcp {
namespace {

/// min |U_ii| / max |U_ii| of a matrix that is regular without doubt.
constexpr double regular = 1e-10;
/// Newton's step, and steps of refinement.
constexpr int most_steps = 4;

/// The cell of x, or the warm basis.
std::vector<Cell> cells_of(const Box& box, In x, const std::vector<Cell>& warm) {
  std::vector<Cell> cells(at(box.size()));
  for (Index i = 0; i < box.size(); ++i) {
    Cell& cell = cells[at(i)];
    cell = !warm.empty()         ? warm[at(i)]
           : x[i] < box.lower[i] ? Cell::Below
           : x[i] > box.upper[i] ? Cell::Above
                                 : Cell::Inside;
    if (box.is_fixed(i))
      cell = Cell::Fixed;
    else if (cell == Cell::Fixed || (cell == Cell::Below && !box.has_lower(i)) ||
             (cell == Cell::Above && !box.has_upper(i)))
      cell = Cell::Inside;
  }
  return cells;
}

/// The piece of G in a cell, with the factors of M_II.
class StraightPiece final : public LastPiece {
 public:
  StraightPiece(const SpMat& M, const std::vector<Cell>& cells, SharedLu& lu) : place_(at(M.rows()), -1), lu_(lu) {
    inside_.reserve(at(M.rows()));
    for (Index i = 0; i < M.rows(); ++i) {
      if (cells[at(i)] != Cell::Inside) continue;
      place_[at(i)] = static_cast<int>(inside_.size());
      inside_.push_back(i);
    }
    take_columns(M);
  }

  /// False if M_II is singular, or nearly so.
  bool factor() const {
    lu_.user = this;
    return lu_.lu.factor(block_) == LuStatus::Ok && lu_.lu.pivot_ratio() >= regular;
  }

  const std::vector<Index>& inside() const { return inside_; }

  /// y = M_II^-1 r_I.
  void solve(In r, Vec& y) const {
    Vec of_block(block_.rows());
    y.resize(block_.rows());
    for (std::size_t k = 0; k < inside_.size(); ++k) of_block[static_cast<Index>(k)] = r[inside_[k]];
    if (!inside_.empty()) lu_.lu.solve(of_block, y);
  }

  /// The matrix of the piece has the columns M_.i inside and e_i outside.
  Vec chord_step(In r) const override {
    if (lu_.user != this) (void)factor();
    Vec y;
    solve(r, y);
    Vec dx = outer_ * y - r;
    for (std::size_t k = 0; k < inside_.size(); ++k) dx[inside_[k]] = -y[static_cast<Index>(k)];
    return dx;
  }

 private:
  /// M_II and M_OI, the latter with n rows.
  void take_columns(const SpMat& M) {
    const auto m = static_cast<Index>(inside_.size());
    block_.resize(m, m);
    outer_.resize(M.rows(), m);
    block_.reserve(M.nonZeros());
    if (m < M.rows()) outer_.reserve(M.nonZeros());
    for (Index k = 0; k < m; ++k) {
      block_.startVec(k);
      outer_.startVec(k);
      for (SpMat::InnerIterator it(M, inside_[at(k)]); it; ++it)
        if (const int row = place_[at(it.row())]; row >= 0)
          block_.insertBack(row, k) = it.value();
        else
          outer_.insertBack(it.row(), k) = it.value();
    }
    block_.finalize();
    outer_.finalize();
  }

  std::vector<int> place_;  // in inside_, or -1
  std::vector<Index> inside_;
  SpMat block_;
  SpMat outer_;
  SharedLu& lu_;
};

double largest_of(const Vec& F, const std::vector<Index>& I) {
  double largest = 0;
  for (const Index i : I) largest = std::max(largest, std::abs(F[i]));
  return largest;
}

/// Row by row, where natural residuals are compared with the largest of q: rows of other sizes are lost beside that.
bool solves(const Vec& F, const Vec& q, const std::vector<Index>& I, double tol) {
  return std::ranges::all_of(I, [&](Index i) { return std::abs(F[i]) <= tol * (1 + std::abs(q[i])); });
}

/// How many variables leave their cells, by more than a ratio test would overlook.
Index leaving(const AffineMcp& problem, const std::vector<Cell>& cells, const Vec& z, const Vec& F, double tol) {
  const double scale = 1 + problem.q.lpNorm<::Eigen::Infinity>();
  const auto leaves = [&](Index i) {
    switch (cells[at(i)]) {
      case Cell::Inside:
        return z[i] < problem.box.lower[i] - tol * (1 + std::abs(problem.box.lower[i])) ||
               z[i] > problem.box.upper[i] + tol * (1 + std::abs(problem.box.upper[i]));
      case Cell::Below:
        return F[i] < -tol * scale;
      case Cell::Above:
        return F[i] > tol * scale;
      case Cell::Fixed:
        break;
    }
    return false;
  };
  Index count = 0;
  for (Index i = 0; i < problem.size(); ++i) count += leaves(i) ? 1 : 0;
  return count;
}

}  // namespace

std::optional<PivotResult> straight_path(const AffineMcp& problem, In start, const LemkeOptions& options, SharedLu& lu,
                                         Index* left_by) {
  const Box& box = problem.box;
  PivotResult result;
  result.cells = cells_of(box, start, options.cells);
  const auto piece = std::make_shared<StraightPiece>(problem.M, result.cells, lu);
  if (!piece->factor()) return std::nullopt;

  Vec z = project(box, start);
  for (Index i = 0; i < z.size(); ++i) {
    if (result.cells[at(i)] == Cell::Below || result.cells[at(i)] == Cell::Fixed) z[i] = box.lower[i];
    if (result.cells[at(i)] == Cell::Above) z[i] = box.upper[i];
  }
  const double scale = 1 + (z.size() > 0 ? problem.q.lpNorm<::Eigen::Infinity>() : 0);
  const double rounding = 1e-13 * scale;
  Vec F = problem.M * z + problem.q;
  Vec step;
  Vec next;
  Vec F_there;
  double left = largest_of(F, piece->inside());
  for (int k = 0; k < most_steps && (k == 0 || left > rounding); ++k) {
    piece->solve(F, step);
    next = z;
    for (std::size_t j = 0; j < piece->inside().size(); ++j) next[piece->inside()[j]] -= step[static_cast<Index>(j)];
    if (!next.allFinite()) return std::nullopt;
    F_there.noalias() = problem.M * next;
    F_there += problem.q;
    const double left_there = largest_of(F_there, piece->inside());
    if (k > 0 && !(left_there < left)) break;
    z.swap(next);
    F.swap(F_there);
    left = left_there;
    if (k > 0) continue;
    const Index count = leaving(problem, result.cells, z, F, 1e3 * options.feasibility_tol);
    if (left_by != nullptr) *left_by = count;
    if (count > 0) return std::nullopt;
  }
  if (leaving(problem, result.cells, z, F, options.feasibility_tol) > 0 ||
      !solves(F, problem.q, piece->inside(), options.residual_tol))
    return std::nullopt;

  result.x = z;
  for (Index i = 0; i < z.size(); ++i)
    if (result.cells[at(i)] != Cell::Inside) result.x[i] -= F[i];
  result.z = project(box, z);
  result.residual = natural_residual(problem, result.z);
  result.refactorizations = 1;
  if (!(result.residual <= options.residual_tol * scale)) return std::nullopt;
  result.end = PivotEnd::Solved;
  result.t = result.best_t = 1;
  result.best_x = result.x;
  if (options.keep_path) result.path = {{.t = 0, .x = start}, {.t = 1, .x = result.x}};
  if (options.keep_basis) result.last_piece = piece;
  return result;
}

}  // namespace perp::lcp

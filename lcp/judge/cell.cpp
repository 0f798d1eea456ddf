// SPDX-License-Identifier: Apache-2.0
#include "lcp/judge/cell.hpp"

#include <algorithm>
#include <cmath>

namespace perp::lcp {
namespace {

/// Adds |M_ij z_j| to terms_i and M_ij z_j to F_i.
void add_product(const SpMat& M, const Vec& z, Vec& F, Vec& terms) {
  for (Index j = 0; j < M.cols(); ++j) {
    if (z[j] == 0) continue;
    for (SpMat::InnerIterator it(M, j); it; ++it) {
      const double a = it.value() * z[j];
      F[it.row()] += a;
      terms[it.row()] += std::abs(a);
    }
  }
}

}  // namespace

Cells cells_of(const Box& box, In z) {
  Cells cells(static_cast<std::size_t>(box.size()));
  for (Index i = 0; i < box.size(); ++i) {
    const bool lower = z[i] <= box.lower[i] || box.lower[i] == box.upper[i];
    const Cell beyond_lower = z[i] >= box.upper[i] ? Cell::Above : Cell::Inside;
    cells[static_cast<std::size_t>(i)] = lower ? Cell::Below : beyond_lower;
  }
  return cells;
}

Cells all_inside(const Box& box) {
  Cells cells(static_cast<std::size_t>(box.size()));
  for (Index i = 0; i < box.size(); ++i)
    cells[static_cast<std::size_t>(i)] = box.lower[i] == box.upper[i] ? Cell::Below : Cell::Inside;
  return cells;
}

std::uint64_t key_of(const Cells& cells) {
  std::uint64_t key = 0x9e3779b97f4a7c15U;
  for (const Cell cell : cells) {  // the finalizer of splitmix64 over every cell
    key += 0x9e3779b97f4a7c15U + static_cast<std::uint64_t>(cell);
    key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9U;
    key = (key ^ (key >> 27)) * 0x94d049bb133111ebU;
    key ^= key >> 31;
  }
  return key;
}

CellSolver::CellSolver(const AffineMcp& problem, LuBackend lu, double tol)
    : problem_(problem), tol_(tol), lu_(lu), row_max_(Vec::Zero(problem.size())) {
  for (Index j = 0; j < problem.M.cols(); ++j)
    for (SpMat::InnerIterator it(problem.M, j); it; ++it)
      row_max_[it.row()] = std::max(row_max_[it.row()], std::abs(it.value()));
}

SpMat CellSolver::block(const Cells& cells) {
  const Index n = problem_.size();
  inside_.clear();
  position_.assign(static_cast<std::size_t>(n), -1);
  for (Index i = 0; i < n; ++i)
    if (cells[static_cast<std::size_t>(i)] == Cell::Inside) {
      position_[static_cast<std::size_t>(i)] = static_cast<int>(inside_.size());
      inside_.push_back(i);
    }
  const auto m = static_cast<Index>(inside_.size());
  SpMat A(m, m);
  for (Index k = 0; k < m; ++k) {
    A.startVec(k);
    for (SpMat::InnerIterator it(problem_.M, inside_[static_cast<std::size_t>(k)]); it; ++it)
      if (const int row = position_[static_cast<std::size_t>(it.row())]; row >= 0 && it.value() != 0)
        A.insertBack(row, k) = it.value();
  }
  A.finalize();
  return A;
}

LuStatus CellSolver::solve(const Cells& cells) {
  const Index n = problem_.size();
  const SpMat A = block(cells);
  const Index m = A.rows();
  if (m > 0) {
    ++factorizations_;
    if (const LuStatus status = lu_.factor(A); status != LuStatus::Ok) return status;
  }
  z_ = Vec::Zero(n);
  for (Index i = 0; i < n; ++i) {
    const Cell cell = cells[static_cast<std::size_t>(i)];
    if (cell != Cell::Inside) z_[i] = cell == Cell::Below ? problem_.box.lower[i] : problem_.box.upper[i];
  }
  F_ = problem_.q;
  terms_ = problem_.q.cwiseAbs();
  add_product(problem_.M, z_, F_, terms_);
  if (m == 0) return F_.allFinite() ? LuStatus::Ok : LuStatus::Singular;
  Vec b(m);
  for (Index k = 0; k < m; ++k) b[k] = -F_[inside_[static_cast<std::size_t>(k)]];
  Vec x(m);
  lu_.solve_refined(b, x);
  if (!x.allFinite()) return LuStatus::Singular;
  Vec z_inside = Vec::Zero(n);
  for (Index k = 0; k < m; ++k) z_inside[inside_[static_cast<std::size_t>(k)]] = x[k];
  add_product(problem_.M, z_inside, F_, terms_);
  z_ += z_inside;
  for (const Index i : inside_) F_[i] = 0;
  return F_.allFinite() ? LuStatus::Ok : LuStatus::Singular;
}

bool CellSolver::correct(In F, Vec& x) const {
  const auto m = static_cast<Index>(inside_.size());
  if (m == 0) return false;
  Vec dx(m);
  const Vec right = F(inside_);
  lu_.solve(right, dx);
  if (!dx.allFinite()) return false;
  for (Index k = 0; k < m; ++k) x[inside_[static_cast<std::size_t>(k)]] -= dx[k];
  return true;
}

bool CellSolver::violated(const Cells& cells, Index i) const {
  const double lower = problem_.box.lower[i];
  const double upper = problem_.box.upper[i];
  const double rounding = tol_ * terms_[i];
  switch (cells[static_cast<std::size_t>(i)]) {
    case Cell::Below:
      return F_[i] < -rounding && lower < upper;
    case Cell::Above:
      return F_[i] > rounding;
    case Cell::Fixed:
      return false;
    case Cell::Inside:
      break;
  }
  const double z_rounding = row_max_[i] > 0 ? rounding / row_max_[i] : 0;
  return (z_[i] < lower && z_[i] < lower - z_rounding - tol_ * std::abs(lower)) ||
         (z_[i] > upper && z_[i] > upper + z_rounding + tol_ * std::abs(upper));
}

std::vector<Index> CellSolver::all_violated(const Cells& cells) const {
  std::vector<Index> indices;
  for (Index i = 0; i < problem_.size(); ++i)
    if (violated(cells, i)) indices.push_back(i);
  return indices;
}

Cell CellSolver::exchanged(const Cells& cells, Index i) const {
  if (cells[static_cast<std::size_t>(i)] != Cell::Inside) return Cell::Inside;
  return z_[i] < problem_.box.lower[i] ? Cell::Below : Cell::Above;
}

Best::Best(const AffineMcp& problem, In start)
    : problem_(problem), z_(project(problem.box, start)), residual_(natural_residual(problem, z_)) {}

bool Best::offer(In z) {
  const Vec inside = project(problem_.box, z);
  const double residual = natural_residual(problem_, inside);
  if (!(residual < residual_)) return false;
  z_ = inside;
  residual_ = residual;
  return true;
}

}  // namespace perp::lcp

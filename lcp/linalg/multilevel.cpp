// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/multilevel.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace perp::lcp {
namespace {

/// Which entries of A are strong for their row.
Mask strong_entries(const SparseRows& A, double theta) {
  Mask strong(A.value.size(), 0);
  for (int i = 0; i < A.rows(); ++i) {
    double most = 0;
    for (int s = A.start[at(i)]; s < A.start[at(i) + 1]; ++s)
      if (A.column[at(s)] != i) most = std::max(most, -A.value[at(s)]);
    if (most == 0) continue;
    for (int s = A.start[at(i)]; s < A.start[at(i) + 1]; ++s)
      if (A.column[at(s)] != i && -A.value[at(s)] >= theta * most) strong[at(s)] = 1;
  }
  return strong;
}

/// Unknowns by their number of strong dependants: doubly linked lists.
class Buckets {
 public:
  explicit Buckets(const std::vector<int>& measure)
      : measure_(measure), next_(measure.size()), previous_(measure.size()) {
    for (int i = static_cast<int>(measure.size()) - 1; i >= 0; --i) insert(i);
  }
  /// An unknown with the largest measure; -1 if none is left.
  int top() {
    while (!head_.empty() && head_.back() < 0) head_.pop_back();
    return head_.empty() ? -1 : head_.back();
  }
  int measure(int i) const { return measure_[at(i)]; }
  void remove(int i) {
    const int before = previous_[at(i)];
    const int after = next_[at(i)];
    (before < 0 ? head_[at(measure_[at(i)])] : next_[at(before)]) = after;
    if (after >= 0) previous_[at(after)] = before;
  }
  void change(int i, int by) {
    remove(i);
    measure_[at(i)] += by;
    insert(i);
  }

 private:
  void insert(int i) {
    const std::size_t m = at(measure_[at(i)]);
    if (m >= head_.size()) head_.resize(m + 1, -1);
    previous_[at(i)] = -1;
    next_[at(i)] = head_[m];
    if (head_[m] >= 0) previous_[at(head_[m])] = i;
    head_[m] = i;
  }
  std::vector<int> measure_;
  std::vector<int> next_;
  std::vector<int> previous_;
  std::vector<int> head_;
};

/// The first pass of Ruge & Stueben: 1 for C, 0 for F.
Mask split(const SparseRows& A, const Mask& strong) {
  const int n = A.rows();
  SparseRows S;  // the pattern of the strong entries
  S.start.reserve(at(n) + 1);
  S.column.reserve(A.column.size());
  for (int i = 0; i < n; ++i) {
    for (int s = A.start[at(i)]; s < A.start[at(i) + 1]; ++s)
      if (strong[at(s)]) S.column.push_back(A.column[at(s)]);
    S.end_row();
  }
  S.value.resize(S.column.size());
  const SparseRows T = S.transposed(n);
  std::vector<int> dependants(at(n));
  for (int i = 0; i < n; ++i) dependants[at(i)] = T.start[at(i) + 1] - T.start[at(i)];
  Buckets undecided(dependants);
  constexpr char is_undecided = 2;
  Mask c(at(n), is_undecided);
  for (int i = undecided.top(); i >= 0; i = undecided.top()) {
    undecided.remove(i);
    if (undecided.measure(i) == 0) {  // nobody left to interpolate from i; a C if it has nobody to interpolate from
      c[at(i)] = S.start[at(i)] < S.start[at(i) + 1] ? 1 : 0;
      continue;
    }
    c[at(i)] = 1;
    for (int s = T.start[at(i)]; s < T.start[at(i) + 1]; ++s) {
      const int j = T.column[at(s)];
      if (c[at(j)] != is_undecided) continue;
      c[at(j)] = 0;
      undecided.remove(j);
      for (int t = S.start[at(j)]; t < S.start[at(j) + 1]; ++t)
        if (c[at(S.column[at(t)])] == is_undecided) undecided.change(S.column[at(t)], 1);
    }
    for (int s = S.start[at(i)]; s < S.start[at(i) + 1]; ++s)
      if (c[at(S.column[at(s)])] == is_undecided) undecided.change(S.column[at(s)], -1);
  }
  return c;
}

SparseRows interpolation(const SparseRows& A, const Mask& strong, const Mask& c, const std::vector<int>& number) {
  SparseRows P;
  P.start.reserve(A.start.size());
  P.column.reserve(A.column.size());
  P.value.reserve(A.column.size());
  for (int i = 0; i < A.rows(); ++i) {
    if (c[at(i)]) {
      P.push(number[at(i)], 1);
      P.end_row();
      continue;
    }
    double diagonal = 0;
    double negative = 0;
    double coarse = 0;
    for (int s = A.start[at(i)]; s < A.start[at(i) + 1]; ++s) {
      const int j = A.column[at(s)];
      const double a = A.value[at(s)];
      if (j == i || a > 0)
        diagonal += a;
      else
        negative += a;
      if (strong[at(s)] && c[at(j)]) coarse += a;
    }
    const double factor = coarse < 0 && diagonal > 0 ? -negative / (coarse * diagonal) : 0;
    if (factor != 0)
      for (int s = A.start[at(i)]; s < A.start[at(i) + 1]; ++s)
        if (strong[at(s)] && c[at(A.column[at(s)])]) P.push(number[at(A.column[at(s)])], factor * A.value[at(s)]);
    P.end_row();
  }
  return P;
}

/// Adds up a sparse row.
class RowSum {
 public:
  explicit RowSum(std::size_t columns = 0) : value_(columns), in_row_(columns, 0) {}
  void add(int j, double a) {
    if (in_row_[at(j)]) {
      value_[at(j)] += a;
    } else {
      in_row_[at(j)] = 1;
      value_[at(j)] = a;
      columns_.push_back(j);
    }
  }
  /// Appends the row to A, columns ascending, and begins a new one.
  void take(SparseRows& A) {
    std::ranges::sort(columns_);
    for (const int j : columns_) {
      A.push(j, value_[at(j)]);
      in_row_[at(j)] = 0;
    }
    columns_.clear();
  }

 private:
  std::vector<double> value_;
  Mask in_row_;
  std::vector<int> columns_;
};

/// Row I of P'A P, over fine and coarse unknowns that are free.
template <class FineFree, class CoarseFree>
void galerkin_row(const SparseRows& A, const SparseRows& P, const SparseRows& R, int I, FineFree fine,
                  CoarseFree coarse, RowSum& row) {
  for (int r = R.start[at(I)]; r < R.start[at(I) + 1]; ++r) {
    const int i = R.column[at(r)];
    if (!fine(i)) continue;
    const double w = R.value[at(r)];
    for (int s = A.start[at(i)]; s < A.start[at(i) + 1]; ++s) {
      const int k = A.column[at(s)];
      if (!fine(k)) continue;
      const double wa = w * A.value[at(s)];
      for (int t = P.start[at(k)]; t < P.start[at(k) + 1]; ++t)
        if (coarse(P.column[at(t)])) row.add(P.column[at(t)], wa * P.value[at(t)]);
    }
  }
}

SparseRows galerkin(const SparseRows& A, const SparseRows& P, const SparseRows& R) {
  SparseRows coarse;
  const int n = R.rows();
  coarse.start.reserve(at(n) + 1);
  coarse.column.reserve(A.column.size());
  coarse.value.reserve(A.column.size());
  RowSum row(at(n));
  const auto all = [](int) { return true; };
  for (int I = 0; I < n; ++I) {
    galerkin_row(A, P, R, I, all, all, row);
    row.take(coarse);
    coarse.end_row();
  }
  return coarse;
}

Vec diagonal_of(const SparseRows& A) {
  Vec d = Vec::Zero(A.rows());
  for (int i = 0; i < A.rows(); ++i)
    for (int s = A.start[at(i)]; s < A.start[at(i) + 1]; ++s)
      if (A.column[at(s)] == i) d[i] = A.value[at(s)];
  return d;
}

/// Row k: of unknown order[k], what stands before it in that order.
void lower_part(const SparseRows& A, const std::vector<int>& order, const std::vector<int>& position, SparseRows& L) {
  L.start.assign(1, 0);
  L.start.reserve(order.size() + 1);
  L.column.clear();
  L.value.clear();
  L.column.reserve(A.column.size() / 2);
  L.value.reserve(A.column.size() / 2);
  for (const int i : order) {
    for (int s = A.start[at(i)]; s < A.start[at(i) + 1]; ++s)
      if (position[at(A.column[at(s)])] < position[at(i)]) L.push(A.column[at(s)], A.value[at(s)]);
    L.end_row();
  }
}

/// The next grid's unknowns, then the others.
std::vector<int> sweep_order(const Grid& grid) {
  std::vector<int> order = grid.c_points;
  order.reserve(at(grid.A.rows()));
  std::size_t next = 0;
  for (int i = 0; i < grid.A.rows(); ++i)
    if (next < grid.c_points.size() && grid.c_points[next] == i)
      ++next;
    else
      order.push_back(i);
  return order;
}

/// Zero for diagonals of the next grid that are the rounding of 0, where A is singular.
void drop_null(const Grid& fine, Vec& diagonal) {
  for (Index I = 0; I < diagonal.size(); ++I)
    if (!(diagonal[I] > 1e-10 * fine.diagonal[fine.c_points[at(static_cast<int>(I))]])) diagonal[I] = 0;
}

}  // namespace

Hierarchy::Hierarchy(SparseRows A, double theta, int coarsest) {
  for (;;) {
    grids.emplace_back();
    Grid& grid = grids.back();
    grid.A = std::move(A);
    grid.diagonal = diagonal_of(grid.A);
    if (grids.size() > 1) drop_null(grids[grids.size() - 2], grid.diagonal);
    const int n = grid.A.rows();
    if (n <= coarsest) return;
    const Mask strong = strong_entries(grid.A, theta);
    const Mask c = split(grid.A, strong);
    std::vector<int> number(at(n), -1);
    for (int i = 0; i < n; ++i)
      if (c[at(i)]) {
        number[at(i)] = static_cast<int>(grid.c_points.size());
        grid.c_points.push_back(i);
      }
    const int n_coarse = static_cast<int>(grid.c_points.size());
    if (n_coarse == 0 || 10 * static_cast<long>(n_coarse) > 9 * static_cast<long>(n)) {
      grid.c_points.clear();
      return;
    }
    grid.P = interpolation(grid.A, strong, c, number);
    grid.R = grid.P.transposed(n_coarse);
    A = galerkin(grid.A, grid.P, grid.R);
  }
}

VCycle::VCycle(const Hierarchy& hierarchy, std::size_t finest, int direct)
    : hierarchy_(hierarchy), finest_(finest), direct_(direct), levels_(hierarchy.grids.size() - finest) {
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    const Index n = hierarchy.grids[finest + k].A.rows();
    levels_[k].b = levels_[k].x = levels_[k].inverse = levels_[k].behind = Vec::Zero(n);
    levels_[k].free.resize(static_cast<std::size_t>(n));
    levels_[k].order = sweep_order(hierarchy.grids[finest + k]);
    levels_[k].position.resize(levels_[k].order.size());
    for (std::size_t p = 0; p < levels_[k].order.size(); ++p)
      levels_[k].position[at(levels_[k].order[p])] = static_cast<int>(p);
  }
  lower_part(hierarchy.grids[finest].A, levels_[0].order, levels_[0].position, levels_[0].lower);
}

FaceStatus VCycle::set_free(const Mask& free) {
  const SparseRows& A = hierarchy_.grids[finest_].A;
  Level& top = levels_[0];
  top.A = &A;
  top.free = free;
  if (std::ranges::find(free, 0) == free.end()) {
    all_free();
    return FaceStatus::Ok;
  }
  // Rows whose coarse rows differ from the hierarchy's, because something they reach is not free.
  Mask changed(free.size(), 0);
  for (int i = 0; i < A.rows(); ++i) {
    top.inverse[i] = free[at(i)] ? 1 / hierarchy_.grids[finest_].diagonal[i] : 0;
    if (free[at(i)]) continue;
    changed[at(i)] = 1;
    for (int s = A.start[at(i)]; s < A.start[at(i) + 1]; ++s) changed[at(A.column[at(s)])] = 1;
  }
  Mask changed_coarse;
  for (std::size_t k = 0; k + 1 < levels_.size(); ++k) {
    restrict_to(k, changed, changed_coarse);
    std::swap(changed, changed_coarse);
  }
  factor_coarsest();
  return FaceStatus::Ok;
}

/// The whole space is a face too: the hierarchy's own matrices.
void VCycle::all_free() {
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    const Grid& grid = hierarchy_.grids[finest_ + k];
    Level& level = levels_[k];
    level.A = &grid.A;
    level.free.assign(level.free.size(), 1);
    level.inverse = grid.diagonal.unaryExpr([](double d) { return d > 0 ? 1 / d : 0.0; });
    if (k > 0) lower_part(grid.A, level.order, level.position, level.lower);
  }
  factor_coarsest();
}

/// The matrix of level k + 1 on the face.
void VCycle::restrict_to(std::size_t k, const Mask& changed, Mask& changed_coarse) {
  const Grid& grid = hierarchy_.grids[finest_ + k];
  const SparseRows& whole = hierarchy_.grids[finest_ + k + 1].A;
  const Level& fine = levels_[k];
  Level& coarse = levels_[k + 1];
  const int n = whole.rows();
  for (int I = 0; I < n; ++I) coarse.free[at(I)] = fine.free[at(grid.c_points[at(I)])];
  SparseRows& A = coarse.truncated;
  A.start.assign(1, 0);
  A.column.clear();
  A.value.clear();
  A.column.reserve(whole.column.size());
  A.value.reserve(whole.value.size());
  changed_coarse.assign(at(n), 0);
  RowSum row(at(n));
  const auto fine_free = [&](int i) { return fine.free[at(i)] != 0; };
  const auto coarse_free = [&](int J) { return coarse.free[at(J)] != 0; };
  for (int I = 0; I < n; ++I) {
    bool touched = !coarse.free[at(I)];
    for (int r = grid.R.start[at(I)]; r < grid.R.start[at(I) + 1] && !touched; ++r)
      touched = changed[at(grid.R.column[at(r)])] != 0;
    bool neighbour_dropped = false;
    for (int s = whole.start[at(I)]; s < whole.start[at(I) + 1]; ++s)
      neighbour_dropped = neighbour_dropped || !coarse.free[at(whole.column[at(s)])];
    changed_coarse[at(I)] = touched || neighbour_dropped ? 1 : 0;
    if (coarse.free[at(I)]) {
      if (changed_coarse[at(I)]) {
        galerkin_row(*fine.A, grid.P, grid.R, I, fine_free, coarse_free, row);
        row.take(A);
      } else {
        A.column.insert(A.column.end(), whole.column.begin() + whole.start[at(I)],
                        whole.column.begin() + whole.start[at(I) + 1]);
        A.value.insert(A.value.end(), whole.value.begin() + whole.start[at(I)],
                       whole.value.begin() + whole.start[at(I) + 1]);
      }
    }
    A.end_row();
  }
  coarse.A = &coarse.truncated;
  lower_part(A, coarse.order, coarse.position, coarse.lower);
  coarse.inverse = diagonal_of(A);
  drop_null(grid, coarse.inverse);
  for (double& d : coarse.inverse) d = d > 0 ? 1 / d : 0;
}

void VCycle::factor_coarsest() {
  const Level& last = levels_.back();
  const Index n = last.b.size();
  factored_ = false;
  if (n > direct_) return;
  std::vector<::Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    if (last.inverse[i] == 0) {
      entries.emplace_back(i, i, 1);
      continue;
    }
    for (int s = last.A->start[at(i)]; s < last.A->start[at(i) + 1]; ++s) {
      const int j = last.A->column[at(s)];
      // A little more on the diagonal: the matrix may be singular, and this is a preconditioner.
      if (last.inverse[j] != 0) entries.emplace_back(i, j, last.A->value[at(s)] * (i == j ? 1 + 1e-12 : 1));
    }
  }
  SpMat A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  ++factorizations;
  factored_ = coarsest_.factor(A) == CholeskyStatus::Ok;
}

void VCycle::apply(const Vec& r, Vec& x) { cycle(0, r, x); }

void VCycle::cycle(std::size_t depth, const Vec& b, Vec& x) {
  Level& level = levels_[depth];
  const bool coarsest = depth + 1 == levels_.size();
  if (coarsest && factored_) {
    coarsest_.solve(b, x);
    for (Index i = 0; i < x.size(); ++i)
      if (level.inverse[i] == 0) x[i] = 0;
    return;
  }
  const int n = level.lower.rows();
  const int* start = level.lower.start.data();
  const int* column = level.lower.column.data();
  const double* value = level.lower.value.data();
  const double* inverse = level.inverse.data();
  double* behind = level.behind.data();
  double* y = x.data();
  const int* order = level.order.data();
  // Forward sweep from 0, which knows only the unknowns before its own. A is symmetric: the same entries carry x_i to
  // those, whose residual b - A x is what they have of the unknowns behind them.
  for (int k = 0; k < n; ++k) {
    const int i = order[k];
    behind[i] = 0;
    y[i] = 0;
    if (inverse[i] == 0) continue;
    double sum = b[i];
    for (int s = start[k]; s < start[k + 1]; ++s) sum -= value[s] * y[column[s]];
    const double x_i = sum * inverse[i];
    y[i] = x_i;
    for (int s = start[k]; s < start[k + 1]; ++s) behind[column[s]] -= value[s] * x_i;
  }
  if (!coarsest) {
    const SparseRows& P = hierarchy_.grids[finest_ + depth].P;
    const int* begin = P.start.data();
    const int* parent = P.column.data();
    const double* weight = P.value.data();
    Level& next = levels_[depth + 1];
    next.b.setZero();
    double* to = next.b.data();
    for (int i = 0; i < n; ++i)
      if (inverse[i] != 0)
        for (int t = begin[i]; t < begin[i + 1]; ++t) to[parent[t]] += weight[t] * behind[i];
    next.b = (next.inverse.array() == 0).select(0, next.b);
    cycle(depth + 1, next.b, next.x);
    const double* from = next.x.data();
    for (int i = 0; i < n; ++i)
      if (inverse[i] != 0)
        for (int t = begin[i]; t < begin[i + 1]; ++t) y[i] += weight[t] * from[parent[t]];
  }
  // Backward sweep: what is behind comes from those that are done, likewise.
  level.behind.setZero();
  for (int k = n - 1; k >= 0; --k) {
    const int i = order[k];
    if (inverse[i] == 0) continue;
    double sum = b[i] + behind[i];
    for (int s = start[k]; s < start[k + 1]; ++s) sum -= value[s] * y[column[s]];
    const double x_i = sum * inverse[i];
    y[i] = x_i;
    for (int s = start[k]; s < start[k + 1]; ++s) behind[column[s]] -= value[s] * x_i;
  }
}

}  // namespace perp::lcp

#include "lcp/multilevel.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace perp::lcp {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

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

/// Appends row I of P'A P to `out`, over fine and coarse unknowns that are `free` (all, if null). place: -1 everywhere.
template <class FineFree, class CoarseFree>
void galerkin_row(const SparseRows& A, const SparseRows& P, const SparseRows& R, int I, FineFree fine,
                  CoarseFree coarse, std::vector<int>& place, SparseRows& out) {
  const std::size_t first = out.column.size();
  for (int r = R.start[at(I)]; r < R.start[at(I) + 1]; ++r) {
    const int i = R.column[at(r)];
    if (!fine(i)) continue;
    const double w = R.value[at(r)];
    for (int s = A.start[at(i)]; s < A.start[at(i) + 1]; ++s) {
      const int k = A.column[at(s)];
      if (!fine(k)) continue;
      const double wa = w * A.value[at(s)];
      for (int t = P.start[at(k)]; t < P.start[at(k) + 1]; ++t) {
        const int J = P.column[at(t)];
        if (!coarse(J)) continue;
        const double a = wa * P.value[at(t)];
        if (place[at(J)] < 0) {
          place[at(J)] = static_cast<int>(out.column.size());
          out.push(J, a);
        } else {
          out.value[at(place[at(J)])] += a;
        }
      }
    }
  }
  for (std::size_t s = first; s < out.column.size(); ++s) place[at(out.column[s])] = -1;
}

/// Sorts the last row by columns.
void sort_last_row(SparseRows& A, std::size_t first) {
  for (std::size_t s = first + 1; s < A.column.size(); ++s) {
    const int j = A.column[s];
    const double a = A.value[s];
    std::size_t t = s;
    for (; t > first && A.column[t - 1] > j; --t) {
      A.column[t] = A.column[t - 1];
      A.value[t] = A.value[t - 1];
    }
    A.column[t] = j;
    A.value[t] = a;
  }
}

SparseRows galerkin(const SparseRows& A, const SparseRows& P, const SparseRows& R) {
  SparseRows coarse;
  const int n = R.rows();
  coarse.start.reserve(at(n) + 1);
  coarse.column.reserve(A.column.size());
  coarse.value.reserve(A.column.size());
  std::vector<int> place(at(n), -1);
  const auto all = [](int) { return true; };
  for (int I = 0; I < n; ++I) {
    const std::size_t first = coarse.column.size();
    galerkin_row(A, P, R, I, all, all, place, coarse);
    sort_last_row(coarse, first);
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
    levels_[k].b = levels_[k].x = levels_[k].inverse = levels_[k].residual = Vec::Zero(n);
    levels_[k].free.resize(static_cast<std::size_t>(n));
  }
  place_.assign(levels_.size() > 1 ? levels_[1].free.size() : 0, -1);
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
  const auto fine_free = [&](int i) { return fine.free[at(i)] != 0; };
  const auto coarse_free = [&](int J) { return coarse.free[at(J)] != 0; };
  for (int I = 0; I < n; ++I) {
    const std::size_t first = A.column.size();
    bool touched = !coarse.free[at(I)];
    for (int r = grid.R.start[at(I)]; r < grid.R.start[at(I) + 1] && !touched; ++r)
      touched = changed[at(grid.R.column[at(r)])] != 0;
    bool neighbour_dropped = false;
    for (int s = whole.start[at(I)]; s < whole.start[at(I) + 1]; ++s)
      neighbour_dropped = neighbour_dropped || !coarse.free[at(whole.column[at(s)])];
    changed_coarse[at(I)] = touched || neighbour_dropped ? 1 : 0;
    if (coarse.free[at(I)]) {
      if (changed_coarse[at(I)]) {
        galerkin_row(*fine.A, grid.P, grid.R, I, fine_free, coarse_free, place_, A);
        sort_last_row(A, first);
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

void VCycle::cycle(std::size_t k, const Vec& b, Vec& x) {
  Level& level = levels_[k];
  const bool coarsest = k + 1 == levels_.size();
  if (coarsest && factored_) {
    coarsest_.solve(b, x);
    for (Index i = 0; i < x.size(); ++i)
      if (level.inverse[i] == 0) x[i] = 0;
    return;
  }
  const int n = level.A->rows();
  const int* start = level.A->start.data();
  const int* column = level.A->column.data();
  const double* value = level.A->value.data();
  const double* inverse = level.inverse.data();
  double* residual = level.residual.data();
  double* y = x.data();
  // Forward sweep from 0, which knows only the columns before the diagonal. A is symmetric: the same entries carry x_i
  // to the rows before, whose residual b - A x is what they have of the columns behind the diagonal.
  for (int i = 0; i < n; ++i) {
    residual[i] = 0;
    y[i] = 0;
    if (inverse[i] == 0) continue;
    double sum = b[i];
    int s = start[i];
    for (; column[s] < i; ++s) sum -= value[s] * y[column[s]];
    const double x_i = sum * inverse[i];
    y[i] = x_i;
    for (--s; s >= start[i]; --s) residual[column[s]] -= value[s] * x_i;
  }
  if (!coarsest) {
    const SparseRows& P = hierarchy_.grids[finest_ + k].P;
    const int* begin = P.start.data();
    const int* parent = P.column.data();
    const double* weight = P.value.data();
    Level& next = levels_[k + 1];
    next.b.setZero();
    double* to = next.b.data();
    for (int i = 0; i < n; ++i)
      if (inverse[i] != 0)
        for (int t = begin[i]; t < begin[i + 1]; ++t) to[parent[t]] += weight[t] * residual[i];
    next.b = (next.inverse.array() == 0).select(0, next.b);
    cycle(k + 1, next.b, next.x);
    const double* from = next.x.data();
    for (int i = 0; i < n; ++i)
      if (inverse[i] != 0)
        for (int t = begin[i]; t < begin[i + 1]; ++t) y[i] += weight[t] * from[parent[t]];
  }
  for (int i = n - 1; i >= 0; --i) {
    if (inverse[i] == 0) continue;
    double sum = b[i];
    for (int s = start[i]; s < start[i + 1]; ++s) sum -= value[s] * y[column[s]];
    y[i] += sum * inverse[i];
  }
}

}  // namespace perp::lcp

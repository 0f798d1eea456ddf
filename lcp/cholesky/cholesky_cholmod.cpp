// SPDX-License-Identifier: Apache-2.0
/// The library of Cholesky in a build with GPL libraries: CHOLMOD, but for the numbers of supernodal factors.
#include <cholmod.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>
#include <utility>
#include <vector>

#include "lcp/cholesky/cholesky_library.hpp"
#include "lcp/cholesky/cholesky_supernodal.hpp"
#include "lcp/cholesky/metis_lock.hpp"

namespace perp::lcp {
namespace {

/// Thorough: beyond so many operations a factorization, by the first of CHOLMOD's list: given (none), AMD, METIS,
/// nested dissection.
constexpr double worth_ordering = 2e7;
constexpr int all_orderings = 4;
/// Operations for an entry of L from which on supernodes take less time: of quadratic programs measured at 45 to 80.
constexpr double worth_supernodes = 60;

/// CHOLMOD's settings and workspace; silent.
class Common {
 public:
  Common() {
    cholmod_start(&common_);
    common_.print = 0;
    common_.error_handler = nullptr;
    common_.supernodal_switch = worth_supernodes;
    // Also where CHOLMOD finds the simplicial method faster, which would be L D L' otherwise and accept any D.
    common_.final_ll = 1;
  }
  ~Common() { cholmod_finish(&common_); }
  Common(const Common&) = delete;
  Common& operator=(const Common&) = delete;
  cholmod_common* get() { return &common_; }
  int status() const { return common_.status; }
  double entries() const { return common_.lnz; }  // of the last analysis
  double flops() const { return common_.fl; }

 private:
  cholmod_common common_{};
};

/// A's lower triangle as CHOLMOD reads it, without a copy.
cholmod_sparse lower_triangle(const SpMat& A) {
  cholmod_sparse view{};
  view.nrow = view.ncol = static_cast<std::size_t>(A.rows());
  view.nzmax = static_cast<std::size_t>(A.nonZeros());
  // CHOLMOD has no const; it only reads these.
  view.p = const_cast<int*>(A.outerIndexPtr());
  view.i = const_cast<int*>(A.innerIndexPtr());
  view.x = const_cast<double*>(A.valuePtr());
  view.stype = -1;
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  return view;
}

cholmod_dense column(const double* values, Index n) {
  cholmod_dense view{};
  view.nrow = view.nzmax = view.d = static_cast<std::size_t>(n);
  view.ncol = 1;
  view.x = const_cast<double*>(values);
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  return view;
}

struct Dense {
  Dense(Common& of, Index rows, std::size_t columns)
      : common(of),
        is(cholmod_allocate_dense(static_cast<std::size_t>(rows), columns, static_cast<std::size_t>(rows), CHOLMOD_REAL,
                                  of.get())) {
    if (is == nullptr) throw std::bad_alloc();
  }
  ~Dense() { cholmod_free_dense(&is, common.get()); }
  Dense(const Dense&) = delete;
  Dense& operator=(const Dense&) = delete;

  Common& common;
  cholmod_dense* is;
};

CholeskyStatus failure_of(int code) {
  return code == CHOLMOD_NOT_POSDEF ? CholeskyStatus::NotPositiveDefinite : CholeskyStatus::OutOfMemory;
}

class Cholmod final : public CholeskyLibrary {
 public:
  explicit Cholmod(CholeskyOrdering ordering) : thorough_(ordering == CholeskyOrdering::Thorough) {}
  ~Cholmod() override { clear(); }

  void set_signs(std::vector<signed char> signs) override {
    signs_ = std::move(signs);
    common_.get()->final_ll = signs_.empty();
    clear();
  }
  CholeskyStatus analyze(const SpMat& A) override {
    analyze(A, 0);
    if (thorough_ && L_ && flops_ > worth_ordering) analyze(A, all_orderings);
    if (L_ && !L_->is_super) order(A);
    return L_ && common_.status() >= CHOLMOD_OK ? CholeskyStatus::Ok : failure_of(common_.status());
  }
  double entries() const override { return entries_; }
  double flops() const override { return flops_; }

  CholeskyStatus factor(const SpMat& A) override {
    if (L_->is_super) return factor_supernodes(A);
    for (std::size_t k = 0; k < from_.size(); ++k) ordered_.valuePtr()[k] = A.valuePtr()[from_[k]];
    cholmod_sparse upper = lower_triangle(ordered_);
    upper.stype = 1;
    const int ordering = std::exchange(L_->ordering, CHOLMOD_NATURAL);
    cholmod_factorize(&upper, L_, common_.get());
    L_->ordering = ordering;
    if (common_.status() < CHOLMOD_OK) return failure_of(common_.status());
    if (!signs_.empty() && L_->minor == L_->n) L_->minor = first_of_wrong_sign();
    return common_.status() == CHOLMOD_NOT_POSDEF || L_->minor < L_->n ? CholeskyStatus::NotPositiveDefinite
                                                                       : CholeskyStatus::Ok;
  }

  CholeskyColumns columns() const override;
  Index failed_column() const override { return static_cast<const int*>(L_->Perm)[L_->minor]; }
  Vec witness(const SpMat& A) override;
  double rcond() override { return cholmod_rcond(L_, common_.get()); }

  void solve(In b, Out x) const override {
    if (supernodes_) {
      Vec columns = b;
      solve_supernodes(columns);
      x = columns;
      return;
    }
    const Index n = b.size();
    Common common;  // its own: solves may run in two threads
    cholmod_dense right = column(b.data(), n);
    // Made here: of its own requests cholmod_solve2 looks at the last one only, and then uses those that were refused.
    Dense solution(common, n, 1);
    Dense permuted(common, n, 1);
    Dense rows(common, 1, std::max<std::size_t>(1, L_->maxesize));
    if (!cholmod_solve2(CHOLMOD_A, L_, &right, nullptr, &solution.is, nullptr, &permuted.is, &rows.is, common.get()))
      throw std::bad_alloc();
    std::copy_n(static_cast<const double*>(solution.is->x), n, x.data());
  }
  void solve_columns(Eigen::MatrixXd& X) const override {
    if (supernodes_) return solve_supernodes(X);
    CholeskyLibrary::solve_columns(X);
  }

 private:
  /// By so many of CHOLMOD's orderings; 0: its defaults.
  void analyze(const SpMat& A, int orderings) {
    clear();
    cholmod_sparse lower = lower_triangle(A);
    common_.get()->nmethods = orderings;
    const std::lock_guard alone(metis_lock());
    L_ = cholmod_analyze(&lower, common_.get());
    entries_ = common_.entries();
    flops_ = common_.flops();
  }
  /// The upper triangle of P A P', which CHOLMOD factors as it is: it would transpose any other twice each time.
  void order(const SpMat& A) {
    const auto* permutation = static_cast<const int*>(L_->Perm);
    std::vector<int> place(at(A.rows()));
    for (std::size_t k = 0; k < place.size(); ++k) place[at(permutation[k])] = static_cast<int>(k);
    std::vector<Eigen::Triplet<double>> entries;  // their values: where they come from
    entries.reserve(at(A.nonZeros()));
    for (int j = 0; j < A.cols(); ++j)
      for (int p = A.outerIndexPtr()[j]; p < A.outerIndexPtr()[j + 1]; ++p)
        if (const int i = A.innerIndexPtr()[p]; i >= j)
          entries.emplace_back(std::min(place[at(i)], place[at(j)]), std::max(place[at(i)], place[at(j)]), p);
    ordered_.resize(A.rows(), A.cols());
    ordered_.setFromTriplets(entries.begin(), entries.end());
    from_.assign(ordered_.valuePtr(), ordered_.valuePtr() + ordered_.nonZeros());
  }
  CholeskyStatus factor_supernodes(const SpMat& A);
  /// The first pivot of L D L' whose sign is not the one asked for, or n; one that is not a number is taken for right.
  std::size_t first_of_wrong_sign() const {
    const auto* order = static_cast<const int*>(L_->Perm);
    const auto* begin = static_cast<const int*>(L_->p);
    const auto* value = static_cast<const double*>(L_->x);
    for (std::size_t k = 0; k < L_->n; ++k)
      if (value[begin[k]] * signs_[at(order[k])] <= 0) return k;
    return L_->n;
  }
  std::span<double> values() const { return {static_cast<double*>(L_->x), L_->xsize}; }
  template <class X>
  void solve_supernodes(X& x) const {
    const auto* order = static_cast<const int*>(L_->Perm);
    X permuted(x.rows(), x.cols());
    for (Index c = 0; c < x.cols(); ++c)
      for (Index k = 0; k < x.rows(); ++k) permuted(k, c) = x(order[k], c);
    supernodes_->solve(values(), permuted);
    for (Index c = 0; c < x.cols(); ++c)
      for (Index k = 0; k < x.rows(); ++k) x(order[k], c) = permuted(k, c);
  }
  void clear() {
    supernodes_.reset();
    if (L_) cholmod_free_factor(&L_, common_.get());
    L_ = nullptr;
  }

  bool thorough_;
  std::vector<signed char> signs_;  // of A's rows; empty: all positive
  Common common_;
  cholmod_factor* L_ = nullptr;
  SpMat ordered_;                               // of a simplicial L: order()
  std::vector<int> from_{};                     // where each of its values is in A
  std::optional<SupernodalFactor> supernodes_;  // of L_, once there was a matrix
  double entries_ = 0;
  double flops_ = 0;
};

/// The memory of L is CHOLMOD's, which solves with it.
CholeskyStatus Cholmod::factor_supernodes(const SpMat& A) {
  if (!supernodes_) {
    const auto ints = [](const void* of, std::size_t size) { return std::span(static_cast<const int*>(of), size); };
    supernodes_.emplace(A, ints(L_->Perm, L_->n), signs_,
                        SupernodalShape{.first = ints(L_->super, L_->nsuper + 1),
                                        .rows_at = ints(L_->pi, L_->nsuper + 1),
                                        .values_at = ints(L_->px, L_->nsuper + 1),
                                        .rows = ints(L_->s, L_->ssize)});
  }
  if (L_->xtype == CHOLMOD_PATTERN && !cholmod_change_factor(CHOLMOD_REAL, 1, 1, 1, 1, L_, common_.get()))
    return CholeskyStatus::OutOfMemory;
  L_->minor = static_cast<std::size_t>(supernodes_->factor(A, values()));
  return L_->minor < L_->n ? CholeskyStatus::NotPositiveDefinite : CholeskyStatus::Ok;
}

CholeskyColumns Cholmod::columns() const {
  const auto ints = [](const void* of) { return static_cast<const int*>(of); };
  const auto n = static_cast<int>(L_->n);
  CholeskyColumns L{.order = std::vector<int>(ints(L_->Perm), ints(L_->Perm) + n)};
  const auto* values = static_cast<const double*>(L_->x);
  const auto take = [&](const int* rows, int first, int end, const double* column) {
    for (int e = first; e < end; ++e) {
      if (column[e] == 0) continue;  // supernodes hold more than the pattern of L
      L.row.push_back(rows[e]);
      L.value.push_back(column[e]);
    }
    L.start.push_back(static_cast<int>(L.row.size()));
  };
  if (!L_->is_super) {
    for (int j = 0; j < n; ++j) {
      const int first = ints(L_->p)[j];
      take(ints(L_->i) + first, 0, ints(L_->nz)[j], values + first);
    }
    return L;
  }
  for (std::size_t s = 0; s < L_->nsuper; ++s) {
    const int columns = ints(L_->super)[s + 1] - ints(L_->super)[s];
    const int rows = ints(L_->pi)[s + 1] - ints(L_->pi)[s];
    for (int j = 0; j < columns; ++j)
      take(ints(L_->s) + ints(L_->pi)[s], j, rows, values + ints(L_->px)[s] + std::ptrdiff_t{j} * rows);
  }
  return L;
}

/// With k the failed pivot and B the leading k x k block of P A P' = (B b; b' beta): d = P'(-B^-1 b, 1, 0) has
/// d'A d = beta - b'B^-1 b, the pivot.
Vec Cholmod::witness(const SpMat& A) {
  const Index n = A.rows();
  const auto k = static_cast<Index>(L_->minor);
  const Index failed = failed_column();
  const auto* permutation = static_cast<const int*>(L_->Perm);
  std::vector<int> place(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) place[static_cast<std::size_t>(permutation[i])] = static_cast<int>(i);
  Vec x = Vec::Zero(n);
  const auto put = [&](Index i, double value) {
    const int at = place[static_cast<std::size_t>(i)];
    if (at < k) x[at] = -value;
  };
  for (Index j = 0; j < n; ++j)  // the failed column of the symmetric matrix, of which the lower triangle is stored
    for (SpMat::InnerIterator it(A, j); it; ++it) {
      if (it.row() < j) continue;
      if (it.row() == failed) put(j, it.value());
      if (j == failed) put(it.row(), it.value());
    }
  cholmod_sparse* columns = cholmod_factor_to_sparse(L_, common_.get());
  if (!columns) return {};
  const auto* p = static_cast<const int*>(columns->p);
  const auto* row = static_cast<const int*>(columns->i);
  const auto* value = static_cast<const double*>(columns->x);
  for (Index j = 0; j < k; ++j) {  // L y = -b; the diagonal comes first in a column
    x[j] /= value[p[j]];
    for (int s = p[j] + 1; s < p[j + 1]; ++s)
      if (row[s] < k) x[row[s]] -= value[s] * x[j];
  }
  for (Index j = k - 1; j >= 0; --j) {  // L'x = y
    for (int s = p[j] + 1; s < p[j + 1]; ++s)
      if (row[s] < k) x[j] -= value[s] * x[row[s]];
    x[j] /= value[p[j]];
  }
  cholmod_free_sparse(&columns, common_.get());
  x[k] = 1;
  Vec d = Vec::Zero(n);
  for (Index i = 0; i <= k; ++i) d[permutation[i]] = x[i];
  return d.allFinite() ? d : Vec();
}

}  // namespace

std::unique_ptr<CholeskyLibrary> make_cholesky(CholeskyOrdering ordering) {
  return std::make_unique<Cholmod>(ordering);
}

}  // namespace perp::lcp

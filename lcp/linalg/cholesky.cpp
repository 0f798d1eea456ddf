// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/cholesky.hpp"

#include <cholmod.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>
#include <vector>

#include "lcp/lu/metis_lock.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

/// CHOLMOD's settings and workspace; silent.
class Common {
 public:
  Common() {
    cholmod_start(&common_);
    common_.print = 0;
    common_.error_handler = nullptr;
    // Also where CHOLMOD finds the simplicial method faster, which would be L D L' otherwise and accept any D.
    common_.final_ll = 1;
  }
  ~Common() { cholmod_finish(&common_); }
  Common(const Common&) = delete;
  Common& operator=(const Common&) = delete;
  cholmod_common* get() { return &common_; }
  int status() const { return common_.status; }

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

}  // namespace

std::string_view to_string(CholeskyStatus status) {
  switch (status) {
    case CholeskyStatus::Ok:
      return "ok";
    case CholeskyStatus::NotPositiveDefinite:
      return "not positive definite";
    case CholeskyStatus::NotFinite:
      return "not finite";
    case CholeskyStatus::OutOfMemory:
      return "out of memory";
  }
  return "?";
}

struct Cholesky::Impl {
  Common common;
  cholmod_factor* L = nullptr;
  Index n = 0;
  CholeskyStatus status = CholeskyStatus::NotPositiveDefinite;
  Index failed_column = -1;
  Vec direction;
  double rcond = 0;
  double nonzeros = 0;
  KernelClock clock;

  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() { clear(); }
  void clear();
  CholeskyStatus factor(const SpMat& A, double entries);
  Vec witness(const SpMat& A);
};

void Cholesky::Impl::clear() {
  if (L) cholmod_free_factor(&L, common.get());
  L = nullptr;
  failed_column = -1;
  direction.resize(0);
  rcond = nonzeros = 0;
}

CholeskyStatus Cholesky::Impl::factor(const SpMat& A, double entries) {
  clear();
  n = A.rows();
  const double* values = A.valuePtr();
  if (!std::all_of(values, values + A.nonZeros(), [](double v) { return std::isfinite(v); }))
    return CholeskyStatus::NotFinite;
  if (n == 0) {
    rcond = 1;
    return CholeskyStatus::Ok;
  }
  if (A.nonZeros() == 0) {  // whose arrays may be null, which CHOLMOD refuses
    failed_column = 0;
    direction = Vec::Unit(n, 0);
    return CholeskyStatus::NotPositiveDefinite;
  }
  cholmod_sparse lower = lower_triangle(A);
  {
    const std::lock_guard alone(metis_lock());
    L = cholmod_analyze(&lower, common.get());
  }
  if (!L || common.status() < CHOLMOD_OK) return failure_of(common.status());
  nonzeros = common.get()->lnz;
  if (nonzeros > entries) return CholeskyStatus::OutOfMemory;
  const KernelCost cost{.flops = common.get()->fl, .bytes = (sizeof(double) + sizeof(int)) * nonzeros};
  clock.before(n, cost);
  cholmod_factorize(&lower, L, common.get());
  clock.after(cost);
  if (common.status() < CHOLMOD_OK) return failure_of(common.status());
  if (common.status() == CHOLMOD_NOT_POSDEF || L->minor < L->n) {
    failed_column = static_cast<const int*>(L->Perm)[L->minor];
    direction = witness(A);
    return CholeskyStatus::NotPositiveDefinite;
  }
  rcond = cholmod_rcond(L, common.get());
  // An overflow on the way makes pivots that are not finite, which CHOLMOD takes for positive.
  return std::isfinite(rcond) && rcond > 0 ? CholeskyStatus::Ok : CholeskyStatus::NotPositiveDefinite;
}

/// With k the failed pivot and B the leading k x k block of P A P' = (B b; b' beta): d = P'(-B^-1 b, 1, 0) has
/// d'A d = beta - b'B^-1 b, the pivot.
Vec Cholesky::Impl::witness(const SpMat& A) {
  const auto k = static_cast<Index>(L->minor);
  const auto* permutation = static_cast<const int*>(L->Perm);
  std::vector<int> place(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) place[static_cast<std::size_t>(permutation[i])] = static_cast<int>(i);
  Vec x = Vec::Zero(n);
  const auto put = [&](Index i, double value) {
    const int at = place[static_cast<std::size_t>(i)];
    if (at < k) x[at] = -value;
  };
  for (Index j = 0; j < n; ++j)  // column failed_column of the symmetric matrix, of which the lower triangle is stored
    for (SpMat::InnerIterator it(A, j); it; ++it) {
      if (it.row() < j) continue;
      if (it.row() == failed_column) put(j, it.value());
      if (j == failed_column) put(it.row(), it.value());
    }
  cholmod_sparse* columns = cholmod_factor_to_sparse(L, common.get());
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
  cholmod_free_sparse(&columns, common.get());
  x[k] = 1;
  Vec d = Vec::Zero(n);
  for (Index i = 0; i <= k; ++i) d[permutation[i]] = x[i];
  return d.allFinite() ? d : Vec();
}

Cholesky::Cholesky(Deadline deadline) : impl_(std::make_unique<Impl>()) { impl_->clock = KernelClock(deadline); }
Cholesky::~Cholesky() = default;
Cholesky::Cholesky(Cholesky&&) noexcept = default;
Cholesky& Cholesky::operator=(Cholesky&&) noexcept = default;

CholeskyStatus Cholesky::factor(const SpMat& A, double entries) {
  if (A.rows() != A.cols()) {
    throw std::invalid_argument(text_of("Cholesky: the matrix is ", A.rows(), " x ", A.cols(), ", not square"));
  }
  if (!A.isCompressed()) {
    SpMat compressed = A;
    compressed.makeCompressed();
    return factor(compressed, entries);
  }
  impl_->status = CholeskyStatus::NotPositiveDefinite;
  try {
    impl_->status = impl_->factor(A, entries);
  } catch (const std::bad_alloc&) {
    impl_->status = CholeskyStatus::OutOfMemory;
  }
  return impl_->status;
}

bool Cholesky::try_factor(const SpMat& A) {
  if (factor(A) == CholeskyStatus::OutOfMemory) throw std::bad_alloc();
  return impl_->status == CholeskyStatus::Ok;
}

void Cholesky::solve(In b, Out x) const {
  if (impl_->status != CholeskyStatus::Ok) throw std::logic_error("Cholesky: solve without a successful factor()");
  const Index n = impl_->n;
  if (b.size() != n || x.size() != n) {
    throw std::invalid_argument(text_of("Cholesky: the matrix has ", n, " rows, b ", b.size(), ", x ", x.size()));
  }
  if (n == 0) return;
  Common common;  // its own: solves may run in two threads
  cholmod_dense right = column(b.data(), n);
  // Made here: of its own requests cholmod_solve2 looks at the last one only, and then uses those that were refused.
  Dense solution(common, n, 1);
  Dense permuted(common, n, 1);
  Dense rows(common, 1, std::max<std::size_t>(1, impl_->L->maxesize));
  if (!cholmod_solve2(CHOLMOD_A, impl_->L, &right, nullptr, &solution.is, nullptr, &permuted.is, &rows.is,
                      common.get()))
    throw std::bad_alloc();
  std::copy_n(static_cast<const double*>(solution.is->x), n, x.data());
}

double Cholesky::rcond() const { return impl_->status == CholeskyStatus::Ok ? impl_->rcond : 0; }
Index Cholesky::failed_column() const { return impl_->failed_column; }
const Vec& Cholesky::failed_direction() const { return impl_->direction; }
Index Cholesky::size() const { return impl_->n; }
double Cholesky::nonzeros() const { return impl_->nonzeros; }

}  // namespace perp::lcp

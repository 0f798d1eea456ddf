// SPDX-License-Identifier: Apache-2.0
#include "lcp/lu/sparse_lu.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>
#include <vector>

#include "lcp/lu/condition.hpp"
#include "lcp/lu/lu_backend.hpp"
#include "lcp/memory.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

/// Up to so many rows a dense LU is faster than any sparse one, and up to so many KLU faster than what has dense
/// blocks.
constexpr Index dense_rows = 32;
constexpr Index small_rows = 300;

std::unique_ptr<LuLibrary> make(LuBackend backend, Index rows) {
  if (backend == LuBackend::Auto && rows <= small_rows) return rows <= dense_rows ? make_dense() : make_klu();
  switch (backend) {
    case LuBackend::Dense:
      return make_dense();
    case LuBackend::Klu:
      return make_klu();
    case LuBackend::Eigen:
      return make_eigen();
    case LuBackend::Auto:
      return make_definite();
    case LuBackend::General:
      break;
  }
  return make_general();
}

/// Whether Auto's library for a matrix of so many rows is the one for another: it keeps its memory then.
bool same_library(Index rows, Index other) {
  if (rows > small_rows || other > small_rows) return rows == other;
  return (rows <= dense_rows) == (other <= dense_rows);
}

bool same_pattern(const SpMat& A, const SpMat& B) {
  return A.rows() == B.rows() && A.nonZeros() == B.nonZeros() &&
         std::equal(A.outerIndexPtr(), A.outerIndexPtr() + A.cols() + 1, B.outerIndexPtr()) &&
         std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), B.innerIndexPtr());
}

}  // namespace

std::string_view to_string(LuBackend backend) {
  switch (backend) {
    case LuBackend::Auto:
      return "auto";
    case LuBackend::Dense:
      return "dense";
    case LuBackend::General:
      return general_lu();
    case LuBackend::Klu:
      return "klu";
    case LuBackend::Eigen:
      return "eigen";
  }
  return "?";
}

std::string_view to_string(LuStatus status) {
  switch (status) {
    case LuStatus::Ok:
      return "ok";
    case LuStatus::Singular:
      return "singular";
    case LuStatus::NotFinite:
      return "not finite";
  }
  return "?";
}

namespace {

/// Whether a row or a column has no entry, or fewer entries than rows say so.
bool has_empty_line(const SpMat& A) {
  if (A.nonZeros() < A.rows()) return true;
  std::vector<char> met(static_cast<std::size_t>(A.rows()), 0);
  for (Index p = 0; p < A.nonZeros(); ++p) met[static_cast<std::size_t>(A.innerIndexPtr()[p])] = 1;
  for (Index j = 0; j < A.cols(); ++j)
    if (A.outerIndexPtr()[j] == A.outerIndexPtr()[j + 1] || met[static_cast<std::size_t>(j)] == 0) return true;
  return false;
}

}  // namespace

struct SparseLu::Impl {
  explicit Impl(LuBackend b) : backend(b) {}
  LuBackend backend;
  std::unique_ptr<LuLibrary> library;  // made for the size
  SpMat A;
  Index made_for = 0;
  bool analyzed = false;
  bool has_factors = false;  // of A
  int analyses = 0;
  bool reuse_pivots = false;
  LuStatus status = LuStatus::Singular;

  LuStatus factor(const SpMat& matrix);
  void solve(In b, Out x, bool transposed) const;
};

SparseLu::SparseLu(LuBackend backend) : impl_(std::make_unique<Impl>(backend)) {}
SparseLu::~SparseLu() = default;
SparseLu::SparseLu(SparseLu&&) noexcept = default;
SparseLu& SparseLu::operator=(SparseLu&&) noexcept = default;

Index SparseLu::size() const { return impl_->A.rows(); }
bool SparseLu::factors(LuFactors& out) const {
  return impl_->analyzed && impl_->status != LuStatus::NotFinite && impl_->library->factors(out);
}
bool SparseLu::gives_factors() const { return impl_->library && impl_->library->gives_factors(); }
int SparseLu::analyses() const { return impl_->analyses; }

void SparseLu::reuse_pivots() {
  impl_->reuse_pivots = true;
  if (impl_->library) impl_->library->reuse_pivots();
}

LuStatus SparseLu::factor(const SpMat& A) {
  if (A.rows() != A.cols()) {
    throw std::invalid_argument(text_of("SparseLu: the matrix is ", A.rows(), " x ", A.cols(), ", not square"));
  }
  Impl& s = *impl_;
  s.status = LuStatus::Singular;
  s.status = s.factor(A);
  return s.status;
}

LuStatus SparseLu::Impl::factor(const SpMat& matrix) {
  if (!matrix.isCompressed()) {
    SpMat compressed = matrix;
    compressed.makeCompressed();
    return factor(compressed);
  }
  const double* values = matrix.valuePtr();
  if (!std::all_of(values, values + matrix.nonZeros(), [](double v) { return std::isfinite(v); }))
    return LuStatus::NotFinite;
  const bool known = analyzed && same_pattern(matrix, A);
  if (known && has_factors && std::equal(values, values + matrix.nonZeros(), A.valuePtr())) return LuStatus::Ok;
  has_factors = false;
  A = matrix;
  if (A.rows() == 0) return LuStatus::Ok;
  if (!known && has_empty_line(A)) {  // no analysis is needed; and KLU refuses a matrix without entries as malformed
    analyzed = false;
    return LuStatus::Singular;
  }
  if (!known) {
    ++analyses;
    if (!library || (backend == LuBackend::Auto && !same_library(made_for, A.rows()))) {
      library = make(backend, A.rows());
      if (reuse_pivots) library->reuse_pivots();
    }
    made_for = A.rows();
    const LuStatus answer = library->analyze(A);
    analyzed = answer == LuStatus::Ok;
    if (!analyzed) return answer;
  }
  require_factors(A.rows(), library->cost().bytes);
  const LuStatus answer = library->factor(A);
  has_factors = answer == LuStatus::Ok;
  return answer;
}

void SparseLu::Impl::solve(In b, Out x, bool transposed) const {
  if (status != LuStatus::Ok) throw std::logic_error("SparseLu: solve without a successful factor()");
  if (b.size() != A.rows() || x.size() != A.rows()) {
    throw std::invalid_argument(
        text_of("SparseLu: the matrix has ", A.rows(), " rows, b ", b.size(), ", x ", x.size()));
  }
  if (A.rows() > 0) library->solve(A, b, x, transposed);
}

void SparseLu::solve(In b, Out x) const { impl_->solve(b, x, false); }

void SparseLu::solve_transposed(In b, Out x) const { impl_->solve(b, x, true); }

void SparseLu::solve_refined(In b, Out x, int steps) const {
  solve(b, x);
  Vec r = b - impl_->A * x;
  double norm = r.lpNorm<::Eigen::Infinity>();
  Vec dx(b.size());
  for (int k = 0; k < steps && norm > 0; ++k) {
    solve(r, dx);
    const Vec better = x + dx;
    const Vec r_better = b - impl_->A * better;
    const double norm_better = r_better.lpNorm<::Eigen::Infinity>();
    if (!(norm_better < norm)) return;
    x = better;
    r = r_better;
    norm = norm_better;
  }
}

double SparseLu::pivot_ratio() const {
  if (impl_->status != LuStatus::Ok) return 0;
  return size() > 0 ? impl_->library->pivot_ratio() : 1;
}

double SparseLu::rcond() const {
  if (impl_->status != LuStatus::Ok) return 0;
  return reciprocal_condition(
      norm1(impl_->A), size(), [this](In b, Out x) { solve(b, x); }, [this](In b, Out x) { solve_transposed(b, x); });
}

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#include "lcp/cholesky/cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>
#include <vector>

#include "lcp/cholesky/cholesky_library.hpp"
#include "lcp/memory.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
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
  explicit Impl(CholeskyOrdering ordering) : library(make_cholesky(ordering)) {}

  std::unique_ptr<CholeskyLibrary> library;
  Index n = 0;
  CholeskyStatus status = CholeskyStatus::NotPositiveDefinite;
  Index failed_column = -1;
  Vec direction;
  double rcond = 0;
  double nonzeros = 0;
  bool is_signed = false;
  std::vector<int> columns, rows;  // the pattern that `library` has analysed; empty: none
  int analyses = 0;

  void clear();
  CholeskyStatus analyze(const SpMat& A);
  CholeskyStatus factor(const SpMat& A, double entries);
};

void Cholesky::Impl::clear() {
  failed_column = -1;
  direction.resize(0);
  rcond = 0;
}

/// Pre: not empty, with an entry.
CholeskyStatus Cholesky::Impl::analyze(const SpMat& A) {
  const int* starts = A.outerIndexPtr();
  const int* indices = A.innerIndexPtr();
  const auto entries = static_cast<std::size_t>(A.nonZeros());
  if (columns.size() == static_cast<std::size_t>(A.cols()) + 1 && rows.size() == entries &&
      std::equal(columns.begin(), columns.end(), starts) && std::equal(rows.begin(), rows.end(), indices))
    return CholeskyStatus::Ok;
  columns.clear();
  ++analyses;
  const CholeskyStatus answer = library->analyze(A);
  if (answer != CholeskyStatus::Ok) return answer;
  nonzeros = library->entries();
  rows.assign(indices, indices + entries);
  columns.assign(starts, starts + A.cols() + 1);
  return answer;
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
  if (A.nonZeros() == 0) {  // whose arrays may be null, which a library may refuse
    failed_column = 0;
    direction = Vec::Unit(n, 0);
    return CholeskyStatus::NotPositiveDefinite;
  }
  const CholeskyStatus analysed = analyze(A);
  if (analysed != CholeskyStatus::Ok) return analysed;
  if (nonzeros > entries) return CholeskyStatus::OutOfMemory;
  require_factors(n, (sizeof(double) + sizeof(int)) * nonzeros);
  const CholeskyStatus answer = library->factor(A);
  if (answer == CholeskyStatus::NotPositiveDefinite) {
    failed_column = library->failed_column();
    if (!is_signed) {
      direction = library->witness(A);
      columns.clear();  // witness() leaves nothing to go on with
    }
  }
  if (answer != CholeskyStatus::Ok) return answer;
  rcond = library->rcond();
  // An overflow on the way makes pivots that are not finite, which are taken for positive.
  return std::isfinite(rcond) && rcond > 0 ? CholeskyStatus::Ok : CholeskyStatus::NotPositiveDefinite;
}

Cholesky::Cholesky(CholeskyOrdering ordering) : impl_(std::make_unique<Impl>(ordering)) {}
Cholesky::~Cholesky() = default;
void Cholesky::set_signs(std::vector<signed char> signs) {
  impl_->is_signed = !signs.empty();
  impl_->columns.clear();
  impl_->library->set_signs(std::move(signs));
}
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

CholeskyStatus Cholesky::analyze(const SpMat& A) {
  if (A.rows() != A.cols() || !A.isCompressed())
    throw std::invalid_argument(text_of("Cholesky: the matrix is ", A.rows(), " x ", A.cols(),
                                        A.isCompressed() ? ", not square" : ", and not compressed"));
  impl_->status = CholeskyStatus::NotPositiveDefinite;
  try {
    return A.nonZeros() == 0 ? CholeskyStatus::Ok : impl_->analyze(A);
  } catch (const std::bad_alloc&) {
    return CholeskyStatus::OutOfMemory;
  }
}

double Cholesky::flops() const { return impl_->columns.empty() ? 0 : impl_->library->flops(); }
int Cholesky::analyses() const { return impl_->analyses; }

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
  impl_->library->solve(b, x);
}

void Cholesky::solve_columns(Eigen::MatrixXd& X) const {
  if (impl_->status != CholeskyStatus::Ok) throw std::logic_error("Cholesky: solve without a successful factor()");
  if (X.rows() != impl_->n)
    throw std::invalid_argument(text_of("Cholesky: the matrix has ", impl_->n, " rows, X ", X.rows()));
  if (X.size() > 0) impl_->library->solve_columns(X);
}

CholeskyColumns Cholesky::columns() const {
  if (impl_->status != CholeskyStatus::Ok) throw std::logic_error("Cholesky: columns without a successful factor()");
  return impl_->n > 0 ? impl_->library->columns() : CholeskyColumns();
}

double Cholesky::rcond() const { return impl_->status == CholeskyStatus::Ok ? impl_->rcond : 0; }
Index Cholesky::failed_column() const { return impl_->failed_column; }
const Vec& Cholesky::failed_direction() const { return impl_->direction; }
Index Cholesky::size() const { return impl_->n; }
double Cholesky::nonzeros() const { return impl_->nonzeros; }

}  // namespace perp::lcp

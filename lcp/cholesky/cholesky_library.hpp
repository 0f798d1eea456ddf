// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The seam between Cholesky and what factors: CHOLMOD, or code of our own in a build without it (PERP_GPL=OFF).
/// Private to lcp/cholesky/.
#include <memory>

#include "lcp/cholesky/cholesky.hpp"

namespace perp::lcp {

/// Pre of all: A is square, compressed, not empty, finite, and has an entry; analyze() before factor() before the rest.
class CholeskyLibrary {
 public:
  CholeskyLibrary() = default;
  CholeskyLibrary(const CholeskyLibrary&) = delete;
  CholeskyLibrary& operator=(const CholeskyLibrary&) = delete;
  virtual ~CholeskyLibrary() = default;

  virtual void set_signs(std::vector<signed char> signs) = 0;
  virtual CholeskyStatus analyze(const SpMat& A) = 0;
  virtual double entries() const = 0;  ///< of L
  virtual double flops() const = 0;    ///< of factor()
  virtual CholeskyStatus factor(const SpMat& A) = 0;
  virtual double rcond() = 0;  ///< not a number, or 0, where a pivot has overflowed
  virtual void solve(In b, Out x) const = 0;
  virtual void solve_columns(Eigen::MatrixXd& X) const {
    for (Index j = 0; j < X.cols(); ++j) solve(Vec(X.col(j)), X.col(j));
  }
  virtual CholeskyColumns columns() const = 0;
  // If factor() answered NotPositiveDefinite.
  virtual Index failed_column() const = 0;
  virtual Vec witness(const SpMat& A) = 0;  ///< Cholesky::failed_direction()
};

std::unique_ptr<CholeskyLibrary> make_cholesky(CholeskyOrdering ordering);

}  // namespace perp::lcp

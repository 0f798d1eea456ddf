// SPDX-License-Identifier: Apache-2.0
#include <Eigen/OrderingMethods>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <new>

#include "lcp/lu/lu_backend.hpp"

namespace perp::lcp {
namespace {

/// Not int: the factors may have more than 2^31 entries. Not Eigen's Index either, see below.
using LuIndex = long long;

}  // namespace
}  // namespace perp::lcp

namespace Eigen::internal {

/// Eigen 3.4 resizes `vec` in place: where that fails it is left with freed memory, which the next attempt, or the
/// destructor, frees again. This specialization leaves it whole and throws std::bad_alloc. That no other part of a
/// program factors with this type of index keeps Eigen's own version out of the way.
template <>
template <typename VectorType>
Index SparseLUImpl<double, perp::lcp::LuIndex>::expand(VectorType& vec, Index& length, Index used, Index keep_length,
                                                       Index& expansions) {
  if (expansions == 0) vec.resize(0);  // of the factorization before
  const Index enough = expansions == 0 || keep_length ? length : std::max(length + 1, length + length / 2);
  VectorType longer(enough);
  longer.head(used) = vec.head(used);
  vec.swap(longer);
  length = enough;
  if (expansions > 0) ++expansions;
  return 0;
}

}  // namespace Eigen::internal

namespace perp::lcp {
namespace {

class EigenLu final : public LuLibrary {
 public:
  LuStatus analyze(const SpMat& A) override {
    auto lu = std::make_unique<Lu>();
    try {
      lu->analyzePattern(Matrix(A));
    } catch (const std::bad_alloc&) {
      (void)lu.release();  // may hold freed memory, as above: better lost than freed twice
      throw;
    }
    lu_ = std::move(lu);
    return LuStatus::Ok;
  }

  LuStatus factor(const SpMat& A) override {
    lu_->factorize(Matrix(A));
    if (lu_->info() != ::Eigen::Success) return LuStatus::Singular;
    return std::isfinite(lu_->logAbsDeterminant()) ? LuStatus::Ok : LuStatus::Singular;
  }

  void solve(const SpMat& /*A*/, In b, Out x, bool transposed) const override {
    if (transposed)
      x = lu_->transpose().solve(b);
    else
      x = lu_->solve(b);
  }

 private:
  using Matrix = ::Eigen::SparseMatrix<double, ::Eigen::ColMajor, LuIndex>;
  using Lu = ::Eigen::SparseLU<Matrix, ::Eigen::COLAMDOrdering<LuIndex>>;
  std::unique_ptr<Lu> lu_;
};

}  // namespace

std::unique_ptr<LuLibrary> make_eigen() { return std::make_unique<EigenLu>(); }

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <new>

#include "lcp/lu/eigen_sparse_lu.hpp"
#include "lcp/lu/lu_backend.hpp"

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

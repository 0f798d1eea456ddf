// SPDX-License-Identifier: Apache-2.0
#include <Eigen/OrderingMethods>
#include <Eigen/SparseLU>
#include <cmath>

#include "lcp/lu/lu_backend.hpp"

namespace perp::lcp {
namespace {

/// Not int: the factors may have more than 2^31 entries.
using LuIndex = ::Eigen::Index;
using Matrix = ::Eigen::SparseMatrix<double, ::Eigen::ColMajor, LuIndex>;

/// Eigen's, with a way to its factors.
class Lu : public ::Eigen::SparseLU<Matrix, ::Eigen::COLAMDOrdering<LuIndex>> {
 public:
  void extract(LuFactors& out) const {
    const Index n = rows();
    out.L = out.U = out.U_transposed = Triangle{};
    out.diagonal.resize(n);
    for (Index j = 0; j < n; ++j) {
      for (decltype(m_Ustore)::InnerIterator it(m_Ustore, j); it; ++it)
        if (it.value() != 0) out.U.push(static_cast<int>(it.index()), it.value());
      // A supernode has the part of U within its diagonal block, too.
      for (SCMatrix::InnerIterator it(m_Lstore, j); it; ++it) {
        const auto i = static_cast<int>(it.index());
        if (i == j)
          out.diagonal[j] = it.value();
        else if (it.value() != 0)
          (i < j ? out.U : out.L).push(i, it.value());
      }
      out.U.end_column();
      out.L.end_column();
    }
    out.L_transposed = out.L.transpose();
    out.P.resize(at(n));
    out.Q.resize(at(n));
    for (Index k = 0; k < n; ++k) {
      out.P[at(m_perm_r.indices()[k])] = static_cast<int>(k);
      out.Q[at(m_perm_c.indices()[k])] = static_cast<int>(k);
    }
    out.R = Vec::Ones(n);
    out.finish();
  }
};

class EigenLu final : public LuLibrary {
 public:
  LuStatus analyze(const SpMat& A) override {
    lu_ = std::make_unique<Lu>();
    lu_->analyzePattern(Matrix(A));
    return LuStatus::Ok;
  }

  LuStatus factor(const SpMat& A) override {
    lu_->factorize(Matrix(A));
    regular_ = lu_->info() == ::Eigen::Success && std::isfinite(lu_->logAbsDeterminant());
    return regular_ ? LuStatus::Ok : LuStatus::Singular;
  }

  void solve(const SpMat& /*A*/, In b, Out x, bool transposed) const override {
    if (transposed)
      x = lu_->transpose().solve(b);
    else
      x = lu_->solve(b);
  }

  bool factors(LuFactors& out) const override {
    if (regular_) lu_->extract(out);
    return regular_;
  }

 private:
  std::unique_ptr<Lu> lu_;
  bool regular_ = false;  // the last factor() was Ok
};

}  // namespace

std::unique_ptr<LuLibrary> make_eigen() { return std::make_unique<EigenLu>(); }

}  // namespace perp::lcp

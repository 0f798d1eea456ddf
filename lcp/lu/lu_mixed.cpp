// SPDX-License-Identifier: Apache-2.0
/// The general library of a build without UMFPACK (PERP_GPL=OFF): KLU's analysis, and its factorization where that is
/// short; else Eigen's, whose dense blocks make up for what it moves, with KLU's order of rows and columns.
#include <algorithm>
#include <cmath>
#include <new>
#include <utility>
#include <vector>

#include "lcp/gpl.hpp"
#include "lcp/lu/eigen_sparse_lu.hpp"
#include "lcp/lu/lu_klu.hpp"
#include "lcp/lu/past_zeros.hpp"

namespace perp::lcp {
namespace {

/// Operations for each entry of the factors beyond which dense blocks pay: five-point grids of 150 x 150, 27-point ones
/// of 8^3.
constexpr double supernodal_flops = 130;
/// As KLU's: the diagonal is kept where it is at least this part of its column's largest.
constexpr double pivot_threshold = 0.1;

class Supernodal {
 public:
  void analyze(const SpMat& A, const int* rows, const int* columns) {
    const Index n = A.rows();
    rows_.assign(rows, rows + n);
    columns_.assign(columns, columns + n);
    std::vector<LuIndex> place(at(n));
    for (Index k = 0; k < n; ++k) place[at(rows_[at(k)])] = k;
    Matrix B(n, n);
    B.reserve(A.nonZeros());
    from_.clear();
    std::vector<std::pair<LuIndex, Index>> column;
    for (Index k = 0; k < n; ++k) {
      column.clear();
      const Index j = columns_[at(k)];
      for (Index e = A.outerIndexPtr()[j]; e < A.outerIndexPtr()[j + 1]; ++e)
        column.emplace_back(place[at(A.innerIndexPtr()[e])], e);
      std::ranges::sort(column);
      B.startVec(k);
      for (const auto& [row, e] : column) {
        B.insertBackByOuterInner(k, static_cast<Index>(row)) = 1;
        from_.push_back(e);
      }
    }
    B.finalize();
    B_ = std::move(B);
    auto lu = std::make_unique<Lu>();
    lu->setPivotThreshold(pivot_threshold);
    try {
      lu->analyzePattern(B_);
    } catch (const std::bad_alloc&) {
      (void)lu.release();  // may hold freed memory (eigen_sparse_lu.hpp): better lost than freed twice
      throw;
    }
    lu_ = std::move(lu);
  }

  LuStatus factor(const SpMat& A) {
    scale_ = row_scale(A).cwiseInverse();
    if (!scale_.allFinite()) return LuStatus::Singular;
    const double* values = A.valuePtr();
    const int* row = A.innerIndexPtr();
    for (std::size_t e = 0; e < from_.size(); ++e) B_.valuePtr()[e] = values[from_[e]] * scale_[row[from_[e]]];
    lu_->factorize(B_);
    if (lu_->info() != ::Eigen::Success) return LuStatus::Singular;
    return std::isfinite(lu_->logAbsDeterminant()) ? LuStatus::Ok : LuStatus::Singular;
  }

  void solve(In b, Out x, bool transposed) const {
    const Index n = b.size();
    Vec y(n);
    if (transposed) {
      for (Index k = 0; k < n; ++k) y[k] = b[columns_[at(k)]];
      const Vec z = lu_->transpose().solve(y);
      for (Index k = 0; k < n; ++k) x[rows_[at(k)]] = scale_[rows_[at(k)]] * z[k];
      return;
    }
    for (Index k = 0; k < n; ++k) y[k] = scale_[rows_[at(k)]] * b[rows_[at(k)]];
    const Vec z = lu_->solve(y);
    for (Index k = 0; k < n; ++k) x[columns_[at(k)]] = z[k];
  }

  void extract(LuFactors& out) const {
    lu_->extract(out);
    for (int& i : out.P) i = rows_[at(i)];
    for (int& j : out.Q) j = columns_[at(j)];
    out.R = scale_;
    out.finish();
  }

 private:
  using Matrix = ::Eigen::SparseMatrix<double, ::Eigen::ColMajor, LuIndex>;
  /// With a way to its factors.
  class Lu : public ::Eigen::SparseLU<Matrix, ::Eigen::NaturalOrdering<LuIndex>> {
   public:
    /// All but the scale and the inverse permutations.
    void extract(LuFactors& out) const {
      const Index n = rows();
      out.L = Triangle{};
      out.U = Triangle{};
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
      out.U_transposed = Triangle{};
      out.P.resize(at(n));
      out.Q.resize(at(n));
      for (Index k = 0; k < n; ++k) {
        out.P[at(m_perm_r.indices()[k])] = static_cast<int>(k);
        out.Q[at(m_perm_c.indices()[k])] = static_cast<int>(k);
      }
    }
  };

  std::vector<int> rows_, columns_;
  std::vector<Index> from_;  // the entries of B_ in A's
  Matrix B_;
  Vec scale_;
  std::unique_ptr<Lu> lu_;
};

class Mixed final : public LuLibrary {
 public:
  LuStatus analyze(const SpMat& A) override {
    supernodal_.reset();
    const LuStatus status = klu_.analyze(A);
    if (status != LuStatus::Ok) return status;
    estimate_ = flops_of_entry(klu_.cost());
    if (estimate_ * excess_ > supernodal_flops) make_supernodal(A);
    return LuStatus::Ok;
  }

  KernelCost cost() const override { return klu_.cost(); }

  LuStatus factor(const SpMat& A) override {
    status_ = LuStatus::OutOfMemory;  // if it throws
    if (!supernodal_ && estimate_ * excess_ > supernodal_flops) make_supernodal(A);
    status_ = supernodal_ ? supernodal_->factor(A) : klu_.factor(A);
    if (!supernodal_ && status_ == LuStatus::Ok && estimate_ > 0)
      excess_ = std::max(1.0, flops_of_entry(klu_.spent()) / estimate_);
    if (status_ == LuStatus::Singular) A_ = A;
    return status_;
  }

  void solve(const SpMat& A, In b, Out x, bool transposed) const override {
    if (supernodal_)
      supernodal_->solve(b, x, transposed);
    else
      klu_.solve(A, b, x, transposed);
  }

  bool factors(LuFactors& out) const override {
    if (status_ == LuStatus::Singular)
      PastZeros(A_, klu_.columns_in_order()).extract(out);
    else if (status_ != LuStatus::Ok)
      return false;
    else if (supernodal_)
      supernodal_->extract(out);
    else
      klu_.extract(out);
    return true;
  }

 private:
  static double flops_of_entry(const KernelCost& cost) {
    constexpr double bytes_of_entry = sizeof(double) + sizeof(int);
    return cost.bytes > 0 ? cost.flops * 2 * bytes_of_entry / cost.bytes : 0;
  }
  void make_supernodal(const SpMat& A) {
    auto supernodal = std::make_unique<Supernodal>();
    supernodal->analyze(A, klu_.rows_in_order(), klu_.columns_in_order().data());
    supernodal_ = std::move(supernodal);
  }

  Klu klu_;
  double estimate_ = 0;  // operations for each entry of the factors
  // What KLU's last factorization came to beside its estimate, which is of pivots on the diagonal: other matrices here
  // are like the last one.
  double excess_ = 1;
  std::unique_ptr<Supernodal> supernodal_;
  LuStatus status_ = LuStatus::OutOfMemory;  // of the last factor()
  SpMat A_;                                  // if that was Singular
};

}  // namespace

std::unique_ptr<LuLibrary> make_general() { return std::make_unique<Mixed>(); }
std::string_view general_lu() { return "mixed"; }
bool gpl_linked() { return false; }

}  // namespace perp::lcp

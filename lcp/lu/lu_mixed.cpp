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

namespace perp::lcp {
namespace {

/// Operations for each entry of the factors beyond which dense blocks pay: five-point grids of 150 x 150, 27-point ones
/// of 8^3.
constexpr double supernodal_flops = 130;
/// As KLU's: the diagonal is kept where it is at least this part of its column's largest.
constexpr double pivot_threshold = 0.1;
/// Eliminating past zeros: what is left of a column is rounding below this part of what it was.
constexpr double rounding = 1e-14;

Vec row_scale(const SpMat& A) {
  Vec largest = Vec::Zero(A.rows());
  for (Index j = 0; j < A.cols(); ++j)
    for (SpMat::InnerIterator it(A, j); it; ++it) largest[it.row()] = std::max(largest[it.row()], std::abs(it.value()));
  return largest;
}

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

/// Gilbert & Peierls' factorization with the largest pivot of each column, which goes on past columns without one: they
/// come last, with the rows that are left. Neither library shows its factors of a singular matrix.
class PastZeros {
 public:
  PastZeros(const SpMat& A, const int* columns) : A_(A), scale_(row_scale(A)) {
    const Index n = A.rows();
    for (double& s : scale_) s = s > 0 ? 1 / s : 1;
    step_of_row_.assign(at(n), -1);
    seen_.assign(at(n), -1);
    x_ = Vec::Zero(n);
    for (Index k = 0; k < n; ++k) eliminate(columns[k], static_cast<int>(k));
  }

  void extract(LuFactors& out) {
    const auto n = static_cast<std::size_t>(A_.rows());
    for (std::size_t i = 0; i < n; ++i) {  // the rows that are left
      if (step_of_row_[i] >= 0) continue;
      step_of_row_[i] = static_cast<int>(pivot_row_.size());
      pivot_row_.push_back(static_cast<int>(i));
    }
    for (int& i : L_.row) i = step_of_row_[static_cast<std::size_t>(i)];
    const std::size_t regular = order_.size();
    for (std::size_t k = 0; k < dependent_.size(); ++k) L_.end_column();
    order_.insert(order_.end(), dependent_.begin(), dependent_.end());
    for (std::size_t j = 0; j < dependent_.size(); ++j) {
      for (int k = U_dependent_.start[j]; k < U_dependent_.start[j + 1]; ++k)
        U_.push(U_dependent_.row[static_cast<std::size_t>(k)], U_dependent_.value[static_cast<std::size_t>(k)]);
      U_.end_column();
    }
    out.diagonal = Vec::Zero(A_.rows());
    std::copy_n(pivot_.begin(), regular, out.diagonal.begin());
    out.L = std::move(L_);
    out.U = std::move(U_);
    out.L_transposed = out.L.transpose();
    out.U_transposed = Triangle{};
    out.P = pivot_row_;
    out.Q = order_;
    out.R = scale_;
    out.finish();
  }

 private:
  void eliminate(int column, int mark) {
    reached_.clear();
    double size = 0;
    for (SpMat::InnerIterator it(A_, column); it; ++it) {
      x_[it.row()] = it.value() * scale_[it.row()];
      size = std::max(size, std::abs(x_[it.row()]));
      reach(static_cast<int>(it.row()), mark);
    }
    std::vector<std::pair<int, double>> upper;
    for (auto i = reached_.rbegin(); i != reached_.rend(); ++i) {
      const int step = step_of_row_[at(*i)];
      const double value = x_[*i];
      if (step < 0 || value == 0) continue;
      upper.emplace_back(step, value);
      size = std::max(size, std::abs(value));
      for (int k = L_.start[at(step)]; k < L_.start[at(step) + 1]; ++k) x_[L_.row[at(k)]] -= L_.value[at(k)] * value;
    }
    int best = -1;
    for (const int i : reached_)
      if (step_of_row_[at(i)] < 0 && std::abs(x_[i]) > rounding * size &&
          (best < 0 || std::abs(x_[i]) > std::abs(x_[best])))
        best = i;
    Triangle& U = best < 0 ? U_dependent_ : U_;
    for (const auto& [step, value] : upper) U.push(step, value);
    U.end_column();
    if (best < 0) {
      dependent_.push_back(column);
    } else {
      const double pivot = x_[best];
      step_of_row_[at(best)] = static_cast<int>(order_.size());
      pivot_row_.push_back(best);
      pivot_.push_back(pivot);
      order_.push_back(column);
      for (const int i : reached_)
        if (step_of_row_[at(i)] < 0 && x_[i] != 0) L_.push(i, x_[i] / pivot);
      L_.end_column();
    }
    for (const int i : reached_) x_[i] = 0;
  }

  /// Appends what `root` leads to through L, each row after those it leads to.
  void reach(int root, int mark) {
    if (seen_[at(root)] == mark) return;
    const auto begin_of = [this](int i) {
      const int step = step_of_row_[at(i)];
      return step < 0 ? 0 : L_.start[at(step)];
    };
    const auto end_of = [this](int i) {
      const int step = step_of_row_[at(i)];
      return step < 0 ? 0 : L_.start[at(step) + 1];
    };
    seen_[at(root)] = mark;
    stack_.assign(1, {root, begin_of(root)});
    while (!stack_.empty()) {
      const int i = stack_.back().first;
      if (stack_.back().second == end_of(i)) {
        reached_.push_back(i);
        stack_.pop_back();
        continue;
      }
      const int next = L_.row[at(stack_.back().second++)];
      if (std::exchange(seen_[at(next)], mark) != mark) stack_.emplace_back(next, begin_of(next));
    }
  }

  const SpMat& A_;
  Vec scale_;
  Triangle L_;  // its rows are A's until the end
  Triangle U_, U_dependent_;
  std::vector<double> pivot_;
  std::vector<int> step_of_row_, pivot_row_, order_, dependent_;
  Vec x_;
  std::vector<int> seen_, reached_;
  std::vector<std::pair<int, int>> stack_;
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
    supernodal->analyze(A, klu_.rows_in_order(), klu_.columns_in_order());
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

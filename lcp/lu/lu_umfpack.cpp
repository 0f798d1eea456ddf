// SPDX-License-Identifier: Apache-2.0
#include <umfpack.h>

#include <array>
#include <cmath>
#include <functional>
#include <new>
#include <utility>

#include "lcp/cholesky/metis_lock.hpp"
#include "lcp/gpl.hpp"
#include "lcp/lu/lu_backend.hpp"

namespace perp::lcp {
namespace {

struct FreeSymbolic {
  void operator()(void* s) const { umfpack_di_free_symbolic(&s); }
};
struct FreeNumeric {
  void operator()(void* s) const { umfpack_di_free_numeric(&s); }
};

LuStatus status_of(int code) {
  switch (code) {
    case UMFPACK_OK:
      return LuStatus::Ok;
    case UMFPACK_ERROR_out_of_memory:
    case UMFPACK_ERROR_ordering_failed:  // AMD and COLAMD fail for lack of memory or of 32-bit indices only
      throw std::bad_alloc();
    default:
      return LuStatus::Singular;
  }
}

/// Nested dissection (METIS) is tried beside minimum degree (AMD) where the pattern is nearly symmetric, rows have more
/// entries than so many, and AMD leaves more operations than so many (UMFPACK's estimate, some 30 times what it comes
/// to): piles and meshes in three dimensions then take half of the operations or less. On five-point grids
/// dissection costs more time than it saves.
constexpr Index dissection_entries = 12;
constexpr double dissection_flops = 2e10;

/// Pivots on the diagonal (UMFPACK's symmetric strategy) are for patterns with so much symmetry and so many entries on
/// the diagonal, of the rows that are no singletons: UMFPACK 6's rule. UMFPACK 5 asks for a symmetry of 0.5, and takes
/// a fourth more operations for the systems of interior points on general equilibria.
constexpr double least_symmetry = 0.3;
constexpr double least_diagonal = 0.9;

class Umfpack final : public LuLibrary {
 public:
  Umfpack() {
    umfpack_di_defaults(control_.data());
    control_[UMFPACK_IRSTEP] = 0;  // refinement is the caller's: SparseLu::solve_refined
  }

  LuStatus analyze(const SpMat& A) override {
    control_[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_AUTO;
    const LuStatus status = analyze_by(UMFPACK_ORDERING_AMD, A);
    if (status != LuStatus::Ok) return status;
    if (nearly_symmetric(A.rows())) {
      control_[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
      // The two bounds on operations are not of the same kind: what is nearly symmetric decides.
      try_analysis(UMFPACK_ORDERING_AMD, A, [](double, double) { return true; });
    }
    if (analysis_[UMFPACK_STRATEGY_USED] == UMFPACK_STRATEGY_SYMMETRIC &&
        A.nonZeros() > dissection_entries * A.rows() && analysis_[UMFPACK_FLOPS_ESTIMATE] > dissection_flops)
      try_analysis(UMFPACK_ORDERING_METIS, A, std::less<>());
    return LuStatus::Ok;
  }

  /// Of pivots on the diagonal where the strategy is symmetric; the bounds for the other are far above what it comes
  /// to.
  FactorCost cost() const override {
    constexpr double above = 10;
    constexpr double bytes_of_entry = sizeof(double) + sizeof(int);
    if (analysis_[UMFPACK_STRATEGY_USED] == UMFPACK_STRATEGY_SYMMETRIC && analysis_[UMFPACK_SYMMETRIC_FLOPS] > 0)
      return {.flops = analysis_[UMFPACK_SYMMETRIC_FLOPS], .bytes = bytes_of_entry * analysis_[UMFPACK_SYMMETRIC_LUNZ]};
    return {.flops = analysis_[UMFPACK_FLOPS_ESTIMATE] / above,
            .bytes = analysis_[UMFPACK_NUMERIC_SIZE_ESTIMATE] * analysis_[UMFPACK_SIZE_OF_UNIT] / above};
  }

  LuStatus factor(const SpMat& A) override {
    numeric_.reset();  // its memory serves the next factors
    void* numeric = nullptr;
    const int code = umfpack_di_numeric(A.outerIndexPtr(), A.innerIndexPtr(), A.valuePtr(), symbolic_.get(), &numeric,
                                        control_.data(), info_.data());
    numeric_.reset(numeric);
    if (code == UMFPACK_OK && !(info_[UMFPACK_RCOND] > 0)) return LuStatus::Singular;  // a pivot overflowed
    return status_of(code);
  }

  void solve(const SpMat& A, In b, Out x, bool transposed) const override {
    std::array<double, UMFPACK_INFO> info{};  // not the member: solves may run in two threads
    // umfpack_di_solve would allocate these, and leave x as it is where it cannot. Sizes: without refinement.
    ::Eigen::VectorXi integers(A.rows());
    Vec numbers(A.rows());
    umfpack_di_wsolve(transposed ? UMFPACK_At : UMFPACK_A, A.outerIndexPtr(), A.innerIndexPtr(), A.valuePtr(), x.data(),
                      b.data(), numeric_.get(), control_.data(), info.data(), integers.data(), numbers.data());
  }

  double pivot_ratio() const override { return info_[UMFPACK_RCOND]; }

  bool factors(LuFactors& out) const override {
    if (!numeric_) return false;
    int l_entries = 0;
    int u_entries = 0;
    int rows = 0;
    int columns = 0;
    int u_diagonal = 0;
    if (umfpack_di_get_lunz(&l_entries, &u_entries, &rows, &columns, &u_diagonal, numeric_.get()) != UMFPACK_OK)
      return false;
    const auto n = static_cast<std::size_t>(rows);
    Triangle l_rows{.start = std::vector<int>(n + 1),  // UMFPACK gives L by rows
                    .row = std::vector<int>(static_cast<std::size_t>(l_entries)),
                    .value = std::vector<double>(static_cast<std::size_t>(l_entries))};
    Triangle u_columns{.start = std::vector<int>(n + 1),
                       .row = std::vector<int>(static_cast<std::size_t>(u_entries)),
                       .value = std::vector<double>(static_cast<std::size_t>(u_entries))};
    out.P.resize(n);
    out.Q.resize(n);
    out.R.resize(rows);
    out.diagonal.resize(rows);
    int reciprocal = 0;
    const int code =
        umfpack_di_get_numeric(l_rows.start.data(), l_rows.row.data(), l_rows.value.data(), u_columns.start.data(),
                               u_columns.row.data(), u_columns.value.data(), out.P.data(), out.Q.data(),
                               out.diagonal.data(), &reciprocal, out.R.data(), numeric_.get());
    if (code == UMFPACK_ERROR_out_of_memory) throw std::bad_alloc();
    if (code != UMFPACK_OK) return false;
    if (reciprocal == 0) out.R = out.R.cwiseInverse();
    out.L_transposed = without_diagonal(l_rows);
    out.L = out.L_transposed.transpose();
    out.U = without_diagonal(u_columns);
    out.finish();
    return true;
  }

 private:
  /// What the analysis found, where it chose pivots off the diagonal.
  bool nearly_symmetric(Index n) const {
    const double rest = static_cast<double>(n) - analysis_[UMFPACK_COL_SINGLETONS] - analysis_[UMFPACK_ROW_SINGLETONS];
    return analysis_[UMFPACK_STRATEGY_USED] != UMFPACK_STRATEGY_SYMMETRIC && rest > 0 &&
           analysis_[UMFPACK_PATTERN_SYMMETRY] >= least_symmetry && analysis_[UMFPACK_NZDIAG] >= least_diagonal * rest;
  }

  /// Another analysis in place of the last one, if it succeeds and is better by its estimate of operations.
  template <class Better>
  void try_analysis(int ordering, const SpMat& A, Better better) {
    const std::array<double, UMFPACK_INFO> analysis = analysis_;
    std::unique_ptr<void, FreeSymbolic> symbolic = std::move(symbolic_);
    if (analyze_by(ordering, A) == LuStatus::Ok &&
        better(analysis_[UMFPACK_FLOPS_ESTIMATE], analysis[UMFPACK_FLOPS_ESTIMATE]))
      return;
    symbolic_ = std::move(symbolic);
    analysis_ = analysis;
  }

  LuStatus analyze_by(int ordering, const SpMat& A) {
    void* symbolic = nullptr;
    const int n = static_cast<int>(A.rows());
    control_[UMFPACK_ORDERING] = ordering;
    std::unique_lock alone(metis_lock(), std::defer_lock);
    if (ordering == UMFPACK_ORDERING_METIS) alone.lock();
    const int code = umfpack_di_symbolic(n, n, A.outerIndexPtr(), A.innerIndexPtr(), A.valuePtr(), &symbolic,
                                         control_.data(), info_.data());
    symbolic_.reset(symbolic);
    analysis_ = info_;
    return status_of(code);
  }

  static Triangle without_diagonal(const Triangle& T) {
    Triangle result;
    result.start.reserve(T.start.size());
    result.row.reserve(T.row.size());
    result.value.reserve(T.value.size());
    for (std::size_t j = 0; j + 1 < T.start.size(); ++j) {
      for (auto k = static_cast<std::size_t>(T.start[j]); k < static_cast<std::size_t>(T.start[j + 1]); ++k)
        if (T.row[k] != static_cast<int>(j)) {
          result.row.push_back(T.row[k]);
          result.value.push_back(T.value[k]);
        }
      result.start.push_back(static_cast<int>(result.row.size()));
    }
    return result;
  }

  std::array<double, UMFPACK_CONTROL> control_{};
  std::array<double, UMFPACK_INFO> info_{};
  std::array<double, UMFPACK_INFO> analysis_{};  // as the analysis left it
  std::unique_ptr<void, FreeSymbolic> symbolic_;
  std::unique_ptr<void, FreeNumeric> numeric_;
};

}  // namespace

std::unique_ptr<LuLibrary> make_general() { return std::make_unique<Umfpack>(); }
std::string_view general_lu() { return "umfpack"; }
bool gpl_linked() { return true; }

}  // namespace perp::lcp

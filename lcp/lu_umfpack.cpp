#include <umfpack.h>

#include <array>
#include <cmath>

#include "lcp/lu_backend.hpp"

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
      return LuStatus::OutOfMemory;
    default:
      return LuStatus::Singular;
  }
}

class Umfpack final : public LuLibrary {
 public:
  Umfpack() {
    umfpack_di_defaults(control_.data());
    control_[UMFPACK_IRSTEP] = 0;  // refinement is the caller's: SparseLu::solve_refined
  }

  LuStatus analyze(const SpMat& A) override {
    void* symbolic = nullptr;
    const int n = static_cast<int>(A.rows());
    const int code = umfpack_di_symbolic(n, n, A.outerIndexPtr(), A.innerIndexPtr(), A.valuePtr(), &symbolic,
                                         control_.data(), info_.data());
    symbolic_.reset(symbolic);
    return status_of(code);
  }

  LuStatus factor(const SpMat& A) override {
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

 private:
  std::array<double, UMFPACK_CONTROL> control_{};
  std::array<double, UMFPACK_INFO> info_{};
  std::unique_ptr<void, FreeSymbolic> symbolic_;
  std::unique_ptr<void, FreeNumeric> numeric_;
};

}  // namespace

std::unique_ptr<LuLibrary> make_umfpack() { return std::make_unique<Umfpack>(); }

}  // namespace perp::lcp

#include <Eigen/OrderingMethods>
#include <Eigen/SparseLU>
#include <cmath>
#include <new>

#include "lcp/lu_backend.hpp"

namespace perp::lcp {
namespace {

class EigenLu final : public LuLibrary {
 public:
  LuStatus analyze(const SpMat& A) override {
    try {
      lu_.analyzePattern(A);
    } catch (const std::bad_alloc&) {
      return LuStatus::OutOfMemory;
    }
    return LuStatus::Ok;
  }

  LuStatus factor(const SpMat& A) override {
    try {
      lu_.factorize(A);
    } catch (const std::bad_alloc&) {
      return LuStatus::OutOfMemory;
    }
    if (lu_.info() != ::Eigen::Success) return LuStatus::Singular;
    return std::isfinite(lu_.logAbsDeterminant()) ? LuStatus::Ok : LuStatus::Singular;
  }

  void solve(const SpMat& /*A*/, In b, Out x, bool transposed) const override {
    if (transposed)
      x = const_cast<Lu&>(lu_).transpose().solve(b);  // Eigen 3.4 forgot the const; nothing is changed
    else
      x = lu_.solve(b);
  }

 private:
  using Lu = ::Eigen::SparseLU<SpMat, ::Eigen::COLAMDOrdering<int>>;
  Lu lu_;
};

}  // namespace

std::unique_ptr<LuLibrary> make_eigen() { return std::make_unique<EigenLu>(); }

}  // namespace perp::lcp

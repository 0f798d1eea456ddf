// SPDX-License-Identifier: Apache-2.0
/// The general library of a build without UMFPACK (PERP_GPL=OFF): KLU where that is short; else Eigen's, whose dense
/// blocks make up for what it moves (27-point grids of 18^3: 0.22 s, KLU 0.77 s).
#include <algorithm>
#include <utility>

#include "lcp/gpl.hpp"
#include "lcp/lu/lu_klu.hpp"
#include "lcp/lu/past_zeros.hpp"

namespace perp::lcp {
namespace {

/// Operations for each entry of the factors beyond which dense blocks pay: five-point grids of 150 x 150, 27-point ones
/// of 8^3.
constexpr double supernodal_flops = 130;

class Mixed final : public LuLibrary {
 public:
  LuStatus analyze(const SpMat& A) override {
    eigen_.reset();
    const LuStatus status = klu_.analyze(A);
    if (status == LuStatus::Ok) estimate_ = flops_of_entry(klu_.cost());
    return status;
  }

  FactorCost cost() const override { return klu_.cost(); }

  LuStatus factor(const SpMat& A) override {
    if (!eigen_ && estimate_ * excess_ > supernodal_flops) {
      auto eigen = make_eigen();
      (void)eigen->analyze(A);
      eigen_ = std::move(eigen);
    }
    status_ = eigen_ ? eigen_->factor(A) : klu_.factor(A);
    if (!eigen_ && status_ == LuStatus::Ok && estimate_ > 0)
      excess_ = std::max(1.0, flops_of_entry(klu_.spent()) / estimate_);
    if (status_ == LuStatus::Singular) A_ = A;
    return status_;
  }

  void solve(const SpMat& A, In b, Out x, bool transposed) const override {
    if (eigen_)
      eigen_->solve(A, b, x, transposed);
    else
      klu_.solve(A, b, x, transposed);
  }

  bool factors(LuFactors& out) const override {
    if (status_ == LuStatus::Singular)
      PastZeros(A_, klu_.columns_in_order()).extract(out);
    else if (status_ != LuStatus::Ok)
      return false;
    else if (eigen_)
      return eigen_->factors(out);
    else
      klu_.extract(out);
    return true;
  }

 private:
  static double flops_of_entry(const FactorCost& cost) {
    constexpr double bytes_of_entry = sizeof(double) + sizeof(int);
    return cost.bytes > 0 ? cost.flops * 2 * bytes_of_entry / cost.bytes : 0;
  }

  Klu klu_;
  double estimate_ = 0;  // operations for each entry of the factors
  // What KLU's last factorization came to beside its estimate, which is of pivots on the diagonal: other matrices here
  // are like the last one.
  double excess_ = 1;
  std::unique_ptr<LuLibrary> eigen_;
  LuStatus status_ = LuStatus::NotFinite;  // of the last factor()
  SpMat A_;                                // if that was Singular
};

}  // namespace

std::unique_ptr<LuLibrary> make_general() { return std::make_unique<Mixed>(); }
std::string_view general_lu() { return "mixed"; }
bool gpl_linked() { return false; }

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A problem of the caller's functions, and what goes wrong in them.
#include <atomic>
#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "capi/matrix.hpp"
#include "capi/perp.h"
#include "ncp/problem/differences.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::capi {

class CallbackMcp final : public ncp::Mcp {
 public:
  /// J null: by differences of F.
  CallbackMcp(lcp::Box box, Matrix pattern, perp_F F, perp_J J, void* user);

  const lcp::Box& box() const override { return box_; }
  const SpMat& jacobian_pattern() const override { return pattern_.entries; }
  bool eval(ncp::In x, ncp::Out F) const override;
  bool jacobian(ncp::In x, SpMat& J) const override;
  bool is_affine() const override { return affine_; }
  std::vector<bool> linear_entries() const override { return linear_; }
  ncp::JacobianWork jacobian_work() const override;

  /// In the order of the pattern as the caller gave it; null: none. Refused without J: differences are not exact.
  void set_linear(const std::int8_t* linear);

  /// From now on *stop is set where a callback asks to stop or fails, and no callback is called once it is set.
  void begin(std::atomic<bool>* stop) const;
  /// Who asked to stop, and when: "F, in its evaluation 3"; empty: nobody.
  const std::string& stopped() const { return stopped_; }
  /// What a callback did wrong; empty: nothing.
  const std::string& failure() const { return failure_; }
  /// Calls since begin().
  int F_calls() const { return F_evals_; }
  int J_calls() const { return J_evals_; }

 private:
  template <class Call>
  bool called(const char* name, int evaluation, std::vector<double>& values, Call call) const;
  bool call_F(ncp::In x, double* F) const;
  bool ended() const { return !stopped_.empty() || !failure_.empty() || (stop_ != nullptr && *stop_); }
  void end(std::string& why, const std::string& text) const;
  std::string place(const char* name, Index k) const;
  /// Ends where F at x, or the J that has just been evaluated, is not what the promise of an affine F makes it.
  void check_promise_of_F(ncp::In x, ncp::In F) const;
  void check_promise_of_J() const;
  /// Copies the values that J's callback has left.
  void put_values(SpMat& J) const;
  /// Checks the promise at another point, once: a method may need F at one only.
  void probe() const;

  lcp::Box box_;
  Matrix pattern_;
  perp_F F_;
  perp_J J_;
  void* user_;
  std::vector<bool> linear_{};
  bool affine_ = false;
  // The first F and J of an affine problem: they make all others.
  mutable Vec first_x_{}, first_F_{};
  mutable SpMat first_J_{};
  mutable bool knows_J_ = false, probed_ = false;

  mutable std::optional<ncp::ColouredDifferences> differences_{};  // where there is no J
  // What the callbacks see: at the same places in every call.
  mutable Vec x_{};
  mutable std::vector<double> values_F_{};
  mutable std::vector<double> values_J_{};
  // Of the solve that runs.
  mutable std::atomic<bool>* stop_ = nullptr;
  mutable int F_evals_ = 0;
  mutable int J_evals_ = 0;
  mutable std::string stopped_{};
  mutable std::string failure_{};
};

/// Watches the callbacks of a problem (null: it has none) while an object of this lives.
class Watch {
 public:
  Watch(const CallbackMcp* callbacks, std::atomic<bool>* stop) : callbacks_(callbacks) {
    if (callbacks_ != nullptr) callbacks_->begin(stop);
  }
  ~Watch() {
    if (callbacks_ != nullptr) callbacks_->begin(nullptr);
  }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;
  /// Throws PERP_BAD_CALLBACK if one failed.
  void check() const;
  /// Returns what `work` returns, or throws what it throws; PERP_BAD_CALLBACK if a callback failed, which may be why.
  template <class Work>
  auto over(Work work) const {
    try {
      auto made = work();
      check();
      return made;
    } catch (const std::exception&) {
      check();
      throw;
    }
  }
  std::string stopped() const { return callbacks_ == nullptr ? "" : callbacks_->stopped(); }

 private:
  const CallbackMcp* callbacks_;
};

}  // namespace perp::capi

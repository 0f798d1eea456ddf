// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Problems of Python's functions.
#include <atomic>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "extension/jacobian.hpp"
#include "ncp/problem/differences.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::python {

/// Of F and jac; of F alone, with differences. Called without the GIL, which it takes for Python's functions only. The
/// first exception of a function ends the solve: from then on no function is called, and every evaluation is undefined.
class FunctionMcp final : public ncp::Mcp {
 public:
  struct Parts {
    py::object F;
    py::object jac;      ///< None: differences
    py::object pattern;  ///< None: that of jac at the start; all, without jac
    std::string name = "mcp";
    std::vector<std::string> variable_names{};
    std::vector<std::string> equation_names{};
  };
  FunctionMcp(Parts parts, lcp::Box box, const Vec& start);
  ~FunctionMcp() override;
  FunctionMcp(const FunctionMcp&) = delete;
  FunctionMcp& operator=(const FunctionMcp&) = delete;

  const lcp::Box& box() const override { return box_; }
  const SpMat& jacobian_pattern() const override { return pattern_; }
  bool eval(ncp::In x, ncp::Out F) const override;
  bool jacobian(ncp::In x, SpMat& J) const override;
  ncp::JacobianWork jacobian_work() const override;
  std::string name() const override { return parts_.name; }
  std::string variable_name(Index i) const override;
  std::string equation_name(Index i) const override;

  /// From now on an exception sets *stop.
  void begin(std::atomic<bool>* stop);
  /// The solve is over; the counts stay.
  void end();
  /// Of a function; null: none.
  std::exception_ptr failure() const { return failure_; }
  long F_calls() const { return F_calls_; }
  long J_calls() const { return J_calls_; }
  Index groups() const { return differences_ ? differences_->colours() : 0; }

 private:
  template <class Call>
  bool guarded(Call call) const;
  void call_F(ncp::In x, double* F) const;
  void call_jac(ncp::In x, double* value) const;

  Parts parts_;
  lcp::Box box_;
  SpMat pattern_;
  mutable std::optional<JacobianReader> reader_{};
  mutable std::optional<ncp::ColouredDifferences> differences_{};
  // jac at the start, which told the pattern, so that it is not called there twice.
  mutable Vec first_x_{};
  mutable py::object first_J_{};

  mutable std::atomic<bool>* stop_ = nullptr;
  mutable std::exception_ptr failure_{};
  mutable long F_calls_ = 0;
  mutable long J_calls_ = 0;
};

}  // namespace perp::python

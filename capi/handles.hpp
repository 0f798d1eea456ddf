// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the opaque handles of perp.h are.
#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capi/callback_mcp.hpp"
#include "capi/perp.h"
#include "contact/model/problem.hpp"
#include "contact/solvers/run.hpp"
#include "ncp/ampl/model.hpp"
#include "ncp/analysis/verify.hpp"
#include "ncp/run/result.hpp"
#include "ncp/settings/settings.hpp"

namespace perp::capi {

/// A problem under the names that the caller gave.
class NamedMcp final : public ncp::Mcp {
 public:
  explicit NamedMcp(std::unique_ptr<ncp::Mcp> mcp) : mcp_(std::move(mcp)) {}
  const lcp::Box& box() const override { return mcp_->box(); }
  const SpMat& jacobian_pattern() const override { return mcp_->jacobian_pattern(); }
  bool eval(ncp::In x, ncp::Out F) const override { return mcp_->eval(x, F); }
  bool jacobian(ncp::In x, SpMat& J) const override { return mcp_->jacobian(x, J); }
  bool is_affine() const override { return mcp_->is_affine(); }
  std::vector<bool> linear_entries() const override { return mcp_->linear_entries(); }
  const ncp::Enclosure* enclosure() const override { return mcp_->enclosure(); }
  std::string name() const override { return name_.empty() ? mcp_->name() : name_; }
  std::string variable_name(Index i) const override {
    return variables_.empty() ? mcp_->variable_name(i) : variables_[lcp::at(i)];
  }
  std::string equation_name(Index i) const override {
    return equations_.empty() ? mcp_->equation_name(i) : equations_[lcp::at(i)];
  }

  void set_name(const char* name) { name_ = name; }
  void set_names(std::vector<std::string> variables, std::vector<std::string> equations) {
    variables_ = std::move(variables);
    equations_ = std::move(equations);
  }
  ncp::Mcp& inner() const { return *mcp_; }

 private:
  std::unique_ptr<ncp::Mcp> mcp_;
  std::string name_{};
  std::vector<std::string> variables_{};
  std::vector<std::string> equations_{};
};

}  // namespace perp::capi

struct perp_problem {
  explicit perp_problem(std::unique_ptr<perp::ncp::Mcp> problem) : mcp(std::move(problem)) {}

  perp::capi::NamedMcp mcp;
  /// Of a problem of functions, else null.
  perp::capi::CallbackMcp* callbacks = nullptr;
  /// Of a problem from a file, else null.
  const perp::ncp::ampl::Model* model = nullptr;
};

struct perp_solver {
  std::vector<perp::settings::Assignment> given{};
  perp::settings::Applied options = perp::settings::apply_options({});
  std::vector<perp::lcp::Cell> basis{};
  perp_log log = nullptr;
  void* log_user = nullptr;
  perp_progress progress = nullptr;
  void* progress_user = nullptr;
  /// Ends a solve; set in signal handlers.
  std::atomic<bool> stop{false};
};

struct perp_result {
  perp::ncp::Result result{};
  std::vector<std::int8_t> basis{};
  /// Of option verify.
  std::optional<perp::ncp::Verified> verified{};
};

struct perp_contact {
  perp::contact::Problem problem{};
};

struct perp_contact_result {
  perp::contact::Run run{};
  std::vector<std::int8_t> states{};
};

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
#include "contact/solvers/sequence.hpp"
#include "ncp/ampl/model.hpp"
#include "ncp/interval/expression.hpp"
#include "ncp/settings/settings.hpp"
#include "ncp/strategy/kept.hpp"

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
  const lcp::AffineMcp* affine() const override { return mcp_->affine(); }
  std::vector<bool> linear_entries() const override { return mcp_->linear_entries(); }
  std::optional<ncp::Expressions> expressions() const override { return mcp_->expressions(); }
  const lcp::Polyhedron* polyhedron() const override { return mcp_->polyhedron(); }
  ncp::JacobianWork jacobian_work() const override { return mcp_->jacobian_work(); }
  const ncp::Enclosure* enclosure() const override { return mcp_->enclosure(); }
  std::string name() const override { return name_; }
  std::string variable_name(Index i) const override { return name_of(variables_, "x", i, &ncp::Mcp::variable_name); }
  std::string equation_name(Index i) const override { return name_of(equations_, "F", i, &ncp::Mcp::equation_name); }

  const std::string& kept_name() const { return name_; }
  void set_name(std::string name) { name_ = std::move(name); }
  /// The number of the first variable that has no name; nothing: names are the problem's own.
  void count_from(int first) { first_ = first; }
  int first() const { return first_.value_or(1); }
  void set_names(std::vector<std::string> variables, std::vector<std::string> equations) {
    variables_ = std::move(variables);
    equations_ = std::move(equations);
  }

 private:
  std::string name_of(const std::vector<std::string>& given, const char* letter, Index i,
                      std::string (ncp::Mcp::*own)(Index) const) const {
    if (!given.empty()) return given[lcp::at(i)];
    return first_ ? std::string(letter) + "[" + std::to_string(i + *first_) + "]" : (*mcp_.*own)(i);
  }

  std::unique_ptr<ncp::Mcp> mcp_;
  std::optional<int> first_{};
  std::string name_ = mcp_->name();
  std::vector<std::string> variables_{};
  std::vector<std::string> equations_{};
};

}  // namespace perp::capi

struct perp_problem {
  /// `first`: of names that are not the problem's own.
  explicit perp_problem(std::unique_ptr<perp::ncp::Mcp> problem, std::optional<int> first = {})
      : mcp(std::move(problem)) {
    if (first) mcp.count_from(*first);
  }

  perp::capi::NamedMcp mcp;
  /// Of a problem of functions, else null.
  perp::capi::CallbackMcp* callbacks = nullptr;
  /// Of a problem from an .nl file, else null.
  const perp::ncp::ampl::Model* model = nullptr;
  bool own_names = false;
  std::string source{};
  /// None: 0.
  std::vector<perp::lcp::Vec> starts{};
};

struct perp_solver {
  std::vector<perp::settings::Assignment> given{};
  perp::settings::Applied options = perp::settings::apply_options({});
  std::vector<perp::lcp::Cell> basis{};
  perp_log log = nullptr;
  void* log_user = nullptr;
  perp_progress progress = nullptr;
  void* progress_user = nullptr;
  bool heeds_sigint = false;
  /// Of perp_solve_kept.
  std::optional<perp::ncp::KeptSolver> kept{};
  /// Ends a solve; set in signal handlers.
  std::atomic<bool> stop{false};
};

struct perp_contact {
  perp::contact::Problem problem{};
};

struct perp_contact_batch {
  std::vector<perp::contact::Sequence> simulations{};
};

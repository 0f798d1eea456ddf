// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/mcp.hpp"

#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "ncp/interval/graph_enclosure.hpp"

namespace perp::ncp {
namespace {

class FunctionMcp final : public Mcp {
 public:
  explicit FunctionMcp(Functions f) : f_(std::move(f)) {
    if (!f_.J) differences_.emplace(f_.pattern, f_.differences);
  }
  FunctionMcp(const FunctionMcp&) = delete;
  FunctionMcp& operator=(const FunctionMcp&) = delete;
  const Box& box() const override { return f_.box; }
  const SpMat& jacobian_pattern() const override { return f_.pattern; }
  bool eval(In x, Out F) const override {
    const bool defined = f_.F(x, F);
    if (defined && differences_) differences_->keep(x, F);
    return defined;
  }
  bool jacobian(In x, SpMat& J) const override {
    return differences_ ? differences_->jacobian(f_.F, f_.box, x, J.valuePtr()) : f_.J(x, J);
  }
  JacobianWork jacobian_work() const override {
    if (!differences_) return {};
    return {JacobianWork::By::Differences, differences_->colours(), differences_->F_evals()};
  }
  bool is_affine() const override { return f_.affine; }
  const Enclosure* enclosure() const override {
    if (!enclosure_ && !std::exchange(asked_, true) && f_.box.size() <= most_enclosed)
      if (auto written = expressions()) enclosure_.emplace(*std::move(written), f_.pattern);
    return enclosure_ ? &*enclosure_ : nullptr;
  }
  std::optional<Expressions> expressions() const override {
    return f_.expression ? written_down(f_.expression, static_cast<int>(f_.box.size())) : std::nullopt;
  }
  std::vector<bool> linear_entries() const override { return f_.affine ? Mcp::linear_entries() : f_.linear_entries; }
  std::string name() const override { return f_.name; }
  std::string variable_name(Index i) const override {
    return f_.variable_names.empty() ? Mcp::variable_name(i) : f_.variable_names[static_cast<std::size_t>(i)];
  }
  std::string equation_name(Index i) const override {
    return f_.equation_names.empty() ? Mcp::equation_name(i) : f_.equation_names[static_cast<std::size_t>(i)];
  }

 private:
  Functions f_;
  mutable std::optional<ColouredDifferences> differences_{};
  mutable std::optional<GraphEnclosure> enclosure_{};
  mutable bool asked_ = false;
};

template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  std::ostringstream what;
  what.precision(17);
  (what << ... << parts);
  throw std::invalid_argument(what.str());
}

}  // namespace

std::string Mcp::variable_name(Index i) const { return std::string("x[").append(std::to_string(i + 1)).append("]"); }
std::string Mcp::equation_name(Index i) const { return std::string("F[").append(std::to_string(i + 1)).append("]"); }

std::optional<Expressions> Mcp::expressions() const { return std::nullopt; }

std::vector<bool> Mcp::linear_entries() const {
  return is_affine() ? std::vector<bool>(static_cast<std::size_t>(jacobian_pattern().nonZeros()), true)
                     : std::vector<bool>{};
}

Functions functions_of(const Mcp& mcp) {
  Functions f;
  f.name = mcp.name();
  f.box = mcp.box();
  f.pattern = mcp.jacobian_pattern();
  f.F = [&mcp](In x, Out F) { return mcp.eval(x, F); };
  f.J = [&mcp](In x, SpMat& J) { return mcp.jacobian(x, J); };
  f.affine = mcp.is_affine();
  f.linear_entries = mcp.linear_entries();
  return f;
}

std::unique_ptr<Mcp> make_mcp(Functions functions) {
  const Index n = functions.box.lower.size();
  const std::string& name = functions.name;
  if (!functions.F) refuse(name, ": no function F is given");
  if (!functions.J && (functions.affine || !functions.linear_entries.empty()))
    refuse(name, ": no Jacobian J is given, and differences cannot keep the promise that entries are constant");
  if (!functions.J && functions.pattern.size() == 0) functions.pattern = dense_pattern(n);
  if (functions.box.upper.size() != n)
    refuse(name, ": ", n, " lower bounds and ", functions.box.upper.size(), " upper bounds");
  if (functions.pattern.rows() != n || functions.pattern.cols() != n)
    refuse(name, ": the Jacobian pattern is ", functions.pattern.rows(), " x ", functions.pattern.cols(), " for ", n,
           " variables");
  for (const auto* names : {&functions.variable_names, &functions.equation_names})
    if (!names->empty() && static_cast<Index>(names->size()) != n)
      refuse(name, ": ", names->size(), " names for ", n, " variables");
  functions.pattern.makeCompressed();
  if (const auto flags = static_cast<Index>(functions.linear_entries.size());
      flags != 0 && flags != functions.pattern.nonZeros())
    refuse(name, ": ", flags, " flags of linear entries for a Jacobian pattern of ", functions.pattern.nonZeros(),
           " nonzeros");
  return std::make_unique<FunctionMcp>(std::move(functions));
}

SpMat dense_pattern(Index n) {
  SpMat pattern = Eigen::MatrixXd::Ones(n, n).sparseView();
  pattern.makeCompressed();
  return pattern;
}

void check_input(const Mcp& mcp, In x0) {
  const Box& box = mcp.box();
  const Index n = box.lower.size();
  if (box.upper.size() != n) refuse(mcp.name(), ": ", n, " lower bounds and ", box.upper.size(), " upper bounds");
  if (const auto i = box.first_invalid())
    refuse(mcp.name(), ": variable ", mcp.variable_name(*i), " has lower bound ", box.lower[*i], " and upper bound ",
           box.upper[*i], ", between which nothing lies");
  const SpMat& pattern = mcp.jacobian_pattern();
  if (pattern.rows() != n || pattern.cols() != n || !pattern.isCompressed())
    refuse(mcp.name(), ": the Jacobian pattern is ", pattern.rows(), " x ", pattern.cols(),
           pattern.isCompressed() ? "" : ", not compressed,", " for ", n, " variables");
  if (x0.size() != n) refuse(mcp.name(), ": the start has ", x0.size(), " entries for ", n, " variables");
  for (Index i = 0; i < n; ++i)
    if (!std::isfinite(x0[i])) refuse(mcp.name(), ": the start of variable ", mcp.variable_name(i), " is ", x0[i]);
}

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/autodiff.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "ncp/interval/graph_enclosure.hpp"
#include "ncp/problem/colouring.hpp"

namespace perp::ncp {
namespace {

using Rows = std::vector<std::vector<ExpressionGraph::Mention>>;

Rows mentions_of(const Expressions& written) {
  Rows rows;
  std::vector<char> visited(written.graph.size(), 0);
  for (const ExpressionGraph::Node root : written.rows) rows.push_back(written.graph.mentions(root, visited));
  return rows;
}

SpMat pattern_of(const Rows& rows) {
  const auto n = static_cast<Index>(rows.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const auto& mention : rows[i]) entries.emplace_back(static_cast<int>(i), mention.variable, 1.0);
  SpMat pattern(n, n);
  pattern.setFromTriplets(entries.begin(), entries.end());
  pattern.makeCompressed();
  return pattern;
}

/// One flag an entry, by columns, rows ascending.
std::vector<bool> linear_flags(const Rows& rows, const SpMat& pattern) {
  std::vector<int> next(pattern.outerIndexPtr(), pattern.outerIndexPtr() + pattern.cols());
  std::vector<bool> linear(at(pattern.nonZeros()));
  for (const auto& row : rows)
    for (const auto& mention : row) linear[at(next[at(mention.variable)]++)] = mention.linear;
  return linear;
}

class AutodiffMcp final : public Mcp {
 public:
  AutodiffMcp(FunctionInstances function, AutodiffParts parts)
      : function_(std::move(function)), parts_(std::move(parts)) {
    if (auto written = written_down(function_.expression, static_cast<int>(parts_.box.size()))) {
      const Rows rows = mentions_of(*written);
      parts_.pattern = pattern_of(rows);
      linear_ = linear_flags(rows, parts_.pattern);
      enclosure_.emplace(*std::move(written), parts_.pattern);
    } else if (parts_.pattern.size() == 0) {
      parts_.pattern = dense_pattern(parts_.box.size());
    }
    groups_ = column_groups(parts_.pattern);
    seeded_.resize(at(size()));
    row_.resize(at(size()));
  }

  const Box& box() const override { return parts_.box; }
  const SpMat& jacobian_pattern() const override { return parts_.pattern; }
  bool is_affine() const override { return enclosure_ && std::ranges::find(linear_, false) == linear_.end(); }
  std::vector<bool> linear_entries() const override { return linear_; }
  const Enclosure* enclosure() const override { return enclosure_ ? &*enclosure_ : nullptr; }
  std::optional<Expressions> expressions() const override {
    return enclosure_ ? std::optional(enclosure_->written()) : std::nullopt;
  }
  JacobianWork jacobian_work() const override {
    return {JacobianWork::By::DualNumbers, static_cast<Index>(groups_.size()), sweeps_};
  }
  std::string name() const override { return parts_.name; }
  std::string variable_name(Index i) const override {
    return parts_.variable_names.empty() ? Mcp::variable_name(i) : parts_.variable_names[at(i)];
  }
  std::string equation_name(Index i) const override {
    return parts_.equation_names.empty() ? Mcp::equation_name(i) : parts_.equation_names[at(i)];
  }

  bool eval(In x, Out F) const override {
    F.setZero();
    return function_.number({x.data(), at(x.size())}, {F.data(), at(F.size())});
  }
  bool jacobian(In x, SpMat& J) const override;

 private:
  FunctionInstances function_;
  AutodiffParts parts_;
  std::optional<GraphEnclosure> enclosure_{};
  std::vector<bool> linear_{};
  std::vector<std::vector<int>> groups_{};
  mutable std::vector<Dual> seeded_{}, row_{};  // x and F on dual numbers
  mutable long sweeps_ = 0;
};

bool AutodiffMcp::jacobian(In x, SpMat& J) const {
  const SpMat& pattern = parts_.pattern;
  for (std::size_t first = 0; first < groups_.size(); first += at(Dual::width)) {
    const std::size_t lanes = std::min(groups_.size() - first, at(Dual::width));
    std::copy(x.begin(), x.end(), seeded_.begin());
    for (std::size_t lane = 0; lane < lanes; ++lane)
      for (const int j : groups_[first + lane]) seeded_[at(j)].d[lane] = 1;
    std::ranges::fill(row_, Dual());
    ++sweeps_;
    if (!function_.dual(seeded_, row_)) return false;
    for (std::size_t lane = 0; lane < lanes; ++lane)
      for (const int j : groups_[first + lane])
        for (int k = pattern.outerIndexPtr()[j]; k < pattern.outerIndexPtr()[j + 1]; ++k)
          J.valuePtr()[k] = row_[at(pattern.innerIndexPtr()[k])].d[lane];
  }
  return true;
}

void check_parts(const FunctionInstances& instances, const AutodiffParts& parts) {
  const Index n = parts.box.lower.size();
  const auto refuse_size = [&](const std::string& what, Index count) {
    throw std::invalid_argument(parts.name + ": " + std::to_string(count) + " " + what + " for " + std::to_string(n) +
                                " variables");
  };
  if (!instances.number || !instances.dual || !instances.expression)
    throw std::invalid_argument(parts.name + ": no function F is given");
  if (parts.box.upper.size() != n) refuse_size("upper bounds", parts.box.upper.size());
  const SpMat& pattern = parts.pattern;
  if (pattern.size() != 0 && pattern.rows() != n) refuse_size("rows of the Jacobian pattern", pattern.rows());
  if (pattern.size() != 0 && pattern.cols() != n) refuse_size("columns of the Jacobian pattern", pattern.cols());
  for (const auto* names : {&parts.variable_names, &parts.equation_names})
    if (!names->empty() && static_cast<Index>(names->size()) != n)
      refuse_size("names", static_cast<Index>(names->size()));
}

}  // namespace

std::unique_ptr<Mcp> make_autodiff_mcp(FunctionInstances instances, AutodiffParts parts) {
  check_parts(instances, parts);
  parts.pattern.makeCompressed();
  return std::make_unique<AutodiffMcp>(std::move(instances), std::move(parts));
}

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/affine.hpp"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <utility>

namespace perp::ncp {
namespace {

/// M is its own pattern: the matrix is there once.
class AffineProblem final : public Mcp {
 public:
  /// Takes the problem's contents.
  AffineProblem(lcp::AffineMcp& problem, std::string name, std::vector<std::string> variable_names,
                std::vector<std::string> equation_names)
      : name_(std::move(name)), variable_names_(std::move(variable_names)), equation_names_(std::move(equation_names)) {
    problem_.M.swap(problem.M);
    problem_.q.swap(problem.q);
    problem_.box = std::move(problem.box);
  }

  const Box& box() const override { return problem_.box; }
  const SpMat& jacobian_pattern() const override { return problem_.M; }
  bool eval(In x, Out F) const override {
    F = problem_.q;
    const SpMat& M = problem_.M;
    for (Index j = 0; j < M.cols(); ++j) {
      const double xj = x[j];
      for (Index p = M.outerIndexPtr()[j]; p < M.outerIndexPtr()[j + 1]; ++p)
        F[M.innerIndexPtr()[p]] += M.valuePtr()[p] * xj;
    }
    return F.allFinite();
  }
  bool jacobian(In, SpMat& J) const override {
    std::copy_n(problem_.M.valuePtr(), problem_.M.nonZeros(), J.valuePtr());
    return true;
  }
  const lcp::AffineMcp* affine() const override { return &problem_; }
  std::string name() const override { return name_; }
  std::string variable_name(Index i) const override {
    return variable_names_.empty() ? Mcp::variable_name(i) : variable_names_[lcp::at(i)];
  }
  std::string equation_name(Index i) const override {
    return equation_names_.empty() ? Mcp::equation_name(i) : equation_names_[lcp::at(i)];
  }

 private:
  lcp::AffineMcp problem_{};
  std::string name_;
  std::vector<std::string> variable_names_;
  std::vector<std::string> equation_names_;
};

}  // namespace

std::shared_ptr<const lcp::AffineMcp> affine_part(const Mcp& mcp) {
  if (const lcp::AffineMcp* own = mcp.affine()) return {std::shared_ptr<const void>(), own};
  if (!mcp.is_affine()) return nullptr;
  const Vec zero = Vec::Zero(mcp.size());
  const auto problem = std::make_shared<lcp::AffineMcp>(mcp.jacobian_pattern(), Vec(mcp.size()), mcp.box());
  if (!mcp.eval(zero, problem->q) || !mcp.jacobian(zero, problem->M) || !problem->q.allFinite()) return nullptr;
  return problem;
}

std::unique_ptr<Mcp> make_affine_mcp(lcp::AffineMcp problem, std::string name, std::vector<std::string> variable_names,
                                     std::vector<std::string> equation_names) {
  if (const auto why = problem.invalid()) throw std::invalid_argument(name + ": " + *why);
  problem.M.makeCompressed();
  for (const auto* names : {&variable_names, &equation_names})
    if (!names->empty() && static_cast<Index>(names->size()) != problem.size())
      throw std::invalid_argument(name + ": " + std::to_string(names->size()) + " names for " +
                                  std::to_string(problem.size()) + " variables");
  return std::make_unique<AffineProblem>(problem, std::move(name), std::move(variable_names),
                                         std::move(equation_names));
}

}  // namespace perp::ncp

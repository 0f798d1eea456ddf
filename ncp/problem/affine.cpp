#include "ncp/problem/affine.hpp"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <utility>

namespace perp::ncp {
std::optional<lcp::AffineMcp> affine_part(const Mcp& mcp) {
  if (!mcp.is_affine()) return std::nullopt;
  const Vec zero = Vec::Zero(mcp.size());
  lcp::AffineMcp problem{.M = mcp.jacobian_pattern(), .q = Vec(mcp.size()), .box = mcp.box()};
  if (!mcp.eval(zero, problem.q) || !mcp.jacobian(zero, problem.M) || !problem.q.allFinite()) return std::nullopt;
  return problem;
}

std::unique_ptr<Mcp> make_affine_mcp(lcp::AffineMcp problem, std::string name, std::vector<std::string> variable_names,
                                     std::vector<std::string> equation_names) {
  if (const auto why = problem.invalid()) throw std::invalid_argument(name + ": " + *why);
  problem.M.makeCompressed();
  const auto shared = std::make_shared<const lcp::AffineMcp>(std::move(problem));
  Functions made{.name = std::move(name), .box = shared->box, .pattern = shared->M, .F = {}, .J = {}};
  made.variable_names = std::move(variable_names);
  made.equation_names = std::move(equation_names);
  made.affine = true;
  made.F = [shared](In x, Out F) {
    F = shared->q;
    F.noalias() += shared->M * x;
    return F.allFinite();
  };
  made.J = [shared](In, SpMat& J) {
    std::copy_n(shared->M.valuePtr(), shared->M.nonZeros(), J.valuePtr());
    return true;
  };
  return make_mcp(std::move(made));
}

}  // namespace perp::ncp

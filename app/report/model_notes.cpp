// SPDX-License-Identifier: Apache-2.0
#include "app/report/model_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "app/text/table.hpp"
#include "ncp/analysis/structure_report.hpp"

namespace perp::app {
namespace {

/// The model without its side inequalities: their variables u = v - bound, v >= bound, are free.
std::unique_ptr<ncp::Mcp> without_sides(const ncp::Mcp& mcp, ncp::Index n_var) {
  ncp::Functions f;
  f.name = mcp.name();
  f.box = mcp.box();
  f.box.lower.tail(mcp.size() - n_var).setConstant(-ncp::infinity);
  f.pattern = mcp.jacobian_pattern();
  f.F = [&mcp](ncp::In x, ncp::Out F) { return mcp.eval(x, F); };
  f.J = [&mcp](ncp::In x, ncp::SpMat& J) { return mcp.jacobian(x, J); };
  f.affine = mcp.is_affine();
  f.linear_entries = mcp.linear_entries();
  return ncp::make_mcp(std::move(f));
}

/// "side[capacity] (by 3)" of those that the solution without them violates; empty if there is none.
std::string held_out_by(const LoadedProblem& problem, ncp::Method method, const ncp::Result& result) {
  constexpr ncp::Seconds at_least{1};
  const ncp::Index n_var = problem.model->n_var();
  ncp::Stop& stop = ncp::stop(method);
  stop.max_time = std::min(stop.max_time - result.stats.time, std::max(at_least, ncp::Seconds(result.stats.time)));
  if (!(stop.max_time.count() > 0)) return {};
  const auto relaxed = without_sides(*problem.mcp, n_var);
  const ncp::Result there = ncp::solve(*relaxed, problem.x0, method);
  if (!there.accepted()) return {};
  std::vector<ncp::Index> violated;
  for (ncp::Index u = n_var; u < there.x.size(); ++u)
    if (there.x[u] < -stop.tol) violated.push_back(u);
  return violated.empty() ? std::string() : ncp::listed(violated.size(), [&](std::size_t k) {
    const ncp::Index u = violated[k];
    return fmt::format("{} (by {})", problem.mcp->equation_name(u), number(-there.x[u]));
  });
}

}  // namespace

void add_model_notes(const LoadedProblem& problem, const ncp::Method& method, ncp::Result& result) {
  if (problem.model == nullptr) return;
  std::vector<std::string> remarks = problem.model->remarks();
  const bool says_names = !result.solved() || !result.notes.empty() || !remarks.empty();
  if (says_names && !problem.model->has_names()) result.notes.emplace_back(ncp::ampl::advice_on_names);
  for (std::string& remark : remarks) result.notes.push_back(std::move(remark));
  if (result.accepted() || result.status == ncp::Status::Interrupted || problem.model->side_inequalities() == 0) return;
  if (const std::string sides = held_out_by(problem, method, result); !sides.empty())
    result.notes.push_back("without its side inequalities the model has a solution, which violates " + sides);
}

}  // namespace perp::app

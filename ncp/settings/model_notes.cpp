// SPDX-License-Identifier: Apache-2.0
#include "ncp/settings/model_notes.hpp"

#include <algorithm>
#include <chrono>

#include "ncp/analysis/structure_report.hpp"
#include "ncp/problem/words.hpp"

namespace perp::settings {
namespace {

/// The model without its side inequalities: their variables u = v - bound, v >= bound, are free.
std::unique_ptr<ncp::Mcp> without_sides(const ncp::Mcp& mcp, ncp::Index n_var) {
  ncp::Functions f = ncp::functions_of(mcp);
  f.box.lower.tail(mcp.size() - n_var).setConstant(-ncp::infinity);
  return ncp::make_mcp(std::move(f));
}

/// "side[capacity] (by 3)" of those that the solution without them violates; empty if there is none.
std::string held_out_by(const ncp::Mcp& mcp, ncp::Index n_var, ncp::In x0, ncp::Method method,
                        const ncp::Result& result) {
  constexpr ncp::Seconds at_least{1};
  ncp::Stop& stop = ncp::stop(method);
  stop.max_time = std::min(stop.max_time - result.stats.time, std::max(at_least, ncp::Seconds(result.stats.time)));
  if (!(stop.max_time.count() > 0)) return {};
  const auto relaxed = without_sides(mcp, n_var);
  const ncp::Result there = ncp::solve(*relaxed, x0, method);
  if (!there.accepted()) return {};
  std::vector<ncp::Index> violated;
  for (ncp::Index u = n_var; u < there.x.size(); ++u)
    if (there.x[u] < -stop.tol) violated.push_back(u);
  return violated.empty() ? std::string() : ncp::listed(violated.size(), [&](std::size_t k) {
    const ncp::Index u = violated[k];
    return mcp.equation_name(u) + " (by " + ncp::number(-there.x[u]) + ")";
  });
}

}  // namespace

void add_model_notes(const ncp::Mcp& mcp, const ncp::ampl::Model& model, ncp::In x0, const ncp::Method& method,
                     ncp::Result& result) {
  std::vector<std::string> remarks = model.remarks();
  const bool says_names = !result.solved() || !result.notes.empty() || !remarks.empty();
  if (says_names && !model.has_names()) result.notes.emplace_back(ncp::ampl::advice_on_names);
  for (std::string& remark : remarks) result.notes.push_back(std::move(remark));
  if (result.accepted() || result.status == ncp::Status::Interrupted || model.side_inequalities() == 0) return;
  if (const std::string sides = held_out_by(mcp, model.n_var(), x0, method, result); !sides.empty())
    result.notes.push_back("without its side inequalities the model has a solution, which violates " + sides);
}

}  // namespace perp::settings

// SPDX-License-Identifier: Apache-2.0
#include "capi/describe.hpp"

#include <utility>

namespace perp::capi {

namespace {

using Cells = std::vector<std::int8_t>;

Part empty() { return std::make_unique<perp_result>(); }

std::int32_t letter(char c) { return c == ' ' ? 0 : static_cast<unsigned char>(c); }

/// By rows.
Vec entries(const Eigen::MatrixXd& matrix) {
  Vec all(matrix.size());
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<Rows>(all.data(), matrix.rows(), matrix.cols()) = matrix;
  return all;
}

}  // namespace

perp_iteration iteration_of(const ncp::Iteration& it, std::int64_t n) {
  return {.struct_size = sizeof(perp_iteration),
          .k = it.k,
          .residual = it.residual,
          .worst = it.worst,
          .merit = it.merit,
          .step = it.step,
          .prox = it.prox,
          .mu = it.mu,
          .pivots = it.pivots,
          .backtracks = it.backtracks,
          .F_evals = it.F_evals,
          .J_evals = it.J_evals,
          .kind = letter(it.kind),
          .linear = letter(it.linear),
          .crash = it.crash ? 1 : 0,
          .attempt = it.attempt.c_str(),
          .n = n,
          .x = nullptr};
}

Part part_of(const ncp::Stats& stats, const CallbackMcp* callbacks) {
  Part part = empty();
  part->fields.reserve(24);
  ncp::each(stats, [&](const char* name, auto number) { part->add(name, number); });
  if (callbacks == nullptr) return part;
  part->add("F_calls", callbacks->F_calls())
      .add("jac_calls", callbacks->J_calls())
      .add("difference_groups", callbacks->jacobian_work().colours);
  return part;
}

Part part_of(ncp::Result result, const CallbackMcp* callbacks) {
  Part part = empty();
  part->fields.reserve(16);
  part->status = static_cast<std::int32_t>(result.status);
  ncp::each(result, [&part](const char* name, auto&& value) { part->add(name, std::move(value)); });
  part->add("stats", part_of(result.stats, callbacks));
  return part;
}

Part part_of(ncp::Verified found) {
  Part part = empty();
  part->add("unique", found.unique)
      .add("x", std::move(found.x))
      .add("radius", std::move(found.radius))
      .add("active", found.active)
      .add("why_not", std::move(found.why_not));
  return part;
}

Part part_of(ncp::AllSolutions all, const CallbackMcp* callbacks) {
  Part part = empty();
  std::vector<Part> found;
  for (ncp::FoundSolution& one : all.found) {
    found.push_back(part_of(std::move(one.result), callbacks));
    found.back()->add("how", std::move(one.how)).add("singular", std::move(one.singular));
  }
  part->add("found", std::move(found))
      .add("first", part_of(std::move(all.first), callbacks))
      .add("attempts", all.attempts)
      .add("duplicates", all.duplicates)
      .add("message", std::move(all.message))
      .add("stats", part_of(all.stats, callbacks));
  return part;
}

Part part_of(const ncp::Sensitivity& found) {
  Part part = empty();
  std::vector<std::string> states;
  for (const ncp::Activity state : found.states) states.emplace_back(to_string(state));
  part->add("status", to_string(found.status))
      .add("known", found.known())
      .add("message", found.message)
      .add("dx", entries(found.dx))
      .add("dF", entries(found.dF))
      .add("directions", found.dx.cols())
      .add("states", std::move(states))
      .add("degenerate", std::vector<std::int64_t>(found.degenerate.begin(), found.degenerate.end()))
      .add("rcond", found.rcond)
      .add("strongly_regular", found.strongly_regular)
      .add("residual", found.residual.natural);
  return part;
}

Part part_of(const ncp::Mcp& mcp, const ncp::JacobianCheck& check) {
  Part part = empty();
  part->add("worst", check.worst)
      .add("row", check.row)
      .add("column", check.col)
      .add("given", check.given)
      .add("difference", check.difference)
      .add("outside_pattern", check.outside_pattern)
      .add("message", ncp::describe(mcp, check));
  return part;
}

Part part_of(const contact::Residual& r) {
  Part part = empty();
  part->add("natural", r.natural)
      .add("siconos", r.siconos)
      .add("rr9118", r.rr9118)
      .add("scaled", r.scaled)
      .add("cone", r.cone)
      .add("normal", r.normal)
      .add("slip", r.slip)
      .add("largest", r.largest());
  return part;
}

Part part_of(const contact::Verdict& verdict) {
  Part part = empty();
  part->add("existence", contact::to_string(verdict.existence)).add("message", verdict.message);
  if (verdict.existence == contact::Existence::None)
    part->add("certificate", verdict.certificate).add("radius", verdict.radius);
  if (verdict.existence == contact::Existence::Exists)
    part->add("r", verdict.witness.r).add("margin", verdict.witness.margin);
  return part;
}

Part part_of(contact::Run run) {
  Part part = empty();
  part->status = static_cast<std::int32_t>(run.status);
  Part residual = part_of(run.residual);
  residual->add("own", run.own);
  Cells states;
  for (const contact::ContactState& one : run.states) states.push_back(static_cast<std::int8_t>(one.state));
  Part stats = empty();
  stats->add("time_s", run.seconds);
  for (const auto& [name, count] : run.counts) stats->add(name, count);
  part->add("r", std::move(run.solution.r))
      .add("u", std::move(run.solution.u))
      .add("status", to_string(run.status))
      .add("success", run.solved)
      .add("message", std::move(run.message))
      .add("solved_by", std::move(run.solved_by))
      .add("residual", std::move(residual))
      .add("states", std::move(states))
      .add("stats", std::move(stats));
  if (!run.solved && !run.verdict.message.empty()) part->add("verdict", part_of(run.verdict));
  return part;
}

Part part_of(const contact::Sensitivity& found) {
  Part part = empty();
  std::vector<std::string> regions;
  for (const contact::Region region : found.regions) regions.emplace_back(contact::to_string(region));
  part->add("status", to_string(found.status))
      .add("known", found.known())
      .add("message", found.message)
      .add("dr", entries(found.dr))
      .add("du", entries(found.du))
      .add("directions", found.dr.cols())
      .add("regions", std::move(regions))
      .add("degenerate", std::vector<std::int64_t>(found.degenerate.begin(), found.degenerate.end()))
      .add("rcond", found.rcond)
      .add("strongly_regular", found.strongly_regular)
      .add("residual", part_of(found.residual));
  return part;
}

}  // namespace perp::capi

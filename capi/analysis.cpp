// SPDX-License-Identifier: Apache-2.0
/// What perp.h says of problems beside solving them.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "capi/describe.hpp"
#include "capi/guard.hpp"
#include "capi/solve.hpp"
#include "ncp/analysis/certificate.hpp"
#include "ncp/analysis/inspection.hpp"
#include "ncp/analysis/structure_report.hpp"
#include "ncp/explain/explain.hpp"

namespace perp::capi {

namespace {

Part inspected(Work& work, const perp_problem& problem, const Vec& x0) {
  const ncp::Mcp& mcp = problem.mcp;
  const ncp::Inspection found = ncp::inspect(mcp, x0, work.stop());
  Part part = std::make_unique<perp_result>();
  Part bounds = std::make_unique<perp_result>();
  bounds->add("free", found.kinds.free)
      .add("lower", found.kinds.lower)
      .add("upper", found.kinds.upper)
      .add("boxed", found.kinds.boxed)
      .add("fixed", found.kinds.fixed.size());
  std::vector<std::string> warnings, guarantees;
  for (const ncp::Concern& concern : ncp::concerns(found)) warnings.push_back(concern.text);
  std::string singular;
  if (found.start.F_defined && found.start.J_defined)
    singular = ncp::explain_singularity(mcp, found.start.J, found.start.x, found.start.F);
  Part classes = std::make_unique<perp_result>();
  const auto add_classes = [&](const auto& all) {
    for (const auto& [name, property] : all) classes->add(name, property->yes() ? 1 : property->no() ? 0 : -1);
  };
  if (found.classes) {
    add_classes(found.classes->all());
    for (const lcp::Guarantee& one : found.classes->guarantees()) guarantees.push_back(one.statement);
  }
  const Index worst = found.start.residual.worst;
  part->add("name", mcp.name())
      .add("size", mcp.size())
      .add("nonzeros", mcp.jacobian_pattern().nonZeros())
      .add("affine", mcp.is_affine())
      .add("bounds", std::move(bounds))
      .add("structural_rank", found.structure.rank + static_cast<Index>(found.kinds.fixed.size()))
      .add("residual", found.start.residual.natural)
      .add("worst", worst < 0 ? std::string() : mcp.equation_name(worst))
      .add("singular", std::move(singular))
      .add("warnings", std::move(warnings))
      .add("classes", std::move(classes))
      .add("guarantees", std::move(guarantees));
  return part;
}

Part demand_part(const ncp::Mcp& mcp, const ncp::Demand& demand) {
  Part part = std::make_unique<perp_result>();
  part->add("what", ncp::to_string(demand.of)).add("name", ncp::name_of(mcp, demand)).add("index", demand.index);
  return part;
}

Part explained(Work& work, const perp_problem& problem, const Vec& x0, double seconds) {
  const ncp::Mcp& mcp = problem.mcp;
  const ncp::Explanation found =
      ncp::explain(mcp, x0, {.method = work.solver().options.settings.method, .seconds = seconds}, work.stop());
  Part part = std::make_unique<perp_result>();
  std::vector<Part> answers, demands, changes;
  for (const ncp::Answer& a : found.answers) {
    std::vector<std::string> rows, variables;
    for (const Index i : a.rows) rows.push_back(mcp.equation_name(i));
    for (const Index j : a.variables) variables.push_back(mcp.variable_name(j));
    answers.push_back(std::make_unique<perp_result>());
    answers.back()
        ->add("kind", ncp::to_string(a.kind))
        .add("proven", a.proven)
        .add("text", a.text)
        .add("rows", std::move(rows))
        .add("variables", std::move(variables))
        .add("row_indices", std::vector<std::int64_t>(a.rows.begin(), a.rows.end()))
        .add("variable_indices", std::vector<std::int64_t>(a.variables.begin(), a.variables.end()));
  }
  part->add("status", to_string(found.result.status))
      .add("success", found.result.accepted())
      .add("message", found.result.message)
      .add("answers", std::move(answers))
      .add("notes", found.result.notes);
  part->status = static_cast<std::int32_t>(found.result.status);
  if (found.conflict) {
    for (const ncp::Demand& d : found.conflict->demands) demands.push_back(demand_part(mcp, d));
    Part conflict = std::make_unique<perp_result>();
    conflict->add("demands", std::move(demands)).add("smallest", found.conflict->smallest);
    if (found.conflict->proof.certificate)
      conflict->add("certificate", ncp::certificate_json(mcp, found.result.x, found.conflict->proof));
    part->add("conflict", std::move(conflict));
  }
  if (!found.repair.changes.empty()) {
    for (const ncp::Change& c : found.repair.changes) {
      changes.push_back(demand_part(mcp, c.what));
      changes.back()->add("from", c.from).add("to", c.to);
    }
    Part repair = std::make_unique<perp_result>();
    repair->add("changes", std::move(changes)).add("least", found.repair.least).add("verified", found.repair.verified);
    part->add("repair", std::move(repair));
  }
  return part;
}

/// Nothing of null.
SpMat derivative_of(const perp_matrix* given, const char* name, Index n, Index m) {
  return given == nullptr ? SpMat() : std::move(matrix_of(given, name, n, m).entries);
}

}  // namespace

}  // namespace perp::capi

using namespace perp::capi;  // NOLINT(google-build-using-namespace): what follows is the interface of C

int32_t perp_inspect(perp_solver* solver, const perp_problem* problem, const double* x0, perp_result** result,
                     perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    require(problem, "problem");
    Work work(solver, problem->callbacks);
    return work.watch().over([&] { return inspected(work, *problem, start_of(*problem, x0, "x0")); });
  });
}

int32_t perp_explain(perp_solver* solver, const perp_problem* problem, const double* x0, double seconds,
                     perp_result** result, perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    require(problem, "problem");
    if (!(seconds > 0)) refuse("seconds", "not a positive number");
    Work work(solver, problem->callbacks);
    return work.watch().over([&] { return explained(work, *problem, start_of(*problem, x0, "x0"), seconds); });
  });
}

int32_t perp_verify(perp_solver* solver, const perp_problem* problem, const double* x, perp_result** result,
                    perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    require(problem, "problem");
    const Work work(solver, problem->callbacks);
    Part part = part_of(perp::ncp::verify(problem->mcp, vector_of(x, problem->mcp.size(), "x")));
    work.watch().check();
    return part;
  });
}

int32_t perp_check_jacobian(perp_solver* solver, const perp_problem* problem, const double* x, perp_result** result,
                            perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    require(problem, "problem");
    const Work work(solver, problem->callbacks);
    const Vec at = start_of(*problem, x, "x");
    perp::ncp::check_input(problem->mcp, at);
    const perp::ncp::JacobianCheck check = perp::ncp::check_jacobian(problem->mcp, at);
    work.watch().check();
    if (!check.defined) refuse("x", "F or J is not defined there, or nowhere near");
    return part_of(problem->mcp, check);
  });
}

int32_t perp_sensitivity(perp_solver* solver, const perp_problem* problem, const double* x, const perp_matrix* dF,
                         const perp_matrix* dlower, const perp_matrix* dupper, const double* direction,
                         perp_result** result, perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    require(problem, "problem");
    require(dF, "dF");
    const Index n = problem->mcp.size();
    const Vec at = vector_of(x, n, "x");
    perp::ncp::ParameterDerivatives parameters{.dF = derivative_of(dF, "dF", n, -1)};
    const Index m = parameters.dF.cols();
    parameters.dl = derivative_of(dlower, "dlower", n, m);
    parameters.du = derivative_of(dupper, "dupper", n, m);
    const Work work(solver, problem->callbacks);
    const perp::ncp::Sensitivity found =
        direction == nullptr
            ? perp::ncp::sensitivity(problem->mcp, at, parameters)
            : perp::ncp::sensitivity(problem->mcp, at, parameters, vector_of(direction, m, "direction"));
    work.watch().check();
    return part_of(found);
  });
}

// SPDX-License-Identifier: Apache-2.0
/// What perp.h says of problems beside solving them.
#include <optional>

#include "capi/describe.hpp"
#include "capi/guard.hpp"
#include "capi/solve.hpp"
#include "ncp/analysis/inspection.hpp"
#include "ncp/analysis/structure_report.hpp"

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

// SPDX-License-Identifier: Apache-2.0
/// Problem.inspect(): what is known of a problem before it is solved.
#include <fmt/format.h>

#include "extension/interrupt.hpp"
#include "extension/problem.hpp"
#include "lcp/classes/classify.hpp"
#include "lcp/linalg/structure.hpp"
#include "ncp/analysis/structure_report.hpp"
#include "ncp/problem/affine.hpp"

namespace perp::python {

namespace {

py::dict bounds_in(const lcp::Box& box) {
  Index free = 0, lower = 0, upper = 0, boxed = 0, fixed = 0;
  for (Index i = 0; i < box.size(); ++i) {
    const bool low = box.lower[i] > -lcp::infinity;
    const bool high = box.upper[i] < lcp::infinity;
    ++(box.lower[i] == box.upper[i] ? fixed : low && high ? boxed : low ? lower : high ? upper : free);
  }
  return py::dict(py::arg("free") = free, py::arg("lower") = lower, py::arg("upper") = upper, py::arg("boxed") = boxed,
                  py::arg("fixed") = fixed);
}

struct Findings {
  ncp::Residual residual{};
  std::string singular{};
  std::optional<lcp::Diagnosis> classes{};
};

Findings findings_of(const ncp::Mcp& mcp, const Vec& x) {
  Findings found;
  found.residual = ncp::residual(mcp, x);
  Vec F(mcp.size());
  SpMat J = mcp.jacobian_pattern();
  if (mcp.eval(x, F) && mcp.jacobian(x, J)) found.singular = ncp::explain_singularity(mcp, J, x, F);
  if (const auto affine = ncp::affine_part(mcp)) found.classes = lcp::classify(*affine);
  return found;
}

}  // namespace

py::dict Problem::inspect(py::handle x0) const {
  const Vec x = lcp::project(mcp_->box(), start_of(x0));
  const Use use(*this);
  Findings found;
  {
    const Released released;
    found = findings_of(*mcp_, x);
  }
  use.check();
  py::dict facts;
  facts["name"] = mcp_->name();
  facts["size"] = mcp_->size();
  facts["nonzeros"] = mcp_->jacobian_pattern().nonZeros();
  facts["affine"] = mcp_->is_affine();
  facts["bounds"] = bounds_in(mcp_->box());
  facts["structural_rank"] = lcp::structural_rank(mcp_->jacobian_pattern(), lcp::Entries::Stored);
  facts["residual"] = found.residual.natural;
  facts["worst"] = found.residual.worst < 0 ? std::string() : mcp_->equation_name(found.residual.worst);
  facts["singular"] = found.singular;
  py::dict classes;
  py::list guarantees;
  if (found.classes) {
    for (const auto& [name, property] : found.classes->all())
      classes[py::str(std::string(name))] = property->yes()  ? py::object(py::bool_(true))
                                            : property->no() ? py::object(py::bool_(false))
                                                             : py::none();
    for (const lcp::Guarantee& one : found.classes->guarantees()) guarantees.append(one.statement);
  }
  facts["classes"] = classes;
  facts["guarantees"] = guarantees;
  return facts;
}

}  // namespace perp::python

// SPDX-License-Identifier: Apache-2.0
/// What of an inspection deserves a second look.
#include <fmt/format.h>

#include <utility>

#include "ncp/analysis/inspection.hpp"
#include "ncp/analysis/structure_report.hpp"

namespace perp::ncp {

namespace {

constexpr double scaling_of_concern = 1e8;  // half the digits of a double
constexpr double singular_rcond = 1e-15;

}  // namespace

std::vector<Concern> concerns(const Inspection& inspection) {
  const Mcp& mcp = inspection.mcp();
  std::vector<Concern> found;
  const auto add = [&](Concern::Part part, std::string text) { found.push_back({part, std::move(text)}); };

  const StructureFindings& structure = inspection.structure;
  if (!structure.empty_rows.empty())
    add(Concern::Structure,
        fmt::format("{} no variable: {}",
                    structure.empty_rows.size() == 1 ? "1 row depends on"
                                                     : fmt::format("{} rows depend on", structure.empty_rows.size()),
                    listed_equations(mcp, structure.empty_rows)));
  if (!structure.empty_columns.empty())
    add(Concern::Structure, fmt::format("{} in no row: {}",
                                        structure.empty_columns.size() == 1
                                            ? "1 variable occurs"
                                            : fmt::format("{} variables occur", structure.empty_columns.size()),
                                        listed_variables(mcp, structure.empty_columns)));
  if (structure.singular()) {
    add(Concern::Structure,
        fmt::format("structurally singular whichever variables are at their bounds (rank {} of {} at most)",
                    structure.rank_with_bounds, structure.size));
    for (const std::string& text : describe_parts(mcp, structure.over, structure.under)) add(Concern::Structure, text);
  }

  const StartFindings& start = inspection.start;
  if (!start.F_undefined.empty())
    add(Concern::Start, "F is not defined in " + listed_equations(mcp, start.F_undefined));
  else if (!start.F_defined)
    add(Concern::Start, "F is not defined, and the problem does not say in which rows");
  if (!start.J_undefined.empty())
    add(Concern::Start, "the Jacobian is not defined: " + listed(start.J_undefined.size(), [&](std::size_t k) {
                          const auto& [i, j] = start.J_undefined[k];
                          return fmt::format("{} by {}", mcp.equation_name(i), mcp.variable_name(j));
                        }));
  else if (!start.J_defined)
    add(Concern::Start, "the Jacobian is not defined");

  if (inspection.scaling.spread() > scaling_of_concern)
    add(Concern::Scaling, fmt::format("the largest entries of rows or of columns differ by a factor of {:.0e}: other "
                                      "units would make them comparable",
                                      inspection.scaling.spread()));
  if (inspection.derivatives && inspection.derivatives->defined)
    if (std::string wrong = describe(mcp, *inspection.derivatives); !wrong.empty())
      add(Concern::Derivatives, std::move(wrong));
  const ConditionFindings& condition = inspection.condition;
  if (condition.active && *condition.active < singular_rcond && condition.active_size > 0) {
    const std::string why = explain_singularity(mcp, start.J, start.x, start.F);
    add(Concern::Condition, why.empty() ? "Newton's matrix at the start is singular" : "at the start " + why);
  }
  return found;
}

}  // namespace perp::ncp

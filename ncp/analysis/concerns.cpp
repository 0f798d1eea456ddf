// SPDX-License-Identifier: Apache-2.0
/// What of an inspection deserves a second look.
#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "ncp/analysis/inspection.hpp"
#include "ncp/analysis/structure_report.hpp"
#include "ncp/problem/model_structure.hpp"

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
  const StartFindings& start = inspection.start;
  if (structure.singular())
    add(Concern::Structure,
        fmt::format("structurally singular whichever variables are at their bounds (rank {} of {} at most)",
                    structure.rank_with_bounds, structure.size));
  // What solve() says; of a bounded variable that is alone it says nothing.
  for (Fault& fault : faults(structure_of(mcp, &start.F, start.J_defined ? &start.J : nullptr)))
    add(Concern::Structure, std::move(fault.text));
  const auto bounded = [&](Indices indices) {
    std::erase_if(indices, [&](Index i) { return mcp.box().is_free(i); });
    return indices;
  };
  if (const Indices rows = bounded(structure.empty_rows); !rows.empty())
    add(Concern::Structure,
        fmt::format("{} no variable: {}",
                    rows.size() == 1 ? "1 row depends on" : fmt::format("{} rows depend on", rows.size()),
                    listed_equations(mcp, rows)));
  if (const Indices columns = bounded(structure.empty_columns); !columns.empty())
    add(Concern::Structure,
        fmt::format("{} in no row: {}",
                    columns.size() == 1 ? "1 variable occurs" : fmt::format("{} variables occur", columns.size()),
                    listed_variables(mcp, columns)));
  if (!start.undefined.empty()) add(Concern::Start, start.undefined);

  if (inspection.scaling.spread() > scaling_of_concern)
    add(Concern::Scaling, fmt::format("the largest entries of rows or of columns differ by a factor of {:.0e}: other "
                                      "units would make them comparable",
                                      inspection.scaling.spread()));
  if (inspection.derivatives && inspection.derivatives->defined)
    if (std::string wrong = describe(mcp, *inspection.derivatives); !wrong.empty())
      add(Concern::Derivatives, std::move(wrong));
  const ConditionFindings& condition = inspection.condition;
  const bool active = condition.active && *condition.active < singular_rcond && condition.active_size > 0;
  // Prices without a numeraire are seen in the numbers alone.
  const bool all = condition.all && *condition.all < singular_rcond && structure.full();
  if (active || all) {
    const std::string why = explain_singularity(mcp, start.J, start.x, start.F);
    if (active || !why.empty())
      add(Concern::Condition, why.empty() ? "Newton's matrix at the start is singular" : "at the start " + why);
  }
  return found;
}

}  // namespace perp::ncp

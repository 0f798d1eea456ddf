// SPDX-License-Identifier: Apache-2.0
/// An Inspection for programs; docs/schema/inspect.json describes it.
#include "app/commands/inspect.hpp"
#include "app/text/json_parts.hpp"

namespace perp::app {

namespace {

using ncp::Index;

Json variables_json(const ncp::Mcp& mcp, const Indices& indices) {
  Json names = Json::array();
  for (const Index i : indices) names.push_back(mcp.variable_name(i));
  return {{"names", std::move(names)}, {"indices", indices}};
}

Json equations_json(const ncp::Mcp& mcp, const Indices& indices) {
  Json names = Json::array();
  for (const Index i : indices) names.push_back(mcp.equation_name(i));
  return {{"names", std::move(names)}, {"indices", indices}};
}

Json entry_json(const ncp::Mcp& mcp, std::pair<Index, Index> place) {
  if (place.first < 0) return nullptr;
  return {{"equation", mcp.equation_name(place.first)},
          {"variable", mcp.variable_name(place.second)},
          {"row", place.first},
          {"column", place.second}};
}

Json part_json(const ncp::Mcp& mcp, const lcp::StructurePart& part) {
  return {{"equations", equations_json(mcp, part.rows)}, {"variables", variables_json(mcp, part.columns)}};
}

Json kinds_json(const Inspection& inspection) {
  const VariableKinds& kinds = inspection.kinds;
  return {{"free", kinds.free},
          {"lower", kinds.lower},
          {"upper", kinds.upper},
          {"boxed", kinds.boxed},
          {"fixed", variables_json(inspection.mcp(), kinds.fixed)}};
}

Json structure_json(const Inspection& inspection) {
  const ncp::Mcp& mcp = inspection.mcp();
  const StructureFindings& found = inspection.structure;
  return {{"size", found.size},
          {"rank", found.rank},
          {"rank_with_bounds", found.rank_with_bounds},
          {"empty_rows", equations_json(mcp, found.empty_rows)},
          {"empty_columns", variables_json(mcp, found.empty_columns)},
          {"overdetermined", part_json(mcp, found.over)},
          {"underdetermined", part_json(mcp, found.under)}};
}

Json start_json(const Inspection& inspection) {
  const ncp::Mcp& mcp = inspection.mcp();
  const StartFindings& start = inspection.start;
  Json undefined = Json::array();
  for (const auto& place : start.J_undefined) undefined.push_back(entry_json(mcp, place));
  const bool some = start.largest_F >= 0;
  return {{"outside_bounds", variables_json(mcp, start.outside)},
          {"F_defined", start.F_defined},
          {"J_defined", start.J_defined},
          {"F_undefined", equations_json(mcp, start.F_undefined)},
          {"J_undefined", std::move(undefined)},
          {"residual", residual_json(mcp, start.residual)},
          {"F_smallest", json_number(start.smallest_F)},
          {"F_largest", some ? json_number(std::abs(start.F[start.largest_F])) : Json(0.0)},
          {"F_largest_equation", equation_json(mcp, start.largest_F)},
          {"F_zeros", start.zeros_in_F},
          {"degenerate", variables_json(mcp, start.degenerate)},
          {"rank", start.J_defined ? Json(start.rank) : Json(nullptr)}};
}

Json scaling_json(const Inspection& inspection) {
  const ncp::Mcp& mcp = inspection.mcp();
  const ScalingFindings& found = inspection.scaling;
  const auto extremes = [](const std::vector<Extreme>& all, auto&& name) {
    Json array = Json::array();
    for (const Extreme& one : all)
      array.push_back({{"name", name(one.index)}, {"index", one.index}, {"largest", json_number(one.value)}});
    return array;
  };
  const auto row = [&](Index i) { return mcp.equation_name(i); };
  const auto column = [&](Index j) { return mcp.variable_name(j); };
  return {{"entries", found.entries},
          {"zeros", found.zeros},
          {"smallest", json_number(found.smallest)},
          {"smallest_at", entry_json(mcp, found.smallest_at)},
          {"largest", json_number(found.largest)},
          {"largest_at", entry_json(mcp, found.largest_at)},
          {"large_rows", extremes(found.large_rows, row)},
          {"small_rows", extremes(found.small_rows, row)},
          {"large_columns", extremes(found.large_columns, column)},
          {"small_columns", extremes(found.small_columns, column)}};
}

Json derivatives_json(const Inspection& inspection) {
  if (!inspection.derivatives) return nullptr;
  const ncp::JacobianCheck& check = *inspection.derivatives;
  return {{"defined", check.defined},
          {"columns", check.columns},
          {"worst", json_number(check.worst)},
          {"worst_at", entry_json(inspection.mcp(), {check.row, check.col})},
          {"given", json_number(check.given)},
          {"difference", json_number(check.difference)},
          {"outside_pattern", check.outside_pattern}};
}

Json condition_json(const ConditionFindings& found) {
  const auto maybe = [](const std::optional<double>& value) { return value ? json_number(*value) : Json(nullptr); };
  return {{"rcond", maybe(found.all)},
          {"rcond_active", maybe(found.active)},
          {"active_rows", found.active_size},
          {"why_not", found.why_not}};
}

Json classes_json(const Inspection& inspection) {
  if (!inspection.classes) return nullptr;
  const ncp::Mcp& mcp = inspection.mcp();
  const lcp::Diagnosis& classes = *inspection.classes;
  Json properties = Json::array();
  for (const auto& [name, property] : classes.all()) {
    Json vector = Json::array();
    for (Index i = 0; i < property->vector.size(); ++i)
      if (property->vector[i] != 0)
        vector.push_back(
            {{"variable", mcp.variable_name(i)}, {"index", i}, {"value", json_number(property->vector[i])}});
    properties.push_back({{"name", name},
                          {"answer", lcp::to_string(property->answer)},
                          {"reason", property->reason},
                          {"indices", property->indices},
                          {"vector", std::move(vector)}});
  }
  Json guarantees = Json::array();
  for (const lcp::Guarantee& guarantee : classes.guarantees())
    guarantees.push_back({{"statement", guarantee.statement}, {"source", guarantee.source}});
  return {{"cone", classes.cone},
          {"bounded", classes.bounded},
          {"properties", std::move(properties)},
          {"guarantees", std::move(guarantees)}};
}

Json function_classes_json(const Inspection& inspection) {
  if (!inspection.function_classes) return nullptr;
  Json properties = Json::array();
  for (const auto& [name, property] : inspection.function_classes->all())
    properties.push_back({{"name", name},
                          {"answer", lcp::to_string(property->answer)},
                          {"reason", property->reason},
                          {"x", json_numbers(property->x)},
                          {"y", json_numbers(property->y)}});
  return {{"modulus", json_number(inspection.function_classes->modulus)}, {"properties", std::move(properties)}};
}

}  // namespace

std::string inspect_json(const Inspection& inspection) {
  const ncp::Mcp& mcp = inspection.mcp();
  Json json = json_header(Document::Inspect);
  json["problem"] = inspection.loaded->label;
  json["start"] = inspection.loaded->start;
  json["status"] = "Inspected";
  json["exit_code"] = static_cast<int>(exit_solved);
  json["size"] = mcp.size();
  json["nonzeros"] = mcp.jacobian_pattern().nonZeros();
  json["affine"] = mcp.is_affine();
  json["interrupted"] = inspection.interrupted;
  json["concerns"] = Json::array();
  for (const Concern& concern : all_concerns(inspection)) json["concerns"].push_back(concern.text);
  json["variables"] = kinds_json(inspection);
  json["structure"] = structure_json(inspection);
  json["at_start"] = start_json(inspection);
  json["scaling"] = scaling_json(inspection);
  json["derivatives"] = derivatives_json(inspection);
  json["condition"] = condition_json(inspection.condition);
  json["classes"] = classes_json(inspection);
  json["function_classes"] = function_classes_json(inspection);
  return json_text(json);
}

}  // namespace perp::app

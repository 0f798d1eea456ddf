// SPDX-License-Identifier: Apache-2.0
#include "app/contact/compare/cell.hpp"

#include <fmt/format.h>

#include "app/program/program.hpp"
#include "app/text/csv.hpp"
#include "app/text/json_fields.hpp"

namespace perp::app::contacts {

namespace {

Outcome outcome_of(const std::string& status) {
  if (status == "Solved") return Outcome::Solved;
  if (status == "Infeasible") return Outcome::Infeasible;
  if (status == "TimeLimit") return Outcome::TimeLimit;
  if (status == "OutOfMemory") return Outcome::MemoryLimit;
  if (status == "NotApplicable") return Outcome::NotApplicable;
  return Outcome::Failed;
}

/// What the run said of itself.
void read(Cell& cell, const Json& json) {
  cell.status = json.at("status").get<std::string>();
  cell.message = compare::in_one_line(json.at("message").get<std::string>());
  cell.outcome = outcome_of(cell.status);
  if (cell.status == "InputError") {
    cell.message = "refused: " + cell.message;
    return;
  }
  const Json& residual = json.at("residual");
  cell.exact = json.at("exact").get<bool>();
  if (json.at("solved_by").is_string()) cell.solved_by = json.at("solved_by").get<std::string>();
  cell.contacts = static_cast<int>(json.at("contacts").size());
  const Json& stats = json.at("stats");
  const auto steps = [&](const char* key, int otherwise) -> long {  // ints, whose sum a long holds
    return stats.contains(key) ? json_integer<int>(stats.at(key), key) : otherwise;
  };
  cell.iterations = steps("iterations", -1) + steps("newton_steps", 0) + steps("sweeps", 0);
  cell.seconds = json.at("stats").at("time_s").get<double>();
  cell.siconos = json_real(residual.at("siconos"), "siconos");
  cell.rr9118 = json_real(residual.at("rr9118"), "rr9118");
  cell.scaled = json_real(residual.at("scaled"), "scaled");
  cell.own = json_real(json.at("own_residual"), "own_residual");
}

}  // namespace

Cell cell_of(const compare::ProcessEnd& end, const std::string& json, const compare::ProcessLimits& limits) {
  using Why = compare::ProcessEnd::Why;
  Cell cell;
  cell.seconds = end.seconds;
  const Json parsed = Json::parse(json, nullptr, false);
  bool complete = parsed.is_object();
  if (complete) try {
      read(cell, parsed);
    } catch (const Json::exception&) {
      complete = false;
    } catch (const InputError&) {
      complete = false;
    }
  cell.peak_mb = end.peak_mb;
  if (end.why == Why::MemoryLimit) {
    cell.outcome = Outcome::MemoryLimit;
    cell.message = fmt::format("killed: more than {} MB", limits.memory_mb);
  } else if (end.why == Why::TimeLimit) {
    cell.outcome = Outcome::TimeLimit;
    cell.message = complete ? fmt::format("told to end after {:.3g} s; {}", end.seconds, cell.message)
                            : fmt::format("killed after {:.3g} s, reading included", end.seconds);
  } else if (!complete) {
    cell.outcome = Outcome::Crashed;
    cell.message = compare::sudden_end(end);
  }
  return cell;
}

std::string cells_csv(std::span<const Cell> cells) {
  std::vector<std::string> names;
  const Json head = json_of(Cell{});
  for (const auto& [name, ignored] : head.items()) names.push_back(name);
  std::string text = csv_row(names);
  for (const Cell& cell : cells) text += csv_row(json_of(cell), field_text);
  return text;
}

std::string cells_json(std::span<const Cell> cells) {
  Json json = json_header(Document::ContactCells);
  json["cells"] = Json::array();
  for (const Cell& cell : cells) json["cells"].push_back(json_of(cell));
  return json_text(json);
}

}  // namespace perp::app::contacts

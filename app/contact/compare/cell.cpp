#include "app/contact/compare/cell.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/program/program.hpp"
#include "app/text/csv.hpp"
#include "app/text/json_integer.hpp"
#include "app/text/json_parts.hpp"

namespace perp::app::contacts {

namespace {

constexpr std::size_t longest_message = 600;

double real(const Json& value) {
  if (value.is_number()) return value.get<double>();
  if (value.is_string() && value == "inf") return std::numeric_limits<double>::infinity();
  return std::nan("");
}

std::string cleaned(const std::string& text) {
  std::string line;
  for (const char c : text.substr(0, longest_message)) line += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  return line;
}

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
  cell.message = cleaned(json.at("message").get<std::string>());
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
  cell.siconos = real(residual.at("siconos"));
  cell.rr9118 = real(residual.at("rr9118"));
  cell.scaled = real(residual.at("scaled"));
  cell.own = real(json.at("own_residual"));
}

Json natural(long n) { return n < 0 ? Json(nullptr) : Json(n); }

/// Names and values, in the order of both files.
Json row(const Cell& c) {
  return {{"variant", c.variant},
          {"problem", c.problem},
          {"exact", c.exact},
          {"outcome", compare::to_string(c.outcome)},
          {"status", c.status},
          {"solved_by", c.solved_by},
          {"contacts", natural(c.contacts)},
          {"iterations", natural(c.iterations)},
          {"seconds", json_known(c.seconds)},
          {"peak_mb", json_known(c.peak_mb)},
          {"siconos", json_known(c.siconos)},
          {"rr9118", json_known(c.rr9118)},
          {"scaled", json_known(c.scaled)},
          {"own_residual", json_known(c.own)},
          {"message", c.message},
          {"command", c.command}};
}

/// What row() made. Throws Json's exceptions and InputError.
Cell cell_of_row(const Json& json) {
  Cell cell;
  cell.variant = json.at("variant").get<std::string>();
  cell.problem = json.at("problem").get<std::string>();
  cell.exact = json.at("exact").get<bool>();
  cell.outcome = compare::outcome_of(json.at("outcome").get<std::string>());
  cell.status = json.at("status").get<std::string>();
  cell.solved_by = json.at("solved_by").get<std::string>();
  cell.contacts = json.at("contacts").is_null() ? -1 : json_integer<int>(json.at("contacts"), "contacts");
  cell.iterations = json.at("iterations").is_null() ? -1 : json_integer<long>(json.at("iterations"), "iterations");
  cell.seconds = real(json.at("seconds"));
  cell.peak_mb = real(json.at("peak_mb"));
  cell.siconos = real(json.at("siconos"));
  cell.rr9118 = real(json.at("rr9118"));
  cell.scaled = real(json.at("scaled"));
  cell.own = real(json.at("own_residual"));
  cell.message = json.at("message").get<std::string>();
  cell.command = json.at("command").get<std::string>();
  return cell;
}

std::string field(const Json& value) {
  if (value.is_null()) return "";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (!value.is_string()) return value.dump();
  return csv_field(value.get_ref<const std::string&>());
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
    cell.message = WIFSIGNALED(end.status) ? compare::signal_name(WTERMSIG(end.status))
                                           : fmt::format("exit code {}, no result", WEXITSTATUS(end.status));
  }
  return cell;
}

std::string cell_line(const Cell& cell) {
  return compare::checked_line(row(cell).dump(-1, ' ', false, Json::error_handler_t::replace));
}

CellsRead parse_cells(const std::string& text) {
  CellsRead read;
  const auto take = [&](std::string_view object) {
    Cell cell;
    try {
      cell = cell_of_row(Json::parse(object));
    } catch (const Json::exception& error) {
      throw InputError(error.what());
    }
    const auto same = std::ranges::find_if(
        read.cells, [&](const Cell& c) { return c.variant == cell.variant && c.problem == cell.problem; });
    if (same == read.cells.end())
      read.cells.push_back(std::move(cell));
    else
      *same = std::move(cell);
  };
  read.dropped = compare::read_checked_lines(text, take).dropped;
  return read;
}

std::string cells_csv(std::span<const Cell> cells) {
  std::vector<std::string> names;
  const Json head = row({});
  for (const auto& [name, ignored] : head.items()) names.push_back(name);
  std::string text = fmt::format("{}\n", fmt::join(names, ","));
  for (const Cell& cell : cells) {
    std::vector<std::string> fields;
    const Json values = row(cell);
    for (const auto& [name, value] : values.items()) fields.push_back(field(value));
    text += fmt::format("{}\n", fmt::join(fields, ","));
  }
  return text;
}

std::string cells_json(std::span<const Cell> cells) {
  Json json = json_header(Document::ContactCells);
  json["cells"] = Json::array();
  for (const Cell& cell : cells) json["cells"].push_back(row(cell));
  return json_text(json);
}

}  // namespace perp::app::contacts

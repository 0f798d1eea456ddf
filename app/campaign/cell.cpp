#include "app/campaign/cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>

#include "app/program/files.hpp"
#include "app/program/program.hpp"
#include "app/text/csv.hpp"
#include "app/text/json_integer.hpp"
#include "app/text/json_parts.hpp"
#include "lcp/io/file_error.hpp"

namespace perp::app::compare {

namespace {

constexpr std::array<std::string_view, 12> outcomes{
    "solved",    "solved-to-rounding", "failed",       "false-convergence",
    "unclaimed", "time-limit",         "memory-limit", "crashed",
    "garbage",   "not-applicable",     "infeasible",   "false-infeasible"};

constexpr std::array<std::string_view, 17> columns{"method",         "problem",
                                                   "start",          "outcome",
                                                   "status",         "claimed",
                                                   "natural",        "iterations",
                                                   "F_evals",        "J_evals",
                                                   "factorizations", "krylov_iterations",
                                                   "restarts",       "outcome_after_restarts",
                                                   "seconds",        "peak_mb",
                                                   "message"};
constexpr std::size_t timeless = 14;

constexpr std::array<std::uint32_t, 256> crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t c = byte;
    for (int bit = 0; bit < 8; ++bit) c = (c & 1U) != 0 ? 0xEDB88320U ^ (c >> 1U) : c >> 1U;
    table.at(byte) = c;
  }
  return table;
}

Json count_json(int n) { return n < 0 ? Json(nullptr) : Json(n); }

const Json& member(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) throw InputError(fmt::format("a cell without '{}'", key));
  return *found;
}

std::string text_of(const Json& object, const char* key) {
  const Json& value = member(object, key);
  if (!value.is_string()) throw InputError(fmt::format("'{}' is no text", key));
  return value.get<std::string>();
}

int count_of(const Json& object, const char* key) {
  const Json& value = member(object, key);
  if (value.is_null()) return -1;
  return json_integer<int>(value, key);
}

double number_of(const Json& value, const char* key) {
  if (value == "inf") return std::numeric_limits<double>::infinity();
  if (value == "-inf") return -std::numeric_limits<double>::infinity();
  if (value == "nan") return std::numeric_limits<double>::quiet_NaN();
  if (!value.is_number()) throw InputError(fmt::format("'{}' is no number", key));
  return value.get<double>();
}

Json to_json(const Cell& cell) {
  Json curve = Json::array();
  for (const double value : cell.curve) curve.push_back(json_number(value));
  return {{"method", cell.method},
          {"problem", cell.problem},
          {"start", cell.start},
          {"outcome", to_string(cell.outcome)},
          {"status", cell.status},
          {"claimed", cell.claimed},
          {"natural", json_number(cell.natural)},
          {"iterations", count_json(cell.iterations)},
          {"F_evals", count_json(cell.F_evals)},
          {"J_evals", count_json(cell.J_evals)},
          {"factorizations", count_json(cell.factorizations)},
          {"krylov_iterations", count_json(cell.krylov_iterations)},
          {"seconds", json_number(cell.seconds)},
          {"peak_mb", json_number(cell.peak_mb)},
          {"restarts", cell.restarts},
          {"outcome_after_restarts", to_string(cell.outcome_after_restarts)},
          {"message", cell.message},
          {"curve", std::move(curve)}};
}

std::string count_text(int n) { return n < 0 ? "" : fmt::format("{}", n); }

/// In the order of `columns`.
std::array<std::string, columns.size()> fields(const Cell& cell) {
  return {cell.method,
          cell.problem,
          fmt::format("{}", cell.start),
          std::string(to_string(cell.outcome)),
          cell.status,
          cell.claimed ? "yes" : "no",
          std::isnan(cell.natural) ? "" : fmt::format("{}", cell.natural),
          count_text(cell.iterations),
          count_text(cell.F_evals),
          count_text(cell.J_evals),
          count_text(cell.factorizations),
          count_text(cell.krylov_iterations),
          fmt::format("{}", cell.restarts),
          std::string(to_string(cell.outcome_after_restarts)),
          fmt::format("{:.6g}", cell.seconds),
          fmt::format("{:.1f}", cell.peak_mb),
          cell.message};
}

template <class Row>
void append_row(std::string& text, const Row& row, std::size_t width) {
  for (std::size_t k = 0; k < width; ++k) {
    if (k > 0) text += ',';
    text += csv_field(row[k]);
  }
  text += '\n';
}

}  // namespace

std::span<const std::string_view> outcome_names() { return outcomes; }

std::string_view to_string(Outcome outcome) { return outcomes.at(static_cast<std::size_t>(outcome)); }

Outcome outcome_of(std::string_view name) {
  const auto found = std::ranges::find(outcomes, name);
  if (found == outcomes.end()) throw InputError(fmt::format("'{}' is no outcome", name));
  return static_cast<Outcome>(found - outcomes.begin());
}

bool good(Outcome outcome) { return outcome == Outcome::Solved || outcome == Outcome::Infeasible; }

CellKey key(const Cell& cell) { return {cell.method, cell.problem, cell.start}; }

std::uint32_t crc32(std::string_view text) {
  static constexpr std::array<std::uint32_t, 256> table = crc_table();
  std::uint32_t c = 0xFFFFFFFFU;
  for (const char byte : text) c = table.at((c ^ static_cast<unsigned char>(byte)) & 0xFFU) ^ (c >> 8U);
  return c ^ 0xFFFFFFFFU;
}

std::string cell_json(const Cell& cell) { return to_json(cell).dump(-1, ' ', false, Json::error_handler_t::replace); }

Cell cell_of_json(std::string_view json) {
  const Json object = Json::parse(json, nullptr, false);
  if (!object.is_object()) throw InputError("no JSON object");
  Cell cell;
  cell.method = text_of(object, "method");
  cell.problem = text_of(object, "problem");
  cell.start = count_of(object, "start");
  cell.outcome = outcome_of(text_of(object, "outcome"));
  cell.status = text_of(object, "status");
  const Json& claimed = member(object, "claimed");
  if (!claimed.is_boolean()) throw InputError("'claimed' is neither true nor false");
  cell.claimed = claimed.get<bool>();
  cell.natural = number_of(member(object, "natural"), "natural");
  cell.iterations = count_of(object, "iterations");
  cell.F_evals = count_of(object, "F_evals");
  cell.J_evals = count_of(object, "J_evals");
  cell.factorizations = count_of(object, "factorizations");
  cell.krylov_iterations = count_of(object, "krylov_iterations");
  cell.seconds = number_of(member(object, "seconds"), "seconds");
  cell.peak_mb = number_of(member(object, "peak_mb"), "peak_mb");
  cell.restarts = count_of(object, "restarts");
  cell.outcome_after_restarts = outcome_of(text_of(object, "outcome_after_restarts"));
  cell.message = text_of(object, "message");
  const Json& curve = member(object, "curve");
  if (!curve.is_array()) throw InputError("'curve' is no array");
  for (const Json& value : curve) cell.curve.push_back(number_of(value, "curve"));
  return cell;
}

std::string checked_line(std::string_view object) {
  return fmt::format("{{\"cell\":{},\"crc\":\"{:08x}\"}}\n", object, crc32(object));
}

std::string_view checked_object(std::string_view line) {
  constexpr std::string_view head = R"({"cell":)";
  constexpr std::string_view middle = R"(,"crc":")";
  constexpr std::string_view tail = R"("})";
  constexpr std::size_t digits = 8;
  constexpr std::size_t around = head.size() + middle.size() + digits + tail.size();
  if (line.size() < around || !line.starts_with(head) || !line.ends_with(tail)) throw InputError("torn");
  const std::string_view text = line.substr(head.size(), line.size() - around);
  const std::string_view rest = line.substr(head.size() + text.size());
  std::uint32_t crc = 0;
  const char* first = rest.data() + middle.size();
  const auto [end, error] = std::from_chars(first, first + digits, crc, 16);
  if (!rest.starts_with(middle) || error != std::errc{} || end != first + digits) throw InputError("torn");
  if (crc != crc32(text)) throw InputError(fmt::format("its CRC is {:08x}, not {:08x}", crc32(text), crc));
  return text;
}

LinesRead read_checked_lines(std::string_view text, const std::function<void(std::string_view)>& take) {
  LinesRead read;
  text = lcp::without_utf8_mark(text);
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    read.torn = end == std::string_view::npos;
    try {
      if (read.torn) throw InputError("torn");
      take(checked_object(text.substr(0, end)));
    } catch (const InputError& error) {
      read.dropped.push_back(fmt::format("line {}: {}", number, error.what()));
    }
    text.remove_prefix(read.torn ? text.size() : end + 1);
  }
  return read;
}

std::string cell_line(const Cell& cell) { return checked_line(cell_json(cell)); }

Cell parse_line(std::string_view line) { return cell_of_json(checked_object(line)); }

CellsRead parse_cells(std::string_view text) {
  std::map<CellKey, Cell> cells;
  LinesRead lines = read_checked_lines(text, [&](std::string_view object) {
    Cell cell = cell_of_json(object);
    cells.insert_or_assign(key(cell), std::move(cell));
  });
  CellsRead read{.cells = {}, .dropped = std::move(lines.dropped), .torn = lines.torn};
  for (auto& [identity, cell] : cells) read.cells.push_back(std::move(cell));
  return read;
}

CellsRead read_cells(const std::string& dir) {
  const std::string path = dir + "/cells.jsonl";
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw InputError(fmt::format("'{}' cannot be read", path));
  return parse_cells(read_text(path));
}

std::span<const std::string_view> csv_columns() { return columns; }
std::span<const std::string_view> outcome_columns() { return std::span(columns).first(timeless); }

std::string cells_csv(std::span<const Cell> cells) {
  std::string text;
  append_row(text, columns, columns.size());
  for (const Cell& cell : cells) append_row(text, fields(cell), columns.size());
  return text;
}

std::string outcomes_csv(std::span<const Cell> cells) {
  std::string text;
  append_row(text, columns, timeless);
  for (Cell cell : cells) {
    if (cell.outcome == Outcome::TimeLimit || cell.outcome == Outcome::MemoryLimit) {
      Cell end{.method = cell.method, .problem = cell.problem, .start = cell.start, .outcome = cell.outcome};
      end.restarts = cell.restarts;
      end.outcome_after_restarts = cell.outcome_after_restarts;
      cell = std::move(end);
    }
    append_row(text, fields(cell), timeless);
  }
  return text;
}

std::string cells_json(std::span<const Cell> cells) {
  std::string text = "[";
  for (const Cell& cell : cells) text += (text.size() == 1 ? "\n" : ",\n") + cell_json(cell);
  return text + "\n]\n";
}

}  // namespace perp::app::compare

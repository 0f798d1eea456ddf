// SPDX-License-Identifier: Apache-2.0
#include "app/report/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <ostream>

#include "app/problem/warm_start.hpp"
#include "app/program/files.hpp"
#include "app/text/json_parts.hpp"
#include "collection/sized.hpp"
#include "ncp/analysis/certificate.hpp"

namespace perp::app {

Json json_number(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

Json json_known(double value) { return std::isnan(value) ? Json(nullptr) : json_number(value); }

Json json_numbers(ncp::In values) {
  Json array = Json::array();
  for (const double value : values) array.push_back(json_number(value));
  return array;
}

namespace {

/// What JSON lets stand and terminals obey: DEL and C1.
std::string for_terminals(std::string dumped) {
  if (dumped.find('\x7F') == std::string::npos && dumped.find('\xC2') == std::string::npos) return dumped;
  std::string text;
  text.reserve(dumped.size());
  for (std::size_t k = 0; k < dumped.size(); ++k) {
    const auto next = k + 1 < dumped.size() ? static_cast<unsigned char>(dumped[k + 1]) : 0U;
    if (dumped[k] == '\x7F')
      text += "\\u007f";
    else if (dumped[k] == '\xC2' && next >= 0x80 && next < 0xA0)
      text += fmt::format("\\u{:04x}", static_cast<unsigned char>(dumped[++k]));
    else
      text += dumped[k];
  }
  return text;
}

}  // namespace

std::string json_text(const Json& json) {
  return for_terminals(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

Json json_header(Document document) {
  // A number rises when a key goes or changes its meaning.
  static constexpr std::array<std::string_view, 11> schemas{
      "perp/solve/1",   "perp/no-result/1", "perp/inspect/1",      "perp/explain/1",          "perp/list/1",
      "perp/problem/1", "perp/contact/1",   "perp/contact-runs/1", "perp/contact-variants/1", "perp/judge/1",
      "perp/methods/1"};
  Json json = json_header();
  json["schema"] = schemas.at(static_cast<std::size_t>(document));
  return json;
}

Json json_header() {
  Json json;
  json["program"] = "perp";
  json["version"] = version_number();
  return json;
}

Json equation_json(const ncp::Mcp& mcp, ncp::Index i) {
  return i >= 0 && i < mcp.size() ? Json(mcp.equation_name(i)) : Json(nullptr);
}

Json index_json(ncp::Index i) { return i >= 0 ? Json(i) : Json(nullptr); }

Json residual_json(const ncp::Mcp& mcp, const ncp::Residual& r) {
  return {{"natural", json_number(r.natural)},
          {"worst", equation_json(mcp, r.worst)},
          {"worst_index", index_json(r.worst)},
          {"bounds", json_number(r.bounds)},
          {"complementarity", json_number(r.complementarity)}};
}

namespace {

namespace collection = ncp::collection;

void append_number(std::string& text, double value) {
  if (!std::isfinite(value)) {
    text += json_number(value).dump();
    return;
  }
  std::array<char, 32> digits{};
  const char* end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  const std::string_view shortest(digits.data(), static_cast<std::size_t>(end - digits.data()));
  text += shortest;
  if (shortest.find_first_of(".e") == std::string_view::npos) text += ".0";  // a double for readers that tell
}

void append_quoted(std::string& text, std::string_view word) {
  if (std::ranges::all_of(word, [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; }))
    text.append(1, '"').append(word).append(1, '"');
  else
    text += Json(word).dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// A line for each, at once: a tree of a million variables takes several times as long as the text.
void append_variables(std::string& text, const Report& report) {
  const ncp::Mcp& mcp = report.mcp();
  const ncp::Box& box = mcp.box();
  const double tol = ncp::stop(report.settings.method).tol;
  const std::vector<lcp::Cell>& basis = report.result.basis;
  const bool has_basis = static_cast<ncp::Index>(basis.size()) == mcp.size();
  const std::size_t start = text.size();
  const auto begin = [&](std::string_view name, std::string_view equation) {
    text += text.back() == '[' ? "\n    {\"name\": " : ",\n    {\"name\": ";
    append_quoted(text, name);
    text += ", \"equation\": ";
    append_quoted(text, equation);
  };
  const auto numbers = [&](double lower, double value, double upper, double F) {
    append_number(text += ", \"lower\": ", lower);
    append_number(text += ", \"value\": ", value);
    append_number(text += ", \"upper\": ", upper);
    append_number(text += ", \"F\": ", F);
  };
  text += "[";
  for (ncp::Index i = 0; i < mcp.size(); ++i) {
    begin(mcp.variable_name(i), mcp.equation_name(i));
    numbers(box.lower[i], report.result.x[i], box.upper[i], F_value(report, i));
    append_quoted(text += ", \"state\": ", state_name(box, i, report.result.x[i], tol));
    if (has_basis) append_quoted(text += ", \"basis\": ", cell_name(basis[static_cast<std::size_t>(i)]));
    text += "}";
    // A text that grows by doubling is copied, and takes twice the memory. What the first ones take, by and large:
    constexpr ncp::Index measured = 1000;
    if (i + 1 == measured)
      text.reserve(start + (text.size() - start) / measured * static_cast<std::size_t>(mcp.size() + mcp.size() / 4));
  }
  for (const auto& [name, equation, value] : computed(report)) {
    begin(name, equation);
    numbers(-ncp::infinity, value, ncp::infinity, 0);
    append_quoted(text += ", \"state\": ", computed_state);
    text += "}";
  }
  text += mcp.size() > 0 ? "\n  ]" : "]";
}

Json iterations_json(const Report& report) {
  Json array = Json::array();
  for (const ncp::Iteration& it : report.iterations)
    array.push_back({{"k", it.k},
                     {"residual", json_number(it.residual)},
                     {"worst", equation_json(report.mcp(), it.worst)},
                     {"worst_index", index_json(it.worst)},
                     {"merit", json_number(it.merit)},
                     {"step", json_number(it.step)},
                     {"prox", json_number(it.prox)},
                     {"mu", json_number(it.mu)},
                     {"pivots", it.pivots},
                     {"backtracks", it.backtracks},
                     {"F_evals", it.F_evals},
                     {"J_evals", it.J_evals},
                     {"kind", std::string(1, it.kind)},
                     {"linear", it.linear == ' ' ? Json(nullptr) : Json(std::string(1, it.linear))},
                     {"crash", it.crash},
                     {"changes", index_json(it.changes)},
                     {"inside", index_json(it.inside)},
                     {"attempt", it.attempt.empty() ? Json(nullptr) : Json(it.attempt)}});
  return array;
}

Json stats_json(const ncp::Stats& stats) {
  Json json = Json::object();
  ncp::each(stats, [&json](const char* name, auto value) {
    if constexpr (std::is_floating_point_v<decltype(value)>)
      json[name] = json_number(value);
    else
      json[name] = value;
  });
  return json;
}

/// Adds the texts and numbers of a result that have no place of their own in the document.
void add_other_fields(Json& json, const ncp::Result& result) {
  constexpr std::array<std::string_view, 4> elsewhere{"success", "worst", "relative", "relative_row"};
  ncp::each(result, [&](std::string_view name, const auto& value) {
    using T = std::remove_cvref_t<decltype(value)>;
    if (json.contains(name) || std::ranges::find(elsewhere, name) != elsewhere.end()) return;
    if constexpr (std::is_same_v<T, double>)
      json[std::string(name)] = json_number(value);
    else if constexpr (std::is_arithmetic_v<T> || std::is_convertible_v<T, std::string_view>)
      json[std::string(name)] = value;
  });
}

Json options_json(const Settings& settings) {
  Settings copy = settings;
  Json json = Json::object();
  for (const ncp::Field& field : fields_of(copy).options())
    if (const std::string text = value_text(field); text != "-")
      json[std::string(field.key)] = std::visit(
          [&](const auto& target) -> Json {
            using T = std::remove_cvref_t<decltype(target)>;
            if constexpr (std::is_same_v<T, double*>)
              return json_number(*target);
            else if constexpr (std::is_same_v<T, ncp::Seconds*>)
              return json_number(target->count());
            else if constexpr (std::is_pointer_v<T>)
              return *target;
            else
              return text;
          },
          field.target);
  return json;
}

Json entry_json(const collection::Entry& entry, const collection::Problem& problem) {
  const collection::Family* family = collection::find_family(entry.name);
  return {{"name", entry.name},
          {"size", entry.size},
          {"nonzeros", problem.mcp->jacobian_pattern().nonZeros()},
          {"affine", problem.mcp->is_affine()},
          {"solvable", problem.no_solution.empty()},
          {"any_size", family == nullptr ? Json(nullptr) : Json(syntax(*family))},
          {"class", entry.problem_class},
          {"starts", problem.starts.size()},
          {"known_solutions", problem.solutions.size()},
          {"solutions_complete", problem.solutions_complete},
          {"no_solution", problem.no_solution},
          {"hard", entry.hard},
          {"source", entry.source}};
}

Json without_point(const std::string& problem, std::string_view status, ExitCode code, const std::string& message) {
  Json json = json_header(Document::NoResult);
  json["problem"] = problem;
  json["status"] = status;
  json["exit_code"] = static_cast<int>(code);
  json["message"] = message;
  return json;
}

Json verified_json(const ncp::Verified& verified) {
  return {{"unique", verified.unique},
          {"radius", verified.unique ? json_number(verified.largest_radius()) : Json(nullptr)},
          {"at_bounds", verified.active},
          {"radii", verified.unique ? json_numbers(verified.radius) : Json::array()},
          {"why_not", verified.why_not}};
}

void add_several(Json& json, const Report& report) {
  const ncp::AllSolutions& all = *report.several;
  json["solutions_complete"] = false;
  json["solutions"] = Json::array();
  for (const ncp::FoundSolution& f : all.found)
    json["solutions"].push_back({{"residual", residual_json(report.mcp(), f.result.residual)},
                                 {"found_by", f.how},
                                 {"singular", f.singular.empty() ? Json(nullptr) : Json(f.singular)},
                                 {"x", json_numbers(f.result.x)},
                                 {"F", json_numbers(f.result.F)}});
  json["deflation"] = {{"asked", *report.settings.solutions},
                       {"attempts", all.attempts},
                       {"duplicates", all.duplicates},
                       {"message", all.message},
                       {"stats", stats_json(all.stats)}};
}

}  // namespace

std::string solve_json(const Report& report) {
  const ncp::Result& result = report.result;
  Json json = json_header(Document::Solve);
  json["problem"] = report.problem->label;
  json["start"] = report.problem->start;
  json["size"] = report.mcp().size();
  json["method"] = report.settings.method_name;
  json["status"] = ncp::to_string(result.status);
  json["exit_code"] = static_cast<int>(report.exit_code());
  json["message"] = result.message;
  json["advice"] = result.advice;
  json["notes"] = report.notes;
  for (const std::string& note : result.notes) json["notes"].push_back(note);
  json["residual"] = residual_json(report.mcp(), result.residual);
  json["residual"]["relative"] = json_number(result.relative);
  json["residual"]["relative_worst"] = equation_json(report.mcp(), result.relative_row);
  if (result.status == ncp::Status::Infeasible) {
    json["residual_bound"] = json_number(result.proof.residual_bound);
    json["proven_by"] = result.proof.certificate ? "certificate" : "ranges";
    json["certificate"] = "";
  }
  json["stats"] = stats_json(result.stats);
  add_other_fields(json, result);
  if (report.derivatives)
    json["derivatives"] = {{"defined", report.derivatives->defined}, {"worst", json_number(report.derivatives->worst)}};
  if (report.verified) json["verified"] = verified_json(*report.verified);
  json["options"] = options_json(report.settings);
  json["variables"] = "";
  json["iterations"] = iterations_json(report);
  if (report.all_solutions) {
    json["solutions_complete"] = report.all_solutions->complete;
    json["solutions"] = Json::array();
    for (const lcp::Solution& solution : report.all_solutions->found)
      json["solutions"].push_back({{"dimension", solution.dimension}, {"x", json_numbers(solution.z)}});
  }
  if (report.several) add_several(json, report);
  std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  const auto put = [&text](std::string_view place, const auto& append) {  // no text has a line break of its own
    const std::size_t begin = text.find(place) + place.size();
    const std::string rest = text.substr(begin + 2);
    text.resize(begin);
    append();
    text += rest;
  };
  if (result.status == ncp::Status::Infeasible)
    put("\n  \"certificate\": ", [&] { text += ncp::certificate_json(report.mcp(), result.x, result.proof); });
  put("\n  \"variables\": ", [&] { append_variables(text, report); });
  return for_terminals(std::move(text));
}

std::string refused_json(const std::string& problem, const std::string& message) {
  return json_text(without_point(problem, "InputError", exit_input, message));
}

std::string no_point_json(const std::string& problem, const OutOfTime& why) {
  return json_text(without_point(problem, ncp::to_string(why.status()), exit_unsolved, why.what()));
}

std::string problem_json(const collection::Entry& entry) {
  const collection::Problem problem = entry.make();
  const ncp::Mcp& mcp = *problem.mcp;
  Json json = json_header(Document::Problem);
  json.update(entry_json(entry, problem));
  json["lower"] = json_numbers(mcp.box().lower);
  json["upper"] = json_numbers(mcp.box().upper);
  json["starts"] = Json::array();
  for (const ncp::Vec& start : problem.starts) json["starts"].push_back(json_numbers(start));
  json["known_solutions"] = Json::array();
  for (const collection::KnownSolution& known : problem.solutions)
    json["known_solutions"].push_back({{"label", known.label},
                                       {"x", json_numbers(known.x)},
                                       {"tol", json_number(known.tol)},
                                       {"residual", residual_json(mcp, ncp::residual(mcp, known.x))}});
  return json_text(json);
}

std::string list_json(std::span<const collection::Entry* const> entries) {
  Json json = json_header(Document::List);
  json["problems"] = Json::array();
  for (const collection::Entry* entry : entries) json["problems"].push_back(entry_json(*entry, entry->make()));
  return json_text(json);
}

bool deliver_json(const std::string& path, const std::string& content, Streams streams) {
  if (path.empty()) return true;
  if (path == "-") {
    streams.out << content << std::flush;
    return true;  // main() looks after a broken standard output
  }
  try {
    write_file(path, content);
    return true;
  } catch (const InputError& error) {
    say_refused(streams, error.what());
    return false;
  }
}

ExitCode deliver_refusal(const std::string& path, const std::string& problem, const std::string& why, Streams streams) {
  say_refused(streams, why);
  deliver_json(path, refused_json(problem, why), streams);
  return exit_input;
}

}  // namespace perp::app

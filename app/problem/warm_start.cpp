// SPDX-License-Identifier: Apache-2.0
#include "app/problem/warm_start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "app/text/json_parts.hpp"
#include "app/text/table.hpp"
#include "lcp/io/file_error.hpp"
#include "ncp/path/warm_basis.hpp"

namespace perp::app {

namespace {

constexpr std::array cell_names{
    std::pair{lcp::Cell::Below, std::string_view("below")}, std::pair{lcp::Cell::Inside, std::string_view("inside")},
    std::pair{lcp::Cell::Above, std::string_view("above")}, std::pair{lcp::Cell::Fixed, std::string_view("fixed")}};

/// The cell of that name, if there is one.
std::optional<lcp::Cell> cell_of(std::string_view name) {
  const auto* found = std::ranges::find(cell_names, name, &decltype(cell_names)::value_type::second);
  if (found == cell_names.end()) return std::nullopt;
  return found->first;
}

}  // namespace

std::string_view cell_name(lcp::Cell cell) {
  return std::ranges::find(cell_names, cell, &decltype(cell_names)::value_type::first)->second;
}

WarmStart read_warm_start(const std::string& path, const ncp::Mcp& mcp) {
  return parse_warm_start(lcp::read_file(path), path, mcp);
}

WarmStart parse_warm_start(std::string_view text, const std::string& path, const ncp::Mcp& mcp) {
  const auto fail = [&](const std::string& why) { throw input_error("--warm-start {}: {}", path, why); };
  const Json json = Json::parse(lcp::without_mark(text, path), nullptr, false);
  if (!json.is_object() || !json.contains("variables") || !json["variables"].is_array())
    fail("this is no result that 'perp solve --json' wrote");
  const Json& variables = json["variables"];  // computed ones are the last
  const auto unknowns = std::ranges::count_if(variables, [](const Json& variable) {
    return !variable.is_object() || !variable.contains("state") || variable["state"] != computed_state;
  });
  if (unknowns != mcp.size()) fail(fmt::format("{} variables, the problem has {}", unknowns, mcp.size()));
  WarmStart warm{.x = ncp::Vec(mcp.size())};
  for (ncp::Index i = 0; i < mcp.size(); ++i) {
    const Json& variable = variables[static_cast<std::size_t>(i)];
    const std::string name = mcp.variable_name(i);
    const auto word = [&](const char* key) {
      return variable.is_object() && variable.contains(key) && variable[key].is_string()
                 ? variable[key].get<std::string>()
                 : std::string();
    };
    if (word("name") != name)
      fail(fmt::format("variable {} is '{}' there and '{}' in the problem", i + 1, word("name"), name));
    if (!variable.contains("value") || !variable["value"].is_number() ||
        !std::isfinite(variable["value"].get<double>()))
      fail(fmt::format("the value of variable '{}' is no finite number", name));
    warm.x[i] = variable["value"].get<double>();
    if (!variable.contains("basis")) continue;  // of all, or of none: below
    const std::optional<lcp::Cell> cell = cell_of(word("basis"));
    if (!cell)
      fail(fmt::format("the basis of variable '{}' is {}; it must be below, inside, above or fixed", name,
                       variable["basis"].is_string() ? fmt::format("'{}'", word("basis")) : "no word"));
    warm.basis.push_back(*cell);
  }
  if (!warm.basis.empty() && static_cast<ncp::Index>(warm.basis.size()) != mcp.size())
    fail("some variables have a basis and others have none");
  return warm;
}

void set_warm_start(WarmStart warm, LoadedProblem& problem, Applied& options) {
  problem.x0 = std::move(warm.x);
  if (warm.basis.empty()) return;
  if (ncp::path_of(options.settings.method) == nullptr) {
    options.notes.push_back(fmt::format("--warm-start: method {} starts from the point alone, without the basis",
                                        options.settings.method_name));
    return;
  }
  const ncp::Index adapted = ncp::fit_basis(problem.mcp->box(), problem.x0, warm.basis);
  if (adapted > 0)
    options.notes.push_back(
        fmt::format("--warm-start: {} with bounds of another kind than then took the cell of the value",
                    count(adapted, "variable")));
  options.settings.basis = std::move(warm.basis);
}

}  // namespace perp::app

// SPDX-License-Identifier: Apache-2.0
#include "app/findings/campaign_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>

#include "app/campaign/settle.hpp"

namespace perp::app::comparison {

CampaignData::CampaignData(compare::Campaign campaign, compare::CellsRead cells)
    : campaign_(std::move(campaign)), read_(std::move(cells)) {
  std::map<std::string, std::size_t> method_index;
  for (std::size_t m = 0; m < methods().size(); ++m) method_index.emplace(label(m), m);
  std::map<std::pair<std::string, int>, std::size_t> pair_index;
  for (std::size_t p = 0; p < campaign_.problems.size(); ++p)
    for (int start = 1; start <= campaign_.problems[p].starts; ++start) {
      pair_index.emplace(std::pair(campaign_.problems[p].name, start), pairs_.size());
      pairs_.push_back({p, start});
    }
  std::erase_if(read_.cells, [&](const Cell& cell) {
    const bool known = method_index.contains(cell.method) && pair_index.contains({cell.problem, cell.start});
    if (!known)
      read_.dropped.push_back(
          fmt::format("{} on {} from start {}: not of this campaign", cell.method, cell.problem, cell.start));
    return !known;
  });
  compare::settle(campaign_, read_.cells);
  at_.assign(methods().size() * pairs_.size(), none);
  for (std::size_t k = 0; k < read_.cells.size(); ++k) {
    Cell& cell = read_.cells[k];
    cell.seconds = std::strtod(fmt::format("{:.6g}", cell.seconds).c_str(), nullptr);
    at_[method_index.at(cell.method) * pairs_.size() + pair_index.at({cell.problem, cell.start})] = k;
  }
}

std::vector<std::string> CampaignData::classes(bool solvable) const {
  std::set<std::string> distinct;
  for (std::size_t p = 0; p < pairs_.size(); ++p)
    if (problem(p).solvable() == solvable) distinct.insert(problem(p).cls);
  return {distinct.begin(), distinct.end()};
}

std::size_t CampaignData::pairs(bool solvable) const {
  std::size_t count = 0;
  for (std::size_t p = 0; p < pairs_.size(); ++p) count += problem(p).solvable() == solvable ? 1 : 0;
  return count;
}

CampaignData read_data(const std::string& dir) { return {compare::read_campaign(dir), compare::read_cells(dir)}; }

namespace {

constexpr std::string_view key = "cfunction";
constexpr std::string_view parameter = "cfunction_parameter";

std::string joined(std::string value, const std::string& parameter_value) {
  if (!parameter_value.empty()) value += (value.empty() ? "" : " ") + parameter_value;
  return value;
}

}  // namespace

std::string given_cfunction(const compare::AskedMethod& method) {
  std::string value, parameter_value;
  for (const std::string& option : method.options) {
    const std::size_t equals = std::min(option.find('='), option.size());
    if (option.substr(0, equals) == key) value = option.substr(std::min(equals + 1, option.size()));
    if (option.substr(0, equals) == parameter) parameter_value = option.substr(std::min(equals + 1, option.size()));
  }
  return joined(value, parameter_value);
}

std::string cfunction_in_force(const compare::AskedMethod& method) {
  for (const auto& [option, value] : method.in_force)
    if (option == key) return value;
  return "";
}

std::string without_cfunction(const compare::AskedMethod& method) {
  std::string text = method.name;
  for (const std::string& option : method.options)
    if (!option.starts_with(key)) text += ':' + option;
  return text;
}

}  // namespace perp::app::comparison

// SPDX-License-Identifier: Apache-2.0
#include "app/campaign/campaign_file.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

namespace perp::app::compare {

namespace {

/// "a, b and 3 more" of those in `these` and not in `others`.
std::string missing(const std::vector<std::string>& these, const std::vector<std::string>& others) {
  constexpr std::size_t most = 5;
  std::vector<std::string> names;
  for (const std::string& name : these)
    if (std::ranges::find(others, name) == others.end()) names.push_back(name);
  const std::size_t more = names.size() > most ? names.size() - most : 0;
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

}  // namespace

bool holds_campaign(const std::string& dir) {
  std::error_code ignored;
  return std::filesystem::exists(dir + "/campaign.json", ignored);
}

void compare_names(const char* what, const std::vector<std::string>& before, const std::vector<std::string>& now,
                   std::vector<std::string>& found) {
  if (const std::string gone = missing(before, now); !gone.empty())
    found.push_back(fmt::format("{} there but not here: {}", what, gone));
  if (const std::string added = missing(now, before); !added.empty())
    found.push_back(fmt::format("{} here but not there: {}", what, added));
}

}  // namespace perp::app::compare

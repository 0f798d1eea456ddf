// SPDX-License-Identifier: Apache-2.0
#include "app/contact/compare/campaign.hpp"

#include <algorithm>
#include <filesystem>

#include "app/campaign/cell.hpp"
#include "app/contact/run/run.hpp"
#include "app/program/files.hpp"

namespace perp::app::contacts {

namespace {

std::vector<std::string> arguments(const std::vector<CampaignProblem>& problems) {
  std::vector<std::string> names(problems.size());
  std::ranges::transform(problems, names.begin(), &CampaignProblem::argument);
  return names;
}

}  // namespace

CampaignProblem campaign_problem(const std::string& argument) {
  if (is_generated(argument)) return {.name = argument};
  check_utf8(argument);
  return {.name = argument, .file = std::filesystem::absolute(argument), .crc = compare::file_crc(argument)};
}

std::vector<std::string> differences(const Campaign& before, const Campaign& now) {
  std::vector<std::string> found;
  compare::compare_names("variants", before.variants, now.variants, found);
  compare::compare_names("problems", arguments(before.problems), arguments(now.problems), found);
  for (const CampaignProblem& problem : now.problems) {
    const auto same = std::ranges::find(before.problems, problem.argument(), &CampaignProblem::argument);
    if (same != before.problems.end())
      compare::compare_value("content (CRC) of " + problem.name, same->crc, problem.crc, found);
  }
  compare::compare_value("--tol", before.tol, now.tol, found);
  compare::compare_value("--time-limit", before.time_limit, now.time_limit, found);
  compare::compare_value("--memory-limit", before.memory_mb, now.memory_mb, found);
  compare::compare_value("version of perp", before.version, now.version, found);
  return found;
}

}  // namespace perp::app::contacts

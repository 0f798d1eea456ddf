#include "app/contact/compare/campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "app/campaign/differences.hpp"
#include "app/contact/run/run.hpp"
#include "app/program/files.hpp"
#include "app/program/program.hpp"
#include "app/text/json_integer.hpp"
#include "app/text/json_parts.hpp"
#include "app/worker/worker_files.hpp"

namespace perp::app::contacts {

namespace {

namespace fs = std::filesystem;
constexpr int format_version = 1;

std::string path_in(const std::string& dir) { return dir + "/campaign.json"; }

std::vector<std::string> arguments(const std::vector<CampaignProblem>& problems) {
  std::vector<std::string> names(problems.size());
  std::ranges::transform(problems, names.begin(), &CampaignProblem::argument);
  return names;
}

}  // namespace

CampaignProblem campaign_problem(const std::string& argument) {
  if (is_generated(argument)) return {.name = argument};
  check_utf8(argument);
  return {.name = argument, .file = fs::absolute(argument), .crc = compare::file_crc(argument)};
}

std::string campaign_json(const Campaign& campaign) {
  Json json = json_header();
  json["contact_campaign"] = format_version;
  json["version"] = campaign.version;
  json["tol"] = campaign.tol;
  json["time_limit"] = campaign.time_limit;
  json["memory_limit_mb"] = campaign.memory_mb;
  json["variants"] = campaign.variants;
  json["problems"] = Json::array();
  for (const CampaignProblem& problem : campaign.problems) {
    Json entry{{"name", problem.name}};
    if (!problem.file.empty()) {
      entry["file"] = problem.file;
      entry["crc"] = problem.crc;
    }
    json["problems"].push_back(std::move(entry));
  }
  return json_text(json);
}

Campaign parse_campaign(const std::string& text) {
  try {
    const Json json = Json::parse(text);
    if (!json.contains("contact_campaign")) throw InputError("no campaign of perp contact --compare");
    if (const int format = json_integer<int>(json.at("contact_campaign"), "contact_campaign"); format != format_version)
      throw InputError(fmt::format("written in format {}, of another version", format));
    Campaign campaign;
    campaign.version = json.at("version").get<std::string>();
    campaign.tol = json.at("tol").get<double>();
    campaign.time_limit = json.at("time_limit").get<double>();
    campaign.memory_mb = json_integer<long long>(json.at("memory_limit_mb"), "memory_limit_mb");
    campaign.variants = json.at("variants").get<std::vector<std::string>>();
    for (const Json& problem : json.at("problems"))
      campaign.problems.push_back({.name = problem.at("name").get<std::string>(),
                                   .file = problem.value("file", ""),
                                   .crc = problem.value("crc", "")});
    return campaign;
  } catch (const Json::exception& error) {
    throw InputError(error.what());
  }
}

bool holds_campaign(const std::string& dir) {
  std::error_code ignored;
  return fs::exists(path_in(dir), ignored);
}

Campaign read_campaign(const std::string& dir) {
  const std::string path = path_in(dir);
  try {
    return parse_campaign(read_text(path));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", path, error.what()));
  }
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

// SPDX-License-Identifier: Apache-2.0
/// Shards of a campaign, each in a folder of its own, as one campaign.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "app/campaign/campaign.hpp"
#include "app/campaign/cell.hpp"
#include "app/comparison_report/write_report.hpp"
#include "app/program/files.hpp"

namespace perp::app {

namespace {

namespace fs = std::filesystem;

/// Of the campaign that the shards are parts of: all of them but their number, so that a missing one is noticed.
void check_one_campaign(const std::string& first, const compare::Campaign& campaign, const std::string& dir,
                        const compare::Campaign& other) {
  std::vector<std::string> found = compare::differences(campaign, other);
  if (compare::parse_shard(campaign.shard).of != compare::parse_shard(other.shard).of)
    found.push_back(fmt::format("--shard: {} there, {} here", campaign.shard, other.shard));
  if (!found.empty())
    throw InputError(
        fmt::format("'{}' and '{}' are of different campaigns:\n  {}", first, dir, fmt::join(found, "\n  ")));
}

void make_empty(const std::string& out) {
  std::error_code error;
  fs::create_directories(out, error);
  if (error) throw InputError(fmt::format("'{}' cannot be made: {}", out, error.message()));
  if (!fs::is_empty(out, error) || error)
    throw InputError(fmt::format("'{}' is not empty: --out DIR names another", out));
}

}  // namespace

std::vector<std::string> join_shards(const std::vector<std::string>& dirs, const std::string& out) {
  compare::Campaign campaign;
  std::map<int, std::string> folders;
  std::string lines;
  for (const std::string& dir : dirs) {
    const compare::Campaign part = compare::read_campaign(dir);
    if (folders.empty()) campaign = part;
    check_one_campaign(dirs.front(), campaign, dir, part);
    const auto [there, added] = folders.emplace(compare::parse_shard(part.shard).number, dir);
    if (!added)
      throw InputError(
          fmt::format("'{}' and '{}' both hold shard {}", there->second, dir, part.shard.empty() ? "1/1" : part.shard));
    for (const compare::Cell& cell : compare::read_cells(dir).cells) lines += compare::cell_line(cell);
  }
  const int shards = compare::parse_shard(campaign.shard).of;
  campaign.shard.clear();
  make_empty(out);
  write_file(out + "/campaign.json", compare::campaign_json(campaign));
  write_file(out + "/cells.jsonl", lines);
  std::vector<std::string> notes;
  for (int k = 1; k <= shards; ++k)
    if (!folders.contains(k))
      notes.push_back(fmt::format("shard {}/{} is missing: its cells are not in the report", k, shards));
  return notes;
}

}  // namespace perp::app

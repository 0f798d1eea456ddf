// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The report of a campaign: DIR/report.html and the numbers beside it, made from DIR/campaign.json and
/// DIR/cells.jsonl.
#include <string>

#include "app/program/files.hpp"

namespace perp::app {

/// Throws InputError if one of a campaign's files in DIR, those that write_report() makes among them, is one of these
/// or another one of them, by whatever names.
void check_campaign_files(const std::string& dir, std::span<const FileUse> inputs);

/// Writes DIR/report.html, cells.csv, cells.json, outcomes.csv and the files of app/comparison_report/files.hpp, each
/// as a whole or not at all, and none of them where one cannot be written. The findings come back, "topic: sentences"
/// each. Throws InputError naming what cannot be read or written.
std::vector<std::string> write_report(const std::string& dir);

/// Makes OUT a campaign of the shards in these folders. Throws InputError if they are not of one campaign, one of them
/// is there twice, OUT is not empty, or a file cannot be read or written. Sentences about shards that are missing come
/// back.
std::vector<std::string> join_shards(const std::vector<std::string>& dirs, const std::string& out);

struct ReportRequest {
  std::vector<std::string> dirs{};  ///< a campaign, or the shards of one
  std::string out{};                ///< where shards are joined; "" for one campaign
};
/// `perp report DIR...`: an exit code.
int report_campaign(const ReportRequest& request, Streams streams);

}  // namespace perp::app

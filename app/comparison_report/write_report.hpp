#pragma once
/// The report of a campaign: DIR/report.html and the numbers beside it, made from DIR/campaign.json and
/// DIR/cells.jsonl.
#include <string>

#include "app/program.hpp"

namespace perp::app {

/// Writes DIR/report.html, cells.csv, cells.json, outcomes.csv and the files of app/comparison_report/files.hpp, each
/// as a whole or not at all. The findings come back, "topic: sentences" each. Throws InputError naming what cannot be
/// read or written.
std::vector<std::string> write_report(const std::string& dir);

/// `perp report DIR`: an exit code.
int report_campaign(const std::string& dir, Streams streams);

}  // namespace perp::app

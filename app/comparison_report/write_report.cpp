// SPDX-License-Identifier: Apache-2.0
#include "app/comparison_report/write_report.hpp"

#include <fmt/format.h>

#include <ostream>

#include "app/comparison_report/files.hpp"
#include "app/findings/findings.hpp"

namespace perp::app {

namespace {

/// Every file with its path. Cells are sorted as cells.jsonl's reader sorts them; cells that are not of the campaign do
/// not come into any file.
std::vector<std::pair<std::string, std::string>> report_files(const std::string& dir,
                                                              const comparison::ReportParts& parts) {
  const auto cells = parts.data.cells();
  std::vector<std::pair<std::string, std::string>> files = comparison::data_files(parts);
  files.emplace_back("cells.csv", compare::cells_csv(cells));
  files.emplace_back("cells.json", compare::cells_json(cells));
  files.emplace_back("outcomes.csv", compare::outcomes_csv(cells));
  files.emplace_back("report.html", comparison::page(parts));
  for (auto& [path, content] : files) path = fmt::format("{}/{}", dir, path);
  return files;
}

}  // namespace

void check_campaign_files(const std::string& dir, std::span<const FileUse> inputs) {
  std::vector<FileUse> outputs;
  for (const char* name :
       {"lock", "campaign.json", "cells.jsonl", "cells.csv", "cells.json", "outcomes.csv", "methods.csv", "pairs.csv",
        "profiles.csv", "summary.csv", "robustness.csv", "unsolvable.csv", "false_claims.csv", "curves.csv",
        "findings.txt", "report.json", "report.html"})
    outputs.push_back({"", fmt::format("{}/{}", dir, name)});
  check_apart(outputs, inputs);
}

std::vector<std::string> write_report(const std::string& dir) {
  check_campaign_files(dir, {});
  const comparison::CampaignData data = comparison::read_data(dir);
  comparison::ReportParts parts{.data = data, .comparisons = comparison::comparisons(data)};
  parts.findings = comparison::findings(data, parts.comparisons);
  write_files(report_files(dir, parts));
  std::vector<std::string> findings;
  for (const comparison::Finding& finding : parts.findings)
    findings.push_back(fmt::format("{}: {}", finding.topic, finding.text));
  return findings;
}

int report_campaign(const ReportRequest& request, Streams streams) {
  try {
    if (request.dirs.size() > 1 && request.out.empty()) throw InputError("--out DIR says where the shards are joined");
    if (!request.out.empty())
      for (const std::string& note : join_shards(request.dirs, request.out))
        streams.err << "perp: note: " << note << '\n';
    const std::string& dir = request.out.empty() ? request.dirs.front() : request.out;
    for (const std::string& sentence : write_report(dir)) streams.out << sentence << '\n';
    streams.out << fmt::format("{}/report.html\n", dir);
    return exit_solved;
  } catch (const InputError& error) {
    return say_refused(streams, error.what());
  }
}

}  // namespace perp::app

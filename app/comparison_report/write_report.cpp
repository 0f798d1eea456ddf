#include "app/comparison_report/write_report.hpp"

#include <fmt/format.h>

#include <ostream>

#include "app/comparison_report/files.hpp"
#include "app/comparison_report/findings.hpp"
#include "app/json.hpp"

namespace perp::app {

namespace {

/// Sorted as cells.jsonl's reader sorts them; cells that are not of the campaign do not come into any file.
void write_cells(const std::string& dir, const comparison::CampaignData& data) {
  write_file(dir + "/cells.csv", compare::cells_csv(data.cells()));
  write_file(dir + "/cells.json", compare::cells_json(data.cells()));
  write_file(dir + "/outcomes.csv", compare::outcomes_csv(data.cells()));
}

}  // namespace

std::vector<std::string> write_report(const std::string& dir) {
  const comparison::CampaignData data = comparison::read_data(dir);
  comparison::ReportParts parts{.data = data, .comparisons = comparison::comparisons(data)};
  parts.findings = comparison::findings(data, parts.comparisons);
  write_cells(dir, data);
  for (const auto& [name, content] : comparison::data_files(parts))
    write_file(fmt::format("{}/{}", dir, name), content);
  write_file(dir + "/report.html", comparison::page(parts));
  std::vector<std::string> findings;
  for (const comparison::Finding& finding : parts.findings)
    findings.push_back(fmt::format("{}: {}", finding.topic, finding.text));
  return findings;
}

int report_campaign(const std::string& dir, Streams streams) {
  try {
    for (const std::string& sentence : write_report(dir)) streams.out << sentence << '\n';
    streams.out << fmt::format("{}/report.html\n", dir);
    return exit_solved;
  } catch (const InputError& error) {
    streams.err << "perp: " << error.what() << '\n';
    return exit_input;
  }
}

}  // namespace perp::app

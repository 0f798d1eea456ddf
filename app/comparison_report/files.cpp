// SPDX-License-Identifier: Apache-2.0
#include "app/comparison_report/files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/findings/robustness.hpp"
#include "app/findings/summary.hpp"
#include "app/text/csv.hpp"
#include "app/text/json_fields.hpp"

namespace perp::app::comparison {

namespace {

/// A table with the columns' names; each value is text, a number or null.
struct Records {
  std::vector<std::string> columns;
  std::vector<std::vector<Json>> rows{};
};

std::string csv(const Records& records) {
  std::string text = csv_row(records.columns);
  for (const auto& row : records.rows) text += csv_row(row, field_text);
  return text;
}

Json json(const Records& records) {
  Json array = Json::array();
  for (const auto& row : records.rows) {
    Json object;
    for (std::size_t k = 0; k < row.size(); ++k) object[records.columns[k]] = row[k];
    array.push_back(std::move(object));
  }
  return array;
}

const char* yes_no(bool value) { return value ? "yes" : "no"; }
bool contains(const std::vector<std::size_t>& values, std::size_t value) {
  return std::ranges::find(values, value) != values.end();
}

Records methods(const ReportParts& parts) {
  Records records{{"method", "name", "options", "external", "cfunction"}};
  for (const Comparison& comparison : parts.comparisons) records.columns.push_back(comparison.id);
  for (std::size_t m = 0; m < parts.data.methods().size(); ++m) {
    const compare::AskedMethod& method = parts.data.methods()[m];
    const std::string given = given_cfunction(method);
    records.rows.push_back({method.label, method.name, fmt::format("{}", fmt::join(method.options, " ")),
                            yes_no(method.external()), given.empty() ? cfunction_in_force(method) : given});
    for (const Comparison& comparison : parts.comparisons)
      records.rows.back().emplace_back(yes_no(contains(comparison.methods, m)));
  }
  return records;
}

Records pairs(const ReportParts& parts) {
  const CampaignData& data = parts.data;
  Records records{{"problem", "start", "class", "n", "nonzeros", "solvable"}};
  for (const Comparison& comparison : parts.comparisons) records.columns.push_back(comparison.id);
  for (std::size_t p = 0; p < data.pairs().size(); ++p) {
    const compare::AskedProblem& problem = data.problem(p);
    records.rows.push_back(
        {problem.name, data.pairs()[p].start, problem.cls, problem.n, problem.nonzeros, yes_no(problem.solvable())});
    for (const Comparison& comparison : parts.comparisons)
      records.rows.back().emplace_back(yes_no(contains(comparison.pairs, p)));
  }
  return records;
}

void add_profile(const Comparison& comparison, const char* kind, Measure measure, const std::string& method,
                 const Profile& profile, Records& records) {
  const auto add = [&](const Json& x, std::size_t count) {
    records.rows.push_back({comparison.id, kind, column(measure), method, x, count, profile.problems});
  };
  for (const Step& step : profile.steps) add(step.x, step.count);
  if (profile.steps.empty()) add("inf", 0);
}

Records profiles(const ReportParts& parts) {
  Records records{{"comparison", "kind", "cost", "method", "x", "count", "of"}};
  for (const Comparison& comparison : parts.comparisons)
    for (const MeasureProfiles& of : comparison.profiles)
      for (std::size_t k = 0; k < of.methods.size(); ++k) {
        const std::string& label = parts.data.label(of.methods[k]);
        add_profile(comparison, "performance", of.measure, label, of.performance[k], records);
        add_profile(comparison, "data", of.measure, label, of.data[k], records);
      }
  return records;
}

Records summaries(const ReportParts& parts) {
  Records records{{"comparison", "method", "solved", "pairs", "with_restarts", "quickest", "within_two", "fewest_F",
                   "common", "mean_iterations", "mean_F_evals", "mean_factorizations", "mean_seconds"}};
  for (const Comparison& comparison : parts.comparisons) {
    const Summary all = summary(parts.data, comparison);
    for (const SummaryRow& row : all.rows)
      records.rows.push_back({comparison.id, parts.data.label(row.method), row.solved, all.pairs, row.after,
                              row.quickest, row.within_two, row.fewest_F, all.common, json_known(row.iterations),
                              json_known(row.F_evals), json_known(row.factorizations), json_known(row.seconds)});
  }
  return records;
}

Records robustness_records(const ReportParts& parts) {
  Records records{{"method", "class", "pairs", "failures", "after_restarts"}};
  const Robustness all = robustness(parts.data);
  for (const RobustnessRow& row : all.rows) {
    const std::string& label = parts.data.label(row.method);
    for (std::size_t c = 0; c < all.classes.size(); ++c)
      records.rows.push_back(
          {label, all.classes[c], row.by_class[c].pairs, row.by_class[c].failures, row.by_class[c].after});
    records.rows.push_back({label, "total", row.total.pairs, row.total.failures, row.total.after});
  }
  return records;
}

Records unsolvable_records(const ReportParts& parts) {
  Records records{{"method", "infeasible", "honest", "wrong", "broken", "not_applicable", "unfinished"}};
  for (const UnsolvableRow& row : unsolvable(parts.data))
    records.rows.push_back({parts.data.label(row.method), row.infeasible, row.honest, row.wrong, row.broken,
                            row.not_applicable, row.unfinished});
  return records;
}

Records curves(const ReportParts& parts) {
  Records records{{"method", "problem", "start", "point", "natural"}};
  for (const Cell& cell : parts.data.cells())
    for (std::size_t k = 0; k < cell.curve.size(); ++k)
      records.rows.push_back({cell.method, cell.problem, cell.start, k, json_known(cell.curve[k])});
  return records;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> data_files(const ReportParts& parts) {
  const Records all_profiles = profiles(parts), all_summaries = summaries(parts), rows = robustness_records(parts),
                without = unsolvable_records(parts);
  std::vector<Cell> claims;
  std::ranges::copy_if(parts.data.cells(), std::back_inserter(claims), false_claim);
  Json whole = json_header(Document::Report);
  whole["date"] = parts.data.campaign().date;
  whole["findings"] = Json::array();
  std::string sentences;
  for (const Finding& finding : parts.findings) {
    whole["findings"].push_back({{"topic", finding.topic}, {"text", finding.text}});
    sentences += fmt::format("{}: {}\n", finding.topic, finding.text);
  }
  whole["robustness"] = json(rows);
  whole["unsolvable"] = json(without);
  whole["summary"] = json(all_summaries);
  whole["profiles"] = json(all_profiles);
  return {{"methods.csv", csv(methods(parts))},
          {"pairs.csv", csv(pairs(parts))},
          {"profiles.csv", csv(all_profiles)},
          {"summary.csv", csv(all_summaries)},
          {"robustness.csv", csv(rows)},
          {"unsolvable.csv", csv(without)},
          {"false_claims.csv", compare::cells_csv(claims)},
          {"curves.csv", csv(curves(parts))},
          {"findings.txt", sentences},
          {"report.json", whole.dump(1, ' ', false, Json::error_handler_t::replace) + "\n"}};
}

}  // namespace perp::app::comparison

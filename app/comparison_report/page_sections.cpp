// SPDX-License-Identifier: Apache-2.0
/// The report's sections that are tables and charts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/comparison_report/html.hpp"
#include "app/comparison_report/page.hpp"
#include "app/comparison_report/profile_chart.hpp"
#include "app/findings/findings.hpp"
#include "app/findings/robustness.hpp"
#include "app/findings/summary.hpp"

namespace perp::app::comparison {

namespace {

HtmlCell count_cell(std::size_t count) { return {.text = fmt::format("{}", count), .css = count == 0 ? "none" : ""}; }

HtmlCell number_cell(double value, const char* format = "{:.3g}") {
  if (!std::isfinite(value)) return {.text = "-", .css = "none"};
  return {.text = fmt::format(fmt::runtime(format), value), .key = fmt::format("{}", value)};
}

HtmlCell failures_cell(const Failures& failures, const char* css) {
  HtmlCell cell{.text = text(failures), .css = css};
  if (failures.pairs > 0) {
    // Sorts by failures, then by those after restarts.
    const double after = static_cast<double>(failures.after) / static_cast<double>(failures.pairs + 1);
    cell.key = fmt::format("{}", static_cast<double>(failures.failures) + after);
    cell.tip = fmt::format("{} solved", share_words(failures.solved(), failures.pairs));
  }
  if (failures.pairs == 0 || failures.failures == 0) cell.css += cell.css.empty() ? "none" : " none";
  return cell;
}

std::string residual_text(double natural) { return std::isnan(natural) ? "no point" : fmt::format("{:.1e}", natural); }

/// Comparisons of C-functions and of the systems of 1997 have colours of their own, so that they differ most; the other
/// charts share theirs.
std::size_t style_in(const Comparison& comparison, std::size_t position, const std::vector<std::size_t>& shared) {
  const bool own = comparison.id.starts_with("cfunctions") || comparison.id == "lecture";
  return own ? position : shared[comparison.methods[position]];
}

std::string chart(const CampaignData& data, const Comparison& comparison, const MeasureProfiles& profiles, bool ratios,
                  const std::vector<std::size_t>& styles) {
  const std::string_view cost = words(profiles.measure);
  const bool units = profiles.measure == Measure::FEvals;
  const std::string unit = units                                  ? "(n + 1) evaluations of F"
                           : profiles.measure == Measure::Seconds ? "seconds"
                                                                  : "factorizations";
  ChartAxes axes{.title = ratios ? fmt::format("Performance profile: {}", cost) : fmt::format("Data profile: {}", cost),
                 .x = ratios ? fmt::format("tau: within tau times the least {}",
                                           profiles.measure == Measure::Seconds ? "time" : "number")
                             : fmt::format("alpha: budget in {}", unit),
                 .ratios = ratios};
  const std::vector<bool> coloured = in_colour(data, comparison);
  std::vector<ChartCurve> curves;
  for (std::size_t k = 0; k < profiles.methods.size(); ++k) {
    const std::size_t m = profiles.methods[k];
    const auto position =
        static_cast<std::size_t>(std::ranges::find(comparison.methods, m) - comparison.methods.begin());
    curves.push_back(
        {.id = fmt::format("{}-{}-{}-m{}", comparison.id, column(profiles.measure), ratios ? "rho" : "d", m),
         .label = name_in(data, comparison, m),
         .style = style_in(comparison, position, styles),
         .muted = !coloured[m],
         .profile = ratios ? profiles.performance[k] : profiles.data[k]});
  }
  return "<div>" + profile_chart(axes, curves) + "</div>\n";
}

std::string legend(const CampaignData& data, const Comparison& comparison, const std::vector<std::size_t>& styles) {
  const std::vector<bool> coloured = in_colour(data, comparison);
  std::string html = "<ul class=\"legend\" aria-label=\"Curves shown in colour\">\n";
  for (std::size_t k = 0; k < comparison.methods.size(); ++k)
    html += fmt::format("<li><button type=\"button\" aria-pressed=\"{}\" data-curve=\"m{}\">{}{}</button></li>\n",
                        bool{coloured[comparison.methods[k]]}, comparison.methods[k],
                        line_sample(style_in(comparison, k, styles)),
                        html_text(name_in(data, comparison, comparison.methods[k])));
  return html + "</ul>\n";
}

std::string panes(const CampaignData& data, const Comparison& comparison, const std::vector<std::size_t>& styles) {
  std::string html = "<div class=\"tabs\">\n";
  for (std::size_t k = 0; k < measures.size(); ++k)
    html += fmt::format(
        "<input type=\"radio\" class=\"t{0}\" name=\"{1}-cost\" id=\"{1}-cost{0}\"{2}/>"
        "<label for=\"{1}-cost{0}\">{3}</label>\n",
        k, comparison.id, k == 0 ? " checked=\"checked\"" : "", words(measures[k]));
  for (std::size_t k = 0; k < measures.size(); ++k) {
    const MeasureProfiles& profiles = comparison.profiles[k];
    html +=
        fmt::format("<div class=\"pane p{}\">\n<div class=\"charts\">\n{}{}</div>\n", k,
                    chart(data, comparison, profiles, true, styles), chart(data, comparison, profiles, false, styles));
    if (!profiles.left_out.empty()) {
      std::vector<std::string> names;
      for (const std::size_t m : profiles.left_out) names.push_back(data.label(m));
      html += fmt::format("<p class=\"note\">Left out, as this cost of theirs is not known: {}.</p>\n",
                          html_text(fmt::format("{}", fmt::join(names, ", "))));
    }
    html += "</div>\n";
  }
  return html + "</div>\n";
}

std::string summary_table(const CampaignData& data, const Comparison& comparison) {
  const Summary all = summary(data, comparison);
  HtmlTable table(fmt::format("{}: in numbers", comparison.title),
                  {{.header = comparison.id.starts_with("cfunctions") ? "C-function" : "method", .number = false},
                   {.header = "solved", .tip = "pairs"},
                   {.header = "share"},
                   {.header = "with restarts", .tip = "pairs solved by the run or one of its restarts"},
                   {.header = "quickest", .tip = "pairs on which no method takes less time: rho(1)"},
                   {.header = "within 2x", .tip = "pairs on which it takes at most twice the least time: rho(2)"},
                   {.header = "fewest F", .tip = "pairs on which no method evaluates F less often"},
                   {.header = "iterations*"},
                   {.header = "F*"},
                   {.header = "factorizations*"},
                   {.header = "seconds*"}});
  for (const SummaryRow& row : all.rows)
    table.add({{.text = name_in(data, comparison, row.method)},
               count_cell(row.solved),
               {.text = percent(row.solved, all.pairs), .key = fmt::format("{}", row.solved)},
               count_cell(row.after),
               count_cell(row.quickest),
               count_cell(row.within_two),
               count_cell(row.fewest_F),
               number_cell(row.iterations),
               number_cell(row.F_evals),
               number_cell(row.factorizations),
               number_cell(row.seconds, "{:.2g}")});
  return table.html() +
         fmt::format(
             "<p class=\"note\">Of {}. * geometric mean over the {} that all methods with a mean solve, which are "
             "those that solve at least three quarters of what the best solves; what is below 1 counts as 1, times "
             "below 1 ms as 1 ms.</p>\n",
             counted(all.pairs, "pair"), counted(all.common, "pair"));
}

}  // namespace

std::string false_claims_section(const CampaignData& data) {
  HtmlTable table("False claims", {{.header = "method", .number = false},
                                   {.header = "problem", .number = false},
                                   {.header = "start"},
                                   {.header = "what it is", .number = false},
                                   {.header = "it said", .number = false},
                                   {.header = "judge's residual"},
                                   {.header = "message", .number = false}});
  std::size_t converged = 0, infeasible = 0;
  for (const Cell& cell : data.cells()) {
    if (!false_claim(cell)) continue;
    ++(cell.outcome == Outcome::FalseConvergence ? converged : infeasible);
    table.add({{.text = cell.method},
               {.text = cell.problem},
               {.text = fmt::format("{}", cell.start)},
               {.text = std::string(to_string(cell.outcome)), .css = "bad"},
               {.text = cell.status},
               {.text = residual_text(cell.natural), .key = fmt::format("{}", cell.natural)},
               {.text = cell.message}});
  }
  if (converged + infeasible == 0)
    return data.cells().empty()
               ? ""
               : "<div class=\"fine\" id=\"false-claims\"><p>No false claims: no cell says solved where the "
                 "judge says no, none says infeasible where a solution is known.</p></div>\n";
  const std::string head = fmt::format(
      "<strong>\u26a0 False claims:</strong> {} solved where the judge's residual is above the tolerance, "
      "{} infeasible although a solution is known.",
      counted(converged, "cell says", "cells say"), counted(infeasible, "says", "say"));
  return fmt::format("<div class=\"alarm\" id=\"false-claims\" role=\"alert\"><p>{}</p>\n{}</div>\n", head,
                     table.html());
}

std::string robustness_section(const CampaignData& data) {
  const Robustness all = robustness(data);
  const bool inapplicable =
      std::ranges::any_of(all.rows, [](const RobustnessRow& row) { return row.not_applicable > 0; });
  const bool unfinished = std::ranges::any_of(all.rows, [](const RobustnessRow& row) { return row.unfinished > 0; });
  std::vector<HtmlColumn> columns{{.header = "method", .number = false}, {.header = "total"}, {.header = "solved"}};
  std::vector<HtmlCell> pairs{{.text = "pairs"}, {.text = fmt::format("{}", data.pairs(true))}, {}};
  for (std::size_t c = 0; c < all.classes.size(); ++c) {
    columns.push_back({.header = all.classes[c]});
    pairs.push_back({.text = fmt::format("{}", all.pairs[c])});
  }
  if (inapplicable) columns.push_back({.header = "not for it", .tip = "pairs that the method does not apply to"});
  if (unfinished) columns.push_back({.header = "unfinished"});
  pairs.resize(columns.size());
  HtmlTable table("Failures by method and class; in parentheses: left after restarts", columns);
  for (const RobustnessRow& row : all.rows) {
    const Failures& total = row.total;
    std::vector<HtmlCell> cells{
        {.text = data.label(row.method)},
        failures_cell(total, "total"),
        {.text = percent(total.solved(), total.pairs), .key = fmt::format("{}", total.share())}};
    for (const Failures& failures : row.by_class) cells.push_back(failures_cell(failures, ""));
    if (inapplicable) cells.push_back(count_cell(row.not_applicable));
    if (unfinished) cells.push_back(count_cell(row.unfinished));
    table.add(std::move(cells));
  }
  table.foot(std::move(pairs));
  const int restarts = data.campaign().restarts;
  const std::string how = restarts > 0 ? fmt::format("After a failure a method starts again from up to {}.",
                                                     counted(static_cast<std::size_t>(restarts), "perturbed point"))
                                       : "This campaign had no restarts, so that both numbers are the same.";
  return fmt::format(
      "<section id=\"robustness\"><h2>Robustness</h2>\n<p>Pairs of a problem that has a solution and a start which a "
      "method "
      "did not solve, as Billups, Dirkse &amp; Ferris (1997) print them: 3 (1) are three failures from the published "
      "starts, one of them still after restarts. {} A point that is a solution but was not claimed as one counts as a "
      "failure. Shares are of the pairs a method applies to.</p>\n{}</section>\n",
      how, table.html("dense"));
}

std::string unsolvable_section(const CampaignData& data) {
  const std::vector<UnsolvableRow> rows = unsolvable(data);
  if (rows.empty()) return "";
  const bool inapplicable = std::ranges::any_of(rows, [](const UnsolvableRow& row) { return row.not_applicable > 0; });
  const bool unfinished = std::ranges::any_of(rows, [](const UnsolvableRow& row) { return row.unfinished > 0; });
  std::vector<HtmlColumn> columns{
      {.header = "method", .number = false},
      {.header = "infeasible", .tip = "says that there is none: best"},
      {.header = "honest", .tip = "says that it has not solved it, or came to a limit: right"},
      {.header = "wrong", .tip = "claims a solution"},
      {.header = "broken", .tip = "crashed, or wrote garbage"}};
  if (inapplicable) columns.push_back({.header = "not for it", .tip = "pairs that the method does not apply to"});
  if (unfinished) columns.push_back({.header = "unfinished"});
  HtmlTable table("Problems without a solution: how the runs ended", columns);
  for (const UnsolvableRow& row : rows) {
    HtmlCell wrong = count_cell(row.wrong);
    if (row.wrong > 0) wrong.css = "bad";
    std::vector<HtmlCell> cells{{.text = data.label(row.method)},
                                count_cell(row.infeasible),
                                count_cell(row.honest),
                                wrong,
                                count_cell(row.broken)};
    if (inapplicable) cells.push_back(count_cell(row.not_applicable));
    if (unfinished) cells.push_back(count_cell(row.unfinished));
    table.add(std::move(cells));
  }
  std::string proven;
  for (const compare::AskedProblem& problem : data.campaign().problems)
    if (!problem.denied_by.empty())
      proven += fmt::format("{}{} (by {})", proven.empty() ? " Not known before, proven in this campaign: " : ", ",
                            html_text(problem.name), html_text(problem.denied_by));
  return fmt::format(
      "<section id=\"unsolvable\"><h2>Problems without a solution</h2>\n<p>{}. The best answer is that there "
      "is no solution; any other end that does not claim one is right, too.{}</p>\n{}</section>\n",
      counted(data.pairs(false), "pair"), proven.empty() ? "" : proven + '.', table.html());
}

std::string comparison_section(const CampaignData& data, const Comparison& comparison,
                               const std::vector<std::size_t>& styles) {
  std::string html =
      fmt::format("<section id=\"{}\" class=\"comparison\"><h3>{}</h3>\n<p class=\"note\">{} {}.", comparison.id,
                  html_text(comparison.title), html_text(comparison.note), counted(comparison.pairs.size(), "pair"));
  if (comparison.unfinished > 0)
    html +=
        fmt::format(" {} left out, as not every method has finished {}.",
                    counted(comparison.unfinished, "pair is", "pairs are"), comparison.unfinished == 1 ? "it" : "them");
  html += "</p>\n";
  if (comparison.pairs.empty()) return html + "<p>Nothing to compare yet.</p></section>\n";
  const auto coloured = static_cast<std::size_t>(std::ranges::count(in_colour(data, comparison), true));
  if (comparison.methods.size() > coloured)
    html += fmt::format(
        "<p class=\"note screen\">In colour {}; press a name to change that, rest on it to bring it out.</p>\n",
        comparison.subject.empty() ? "the eight that solve most" : "those of either kind that solve most");
  return html + legend(data, comparison, styles) + panes(data, comparison, styles) +
         (comparison.id.starts_with("cfunctions") ? parameter_chart(data, comparison) : "") +
         summary_table(data, comparison) + "</section>\n";
}

}  // namespace perp::app::comparison

// SPDX-License-Identifier: Apache-2.0
#include "app/contact/compare/variants_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <ostream>

#include "app/campaign/campaign.hpp"
#include "app/comparison_report/html.hpp"
#include "app/comparison_report/page.hpp"
#include "app/comparison_report/profile_chart.hpp"
#include "app/contact/run/report.hpp"
#include "app/text/plot_layout.hpp"
#include "app/text/table.hpp"

namespace perp::app::contacts {

namespace {

using comparison::HtmlCell;
using comparison::HtmlTable;

constexpr double least_time = 1e-6;  // s; below it times are noise

double geometric_median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : std::sqrt(values[middle - 1] * values[middle]);  // geometric
}

std::string text_of(double value, int digits) { return std::isnan(value) ? "" : number(value, digits); }

/// What a variant did on all problems.
struct Line {
  std::string variant;
  bool exact = true;
  int cells = 0, solved = 0, infeasible = 0, failed = 0, time = 0, broken = 0, not_applicable = 0;
  double seconds = 0;                // in all, what was not solved counted as the limit
  std::map<std::string, int> by{};   // how many each step solved
  double iterations = std::nan("");  // median of the solved
  double error = std::nan("");       // of Coulomb's law, median of the solved
  double worst = std::nan("");
};

std::vector<Line> lines(const Comparison& comparison) {
  std::vector<Line> all;
  for (const std::string& variant : comparison.variants) {
    Line line{.variant = variant};
    std::vector<double> iterations, errors;
    for (const Cell& cell : comparison.cells) {
      if (cell.variant != variant) continue;
      line.exact = cell.exact;
      ++line.cells;
      const bool answered = cell.solved() || cell.outcome == Outcome::Infeasible;
      line.seconds += answered ? cell.seconds : comparison.time_limit;
      switch (cell.outcome) {
        case Outcome::Solved:
          ++line.solved;
          if (!cell.solved_by.empty()) ++line.by[cell.solved_by];
          iterations.push_back(std::max(1.0, static_cast<double>(cell.iterations)));
          errors.push_back(std::max(1e-300, cell.siconos));
          break;
        case Outcome::Infeasible:
          ++line.infeasible;
          break;
        case Outcome::TimeLimit:
          ++line.time;
          break;
        case Outcome::Crashed:
        case Outcome::MemoryLimit:
          ++line.broken;
          break;
        case Outcome::NotApplicable:
          ++line.not_applicable;
          break;
        default:
          ++line.failed;
      }
    }
    line.iterations = geometric_median(iterations);
    line.error = geometric_median(errors);
    if (!errors.empty()) line.worst = std::ranges::max(errors);
    all.push_back(line);
  }
  return all;
}

/// "sweeps 17, newton 11", the most first.
std::string by_text(const std::map<std::string, int>& by) {
  std::vector<std::pair<std::string, int>> all(by.begin(), by.end());
  std::ranges::stable_sort(all, std::ranges::greater{}, &std::pair<std::string, int>::second);
  std::string text;
  for (const auto& [step, n] : all) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", step, n);
  return text;
}

std::vector<std::string> cells_of(const Line& line) {
  return {line.variant,
          line.exact ? "Coulomb" : "its own",
          fmt::format("{}/{}", line.solved, line.cells),
          by_text(line.by),
          fmt::format("{}", line.infeasible),
          fmt::format("{}", line.failed),
          fmt::format("{}", line.time),
          fmt::format("{}", line.broken),
          fmt::format("{}", line.not_applicable),
          seconds_text(line.seconds),
          text_of(line.iterations, 3),
          text_of(line.error, 2),
          text_of(line.worst, 2)};
}

constexpr std::array<std::pair<const char*, const char*>, 13> columns{
    {{"variant", "formulation+method/form"},
     {"judged by", "the law whose residual decides"},
     {"solved", "of the cells that ran"},
     {"solved by", "the step that made the accepted point"},
     {"infeasible", "proven to have no solution"},
     {"failed", "the method gave up, or its point is no solution"},
     {"time limit", ""},
     {"broken", "crashed, or beyond the limit of memory"},
     {"not applicable", ""},
     {"time in all", "what was neither solved nor proven infeasible counts as the time limit"},
     {"iterations", "median of the solved"},
     {"exact-law error", "Siconos' metric of Coulomb's law, median of the solved"},
     {"largest", "of those errors"}}};

std::string_view short_outcome(Outcome outcome) {
  return outcome == Outcome::Failed        ? "failed"
         : outcome == Outcome::TimeLimit   ? "limit"
         : outcome == Outcome::MemoryLimit ? "memory"
         : outcome == Outcome::Crashed     ? "CRASH"
         : outcome == Outcome::Infeasible  ? "infeasible"
                                           : "n/a";
}

std::string base(const std::string& problem) { return std::filesystem::path(problem).filename(); }

int contacts_of(const Comparison& comparison, const std::string& problem) {
  int contacts = -1;
  for (const Cell& cell : comparison.cells)
    if (cell.problem == problem) contacts = std::max(contacts, cell.contacts);
  return contacts;
}

/// The chart of the variants that `takes` names.
std::string chart(const Comparison& comparison, const std::string& title, bool exact_only) {
  comparison::Costs costs;
  std::vector<comparison::ChartCurve> curves;
  const std::vector<Line> all = lines(comparison);
  for (std::size_t s = 0; s < all.size(); ++s) {
    if (exact_only && !all[s].exact) continue;
    std::vector<double> row;
    for (const std::string& problem : comparison.problems) {
      const Cell* cell = comparison.find(all[s].variant, problem);
      row.push_back(cell != nullptr && cell->solved() ? std::max(least_time, cell->seconds)
                                                      : std::numeric_limits<double>::infinity());
    }
    costs.push_back(std::move(row));
    curves.push_back({.id = fmt::format("c{}-{}", exact_only ? 1 : 0, s),
                      .label = all[s].variant + (all[s].exact ? "" : " *"),
                      .style = s});
  }
  const auto profiles = comparison::performance_profiles(costs);
  for (std::size_t k = 0; k < curves.size(); ++k) curves[k].profile = profiles[k];
  return comparison::profile_chart({.title = title, .x = "solve time over the best one's (tau)", .ratios = true},
                                   curves);
}

bool has(const Comparison& comparison, bool exact) {
  return std::ranges::any_of(lines(comparison), [&](const Line& line) { return line.exact == exact; });
}

std::string summary_table(const Comparison& comparison) {
  std::vector<comparison::HtmlColumn> heads;
  for (std::size_t k = 0; k < columns.size(); ++k) heads.push_back({columns[k].first, columns[k].second, k > 1});
  HtmlTable table("", std::move(heads));
  for (const Line& line : lines(comparison)) {
    std::vector<HtmlCell> row;
    for (const std::string& text : cells_of(line)) row.push_back({.text = text});
    table.add(std::move(row));
  }
  return table.html();
}

std::string cells_table(const Comparison& comparison) {
  std::vector<comparison::HtmlColumn> heads{{"problem", "", false}, {"contacts", "", true}};
  for (const std::string& variant : comparison.variants) heads.push_back({variant, "", true});
  HtmlTable table("Time of the solve; where the law is not Coulomb's, the error of Coulomb's law below it.", heads);
  for (const std::string& problem : comparison.problems) {
    const int n = contacts_of(comparison, problem);
    std::vector<HtmlCell> row{{.text = base(problem)}, {.text = n < 0 ? "" : fmt::format("{}", n)}};
    double best = std::numeric_limits<double>::infinity();
    for (const std::string& variant : comparison.variants)
      if (const Cell* cell = comparison.find(variant, problem); cell != nullptr && cell->solved() && cell->exact)
        best = std::min(best, cell->seconds);
    for (const std::string& variant : comparison.variants) {
      const Cell* cell = comparison.find(variant, problem);
      if (cell == nullptr) {
        row.push_back({.text = "not run", .css = "soft"});
      } else if (!cell->solved()) {
        row.push_back({.text = std::string(short_outcome(cell->outcome)), .css = "bad", .tip = cell->message});
      } else {
        std::string text = comparison::html_text(seconds_text(cell->seconds));
        if (!cell->exact) text += fmt::format("<br><span class=\"soft\">{}</span>", number(cell->siconos, 2));
        row.push_back({.text = text,
                       .key = number(cell->seconds, 17),
                       .css = cell->exact && cell->seconds <= best ? "best" : "",
                       .raw = true,
                       .tip = cell->message});
      }
    }
    table.add(std::move(row));
  }
  return table.html();
}

}  // namespace

const Cell* Comparison::find(const std::string& variant, const std::string& problem) const {
  const auto cell =
      std::ranges::find_if(cells, [&](const Cell& c) { return c.variant == variant && c.problem == problem; });
  return cell == cells.end() ? nullptr : &*cell;
}

void print_comparison(std::ostream& out, const Comparison& comparison) {
  std::vector<Column> heads;
  for (std::size_t k = 0; k < columns.size(); ++k)
    heads.push_back({columns[k].first, k > 1 ? Align::Right : Align::Left});
  Table summary(std::move(heads));
  for (const Line& line : lines(comparison)) summary.add(cells_of(line));
  summary.print(out);
  out << "\nTimes; [1], [2], ... are the variants in the order above\n";
  heads = {"problem", ">contacts"};
  for (std::size_t k = 0; k < comparison.variants.size(); ++k)
    heads.push_back({fmt::format("[{}]", k + 1), Align::Right});
  Table table(std::move(heads));
  for (const std::string& problem : comparison.problems) {
    const int n = contacts_of(comparison, problem);
    std::vector<std::string> row{shortened(base(problem), 36), n < 0 ? "" : fmt::format("{}", n)};
    for (const std::string& variant : comparison.variants) {
      const Cell* cell = comparison.find(variant, problem);
      row.push_back(cell == nullptr  ? "-"
                    : cell->solved() ? seconds_text(cell->seconds)
                                     : std::string(short_outcome(cell->outcome)));
    }
    table.add(std::move(row));
  }
  table.print(out);
  for (const Cell& cell : comparison.cells)
    if (cell.outcome == Outcome::Crashed) out << fmt::format("CRASH: {}: {}\n", cell.command, cell.message);
}

std::string profile_svg(const Comparison& comparison) {
  std::string svg = chart(comparison, "Problems solved within tau times the best time (* by a law of its own)", false);
  const std::size_t at = svg.find("<style>");
  svg.insert(at + 7, comparison::chart_style());
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + svg;
}

std::string report_html(const Comparison& comparison) {
  const compare::Machine machine = compare::Machine::here();
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>Contact problems compared</title><style>{}</style></head><body>\n"
      "<h1>Contact problems: formulations and methods</h1>\n"
      "<p>{} on {}, each run in a process of its own; tolerance {:g}, {:g} s and {} MB a run; perp {}, {}.</p>\n",
      comparison::page_style(), count(static_cast<long long>(comparison.variants.size()), "variant"),
      count(static_cast<long long>(comparison.problems.size()), "problem"), comparison.tol, comparison.time_limit,
      comparison.memory_mb, version_number(), comparison::html_text(machine.cpu));
  page +=
      "<p>glocker and ncp1 are solved when Coulomb's law holds: the natural map of r, relative to max(|q|, |r|, |u|) "
      "(Siconos 4.4) and to |q| (INRIA RR-9118), is at most the tolerance. inner:K, outer:K and frictionless are laws "
      "of "
      "their own; they are solved when the natural residual of their affine problem is at most the tolerance, and what "
      "Coulomb's law says of their impulses stands beside it.</p>\n";
  page += "<h2>Variants</h2>\n" + summary_table(comparison);
  page +=
      "<h2>Performance profiles</h2>\n<p>Share of the problems solved within tau times the best time on each "
      "(Dolan &amp; Mor&eacute; 2002).</p>\n<div class=\"charts\">";
  if (has(comparison, true)) page += "<div>" + chart(comparison, "Coulomb's exact law", true) + "</div>\n";
  if (has(comparison, false))
    page += "<div>" + chart(comparison, "All variants, each by its own law (* not Coulomb's)", false) + "</div>\n";
  page += "</div>\n<h2>Cells</h2>\n" + cells_table(comparison);
  return page + "</body></html>\n";
}

}  // namespace perp::app::contacts

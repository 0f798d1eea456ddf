// SPDX-License-Identifier: Apache-2.0
#include "app/comparison_report/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/comparison_report/html.hpp"
#include "app/findings/findings.hpp"
#include "app/text/json_parts.hpp"
#include "app/worker/external.hpp"

namespace perp::app::comparison {

namespace {

/// Of the charts: first those of the first comparison, in its order, so that they differ most; then the others.
std::vector<std::size_t> styles(const CampaignData& data, const std::vector<Comparison>& comparisons) {
  constexpr auto none = static_cast<std::size_t>(-1);
  std::vector<std::size_t> style(data.methods().size(), none);
  std::size_t next = 0;
  for (const Comparison& comparison : comparisons)
    for (const std::size_t m : comparison.methods)
      if (style[m] == none) style[m] = next++;
  for (std::size_t& s : style)
    if (s == none) s = next++;
  return style;
}

std::string definition(std::string_view term, std::string_view value) {
  return value.empty() ? "" : fmt::format("<dt>{}</dt><dd>{}</dd>\n", html_text(term), html_text(value));
}

std::string machine_words(const compare::Machine& machine) {
  return fmt::format("{}, {}, {} MiB, {}", machine.cpu.empty() ? "unknown processor" : machine.cpu,
                     counted(static_cast<std::size_t>(std::max(0, machine.cores)), "core"), machine.memory_mb,
                     machine.system);
}

/// The one with the most curves worth looking at: {problem, start}.
Json shown_pair(const CampaignData& data) {
  constexpr std::size_t worth = 2;  // points
  std::size_t best = 0, most = 0;
  for (std::size_t p = 0; p < data.pairs().size(); ++p) {
    std::size_t curves = 0;
    for (std::size_t m = 0; m < data.methods().size(); ++m)
      curves += data.at(m, p) != nullptr && data.at(m, p)->curve.size() >= worth ? 1 : 0;
    if (curves > most) best = p, most = curves;
  }
  if (most == 0) return nullptr;
  return {data.pairs()[best].problem, data.pairs()[best].start};
}

Json curve_data(const Cell& cell) {
  Json curve = Json::array();
  for (const double value : cell.curve) {
    constexpr double least = 1e-300, most = 1e300;  // 0 and inf stay on the page
    curve.push_back(std::isnan(value) ? Json(nullptr)
                                      : Json(std::lround(100 * std::log10(std::clamp(value, least, most)))));
  }
  return curve;
}

Json json_count(int count) { return count < 0 ? Json(nullptr) : Json(count); }

std::string cells_section() {
  return R"html(<section id="cells"><h2>Every cell</h2>
<div class="controls needs-script" hidden="hidden">
<label>Search <input type="search" id="cells-search" placeholder="words in any column, e.g. path kojshin" autocomplete="off"/></label>
<label>Outcome <select id="cells-outcome"><option value="">all</option></select></label>
<label>Class <select id="cells-class"><option value="">all</option></select></label>
<label>Rows <select id="cells-rows"><option>100</option><option>1000</option><option value="0">all</option></select></label>
</div>
<noscript><p>This table needs JavaScript; cells.csv beside this page has all of it.</p></noscript>
<p class="note" id="cells-count" aria-live="polite"></p>
<div class="scroll" tabindex="0" role="region" aria-label="Every cell"><table>
<thead><tr id="cells-head"></tr></thead><tbody id="cells-body"></tbody></table></div>
<p class="more needs-script" hidden="hidden"><button type="button" id="cells-back">back</button>
<button type="button" id="cells-on">on</button></p>
</section>
)html";
}

std::string convergence_section() {
  return R"html(<section id="convergence"><h2>Convergence</h2>
<div class="controls needs-script" hidden="hidden">
<label>Problem <select id="curve-problem"></select></label>
<label>Start <select id="curve-start"></select></label>
<label>Iterations <select id="curve-length"><option value="">all</option><option value="10">first 10</option>
<option value="25">first 25</option><option value="50">first 50</option><option value="100">first 100</option>
<option value="500">first 500</option></select></label>
</div>
<noscript><p>This chart needs JavaScript; curves.csv beside this page has all of it.</p></noscript>
<p class="note screen">Natural residual of the original problem after each iteration; curves.csv has the numbers.</p>
<ul class="legend needs-script" hidden="hidden" id="curve-methods" aria-label="Methods shown"></ul>
<h4 id="curves-title"></h4>
<div id="curves" class="scroll" tabindex="0" role="region" aria-label="Convergence"></div>
<p class="note" id="curves-note"></p>
</section>
)html";
}

std::string findings_section(const std::vector<Finding>& findings) {
  std::string html = "<div class=\"findings\" id=\"findings\">\n";
  for (const Finding& finding : findings)
    html += fmt::format("<p><b>{}.</b> {}</p>\n", html_text(finding.topic), html_text(finding.text));
  return html + "</div>\n";
}

std::string navigation(const ReportParts& parts) {
  std::string html = R"(<nav aria-label="Sections"><a href="#robustness">Robustness</a>)";
  if (parts.data.pairs(false) > 0) html += "<a href=\"#unsolvable\">Without a solution</a>";
  html += "<a href=\"#profiles\">Profiles</a>";
  if (std::ranges::any_of(parts.comparisons, [](const Comparison& c) { return c.id.starts_with("cfunctions"); }))
    html += "<a href=\"#cfunctions\">C-functions</a>";
  return html +
         "<a href=\"#convergence\">Convergence</a><a href=\"#cells\">Every cell</a><a href=\"#how\">How it was "
         "measured</a></nav>\n";
}

std::string profiles_sections(const ReportParts& parts, const std::vector<std::size_t>& style) {
  std::string html =
      "<section id=\"profiles\"><h2>Profiles</h2>\n<p>Performance profile (Dolan &amp; Mor\u00e9 2002): the share of "
      "pairs "
      "that a method solves within tau times the least cost of all methods shown; at tau = 1, where it is the best, "
      "ties "
      "counting for all; far to the right, what it solves at all. Data profile (Mor\u00e9 &amp; Wild 2009): the share "
      "that "
      "it solves within a budget. Pairs that nobody solved stay in the denominator. Times below 1 ms count as 1 ms, 0 "
      "evaluations or factorizations as 1: below that there is nothing to compare.</p></section>\n";
  bool headed = false;
  for (const Comparison& comparison : parts.comparisons) {
    if (comparison.id.starts_with("cfunctions") && !headed) {
      html +=
          "<section id=\"cfunctions\"><h2>C-functions</h2>\n<p>The same method with one C-function after the other; "
          "'perp cfunctions' has their formulas.</p></section>\n";
      headed = true;
    }
    html += comparison_section(parts.data, comparison, style);
  }
  return html;
}

}  // namespace

std::string method_section(const CampaignData& data) {
  const compare::Campaign& campaign = data.campaign();
  std::string html = "<section id=\"how\"><h2>How it was measured</h2>\n<dl>\n";
  html += definition("when", campaign.date);
  html += definition("program", fmt::format("perp {}", campaign.version));
  html += definition("libraries", fmt::format("{}", fmt::join(campaign.libraries, ", ")));
  html += definition("machine", machine_words(campaign.machine));
  html += definition("command", fmt::format("{}", fmt::join(campaign.command_line, " ")));
  html +=
      definition("tolerance", fmt::format("{:g} on the natural residual of the problem as given, max_i |x_i - mid(l_i, "
                                          "x_i - F_i(x), u_i)|; evaluated outside of the method",
                                          campaign.tol));
  html += definition("limits of a run", fmt::format("{:g} s, {} MiB; each in a process of its own, {} at a time",
                                                    campaign.time_limit, campaign.memory_mb, campaign.jobs));
  html += definition("restarts", fmt::format("{} at most, seed {}", campaign.restarts, campaign.seed));
  html += definition("starts", campaign.starts == 0 ? "all of each problem"
                                                    : fmt::format("at most {} of each problem", campaign.starts));
  for (const compare::AskedMethod& method : campaign.methods)
    if (method.external())
      html += definition("external " + method.label, compare::with_tolerance(method.command, campaign.tol));
  html +=
      "</dl>\n<p>Times, iterations and evaluations are of the run from the start itself, not of restarts; an external "
      "program's time is that of its process. Outcomes: "
      "<b>solved</b> claimed, and the judge agrees; <b>solved-to-rounding</b> not to the tolerance, but as far as "
      "double "
      "arithmetic goes, by the method and the judge: not counted as solved; <b>failed</b> says so itself; "
      "<b>false-convergence</b> claimed, "
      "and "
      "the judge disagrees; <b>unclaimed</b> a solution that the method does not call one; <b>time-limit</b>, "
      "<b>memory-limit</b>, <b>crashed</b>; <b>garbage</b> an external program's answer that cannot be read; "
      "<b>not-applicable</b> not a problem for this method; <b>infeasible</b> rightly: there is no "
      "solution, as is known or as one of Perp's methods has proven while nobody found one; <b>false-infeasible</b> "
      "although a solution is known or another method has found one.</p>\n"
      "<p>Beside this page: cells.csv and cells.json (all cells), curves.csv, methods.csv, pairs.csv, profiles.csv, "
      "summary.csv, robustness.csv, unsolvable.csv, false_claims.csv, report.json, findings.txt. Everything here can "
      "be computed from cells.csv, curves.csv, pairs.csv and methods.csv.</p>\n";
  if (!data.dropped().empty()) {
    html += fmt::format("<p>{} of cells.jsonl left out:</p>\n<ul>\n", counted(data.dropped().size(), "line"));
    for (const std::string& line : data.dropped()) html += fmt::format("<li><code>{}</code></li>\n", html_text(line));
    html += "</ul>\n";
  }
  return html + "</section>\n";
}

std::string cells_data(const CampaignData& data, const std::vector<std::size_t>& style) {
  Json json;
  json["tol"] = data.campaign().tol;
  json["methods"] = Json::array();
  for (std::size_t m = 0; m < data.methods().size(); ++m) json["methods"].push_back(data.label(m));
  json["styles"] = style;
  json["problems"] = Json::array();
  for (const compare::AskedProblem& problem : data.campaign().problems)
    json["problems"].push_back({problem.name, problem.cls, problem.n});
  json["outcomes"] = Json::array();
  for (const std::string_view name : compare::outcome_names()) json["outcomes"].push_back(name);
  json["shown"] = shown_pair(data);
  Json cells = Json::array();
  for (std::size_t m = 0; m < data.methods().size(); ++m)
    for (std::size_t p = 0; p < data.pairs().size(); ++p) {
      const Cell* cell = data.at(m, p);
      if (cell == nullptr) continue;
      cells.push_back({m, data.pairs()[p].problem, cell->start, static_cast<int>(cell->outcome),
                       static_cast<int>(cell->outcome_after_restarts), cell->status, json_known(cell->natural),
                       json_count(cell->iterations), json_count(cell->F_evals), json_count(cell->J_evals),
                       json_count(cell->factorizations), json_count(cell->krylov_iterations), cell->restarts,
                       json_known(cell->seconds), json_known(cell->peak_mb), cell->message, curve_data(*cell)});
    }
  json["cells"] = std::move(cells);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string page(const ReportParts& parts) {
  const CampaignData& data = parts.data;
  const compare::Campaign& campaign = data.campaign();
  const std::vector<std::size_t> style = styles(data, parts.comparisons);
  const std::string title = fmt::format("Comparison of {} on {}", counted(campaign.methods.size(), "method"),
                                        counted(campaign.problems.size(), "problem"));
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
      "'unsafe-inline'; script-src 'unsafe-inline'; img-src data:\"/>\n<link rel=\"icon\" href=\"data:,\"/>\n";
  html += fmt::format(
      "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n<a class=\"skip\" href=\"#robustness\">To the "
      "tables</a>\n<header><h1>{}</h1>\n<p class=\"sub\">{} \u00b7 perp {} \u00b7 {}</p></header>\n",
      title, page_style(), title, html_text(campaign.date), html_text(campaign.version),
      html_text(machine_words(campaign.machine)));
  html += "<main>\n" + false_claims_section(data);
  html += findings_section(parts.findings);
  html += navigation(parts) + robustness_section(data) + unsolvable_section(data) + profiles_sections(parts, style) +
          convergence_section() + cells_section() + method_section(data) + "</main>\n";
  html += R"(<script type="application/json" id="data">)" + script_json(cells_data(data, style)) + "</script>\n";
  return html +
         fmt::format("<script>\n\"use strict\";{}{}</script>\n</body>\n</html>\n", page_script(), page_script_curves());
}

}  // namespace perp::app::comparison

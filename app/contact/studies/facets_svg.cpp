// SPDX-License-Identifier: Apache-2.0
#include "app/contact/studies/facets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "app/text/plot_layout.hpp"
#include "app/text/svg.hpp"
#include "app/text/table.hpp"

namespace perp::app::contacts {

namespace {

using Anchor = Svg::Anchor;
using Marker = Svg::Marker;

constexpr double width = 1200;
constexpr double left = 84;
constexpr double head = 148;
constexpr double panel_width = 480;
constexpr double panel_height = 330;
constexpr double column = 560;    // from panel to panel
constexpr double step = 436;      // from row to row
constexpr double room = 84;       // for words at the ends of lines
constexpr double apart = 1.6;     // factor between guides and the first points
constexpr double label_gap = 18;  // between words at the ends of lines

constexpr std::string_view style = R"css(
text { font: 14px system-ui, "DejaVu Sans", "Liberation Sans", Arial, sans-serif; fill: #222; }
.title { font-size: 20px; font-weight: 600; } .panel-title { font-size: 16px; font-weight: 600; }
.soft { fill: #555; } .small { font-size: 12px; fill: #555; }
.grid { stroke: #ececec; stroke-width: 1; } .tick { stroke: #555; stroke-width: 1; }
.frame { fill: none; stroke: #b5b5b5; stroke-width: 1; }
.guide { stroke: #8a8a8a; stroke-width: 1.4; stroke-dasharray: 1.5 4; stroke-linecap: round; }
.guide-words { font-size: 13px; fill: #666; }
.inner { fill: none; stroke: #0072B2; stroke-width: 2.4; } .outer { fill: none; stroke: #D55E00; stroke-width: 2.4; stroke-dasharray: 8 4; }
.inner-mark { fill: #0072B2; stroke: #fff; stroke-width: .8; } .outer-mark { fill: #D55E00; stroke: #fff; stroke-width: .8; }
.inner-words, .outer-words { font-weight: 600; paint-order: stroke; stroke: #fff; stroke-width: 4px; stroke-linejoin: round; }
.inner-words { fill: #005a8e; } .outer-words { fill: #a94900; }
)css";

struct Look {
  const char *line, *mark, *words, *name;
  Marker shape;
};
constexpr Look look(bool outer) {
  return outer ? Look{"outer", "outer-mark", "outer-words", "about the disk (outer:K)", Marker::Square}
               : Look{"inner", "inner-mark", "inner-words", "in the disk (inner:K)", Marker::Dot};
}

struct Words {
  std::string_view title, what;
};
constexpr Words words(FacetError error) {
  switch (error) {
    case FacetError::Natural:
      return {"Natural map of Coulomb's law", "free of units"};
    case FacetError::Velocity:
      return {"Velocity", "|u - u_exact| / |q|"};
    case FacetError::Cone:
      return {"Force outside of the friction cone", "(|r_T| - mu r_N) / max r_N"};
    case FacetError::Slip:
      return {"Missing dissipation", "(mu r_N |u_T| + r_T.u_T) / (max r_N max |q|)"};
  }
  return {};
}

double of(const FacetLine& line, FacetError error) { return line.medians.at(static_cast<std::size_t>(error)); }

/// Scales that all panels share.
struct Axes {
  Scale K, error;
};

/// One panel: where its values go.
struct View {
  Panel panel{};
  Axes axes;
  Pixel operator()(double K, double error) const { return {axes.K(K), axes.error(error)}; }
};

View view_at(const FacetStudy& study, const std::vector<double>& errors, double x, double y) {
  const Panel panel{x, x + panel_width, y, y + panel_height};
  std::vector<double> K(study.facets.begin(), study.facets.end());
  return {panel,
          {Scale::logarithmic(K, panel.left, panel.right - room), Scale::logarithmic(errors, panel.bottom, panel.top)}};
}

void axes(Svg& svg, const View& view, const FacetStudy& study) {
  const Panel& p = view.panel;
  y_axis(svg, p, view.axes.error, "");
  double last = -1e9;
  for (const int K : study.facets) {
    const double x = view.axes.K(K);
    svg.line("grid", {x, p.top}, {x, p.bottom});
    svg.line("tick", {x, p.bottom}, {x, p.bottom + 5});
    const std::string words = fmt::format("{}", K);
    const double half = 4.0 * static_cast<double>(words.size());
    if (x - half < last + 4) continue;  // words would touch
    svg.text("small", {x, p.bottom + 20}, words, Anchor::Middle);
    last = x + half;
  }
  svg.text("soft", {p.middle(), p.bottom + 40}, "facets K", Anchor::Middle);
  svg.rectangle("frame", {p.left, p.top}, p.width(), p.height());
}

/// Words beside a line's end.
struct Label {
  Pixel at;
  std::string text;
  const char* css;
};

/// c / K^power through (K, error), as far as the panel goes.
void guide(Svg& svg, const View& view, double K, double error, double last, int power, std::vector<Label>& labels) {
  const double low = std::pow(10, view.axes.error.low());
  const double end = std::min(last, K * std::pow(error / low, 1.0 / power));
  if (!(end > K)) return;
  const Pixel to = view(end, error * std::pow(K / end, power));
  svg.line("guide", view(K, error), to);
  labels.push_back({{to.x + 10, to.y + 4}, power == 1 ? "1/K" : "1/K^2", "guide-words"});
}

/// Where the panel's errors should fall like 1/K one guide above them and one below, else both above.
void guides(Svg& svg, const View& view, const FacetStudy& study, const std::vector<FacetLine>& lines, FacetError error,
            std::vector<Label>& labels) {
  std::vector<double> first;
  for (const FacetLine& line : lines)
    if (line.facets == study.facets.front() && of(line, error) >= facet_rounding) first.push_back(of(line, error));
  if (first.empty() || study.facets.size() < 2) return;
  const double above = apart * std::ranges::max(first);
  const bool turned = error == FacetError::Natural || error == FacetError::Velocity;
  guide(svg, view, study.facets.front(), above, study.facets.back(), 1, labels);
  guide(svg, view, study.facets.front(), turned ? std::ranges::min(first) / apart : above, study.facets.back(), 2,
        labels);
}

/// Points and line of one side; its label stands at the end of it.
void curve(Svg& svg, const View& view, const std::vector<FacetLine>& lines, bool outer, FacetError error,
           std::vector<Label>& labels) {
  const Look l = look(outer);
  std::vector<Pixel> points;
  std::vector<const FacetLine*> marked;
  for (const FacetLine& line : lines) {
    if (line.outer != outer || !(of(line, error) >= facet_rounding)) continue;
    points.push_back(view(line.facets, of(line, error)));
    marked.push_back(&line);
  }
  if (points.empty()) {
    svg.text(l.words, {view.panel.left + 12, view.panel.bottom - (outer ? 12 : 12 + label_gap)},
             fmt::format("{}: 0, to rounding", outer ? "outer" : "inner"));
    return;
  }
  svg.polyline(l.line, points);
  for (std::size_t k = 0; k < points.size(); ++k)
    svg.marker(
        l.mark, l.shape, points[k], 5,
        fmt::format("{}:{}: {}", outer ? "outer" : "inner", marked[k]->facets, number(of(*marked[k], error), 3)));
  const double power = fitted_power(lines, outer, error);
  if (!std::isnan(power))
    labels.push_back({{points.back().x + 10, points.back().y + 5}, fmt::format("K^{:.2f}", power), l.words});
}

void panel(Svg& svg, const FacetStudy& study, const std::vector<FacetLine>& lines, const View& view, FacetError error) {
  const Words w = words(error);
  svg.text("panel-title", {view.panel.left, view.panel.top - 28}, w.title);
  svg.text("small", {view.panel.left, view.panel.top - 10}, w.what);
  axes(svg, view, study);
  if (study.counting() == 0) {
    svg.text("soft", {view.panel.middle(), (view.panel.top + view.panel.bottom) / 2},
             "nothing slips, so that polygons have no error", Anchor::Middle);
    return;
  }
  std::vector<Label> labels;
  guides(svg, view, study, lines, error, labels);
  for (const bool outer : {false, true}) curve(svg, view, lines, outer, error, labels);
  std::ranges::sort(labels, {}, [](const Label& label) { return label.at.y; });
  for (std::size_t k = 1; k < labels.size(); ++k)
    if (std::abs(labels[k].at.x - labels[k - 1].at.x) < room)
      labels[k].at.y = std::max(labels[k].at.y, labels[k - 1].at.y + label_gap);
  for (const Label& label : labels) svg.text(label.css, label.at, label.text);
}

std::string subtitle(const FacetStudy& study) {
  return fmt::format("{}, in {} of them something slips; medians over those and over three positions of each polygon",
                     count(static_cast<long long>(study.problems.size()), "problem"), study.counting());
}

}  // namespace

std::string facets_svg(const FacetStudy& study) {
  const std::vector<FacetLine> lines = study.lines();
  std::vector<double> errors;
  for (const FacetLine& line : lines)
    for (const FacetError error : facet_errors)
      if (of(line, error) >= facet_rounding) errors.push_back(of(line, error));
  Svg svg(static_cast<int>(width), static_cast<int>(head + 2 * step - 10), "What friction polygons of K facets cost",
          style);
  svg.text("title", {left - 56, 38},
           "Polygons of K facets in place of the friction disk: errors by Coulomb's exact law");
  svg.text("soft", {left - 56, 62}, subtitle(study));
  double x = left - 56;
  for (const bool outer : {false, true}) {
    const Look l = look(outer);
    svg.line(l.line, {x, 85}, {x + 52, 85});
    svg.marker(l.mark, l.shape, {x + 26, 85}, 5);
    svg.text("", {x + 62, 90}, l.name);
    x += 270;
  }
  svg.line("guide", {x, 85}, {x + 52, 85});
  svg.text("", {x + 62, 90}, "c / K, c / K^2");
  svg.text("", {x + 200, 90}, "K^p beside a line: fitted to its points");
  for (std::size_t k = 0; k < facet_errors.size(); ++k) {
    const double side = left + (k % 2 == 0 ? 0 : column);
    const double y = head + 14 + (k < 2 ? 0 : step);
    panel(svg, study, lines, view_at(study, errors, side, y), facet_errors.at(k));
  }
  return svg.finish();
}

}  // namespace perp::app::contacts

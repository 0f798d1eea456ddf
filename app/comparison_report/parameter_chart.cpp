// SPDX-License-Identifier: Apache-2.0
/// What the parameter of a C-function does: the share of pairs that are solved, over its values.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include "app/comparison_report/html.hpp"
#include "app/comparison_report/page.hpp"
#include "app/findings/summary.hpp"
#include "app/text/plot_layout.hpp"
#include "app/text/svg.hpp"
#include "ncp/reformulation/cfunction.hpp"

namespace perp::app::comparison {

namespace {

using Anchor = Svg::Anchor;

/// Of a function, by its parameter: the share of the pairs that is solved.
struct Curves {
  std::map<std::string, std::map<double, double>> of{};
  std::size_t pairs = 0;
};

/// "min-rho-b 0.01": the name and the value.
std::optional<std::pair<std::string, double>> parametrised(const std::string& given) {
  const std::size_t space = given.find(' ');
  double value = 0;
  if (space == std::string::npos) return std::nullopt;
  const auto [end, error] = std::from_chars(given.data() + space + 1, given.data() + given.size(), value);
  if (error != std::errc() || end != given.data() + given.size() || !(value > 0)) return std::nullopt;
  return std::pair(given.substr(0, space), value);
}

Curves curves_of(const CampaignData& data, const Comparison& comparison) {
  Curves curves;
  const Summary all = summary(data, comparison);
  if (all.pairs == 0) return curves;
  curves.pairs = static_cast<std::size_t>(all.pairs);
  for (const SummaryRow& row : all.rows)
    if (const auto which = parametrised(given_cfunction(data.methods()[row.method])))
      curves.of[which->first][which->second] = static_cast<double>(row.solved) / static_cast<double>(all.pairs);
  std::erase_if(curves.of, [](const auto& curve) { return curve.second.size() < 2; });
  return curves;
}

/// "rho or lambda": what the curves are drawn over.
std::string parameters_of(const Curves& curves) {
  std::vector<std::string> names;
  for (const auto& [name, points] : curves.of) {
    const std::string parameter = ncp::cfunction(name).parameter->name;
    if (std::ranges::find(names, parameter) == names.end()) names.push_back(parameter);
  }
  std::ranges::sort(names, std::greater{});  // rho, lambda, alpha, as the methods' page has them
  return fmt::format("{}", fmt::join(names, " or "));
}

void draw_frame(Svg& svg, const Panel& panel, const Scale& x, const Scale& y, double low, double high, double least,
                const Curves& curves) {
  svg.text("title", {8, 17}, fmt::format("Solved of {} pairs, by the parameter of the C-function", curves.pairs));
  for (double share = least; share < 1.001; share += 0.1) {
    svg.line(share == least ? "axis" : "grid", {panel.left, y(share)}, {panel.right, y(share)});
    svg.text("tick", {panel.left - 6, y(share) + 4}, fmt::format("{:.0f} %", 100 * share), Anchor::End);
  }
  for (double power = std::ceil(low); power <= high; power += 1) {
    svg.line("grid", {x(power), panel.top}, {x(power), panel.bottom});
    svg.text("tick", {x(power), panel.bottom + 16}, fmt::format("{:g}", std::pow(10, power)), Anchor::Middle);
  }
  svg.text("axis-name", {panel.middle(), panel.bottom + 34}, parameters_of(curves), Anchor::Middle);
}

}  // namespace

std::string parameter_chart(const CampaignData& data, const Comparison& comparison) {
  const Curves curves = curves_of(data, comparison);
  if (curves.of.empty()) return "";
  double low = 300, high = -300, least = 1;
  for (const auto& [name, points] : curves.of) {
    low = std::min(low, std::log10(points.begin()->first));
    high = std::max(high, std::log10(points.rbegin()->first));
    for (const auto& [value, share] : points) least = std::min(least, share);
  }
  least = std::max(0.0, std::floor(10 * least - 1e-9) / 10);
  const Panel panel{.left = 48, .right = 434, .top = 34, .bottom = 300};
  const Scale x = Scale::linear(low - 0.1, high + 0.1, panel.left, panel.right);
  const Scale y = Scale::linear(least, 1, panel.bottom, panel.top);
  Svg svg(680, 344, "Solved pairs by the parameter of the C-function", "");
  draw_frame(svg, panel, x, y, low, high, least, curves);
  std::size_t style = 0;
  for (const auto& [name, points] : curves.of) {
    std::vector<Pixel> line;
    for (const auto& [value, share] : points) line.push_back({x(std::log10(value)), y(share)});
    svg.begin_group(fmt::format("{}-parameter-{}", comparison.id, style), "curve");
    svg.polyline(fmt::format("line c{} d{}", style % 7, style % 4), line);
    for (const auto& [value, share] : points)
      svg.marker(fmt::format("marker f{}", style % 7), Svg::Marker::Dot, {x(std::log10(value)), y(share)}, 3.4,
                 fmt::format("{} at {:g}: {:.1f} %", name, value, 100 * share));
    const double height = panel.top + 16 * static_cast<double>(style);
    svg.line(fmt::format("line c{} d{}", style % 7, style % 4), {panel.right + 12, height}, {panel.right + 34, height});
    svg.text("label", {panel.right + 40, height + 4}, name);
    svg.end_group();
    ++style;
  }
  return "<div class=\"parameters\">" + svg.inlined() + "</div>\n";
}

}  // namespace perp::app::comparison

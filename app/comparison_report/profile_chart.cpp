// SPDX-License-Identifier: Apache-2.0
#include "app/comparison_report/profile_chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "app/text/plot_layout.hpp"
#include "app/text/svg.hpp"

namespace perp::app::comparison {

namespace {

constexpr double width = 620;
constexpr double label_height = 13.5;
constexpr std::size_t label_length = 22;
using Anchor = Svg::Anchor;

constexpr std::array shapes{Svg::Marker::Dot,     Svg::Marker::Square,       Svg::Marker::TriangleUp,
                            Svg::Marker::Diamond, Svg::Marker::TriangleDown, Svg::Marker::Ring,
                            Svg::Marker::Plus,    Svg::Marker::Cross};

Svg::Marker shape(std::size_t style) { return shapes[style % shapes.size()]; }
std::string line_class(std::size_t style) { return fmt::format("line c{} d{}", style % 7, style % 4); }
std::string marker_class(std::size_t style) { return fmt::format("marker f{}", style % 7); }

/// The logarithmic x axis.
struct Axis {
  double base, low, high;  // exponents
  Scale scale;
  double operator()(double x) const { return scale(std::clamp(std::log(x) / std::log(base), low, high)); }
};

Axis x_axis(const ChartAxes& axes, const std::vector<ChartCurve>& curves, const Panel& panel) {
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  for (const ChartCurve& curve : curves)
    if (!curve.profile.steps.empty())
      least = std::min(least, curve.profile.steps.front().x), most = std::max(most, curve.profile.steps.back().x);
  const double base = axes.ratios ? 2 : 10;
  if (most == 0) least = 1, most = base;
  const double high = std::max(std::log(most) / std::log(base), axes.ratios ? 1.0 : -300.0);
  const double low = axes.ratios ? 0 : std::min(std::log(least) / std::log(base), high - 0.5);
  const double end = high + 0.04 * (high - low);  // so that the last step is seen
  return {base, low, end, Scale::linear(low, end, panel.left, panel.right)};
}

std::string power_label(double base, long exponent) {
  if (base == 2 && exponent < 20) return fmt::format("{}", 1L << exponent);
  if (base == 10 && exponent >= -3 && exponent <= 4) return fmt::format("{:g}", std::pow(10.0, exponent));
  return fmt::format("{:g}^{}", base, exponent);
}

void draw_frame(Svg& svg, const ChartAxes& axes, const Axis& axis, const Panel& panel) {
  svg.text("title", {8, 17}, axes.title);
  for (int tenths = 0; tenths <= 10; tenths += 2) {
    const double y = panel.bottom - panel.height() * tenths / 10;
    svg.line(tenths == 0 ? "axis" : "grid", {panel.left, y}, {panel.right, y});
    svg.text("tick", {panel.left - 6, y + 4}, fmt::format("{} %", 10 * tenths), Anchor::End);
  }
  const auto first = static_cast<long>(std::ceil(axis.low - 1e-9));
  const auto last = static_cast<long>(std::floor(axis.high + 1e-9));
  const long every = std::max(1L, (last - first) / 9 + 1);
  for (long k = first; k <= last; k += every) {
    const double x = axis.scale(static_cast<double>(k));
    svg.line("grid", {x, panel.top}, {x, panel.bottom});
    svg.text("tick", {x, panel.bottom + 16}, power_label(axis.base, k), Anchor::Middle);
  }
  svg.text("axis-name", {panel.middle(), panel.bottom + 34}, axes.x, Anchor::Middle);
}

void draw_curve(Svg& svg, const ChartCurve& curve, const Axis& axis, const Panel& panel) {
  const auto y = [&](std::size_t count) {
    const double share =
        static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(1, curve.profile.problems));
    return panel.bottom - share * panel.height();
  };
  std::vector<Pixel> line{{panel.left, panel.bottom}};
  for (const Step& step : curve.profile.steps) {
    line.push_back({axis(step.x), line.back().y});
    line.push_back({axis(step.x), y(step.count)});
  }
  line.push_back({panel.right, line.back().y});
  // A curve that begins on the axis begins at its height.
  if (!curve.profile.steps.empty() && axis(curve.profile.steps.front().x) <= panel.left)
    line.erase(line.begin(), line.begin() + 2);
  svg.polyline(line_class(curve.style), line);

  constexpr int markers = 4;  // at places that differ from curve to curve
  for (int k = 0; k < markers; ++k) {
    const double place = (k + static_cast<double>(curve.style * 5 % 8) / 8) / markers;
    const double exponent = axis.low + place * (axis.high - axis.low);
    const double x = std::pow(axis.base, exponent);
    svg.marker(
        marker_class(curve.style), shape(curve.style), {axis.scale(exponent), y(curve.profile.count(x))}, 3.4,
        fmt::format("{}: {} of {} within {:.3g}", curve.label, curve.profile.count(x), curve.profile.problems, x));
  }
}

/// Heights of the labels: as close to where the curves end as they can be without touching, in the order of the ends.
std::vector<double> label_places(const std::vector<double>& ends, const Panel& panel) {
  std::vector<std::size_t> order(ends.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return ends[k]; });
  std::vector<double> place(ends.size());
  double next = panel.top;  // pushed down from the top, then up from the bottom
  for (const std::size_t k : order) {
    place[k] = std::max(ends[k], next);
    next = place[k] + label_height;
  }
  double lowest = panel.bottom;
  std::ranges::reverse(order);
  for (const std::size_t k : order) {
    place[k] = std::min(place[k], lowest);
    lowest = place[k] - label_height;
  }
  return place;
}

}  // namespace

std::string line_sample(std::size_t style) {
  Svg svg(34, 12, "", "");
  svg.line(line_class(style), {1, 6}, {33, 6});
  svg.marker(marker_class(style), shape(style), {17, 6}, 3.4);
  return svg.inlined();
}

std::string profile_chart(const ChartAxes& axes, const std::vector<ChartCurve>& curves) {
  const double height = std::max(330.0, label_height * static_cast<double>(curves.size()) + 20);
  const Panel panel{.left = 48, .right = width - 186, .top = 34, .bottom = 34 + height};
  Svg svg(static_cast<int>(width), static_cast<int>(panel.bottom + 44), axes.title, "");
  const Axis axis = x_axis(axes, curves, panel);
  draw_frame(svg, axes, axis, panel);

  std::vector<double> ends(curves.size());
  std::ranges::transform(curves, ends.begin(), [&](const ChartCurve& curve) {
    return panel.bottom - curve.profile.share(std::numeric_limits<double>::infinity()) * panel.height();
  });
  const std::vector<double> places = label_places(ends, panel);
  for (std::size_t k = curves.size(); k-- > 0;) {  // the first on top
    const ChartCurve& curve = curves[k];
    svg.begin_group(curve.id, curve.muted ? "curve muted" : "curve");
    draw_curve(svg, curve, axis, panel);
    svg.polyline(fmt::format("leader c{}", curve.style % 7),
                 {{panel.right, ends[k]}, {panel.right + 16, places[k]}, {panel.right + 20, places[k]}});
    svg.marker(marker_class(curve.style), shape(curve.style), {panel.right + 25, places[k]}, 3.4);
    svg.text("label", {panel.right + 32, places[k] + 4}, shortened(curve.label, label_length));
    svg.end_group();
  }
  return svg.inlined();
}

}  // namespace perp::app::comparison

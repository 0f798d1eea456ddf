// SPDX-License-Identifier: Apache-2.0
#include "app/contact/studies/ball.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "app/text/plot_layout.hpp"
#include "app/text/svg.hpp"

namespace perp::app::contacts {

namespace {

using contact::BallPath;
using contact::FrictionLaw;
using contact::Vec3;
using Anchor = Svg::Anchor;
using Marker = Svg::Marker;

constexpr double width = 1240;
constexpr double margin = 28;
constexpr double head = 132;
constexpr double plot_width = 420;
constexpr double plot_height = 350;
constexpr double gutter = 16;
constexpr double below = 52;  // a panel, up to the next one
constexpr double row = 24;
constexpr double nearest = 1.5;       // pixels between points of a line
constexpr double resting = 1e-3;      // m that count as none
constexpr double least_extent = 0.5;  // m of a picture
constexpr double dominant = 2.2;      // extents of the others from which on these are shown larger

constexpr std::string_view style = R"css(
text { font: 14px system-ui, "DejaVu Sans", "Liberation Sans", Arial, sans-serif; fill: #222; }
.title { font-size: 20px; font-weight: 600; } .panel-title { font-size: 16px; font-weight: 600; }
.soft { fill: #555; } .small { font-size: 12px; fill: #555; } .bad { fill: #b00020; font-weight: 600; }
.grid { stroke: #e7e7e7; stroke-width: 1; } .frame { fill: none; stroke: #b5b5b5; stroke-width: 1; }
.scale { stroke: #222; stroke-width: 2.5; } .arrow { stroke: #444; stroke-width: 2; fill: none; }
.path { fill: none; stroke-width: 2; stroke-linejoin: round; stroke-linecap: round; }
.exact { stroke: #000; stroke-width: 5.5; } .mark-exact { fill: #000; stroke: #fff; stroke-width: .8; }
.halo { paint-order: stroke; stroke: #fff; stroke-width: 4px; stroke-linejoin: round; font-weight: 600; }
.mark { stroke: #fff; stroke-width: .8; } .part { fill: none; stroke: #222; stroke-width: 1.2; stroke-dasharray: 3 3; } .start { fill: #fff; stroke: #000; stroke-width: 1.6; }
.c0 { stroke: #D55E00; } .c1 { stroke: #E69F00; stroke-dasharray: 9 4; } .c2 { stroke: #009E73; stroke-dasharray: 14 3 3 3; }
.c3 { stroke: #0072B2; stroke-dasharray: 5 3; } .c4 { stroke: #CC79A7; stroke-dasharray: 2 3; } .c5 { stroke: #56B4E9; }
.f0 { fill: #D55E00; } .f1 { fill: #E69F00; } .f2 { fill: #009E73; } .f3 { fill: #0072B2; } .f4 { fill: #CC79A7; } .f5 { fill: #56B4E9; }
)css";

constexpr std::array<Marker, 6> shapes{Marker::Square,       Marker::TriangleUp, Marker::Diamond,
                                       Marker::TriangleDown, Marker::Dot,        Marker::Square};

bool is_exact(const BallPath& path) { return path.law.kind == FrictionLaw::Kind::Coulomb; }

/// Names and classes of one path.
struct Look {
  std::string line, fill, words;
  Marker shape = Marker::Dot;
};
Look look(const BallPath& path, std::size_t k) {
  if (is_exact(path)) return {"path exact", "mark-exact", "exact law", Marker::Dot};
  return {fmt::format("path c{}", k % shapes.size()), fmt::format("mark f{}", k % shapes.size()),
          fmt::format("{} facets", path.law.facets), shapes[k % shapes.size()]};
}

/// From metres to pixels, the same in x and y, y upwards.
struct View {
  Panel panel{};
  double x = 0, y = 0;  // in the middle of the panel [m]
  double scale = 1;     // pixels a metre
  bool shows(const Pixel& p) const {
    return p.x >= panel.left && p.x <= panel.right && p.y >= panel.top && p.y <= panel.bottom;
  }
  Pixel operator()(const Vec3& p) const {
    return {panel.middle() + scale * (p.x() - x), (panel.top + panel.bottom) / 2 - scale * (p.y() - y)};
  }
};

struct Extent {
  double low_x = 0, high_x = 0, low_y = 0, high_y = 0;  // the start is in it
  void add(const BallPath& path) {
    for (const Vec3& p : path.centres) {
      low_x = std::min(low_x, p.x()), high_x = std::max(high_x, p.x());
      low_y = std::min(low_y, p.y()), high_y = std::max(high_y, p.y());
    }
  }
  double size() const { return std::hypot(high_x - low_x, high_y - low_y); }
};

View view_of(const Extent& e, const Panel& panel) {
  const double wide = std::max(e.high_x - e.low_x, least_extent);
  const double high = std::max(e.high_y - e.low_y, least_extent);
  const double scale = std::min((panel.width() - 160) / wide, (panel.height() - 96) / high);
  return {panel, (e.low_x + e.high_x) / 2, (e.low_y + e.high_y) / 2, scale};
}

/// Which paths a closer view shows: all but those that make the others small; none if nothing would be larger.
std::vector<bool> close_paths(const BallScene& scene) {
  std::vector<double> sizes;
  for (const BallPath& path : scene.paths) {
    Extent e;
    e.add(path);
    sizes.push_back(e.size());
  }
  std::vector<double> sorted = sizes;
  std::ranges::sort(sorted);
  double limit = 0;  // the largest size below a jump
  for (std::size_t k = 0; k + 1 < sorted.size(); ++k)
    if (sorted[k] > 1e-2 && sorted[k + 1] > dominant * sorted[k]) limit = sorted[k];
  std::vector<bool> close(sizes.size());
  for (std::size_t k = 0; k < sizes.size(); ++k) close[k] = sizes[k] <= limit;
  return close;
}

/// 1, 2 or 5 times a power of ten, at most `most`.
double round_length(double most) {
  const double power = std::pow(10, std::floor(std::log10(most)));
  for (const double factor : {5.0, 2.0})
    if (factor * power <= most) return factor * power;
  return power;
}

void grid(Svg& svg, const View& view) {
  const Panel& p = view.panel;
  const double step = round_length(110 / view.scale);
  const Pixel origin = view(Vec3::Zero());
  const double cell = step * view.scale;
  const auto lines = [cell](double from, double low, double high) {
    std::vector<double> at;
    for (auto k = std::lround(std::ceil((low - from) / cell)); from + static_cast<double>(k) * cell < high; ++k)
      at.push_back(from + static_cast<double>(k) * cell);
    return at;
  };
  for (const double x : lines(origin.x, p.left, p.right)) svg.line("grid", {x, p.top}, {x, p.bottom});
  for (const double y : lines(origin.y, p.top, p.bottom)) svg.line("grid", {p.left, y}, {p.right, y});
  svg.rectangle("frame", {p.left, p.top}, p.width(), p.height());
  const Pixel corner{p.left + 14, p.bottom - 14};
  svg.line("scale", corner, {corner.x + cell, corner.y});
  svg.line("scale", {corner.x, corner.y - 5}, {corner.x, corner.y + 5});
  svg.line("scale", {corner.x + cell, corner.y - 5}, {corner.x + cell, corner.y + 5});
  svg.text("halo", {corner.x + cell / 2, corner.y - 8}, fmt::format("{:g} m", step), Anchor::Middle);
}

void draw(Svg& svg, const View& view, const BallPath& path, const Look& look, const contact::CyclicBall& ball) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Pixel> points;
  Pixel last{nan, nan};
  for (std::size_t k = 0; k < path.centres.size(); ++k) {
    const Pixel here = view(path.centres[k]);
    const bool near = std::hypot(here.x - last.x, here.y - last.y) < nearest;
    if (near && k + 1 < path.centres.size()) continue;
    points.push_back(view.shows(here) ? here : Pixel{nan, nan});
    last = here;
  }
  svg.polyline(look.line, points);
  const double cycle = 3 * ball.phase;
  for (int k = 1; k * cycle < path.times.back() + 0.5 * ball.h; ++k) {
    const auto at = std::min(path.centres.size() - 1, static_cast<std::size_t>(std::lround(k * cycle / ball.h)));
    if (const Pixel here = view(path.centres[at]); view.shows(here))
      svg.marker(look.fill, look.shape, here, is_exact(path) ? 7 : 4.6,
                 fmt::format("{}, t = {:g} s: ({:.3f}, {:.3f}) m", look.words, path.times[at], path.centres[at].x(),
                             path.centres[at].y()));
  }
}

/// Words at the ends of the paths that are asked for, below each other where they would overlap.
void label_ends(Svg& svg, const View& view, const BallScene& scene, const std::vector<bool>& wanted) {
  struct Label {
    Pixel at;
    std::string words;
  };
  std::vector<Label> labels;
  for (std::size_t k = 0; k < scene.paths.size(); ++k) {
    const Pixel end = view(scene.paths[k].centres.back());
    Extent extent;
    extent.add(scene.paths[k]);
    const char* rests = extent.size() < resting ? ": stays at rest" : "";
    if (wanted[k]) labels.push_back({{end.x + 11, end.y + 5}, look(scene.paths[k], k).words + rests});
  }
  std::ranges::stable_sort(labels, {}, [](const Label& label) { return label.at.y; });
  for (std::size_t k = 1; k < labels.size(); ++k)
    for (std::size_t j = 0; j < k; ++j)
      if (std::abs(labels[k].at.x - labels[j].at.x) < 82 && labels[k].at.y - labels[j].at.y < 17)
        labels[k].at.y = labels[j].at.y + 17;
  for (const Label& label : labels) svg.text("halo", label.at, label.words);
}

/// Coulomb's path below the others, wide.
void draw_all(Svg& svg, const View& view, const BallScene& scene, const std::vector<bool>& labelled) {
  grid(svg, view);
  for (const bool exact : {true, false})
    for (std::size_t k = 0; k < scene.paths.size(); ++k)
      if (is_exact(scene.paths[k]) == exact) draw(svg, view, scene.paths[k], look(scene.paths[k], k), scene.ball);
  svg.marker("start", Marker::Dot, view(Vec3::Zero()), 3.6, "start");
  label_ends(svg, view, scene, labelled);
}

void table(Svg& svg, Pixel at, const BallScene& scene) {
  const std::array<double, 3> columns{at.x + 56, at.x + 212, width - margin};
  const bool exact = scene.exact() != nullptr && scene.paths.size() > 1;
  if (exact) svg.text("small", {columns[1], at.y}, "end from exact", Anchor::End);
  svg.text("small", {columns[2], at.y}, "drift", Anchor::End);
  double y = at.y;
  for (std::size_t k = 0; k < scene.paths.size(); ++k) {
    const BallPath& path = scene.paths[k];
    const Look l = look(path, k);
    y += row;
    svg.line(l.line, {at.x + 2, y - 5}, {at.x + 46, y - 5});
    svg.marker(l.fill, l.shape, {at.x + 24, y - 5}, is_exact(path) ? 7 : 4.6);
    svg.text(path.solved ? "" : "bad", {columns[0], y}, path.solved ? l.words : "UNSOLVED");
    if (const double distance = from_exact(scene, path); exact && !std::isnan(distance) && !is_exact(path))
      svg.text("", {columns[1], y}, fmt::format("{:.2f} m", distance), Anchor::End);
    svg.text("", {columns[2], y}, fmt::format("{:.3f} m/s", path.drift(scene.ball).norm()), Anchor::End);
  }
  y += row + 8;
  const auto note = [&](std::string_view words) {
    svg.text("small", {at.x, y}, words);
    y += 17;
  };
  note("drift: mean velocity over the last cycle");
  const auto symmetric = [](const BallPath& path) { return !is_exact(path) && path.law.facets % 3 == 0; };
  if (scene.ball.rolls) return;
  if (std::ranges::any_of(scene.paths, symmetric)) {
    note("multiples of 3 facets share the load's");
    note("symmetry: no drift, but another path");
  }
}

std::string panel_title(const BallScene& scene) {
  const double L = scene.ball.load;
  if (scene.ball.rolls) return fmt::format("Load = {:g} mu m g: the ball may roll", L);
  if (L == 1) return "Load = mu m g: friction can just hold the ball";
  return fmt::format("Load = {:g} mu m g: {}", L, L < 1 ? "friction can hold the ball" : "the ball slides");
}

/// Is a polygon's path another one than Coulomb's?
bool facets_show(const BallScene& scene) {
  return std::ranges::any_of(scene.paths, [&](const BallPath& path) { return from_exact(scene, path) > 10 * resting; });
}

/// The three directions of the load, with the order they come in.
void compass(Svg& svg, const contact::CyclicBall& ball, Pixel centre) {
  for (int j = 0; j < 3; ++j) {
    const Vec3 d = load_direction(ball, (j + 0.5) * ball.phase);
    const auto at = [&](double along, double across) {
      return Pixel{centre.x + along * d.x() - across * d.y(), centre.y - along * d.y() - across * d.x()};
    };
    svg.line("arrow", at(4, 0), at(32, 0));
    svg.polyline("arrow", {at(25, 5), at(32, 0), at(25, -5)});
    const Pixel label = at(43, 0);
    svg.text("small", {label.x, label.y + 4}, fmt::format("{}", j + 1), Anchor::Middle);
  }
}

}  // namespace

std::string ball_svg(std::span<const BallScene> scenes) {
  const double height = head + static_cast<double>(scenes.size()) * (plot_height + below) - 14;
  Svg svg(static_cast<int>(width), static_cast<int>(height), "Ball on a plane under a cyclic load", style);

  const contact::CyclicBall& ball = scenes.front().ball;
  svg.text("title", {margin, 38}, "Ball on a plane under a cyclic load, seen from above");
  svg.text("soft", {margin, 62},
           fmt::format("load in the directions 1, 2, 3 in turn for {:g} s each, {:g} {}; mu = {:g}{}; ring: the "
                       "start, at rest; marks: ends of cycles",
                       ball.phase, ball.cycles, ball.cycles == 1 ? "cycle" : "cycles", ball.mu,
                       ball.rolls ? "; it may roll" : ""));
  if (std::ranges::any_of(scenes, facets_show))
    svg.text("", {margin, 84},
             "Facets in place of the friction disk bend the path and let the ball drift. By the exact law it stays, or "
             "its path closes.");
  compass(svg, ball, {width - margin - 46, 54});
  double top = head;
  for (const BallScene& scene : scenes) {
    const std::vector<bool> close = close_paths(scene);
    const bool closer = std::ranges::find(close, true) != close.end();
    const double right = margin + (closer ? plot_width : 2 * plot_width + gutter);
    const Panel panel{margin, right, top, top + plot_height};
    svg.text("panel-title", {margin, top - 12}, panel_title(scene));
    Extent all;
    Extent near;
    std::vector<bool> far;
    for (std::size_t k = 0; k < close.size(); ++k) {
      all.add(scene.paths[k]);
      if (close[k]) near.add(scene.paths[k]);
      far.push_back(!close[k]);
    }
    const View view = view_of(all, panel);
    draw_all(svg, view, scene, far);
    if (closer) {
      const View zoom = view_of(near, {right + gutter, right + gutter + plot_width, top, top + plot_height});
      const double w = plot_width / zoom.scale * view.scale;
      const double h = plot_height / zoom.scale * view.scale;
      const Pixel centre = view(Vec3(zoom.x, zoom.y, 0));
      svg.rectangle("part", {centre.x - w / 2, centre.y - h / 2}, w, h);
      svg.text("soft", {zoom.panel.left, top - 12},
               fmt::format("the dashed part, {:.2g} times larger", zoom.scale / view.scale));
      draw_all(svg, zoom, scene, close);
    }
    table(svg, {margin + 2 * plot_width + 2 * gutter + 4, top + 12}, scene);
    top += plot_height + below;
  }
  return svg.finish();
}

}  // namespace perp::app::contacts

#include "app/contact/ball_svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include "app/plot_layout.hpp"
#include "app/svg.hpp"

namespace perp::app::contacts {

namespace {

using contact::BallPath;
using contact::FrictionLaw;
using contact::Vec3;
using Anchor = Svg::Anchor;
using Marker = Svg::Marker;

constexpr double margin = 30;
constexpr double head = 128;
constexpr double plot_width = 560;
constexpr double plot_height = 470;
constexpr double gutter = 44;
constexpr double row = 22;
constexpr double nearest = 1.5;  // pixels between points of a line

constexpr std::string_view style = R"css(
text { font: 14px system-ui, "DejaVu Sans", "Liberation Sans", Arial, sans-serif; fill: #222; }
.title { font-size: 20px; font-weight: 600; } .panel-title { font-size: 16px; font-weight: 600; }
.soft { fill: #555; } .small { font-size: 12px; fill: #555; } .bad { fill: #b00020; font-weight: 600; }
.grid { stroke: #e7e7e7; stroke-width: 1; } .frame { fill: none; stroke: #b5b5b5; stroke-width: 1; }
.scale { stroke: #222; stroke-width: 2.5; } .arrow { stroke: #444; stroke-width: 2; fill: none; }
.path { fill: none; stroke-width: 2; stroke-linejoin: round; stroke-linecap: round; }
.exact { stroke: #000; stroke-width: 4.2; } .mark-exact { fill: #000; stroke: #fff; stroke-width: .8; }
.halo { paint-order: stroke; stroke: #fff; stroke-width: 4px; stroke-linejoin: round; font-weight: 600; }
.mark { stroke: #fff; stroke-width: .8; } .start { fill: #fff; stroke: #000; stroke-width: 1.6; }
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
  Pixel operator()(const Vec3& p) const {
    return {panel.middle() + scale * (p.x() - x), (panel.top + panel.bottom) / 2 - scale * (p.y() - y)};
  }
};

View view_of(const BallScene& scene, const Panel& panel) {
  double low_x = 0, high_x = 0, low_y = 0, high_y = 0;
  for (const BallPath& path : scene.paths)
    for (const Vec3& p : path.centres) {
      low_x = std::min(low_x, p.x()), high_x = std::max(high_x, p.x());
      low_y = std::min(low_y, p.y()), high_y = std::max(high_y, p.y());
    }
  const double width = std::max(high_x - low_x, 1e-3);
  const double height = std::max(high_y - low_y, 1e-3);
  const double scale = std::min((panel.width() - 150) / width, (panel.height() - 90) / height);
  return {panel, (low_x + high_x) / 2, (low_y + high_y) / 2, scale};
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
  const double width = step * view.scale;
  for (double x = origin.x - std::floor((origin.x - p.left) / width) * width; x < p.right; x += width)
    svg.line("grid", {x, p.top}, {x, p.bottom});
  for (double y = origin.y - std::floor((origin.y - p.top) / width) * width; y < p.bottom; y += width)
    svg.line("grid", {p.left, y}, {p.right, y});
  svg.rectangle("frame", {p.left, p.top}, p.width(), p.height());
  const Pixel corner{p.left + 14, p.bottom - 14};
  svg.line("scale", corner, {corner.x + width, corner.y});
  svg.line("scale", {corner.x, corner.y - 5}, {corner.x, corner.y + 5});
  svg.line("scale", {corner.x + width, corner.y - 5}, {corner.x + width, corner.y + 5});
  svg.text("halo", {corner.x + width / 2, corner.y - 8}, fmt::format("{:g} m", step), Anchor::Middle);
}

void draw(Svg& svg, const View& view, const BallPath& path, const Look& look, const contact::CyclicBall& ball) {
  std::vector<Pixel> points;
  for (std::size_t k = 0; k < path.centres.size(); ++k) {
    const Pixel here = view(path.centres[k]);
    const bool far = points.empty() || std::hypot(here.x - points.back().x, here.y - points.back().y) >= nearest;
    if (far || k + 1 == path.centres.size()) points.push_back(here);
  }
  svg.polyline(look.line, points);
  const double cycle = 3 * ball.phase;
  for (int k = 1; k * cycle < path.times.back() + 0.5 * ball.h; ++k) {
    const auto at = std::min(path.centres.size() - 1, static_cast<std::size_t>(std::lround(k * cycle / ball.h)));
    svg.marker(look.fill, look.shape, view(path.centres[at]), is_exact(path) ? 6.5 : 5,
               fmt::format("{}, t = {:g} s: ({:.3f}, {:.3f}) m", look.words, path.times[at], path.centres[at].x(),
                           path.centres[at].y()));
  }
}

/// Words at the ends of the paths, below each other where they would overlap.
void label_ends(Svg& svg, const View& view, const BallScene& scene) {
  struct Label {
    Pixel at;
    std::string words;
  };
  std::vector<Label> labels;
  for (std::size_t k = 0; k < scene.paths.size(); ++k) {
    const Pixel end = view(scene.paths[k].centres.back());
    labels.push_back({{end.x + 11, end.y + 5}, look(scene.paths[k], k).words});
  }
  std::ranges::stable_sort(labels, {}, [](const Label& label) { return label.at.y; });
  for (std::size_t k = 1; k < labels.size(); ++k)
    for (std::size_t j = 0; j < k; ++j)
      if (std::abs(labels[k].at.x - labels[j].at.x) < 82 && labels[k].at.y - labels[j].at.y < 17)
        labels[k].at.y = labels[j].at.y + 17;
  for (const Label& label : labels) svg.text("halo", label.at, label.words);
}

void table(Svg& svg, const Panel& panel, const BallScene& scene) {
  const double first = panel.bottom + 30;
  const std::array<double, 3> columns{panel.left + 190, panel.left + 340, panel.left + 490};
  const bool exact = scene.exact() != nullptr;
  if (exact) svg.text("small", {columns[1], first}, "end: from exact", Anchor::End);
  svg.text("small", {columns[2], first}, "drift, last cycle", Anchor::End);
  for (std::size_t k = 0; k < scene.paths.size(); ++k) {
    const BallPath& path = scene.paths[k];
    const Look l = look(path, k);
    const double y = first + row * static_cast<double>(k + 1);
    svg.line(l.line, {panel.left + 2, y - 5}, {panel.left + 52, y - 5});
    svg.marker(l.fill, l.shape, {panel.left + 27, y - 5}, is_exact(path) ? 6.5 : 5);
    svg.text(path.solved ? "" : "bad", {panel.left + 64, y}, path.solved ? l.words : l.words + ", UNSOLVED");
    if (const double distance = from_exact(scene, path); exact && !std::isnan(distance) && !is_exact(path))
      svg.text("", {columns[1], y}, fmt::format("{:.2f} m", distance), Anchor::End);
    svg.text("", {columns[2], y}, fmt::format("{:.3f} m/s", path.drift(scene.ball).norm()), Anchor::End);
  }
}

std::string panel_title(const BallScene& scene) {
  const double L = scene.ball.load;
  if (L == 1) return "Load = mu m g: friction can just hold the ball";
  return fmt::format("Load = {:g} mu m g: {}", L, L < 1 ? "friction can hold the ball" : "the ball slides");
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
  const std::size_t columns = std::min<std::size_t>(scenes.size(), 2);
  const std::size_t rows = (scenes.size() + 1) / 2;
  std::size_t most = 0;
  for (const BallScene& scene : scenes) most = std::max(most, scene.paths.size());
  const double below = 30 + row * static_cast<double>(most + 1) + 26;
  const double width = 2 * margin + static_cast<double>(columns) * (plot_width + gutter) - gutter;
  const double height = head + static_cast<double>(rows) * (plot_height + below + 22);
  Svg svg(static_cast<int>(width), static_cast<int>(height), "Ball on a plane under a cyclic load", style);

  const contact::CyclicBall& ball = scenes.front().ball;
  svg.text("title", {margin, 38}, "Ball on a plane under a cyclic load, seen from above");
  svg.text("soft", {margin, 62},
           fmt::format("load {:g} s in each direction 1, 2, 3, again and again; mu = {:g}, {:g} cycles", ball.phase,
                       ball.mu, ball.cycles));
  svg.text("soft", {margin, 82}, "o start at rest; marks where a cycle ends");
  compass(svg, ball, {width - margin - 46, 52});
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    const double left = margin + static_cast<double>(k % 2) * (plot_width + gutter);
    const double top = head + static_cast<double>(k / 2) * (plot_height + below + 22);
    const Panel panel{left, left + plot_width, top, top + plot_height};
    const View view = view_of(scenes[k], panel);
    svg.text("panel-title", {left, top - 12}, panel_title(scenes[k]));
    grid(svg, view);
    for (std::size_t j = 0; j < scenes[k].paths.size(); ++j)
      draw(svg, view, scenes[k].paths[j], look(scenes[k].paths[j], j), scenes[k].ball);
    svg.marker("start", Marker::Dot, view(Vec3::Zero()), 3.4, "start");
    label_ends(svg, view, scenes[k]);
    table(svg, panel, scenes[k]);
  }
  return svg.finish();
}

}  // namespace perp::app::contacts

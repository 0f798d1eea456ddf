// SPDX-License-Identifier: Apache-2.0
#include "app/contact/forces_svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <vector>

#include "app/text/plot_layout.hpp"
#include "app/text/svg.hpp"
#include "app/text/table.hpp"
#include "contact/laws/polygon.hpp"

namespace perp::app::contacts {

namespace {

using contact::State;
using lcp::Index;
using Anchor = Svg::Anchor;
using Marker = Svg::Marker;

constexpr double width = 1200;
constexpr double margin = 24;
constexpr double top = 122;          // of the disks
constexpr double overview = 330;     // width of the column with all in one disk
constexpr double farthest = 1.45;    // radii: where a force outside of its cone is drawn at most
constexpr double decades = 3;        // of logarithmic bars
constexpr double disk_share = 0.31;  // radius of a disk in widths of its cell
constexpr double disk_centre = 0.4;  // from the left of its cell
constexpr double ticked = 46;        // and the direction of slip
constexpr double numbered = 44;      // cells from this width on have their number, smaller ones their row's

constexpr std::string_view style = R"css(
text { font: 13px system-ui, "DejaVu Sans", "Liberation Sans", Arial, sans-serif; fill: #222; }
.title { font-size: 18px; font-weight: 600; }
.soft { fill: #555; } .small { font-size: 11px; fill: #555; } .bad { fill: #b00020; font-weight: 600; }
.rim { fill: none; stroke-width: 1; } .rim-stick { fill: #e6f0f8; stroke: #7fb2d6; }
.rim-slip { fill: #fdeadd; stroke: #D55E00; stroke-width: 2; } .rim-open { fill: #fff; stroke: #9a9a9a; stroke-dasharray: 2.5 2.5; }
.rim-all { fill: #fafafa; stroke: #555; stroke-width: 1.4; }
.interval { stroke-width: 1.4; } .interval.rim-slip { stroke-width: 2.4; }
.polygon { fill: none; stroke: #6a6a6a; stroke-width: .8; }
.axis { stroke: #d4d4d4; stroke-width: 1; }
.stick { fill: #0072B2; stroke: #0072B2; } .slip { fill: #D55E00; stroke: #D55E00; } .open { fill: none; stroke: #767676; }
.mark { stroke: #fff; stroke-width: .6; } .open.stroke { stroke: #767676; stroke-width: 1.4; }
.force { stroke-width: 1.4; } .through { fill-opacity: .72; }
.against { stroke: #222; stroke-width: 1.6; }
.track { fill: #ececec; } .bar-stick { fill: #0072B2; } .bar-slip { fill: #D55E00; } .bar-open { fill: #9a9a9a; }
.hollow { fill: none; } .frame { fill: none; stroke: #999; stroke-width: .6; }
)css";

std::string_view css_of(State state) {
  constexpr std::array<std::string_view, 3> names{"open", "stick", "slip"};
  return names.at(static_cast<std::size_t>(state));
}
Marker shape_of(State state) {
  return state == State::Stick ? Marker::Dot : state == State::Slip ? Marker::Diamond : Marker::Cross;
}

/// Of a contact, in radii of its disk; the second component grows downwards, as pixels do.
struct Point {
  double x = 0, y = 0;
  double size() const { return std::hypot(x, y); }
};

struct Contact {
  Index number = 0;  // from 1
  State state = State::Open;
  double r_N = 0;  // not below 0
  bool friction = true;
  Point force{};    // r_T / (mu r_N)
  Point against{};  // -u_T / |u_T| where it slips
  std::string tip{};
};

Point tangential(lcp::In values, Index a, int d) { return {values[d * a + 1], d == 3 ? -values[d * a + 2] : 0.0}; }

std::vector<Contact> contacts_of(const contact::Problem& problem, const Run& run) {
  const int d = problem.dimension;
  std::vector<Contact> all;
  for (Index a = 0; a < problem.contacts(); ++a) {
    const contact::ContactState& s = run.states[static_cast<std::size_t>(a)];
    const double r_N = run.solution.r[d * a];
    const double most = problem.mu[a] * r_N;
    Contact c{.number = a + 1, .state = s.state, .r_N = std::max(0.0, r_N), .friction = problem.mu[a] > 0};
    const Point r_T = tangential(run.solution.r, a, d);
    if (s.state != State::Open && most > 0) {
      c.force = {r_T.x / most, r_T.y / most};
      if (const double size = c.force.size(); size > farthest)
        c.force = {c.force.x * farthest / size, c.force.y * farthest / size};
    }
    const Point u_T = tangential(run.solution.u, a, d);
    if (s.state == State::Slip && u_T.size() > 0) c.against = {-u_T.x / u_T.size(), -u_T.y / u_T.size()};
    c.tip =
        fmt::format("contact {}: {}; r_N {}, r_T {}{}, mu {}, mu r_N {} N s; u_N {}, |u_T| {} m/s", a + 1,
                    name(s.state), number(r_N, 4), number(r_T.x, 4), d == 3 ? ", " + number(-r_T.y, 4) : "",
                    number(problem.mu[a], 4), number(most, 4), number(run.solution.u[d * a], 4), number(u_T.size(), 4));
    all.push_back(std::move(c));
  }
  return all;
}

/// The polygon of a faceted law, closed; empty for others.
std::vector<Point> outline(const Run& run, int dimension) {
  std::vector<Point> corners;
  if (!run.variant.faceted() || dimension == 2) return corners;
  const contact::Polygon polygon = run.variant.polygons(dimension)[0];
  for (Index k = 0; k <= polygon.facets(); ++k)
    corners.push_back({polygon.vertices()(0, k % polygon.facets()), -polygon.vertices()(1, k % polygon.facets())});
  return corners;
}

/// Are bars of a linear scale too short to be read?
bool wide_range(const std::vector<Contact>& contacts, double largest) {
  std::vector<double> loads;
  for (const Contact& c : contacts)
    if (c.state != State::Open) loads.push_back(c.r_N);
  if (loads.empty()) return false;
  const auto middle = loads.begin() + static_cast<std::ptrdiff_t>(loads.size() / 2);
  std::ranges::nth_element(loads, middle);
  return *middle < largest / 8;
}

struct Grid {
  double left = 0, cell = 0, height = 0;
  Index columns = 1;
  bool numbers = true;
  /// Upper left corner of the k-th cell.
  Pixel corner(Index k) const {
    const Index row = k / columns;
    return {left + cell * static_cast<double>(k - row * columns), top - 8 + height * static_cast<double>(row)};
  }
  double bottom(Index n) const { return corner(n - 1).y + height + 8; }
};

/// The largest cells with which all fit on a page of the usual height.
Grid grid_for(Index n, double left) {
  Grid grid;
  for (const double cell : {220.0, 160.0, 128.0, 100.0, 80.0, 64.0, 52.0, 44.0, 36.0, 30.0, 25.0}) {
    grid.numbers = cell >= numbered;
    grid.left = left + (grid.numbers ? 0 : 34);
    grid.cell = cell;
    grid.height = cell + (grid.numbers ? 10 : 0);
    grid.columns = std::max<Index>(1, static_cast<Index>((width - margin - grid.left) / cell));
    if (grid.bottom(n) <= 880) break;
  }
  return grid;
}

class Drawing {
 public:
  Drawing(const Loaded& loaded, const Run& run) : loaded_(loaded), run_(run), d_(loaded.problem.dimension) {
    const contact::Problem& problem = loaded.problem;
    for (Index a = 0; a < problem.contacts(); ++a) largest_ = std::max(largest_, run.solution.r[d_ * a]);
    contacts_ = contacts_of(problem, run);
    logarithmic_ = wide_range(contacts_, largest_);
    outline_ = outline(run, d_);
    if (static_cast<Index>(contacts_.size()) > most_drawn) {
      std::ranges::nth_element(contacts_, contacts_.begin() + most_drawn, std::ranges::greater{}, &Contact::r_N);
      contacts_.resize(static_cast<std::size_t>(most_drawn));
      std::ranges::sort(contacts_, {}, &Contact::number);
    }
  }

  std::string draw() {
    const auto n = static_cast<Index>(contacts_.size());
    const bool all_in_one = d_ == 3 && n > 1;
    const Grid grid = grid_for(n, all_in_one ? margin + overview : margin);
    const double bottom = std::max(grid.bottom(n), all_in_one ? top + overview + 30 : 0) + margin;
    Svg svg(static_cast<int>(width), static_cast<int>(bottom), fmt::format("{}: contact forces", loaded_.label), style);
    head(svg, grid.cell > ticked);
    if (all_in_one) together(svg);
    one_by_one(svg, grid);
    return svg.finish();
  }

 private:
  void head(Svg& svg, bool ticks) const {
    svg.text("title", {margin, 32},
             fmt::format("{}: contact forces, seen along the normals",
                         shortened(std::filesystem::path(loaded_.label).filename().string(), 70)));
    const auto all = loaded_.problem.contacts();
    const std::string law = run_.variant.exact() ? "Coulomb's law" : run_.variant.formulation() + ", not Coulomb's law";
    std::string text =
        fmt::format("{}: {} stick, {} slip, {} open; {}", count(all, "contact"), run_.in_state(State::Stick),
                    run_.in_state(State::Slip), run_.in_state(State::Open), law);
    if (static_cast<Index>(contacts_.size()) < all)
      text += fmt::format("; the {} with the largest r_N are drawn", contacts_.size());
    svg.text(run_.solved ? "soft" : "bad", {margin, 54},
             run_.solved ? text : text + fmt::format("; NOT SOLVED ({})", to_string(run_.status)));
    Legend legend(svg, {margin, 80}, width - margin);
    legend.marker("stick", Marker::Dot, "stick: inside");
    legend.marker("slip", Marker::Diamond, "slip: on the rim");
    legend.marker("open", Marker::Cross, "open: no force");
    if (ticks)
      legend.line("against", d_ == 3 ? "against the slip (-u_T): where friction belongs" : "against the slip (-u_T)");
    Legend second(svg, {margin - 8, 102}, width - margin);
    second.words(d_ == 3 ? "disk: |r_T| <= mu r_N, scaled to one size; T1 right, T2 up"
                         : "interval: |r_T| <= mu r_N, scaled to one size");
    second.box("bar-stick", logarithmic_ ? fmt::format("bar: r_N, logarithmic, from {} N s at its foot to {}",
                                                       number(largest_ / std::pow(10, decades), 3), number(largest_, 3))
                                         : fmt::format("bar: r_N, full height {} N s", number(largest_, 3)));
    if (!outline_.empty()) second.line("polygon", "friction polygon of this formulation");
  }

  /// Of a bar, from 0 to 1.
  double height(double r_N) const {
    if (!(r_N > 0) || !(largest_ > 0)) return 0;
    if (!logarithmic_) return r_N / largest_;
    return std::max(0.04, 1 + std::log10(r_N / largest_) / decades);
  }

  static Pixel at(Pixel centre, const Point& p, double radius) {
    return {centre.x + radius * p.x, centre.y + radius * p.y};
  }

  void polygon(Svg& svg, Pixel centre, double radius) const {
    std::vector<Pixel> line;
    for (const Point& corner : outline_) line.push_back(at(centre, corner, radius));
    svg.polyline("polygon", line);
  }

  /// Marks of all contacts in one disk, the largest r_N first so that small ones are seen.
  void together(Svg& svg) const {
    const double radius = 132;
    const Pixel centre{margin + overview / 2 - 14, top + 26 + radius};
    svg.text("soft", {centre.x, top + 4}, "all in one disk, areas as r_N", Anchor::Middle);
    svg.marker("rim-all", Marker::Dot, centre, radius);
    svg.line("axis", {centre.x - radius, centre.y}, {centre.x + radius, centre.y});
    svg.line("axis", {centre.x, centre.y - radius}, {centre.x, centre.y + radius});
    svg.text("small", {centre.x + radius + 5, centre.y + 4}, "T1");
    svg.text("small", {centre.x, centre.y - radius - 5}, "T2", Anchor::Middle);
    polygon(svg, centre, radius);
    std::vector<std::size_t> order(contacts_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t k) { return contacts_[k].r_N; });
    Index beside = 0;
    for (const std::size_t k : order) {
      const Contact& c = contacts_[k];
      if (c.state == State::Open || !c.friction) {
        ++beside;
        continue;
      }
      svg.marker(fmt::format("{} mark through", css_of(c.state)), shape_of(c.state), at(centre, c.force, radius),
                 std::max(2.2, 8 * std::sqrt(c.r_N / largest_)), c.tip);
    }
    if (beside > 0)
      svg.text("small", {centre.x, centre.y + radius + 22},
               fmt::format("without the {} that {} open or without friction", beside, beside == 1 ? "is" : "are"),
               Anchor::Middle);
  }

  void one_by_one(Svg& svg, const Grid& grid) const {
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
      const auto place = static_cast<Index>(k);
      const auto [x, y] = grid.corner(place);
      if (!grid.numbers && place % grid.columns == 0)
        svg.text("small", {grid.left - 6, y + grid.cell / 2 + 4}, fmt::format("{}", contacts_[k].number), Anchor::End);
      if (grid.numbers)
        svg.text("small", {x + disk_centre * grid.cell, y + 10}, fmt::format("{}", contacts_[k].number),
                 Anchor::Middle);
      one(svg, contacts_[k], {x + disk_centre * grid.cell, y + grid.cell / 2 + (grid.numbers ? 10 : 0)},
          disk_share * grid.cell);
    }
  }

  void rim(Svg& svg, const Contact& c, Pixel centre, double radius) const {
    const std::string css = fmt::format("rim rim-{}", css_of(c.state));
    if (!c.friction) return svg.marker("rim rim-open", Marker::Dot, centre, 0.2 * radius, c.tip);
    if (d_ == 3) {
      svg.marker(css, Marker::Dot, centre, radius, c.tip);
      return polygon(svg, centre, radius);
    }
    const std::string interval = fmt::format("interval {}", css);
    svg.line(interval, {centre.x - radius, centre.y}, {centre.x + radius, centre.y});
    for (const double end : {-radius, radius})
      svg.line(interval, {centre.x + end, centre.y - 0.3 * radius}, {centre.x + end, centre.y + 0.3 * radius});
    svg.line("axis", {centre.x, centre.y - 0.15 * radius}, {centre.x, centre.y + 0.15 * radius});
  }

  void one(Svg& svg, const Contact& c, Pixel centre, double radius) const {
    const std::string_view css = css_of(c.state);
    rim(svg, c, centre, radius);
    if (c.against.size() > 0 && c.friction && radius > disk_share * ticked)
      svg.line("against", at(centre, c.against, 1.06 * radius), at(centre, c.against, 1.34 * radius));
    const Pixel tip = at(centre, c.force, radius);
    if (c.force.size() > 0.02) svg.line(fmt::format("force {}", css), centre, tip);
    const double mark = std::clamp(0.13 * radius, c.state == State::Slip ? 2.3 : 1.8, 6.0);
    svg.marker(c.state == State::Open ? "open" : fmt::format("{} mark", css), shape_of(c.state), tip,
               c.state == State::Slip ? 1.15 * mark : mark, c.tip);
    const double bar = std::max(2.0, 0.13 * radius);
    const Pixel corner{centre.x + (radius > disk_share * ticked ? 1.4 : 1.2) * radius, centre.y - radius};
    svg.rectangle("track", corner, bar, 2 * radius);
    if (const double share = height(c.r_N); share > 0)
      svg.rectangle(fmt::format("bar-{}", css), {corner.x, corner.y + 2 * radius * (1 - share)}, bar,
                    2 * radius * share);
  }

  const Loaded& loaded_;
  const Run& run_;
  int d_;
  double largest_ = 0;
  bool logarithmic_ = false;
  std::vector<Contact> contacts_;
  std::vector<Point> outline_;
};

}  // namespace

std::string forces_svg(const Loaded& loaded, const Run& run) { return Drawing(loaded, run).draw(); }

}  // namespace perp::app::contacts

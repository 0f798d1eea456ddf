// SPDX-License-Identifier: Apache-2.0
#include "app/report/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "app/text/plot_layout.hpp"
#include "app/text/table.hpp"

namespace perp::app {

namespace {

using Marker = Svg::Marker;

constexpr int width = 1280;
constexpr int height = 1020;
constexpr Panel upper{.left = 96, .right = 1200, .top = 96, .bottom = 420};
constexpr Panel lower{.left = 96, .right = 1200, .top = 602, .bottom = 900};

// Okabe & Ito's colours, which people with any colour vision tell apart; dashes and shapes say the same in print.
constexpr std::string_view style =
    "text{font-family:'DejaVu Sans',Verdana,Arial,sans-serif;font-size:14px;fill:#000}"
    ".title{font-size:20px;font-weight:bold}.subtitle{font-size:16px;font-weight:bold}.small{font-size:12px;paint-"
    "order:stroke;stroke:#fff;stroke-width:3px}"
    ".note{font-size:13px;fill:#333}"
    "polyline,line,path.stroke{fill:none}"
    ".frame{fill:none;stroke:#000}.grid{stroke:#ddd}.tick{stroke:#000}"
    ".merit{stroke:#0072B2;stroke-width:2.2}.residual{stroke:#D55E00;stroke-width:1.8;stroke-dasharray:7 4}"
    ".tolerance{stroke:#000;stroke-width:1.2;stroke-dasharray:2 3}"
    ".homotopy{stroke:#707070;stroke-width:1.4;stroke-dasharray:5 2 1 2}"
    ".crash{fill:#f0f0f0}.chosen{fill:#fdf3d8}.restart{stroke:#000;stroke-width:1.4;stroke-dasharray:8 3}"
    ".step{fill:#0072B2;stroke:#000;stroke-width:1}.hollow{fill:#fff}.stroke{stroke:#000;stroke-width:1.8}"
    ".kink{fill:#fff;stroke:#0072B2;stroke-width:1.6}.mark{stroke:#0072B2;stroke-width:1}"
    ".end{fill:#0072B2;stroke:#000}.accepted{fill:#D55E00;stroke:#000;stroke-width:1.2}"
    ".accepted-line{stroke:#D55E00;stroke-width:1.4}.refused{stroke:#000;stroke-width:2}";

/// How a step is drawn and called.
struct StepType {
  std::string_view letters;
  Marker shape;
  std::string_view words;
};
constexpr std::array step_types{
    StepType{"IR", Marker::Ring, "start, restart"},       StepType{"C", Marker::Plus, "crash"},
    StepType{"OMN", Marker::Dot, "Newton point"},         StepType{"D", Marker::Diamond, "D-step, untested"},
    StepType{"B", Marker::TriangleDown, "searched back"}, StepType{"W", Marker::Square, "watchdog"},
    StepType{"G", Marker::TriangleUp, "gradient step"},   StepType{"", Marker::Cross, "other"}};

const StepType& step_type(char kind) {
  const auto* found = std::ranges::find_if(
      step_types, [&](const StepType& type) { return type.letters.find(kind) != std::string_view::npos; });
  return found == step_types.end() ? step_types.back() : *found;
}

std::string_view linear_words(char linear) {
  switch (linear) {
    case 'S':
      return "solved";
    case 'R':
      return "ended on a ray";
    case 'C':
      return "came back to its start";
    case 'N':
      return "met a singular basis";
    case 'I':
      return "met the limit of pivots";
    case 'T':
      return "inaccurate";
    default:
      return "stopped";
  }
}

/// Two letters as in the log.
std::string type_of(const ncp::Iteration& it) {
  std::string type;
  if (it.linear != ' ') type += it.linear;
  if (it.kind != ' ') type += it.kind;
  return type;
}

/// The upper panel.
class Progress {
 public:
  Progress(Svg& svg, const Report& report, const std::optional<KeptWay>& way)
      : svg_(svg),
        records_(report.iterations),
        tol_(ncp::stop(report.settings.method).tol),
        way_(way),
        x_(Scale::linear(-0.6, static_cast<double>(records_.size()) - 0.4, upper.left, upper.right)),
        y_(Scale::logarithmic(values(), upper.bottom, upper.top)) {}

  void draw() {
    svg_.begin_group("progress");
    regions();
    axes();
    curves();
    restarts();
    markers();
    svg_.rectangle("frame", {upper.left, upper.top}, upper.width(), upper.height());
    legend();
    svg_.end_group();
  }

 private:
  std::vector<double> values() const {
    std::vector<double> values{tol_};
    for (const ncp::Iteration& it : records_) values.insert(values.end(), {it.residual, merit(it)});
    return values;
  }
  /// NaN where a record has none (of a linear method, of a proximal escape).
  static double merit(const ncp::Iteration& it) {
    return it.merit > 0 || it.residual == 0 ? it.merit : std::numeric_limits<double>::quiet_NaN();
  }
  bool drawn_below(const ncp::Iteration& it) const {
    return way_ && !it.crash && it.k == way_->iteration.k && it.kind != 'R' && it.kind != 'I';
  }

  void regions() {
    for (std::size_t r = 0; r < records_.size(); ++r) {
      const double left = std::max(upper.left, x_(static_cast<double>(r) - 0.5));
      const double span = x_(1) - x_(0);
      if (records_[r].kind == 'C') svg_.rectangle("crash", {left, upper.top}, span, upper.height());
      if (drawn_below(records_[r])) svg_.rectangle("chosen", {left, upper.top}, span, upper.height());
    }
  }

  void axes() {
    y_axis(svg_, upper, y_, "merit, residual");
    const std::size_t every = std::max<std::size_t>(1, (records_.size() + 24) / 25);
    for (std::size_t r = 0; r < records_.size(); r += every) {
      const double x = x_(static_cast<double>(r));
      svg_.line("tick", {x, upper.bottom}, {x, upper.bottom + 5});
      svg_.text("small", {x, upper.bottom + 19}, records_[r].kind == 'C' ? "c" : fmt::format("{}", records_[r].k),
                Svg::Anchor::Middle);
    }
    svg_.text("", {upper.middle(), upper.bottom + 40}, "iteration (major; c: of the crash)", Svg::Anchor::Middle);
  }

  void curves() {
    std::vector<Pixel> merits;
    std::vector<Pixel> residuals;
    for (std::size_t r = 0; r < records_.size(); ++r) {
      const double x = x_(static_cast<double>(r));
      if (!records_[r].attempt.empty()) {  // a restart goes on from another point
        merits.push_back({x, std::nan("")});
        residuals.push_back({x, std::nan("")});
      }
      merits.push_back({x, y_(merit(records_[r]))});
      residuals.push_back({x, y_(records_[r].residual)});
    }
    const double tol = y_(tol_);
    svg_.line("tolerance", {upper.left, tol}, {upper.right, tol});
    svg_.polyline("residual", residuals);
    svg_.polyline("merit", merits);
  }

  void restarts() {
    double free = 0;  // left of it there are words already
    for (std::size_t r = 0; r < records_.size(); ++r)
      if (!records_[r].attempt.empty()) {
        const double x = x_(static_cast<double>(r) - 0.5);
        svg_.line("restart", {x, upper.top}, {x, upper.bottom});
        free = std::max(free, x) + 13;
        svg_.text("small", {free, upper.top + 8}, shortened("restart: " + records_[r].attempt, 46), Svg::Anchor::End,
                  -90);
      }
  }

  void markers() {
    const bool letters = records_.size() <= 40;
    const double radius = records_.size() <= 100 ? 5 : records_.size() <= 300 ? 3 : 1.8;
    for (std::size_t r = 0; r < records_.size(); ++r) {
      const ncp::Iteration& it = records_[r];
      const double y = y_(merit(it));
      const Pixel at{x_(static_cast<double>(r)), std::isfinite(y) ? y : y_(it.residual)};
      svg_.marker("step", step_type(it.kind).shape, at, radius,
                  fmt::format("iteration {} {}: merit {:.3e}, residual {:.3e}, step {:.3g}", it.k, type_of(it),
                              it.merit, it.residual, it.step));
      if (letters && std::isfinite(at.y))
        svg_.text("small", {at.x, at.y - 10 < upper.top + 11 ? at.y + 20 : at.y - 10}, type_of(it),
                  Svg::Anchor::Middle);
    }
  }

  void legend() {
    Legend legend(svg_, {upper.left, upper.bottom + 64}, upper.right);
    legend.line("merit", "merit");
    legend.line("residual", "natural residual");
    legend.line("tolerance", fmt::format("tolerance {:g}", tol_));
    for (const StepType& type : step_types) {
      const auto has = [&](const ncp::Iteration& it) { return &step_type(it.kind) == &type; };
      if (std::ranges::any_of(records_, has)) legend.marker("step", type.shape, type.words);
    }
    if (std::ranges::any_of(records_, [](const auto& it) { return it.kind == 'C'; })) legend.box("crash", "crash");
    if (way_) legend.box("chosen", "drawn below");
  }

  Svg& svg_;
  const std::vector<ncp::Iteration>& records_;
  double tol_;
  const std::optional<KeptWay>& way_;
  Scale x_, y_;
};

/// The lower panel.
class WayPicture {
 public:
  WayPicture(Svg& svg, const ncp::PathSearch& method, const KeptWay& way)
      : svg_(svg),
        method_(method),
        way_(way),
        it_(way.iteration),
        end_(static_cast<double>(way.segments())),
        x_(Scale::linear(0, end_, lower.left, lower.right)),
        y_(Scale::logarithmic(values(), lower.bottom, lower.top)) {}

  void draw() {
    svg_.begin_group("way");
    heading();
    axes();
    homotopy();
    curve();
    kinks();
    refused();
    accepted();
    svg_.rectangle("frame", {lower.left, lower.top}, lower.width(), lower.height());
    legend();
    svg_.end_group();
  }

 private:
  std::vector<double> values() const {
    std::vector<double> values;
    for (const WaySample& sample : way_.samples) values.push_back(sample.merit);
    return values;
  }
  bool taken() const { return it_.kind != 'G' && it_.step > 0; }
  Pixel at(double s) const { return {x_(s), y_(way_.merit(s))}; }

  void heading() {
    const std::string pivots = fmt::format("{} in all", count(it_.pivots, "pivot"));
    const std::string what =
        way_.on_path ? fmt::format("the path of the linearised problem, {}, {}",
                                   count(static_cast<long long>(way_.kinks()), "kink"), pivots)
                     : fmt::format("the straight way to the Newton point{}, {}",
                                   method_.search == ncp::Searchtype::Path ? " (found from a ray)" : "", pivots);
    svg_.text("subtitle", {lower.left, lower.top - 44},
              fmt::format("Iteration {} ({}): {}", it_.k, type_of(it_), what));
    std::string note = fmt::format("The linearised problem: {}", linear_words(it_.linear));
    if (it_.prox > 0) note += fmt::format(", with proximal term {:.1e}", it_.prox);
    if (taken())
      note += fmt::format("; accepted: {}, T = {:g}", step_type(it_.kind).words, way_.T);
    else
      note += it_.kind == 'G' ? "; a gradient step was taken in its place" : "; no point of the way was accepted";
    if (it_.backtracks > 0) note += fmt::format(", {} refused before", count(it_.backtracks, "point"));
    if (it_.kind == 'W') note += "; the way is the one from the last point that passed a test";
    svg_.text("note", {lower.left, lower.top - 22}, note + '.');
  }

  void axes() {
    y_axis(svg_, lower, y_, method_.merit == ncp::PathMerit::Fischer ? "Fischer-Burmeister merit" : "normal-map merit");
    for (const Scale::Tick& tick : x_.ticks(way_.on_path ? std::min(20, static_cast<int>(way_.segments())) : 10)) {
      svg_.line("tick", {x_(tick.value), lower.bottom}, {x_(tick.value), lower.bottom + 9});
      svg_.text("small", {x_(tick.value), lower.bottom + 23}, tick.label, Svg::Anchor::Middle);
    }
    svg_.text("", {lower.middle(), lower.bottom + 43},
              way_.on_path ? "kink of the path (0: the iterate before; a pivot each)" : "T (0: the iterate before)",
              Svg::Anchor::Middle);
  }

  /// t along the path, on an axis of its own on the right.
  void homotopy() {
    if (!way_.on_path) return;
    const double low = std::min(0.0, *std::ranges::min_element(way_.t));
    const double high = std::max(1.0, *std::ranges::max_element(way_.t));
    const double room = 0.03 * (high - low);
    const Scale t = Scale::linear(low - room, high + room, lower.bottom, lower.top);
    std::vector<Pixel> line;
    for (std::size_t k = 0; k < way_.t.size(); ++k) line.push_back({x_(static_cast<double>(k)), t(way_.t[k])});
    svg_.polyline("homotopy", line);
    for (const Scale::Tick& tick : t.ticks(5)) {
      svg_.line("tick", {lower.right, t(tick.value)}, {lower.right + 5, t(tick.value)});
      svg_.text("small", {lower.right + 9, t(tick.value) + 4}, tick.label);
    }
    svg_.text("", {lower.right + 52, (lower.top + lower.bottom) / 2}, "t", Svg::Anchor::Middle);
  }

  void curve() {
    std::vector<Pixel> line;
    for (const WaySample& sample : way_.samples) line.push_back({x_(sample.s), y_(sample.merit)});
    svg_.polyline("merit", line);
  }

  /// A mark on the axis for every kink, whether or not F is defined there, and one on the curve.
  void kinks() {
    const double radius = way_.kinks() <= 60 ? 4.5 : way_.kinks() <= 300 ? 2.5 : 1.3;
    for (std::size_t k = 1; k <= way_.kinks(); ++k) {
      const auto s = static_cast<double>(k);
      svg_.line("mark", {x_(s), lower.bottom - 7}, {x_(s), lower.bottom});
      svg_.marker("kink", Marker::Dot, at(s), radius,
                  fmt::format("kink {}: t = {:.6g}, merit {:.3e}", k, way_.t[k], way_.merit(s)));
    }
    svg_.marker("end", Marker::Square, at(0), 5, "the iterate before");
    svg_.marker("end", Marker::Square, at(end_), 5,
                it_.linear == 'S' ? "the Newton point" : "where the linearised problem ended");
  }

  /// What a search back tried before: T = 1, beta, ...
  void refused() {
    if (it_.kind != 'B' || !taken()) return;
    double T = 1;
    for (int k = 0; k < it_.backtracks && T > way_.T; ++k, T *= method_.beta)
      svg_.marker("refused", Marker::Cross, at(way_.place(T)), 6, fmt::format("refused: T = {:g}", T));
  }

  void accepted() {
    if (!taken()) return;
    const Pixel here = at(way_.place(way_.T));
    svg_.line("accepted-line", {here.x, lower.top}, {here.x, lower.bottom});
    svg_.marker("accepted", Marker::Diamond, here, 7, fmt::format("accepted: T = {:g}", way_.T));
  }

  void legend() {
    Legend legend(svg_, {lower.left, lower.bottom + 68}, lower.right);
    legend.line("merit", "merit along the way");
    if (way_.kinks() > 0) legend.marker("kink", Marker::Dot, "kink (pivot)");
    legend.marker("end", Marker::Square, "begin and end of the way");
    if (way_.on_path) legend.line("homotopy", "t: 0 at the iterate, 1 at the Newton point");
    if (it_.kind == 'B' && way_.T < 1) legend.marker("refused", Marker::Cross, "refused");
    if (taken()) legend.marker("accepted", Marker::Diamond, fmt::format("accepted, T = {:g}", way_.T));
    if (std::ranges::any_of(way_.samples, [](const WaySample& sample) { return std::isnan(sample.merit); }))
      legend.words("gap: F is not defined there");
  }

  Svg& svg_;
  const ncp::PathSearch& method_;
  const KeptWay& way_;
  const ncp::Iteration& it_;
  double end_;
  Scale x_, y_;
};

}  // namespace

std::string plot_svg(const Report& report, const std::optional<KeptWay>& way) {
  const LoadedProblem& problem = *report.problem;
  const std::string title =
      fmt::format("{}, start {}, method {}: {} after {}", problem.label, problem.start, report.settings.method_name,
                  ncp::to_string(report.result.status), count(report.result.stats.iterations, "iteration"));
  Svg svg(width, height, title, style);
  svg.text("title", {upper.left, 34}, shortened(title, 88));
  svg.text("note", {upper.left, 58},
           fmt::format("{}, {}, {}, {}; natural residual {:.3e}", count(problem.mcp->size(), "variable"),
                       count(report.result.stats.pivots, "pivot"),
                       count(report.result.stats.crash_iterations, "crash iteration"),
                       count(report.result.stats.restarts, "restart"), report.result.residual.natural));
  Progress(svg, report, way).draw();
  if (const ncp::PathSearch* method = ncp::path_of(report.settings.method); way && method != nullptr)
    WayPicture(svg, *method, *way).draw();
  else
    svg.text("note", {lower.left, lower.top},
             "No iteration of this run followed the way of a linearised problem: there is no path to show.");
  return svg.finish();
}

}  // namespace perp::app

// SPDX-License-Identifier: Apache-2.0
/// Pictures of runs: well-formed, complete, and true to the run they are of.
#include "app/report/plot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "app/commands/solve.hpp"
#include "app/support.hpp"
#include "app/text/svg.hpp"

namespace perp::app {
namespace {

using testing::HasSubstr;

/// What an XML document consists of; throws where it is not well-formed (tags, attributes, entities).
struct Xml {
  std::map<std::string, int> classes;  // elements that are not of a legend, by first class
  std::string text;                    // of all text elements, one a line

  explicit Xml(const std::string& document) : in_(document) {
    if (!document.starts_with("<?xml ")) throw std::runtime_error("no declaration");
    at_ = document.find("?>") + 2;
    while (at_ < in_.size()) in_[at_] == '<' ? tag() : characters();
    if (!open_.empty()) throw std::runtime_error(open_.back() + " is open");
  }

 private:
  void characters() {
    const std::size_t end = std::min(in_.find('<', at_), in_.size());
    const std::string words = in_.substr(at_, end - at_);
    if (words.find('>') != std::string::npos) throw std::runtime_error("stray >");
    for (std::size_t k = words.find('&'); k != std::string::npos; k = words.find('&', k + 1)) {
      const std::string entity = words.substr(k, words.find(';', k) - k + 1);
      if (entity != "&amp;" && entity != "&lt;" && entity != "&gt;" && entity != "&quot;")
        throw std::runtime_error("entity " + entity);
    }
    if (!open_.empty() && open_.back() == "text") text += words + '\n';
    at_ = end;
  }

  void tag() {
    const std::size_t end = in_.find('>', at_);
    if (end == std::string::npos) throw std::runtime_error("open tag");
    std::string inside = in_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    if (inside.starts_with('/')) {
      if (open_.empty() || open_.back() != inside.substr(1)) throw std::runtime_error("closes " + inside);
      open_.pop_back();
      return;
    }
    const bool empty = inside.ends_with('/');
    if (empty) inside.pop_back();
    const std::size_t name_end = std::min(inside.find(' '), inside.size());
    for (std::size_t k = name_end; k < inside.size();) attribute(inside, k);
    if (!empty) open_.push_back(inside.substr(0, name_end));
  }

  void attribute(const std::string& inside, std::size_t& k) {
    const std::size_t equals = inside.find("=\"", k);
    const std::size_t close = equals == std::string::npos ? equals : inside.find('"', equals + 2);
    if (close == std::string::npos || inside[k] != ' ') throw std::runtime_error("attribute in " + inside);
    const std::string value = inside.substr(equals + 2, close - equals - 2);
    if (value.find('<') != std::string::npos || value.find("nan") != std::string::npos ||
        value.find("inf") != std::string::npos)
      throw std::runtime_error("value " + value);
    if (inside.substr(k + 1, equals - k - 1) == "class" && value.find("legend") == std::string::npos)
      ++classes[value.substr(0, value.find(' '))];
    k = close + 1;
  }

  const std::string& in_;
  std::size_t at_ = 0;
  std::vector<std::string> open_;
};

struct Pictured {
  Report report;
  std::optional<KeptWay> way;
  std::string svg;
};

Pictured pictured(const LoadedProblem& problem, const std::vector<Assignment>& options = {},
                  std::optional<int> iteration = {}) {
  const Settings settings = apply_options(options).settings;
  WayKeeper keeper(iteration, ncp::PathMerit::Fischer);
  Report report = run_method(problem, settings, nullptr, keeper.observer());
  std::string svg = plot_svg(report, keeper.kept());
  return {std::move(report), keeper.kept(), std::move(svg)};
}

// Would catch kinks or iterations that are left out, and a picture that does not say what it is of.
TEST(Plot, ShowsEveryIterationAndEveryKink) {
  for (const char* name : {"josephy", "kojshin", "colvdual", "nash10", "walras-own-1000"}) {
    const LoadedProblem problem = load_problem(name);
    const Pictured picture = pictured(problem, {{"crash_method", "none", "test"}});
    ASSERT_TRUE(picture.way) << name;
    const Xml xml(picture.svg);
    const auto count = [&](const char* css) { return xml.classes.contains(css) ? xml.classes.at(css) : 0; };
    EXPECT_EQ(count("step"), static_cast<int>(picture.report.iterations.size())) << name;
    EXPECT_EQ(count("kink"), static_cast<int>(picture.way->kinks())) << name;
    EXPECT_EQ(count("mark"), static_cast<int>(picture.way->kinks())) << name;
    EXPECT_EQ(count("accepted"), 1) << name;
    EXPECT_EQ(count("end"), 2) << name;
    EXPECT_THAT(xml.text, testing::AllOf(HasSubstr(name), HasSubstr("start 1"), HasSubstr("method auto"),
                                         HasSubstr("Solved"), HasSubstr("pivot"),
                                         HasSubstr("Iteration " + std::to_string(picture.way->iteration.k) + " ")));
    EXPECT_EQ(picture.svg.find("http"), picture.svg.rfind("http")) << "the name of the name space, and no address";
  }
}

// The curve at the point accepted is the merit the method itself found there, and at s = 0 that of the iterate before;
// for all iterations, whatever the way (a presolved or scaled problem has a merit of its own). Would catch a way that
// is not the one searched, kinks shifted by one, t taken for T, the merit of another function.
TEST(Plot, TheCurvePassesThroughTheIterates) {
  int backtracked = 0;
  struct Case {
    const char* name;
    int start;
    const char* searchtype;
  };
  for (const Case& of : {Case{"josephy", 3, "path"}, Case{"kojshin", 3, "path"}, Case{"nash-own", 3, "path"},
                         Case{"colvdual", 1, "path"}, Case{"josephy", 3, "arc"}, Case{"josephy", 3, "line"},
                         Case{"nash-own", 3, "arc"}}) {
    const LoadedProblem problem = load_problem(of.name, of.start);
    const std::vector<Assignment> options{{"method", "path-1997", "test"},
                                          {"merit_function", "fischer", "test"},
                                          {"gradient_step_limit", "5", "test"},
                                          {"nms_searchtype", of.searchtype, "test"}};
    double before = 0;
    const ncp::Observer check = ncp::of_ways([&](const ncp::Iteration& it) {
      if (it.way != nullptr && it.step > 0 && it.kind != 'G') {
        KeptWay kept{.iteration = it, .on_path = it.way->on_path};
        for (const lcp::Breakpoint& corner : it.way->kinks) kept.t.push_back(corner.t);
        const auto merit_at = [&](double s) {
          const auto k = std::min(static_cast<std::size_t>(s), it.way->kinks.size() - 2);
          const ncp::Vec& a = it.way->kinks[k].x;
          const ncp::Vec x = a + (s - static_cast<double>(k)) * (it.way->kinks[k + 1].x - a);
          return merit_along(*it.problem, {{.t = 0, .x = x}}, ncp::PathMerit::Fischer, 0).at(0).merit;
        };
        EXPECT_NEAR(merit_at(kept.place(it.way->T)), it.merit, 1e-7 * it.merit + 1e-20)
            << of.name << ' ' << of.searchtype << ' ' << it.k << ' ' << it.kind << " T = " << it.way->T;
        if (it.kind != 'W') {
          EXPECT_NEAR(merit_at(0), before, 1e-7 * before + 1e-20) << of.name << ' ' << of.searchtype << ' ' << it.k;
        }
        backtracked += it.way->T < 1;
      }
      before = it.merit;
      return ncp::Next::Continue;
    });
    run_method(problem, apply_options(options).settings, nullptr, check);
  }
  EXPECT_GT(backtracked, 4) << "the test is of searches, too";
}

TEST(Plot, TheIterationAskedForIsDrawn) {
  const LoadedProblem problem = load_problem("josephy", 3);
  for (const int k : {1, 2, 4}) {
    const Pictured picture = pictured(problem, {}, k);
    ASSERT_TRUE(picture.way);
    EXPECT_EQ(picture.way->iteration.k, k);
  }
  EXPECT_FALSE(pictured(problem, {}, 4000).way);
}

/// F(x) = x - 2 on x >= 0, not defined in (0.4, 0.6).
std::unique_ptr<ncp::Mcp> with_hole() {
  return ncp::make_mcp({.name = "hole",
                        .box = ncp::Box::nonnegative(1),
                        .pattern = ncp::dense_pattern(1),
                        .F =
                            [](ncp::In x, ncp::Out F) {
                              F[0] = x[0] - 2;
                              return x[0] <= 0.4 || x[0] >= 0.6;
                            },
                        .J =
                            [](ncp::In, ncp::SpMat& J) {
                              J.coeffRef(0, 0) = 1;
                              return true;
                            }});
}

// phi(a, b) = a + b - sqrt(a^2 + b^2) by hand; a point beyond the bound is projected. Would catch a curve through
// points where F is not defined, or one drawn by the coordinates of the normal map.
TEST(Plot, GapsWhereFIsNotDefined) {
  LoadedProblem problem{.label = "a <hole> & \"more\"", .mcp = with_hole(), .x0 = ncp::Vec::Zero(1)};
  const std::vector<lcp::Breakpoint> corners{{.t = 0, .x = ncp::Vec::Constant(1, -1)},
                                             {.t = 0.5, .x = ncp::Vec::Constant(1, 0)},
                                             {.t = 1, .x = ncp::Vec::Constant(1, 1)}};
  const auto samples = merit_along(*problem.mcp, corners, ncp::PathMerit::Fischer, 9);
  ASSERT_EQ(samples.size(), 21U);
  EXPECT_DOUBLE_EQ(samples[3].s, 0.3);
  EXPECT_DOUBLE_EQ(samples[3].merit, samples[10].merit) << "both project to 0, where phi(0, -2) = -4";
  EXPECT_DOUBLE_EQ(samples[3].merit, 8);
  EXPECT_TRUE(std::isnan(samples[15].merit));
  EXPECT_NEAR(samples[20].merit, 0.5 * std::pow(1 - 1 - std::sqrt(2.0), 2), 1e-15);
  EXPECT_NEAR(merit_along(*problem.mcp, corners, ncp::PathMerit::NormalMap, 0)[0].merit, 0.5 * 9, 1e-15);

  Report report;
  report.problem = &problem;
  report.settings = apply_options({}).settings;
  report.result.x = ncp::Vec::Zero(1);
  report.iterations = {{.k = 0, .residual = 1, .merit = 8, .kind = 'I'},
                       {.k = 1, .residual = ncp::infinity, .merit = 1, .step = 1, .kind = 'B', .linear = 'S'}};
  const KeptWay way{.iteration = report.iterations[1],
                    .on_path = true,
                    .T = 0.5,
                    .t = {0, 0.5, 1},
                    .samples_between = 9,
                    .samples = samples};
  const std::string svg = plot_svg(report, way);
  const Xml xml(svg);
  EXPECT_THAT(xml.text, testing::AllOf(HasSubstr("gap: F is not defined"), HasSubstr("a &lt;hole&gt; &amp; &quot;")));
  EXPECT_EQ(xml.classes.at("merit"), 1 + 2 + 2) << "of iterations; two pieces of the way; two legends";
}

// Restarts and other methods have records without a way, without a merit, with other letters.
TEST(Plot, AnyRunIsDrawn) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::infeasible_nl());
  const LoadedProblem infeasible = load_problem(folder / "m.nl");
  const Pictured restarted = pictured(infeasible, {{"method", "path", ""}});
  ASSERT_GT(restarted.report.result.stats.restarts, 0);
  const Xml xml(restarted.svg);
  EXPECT_EQ(xml.classes.at("restart"), restarted.report.result.stats.restarts);
  EXPECT_THAT(xml.text, HasSubstr("restart: "));

  const LoadedProblem problem = load_problem("kojshin");
  for (const char* method : {"semismooth", "josephy"}) {
    const Pictured picture = pictured(problem, {{"method", method, "test"}});
    EXPECT_THAT(Xml(picture.svg).text, testing::AllOf(HasSubstr(method), HasSubstr("no path to show")));
  }
  Report empty;
  empty.problem = &problem;
  empty.settings = apply_options({}).settings;
  EXPECT_NO_THROW(Xml(plot_svg(empty, {})));
}

// Would catch a long run whose picture cannot be written in the end.
TEST(Plot, UnwritableFilesAreRefusedBeforeTheRun) {
  const test::Folder folder;
  for (const std::string& path : {folder / "none/p.svg", folder / ""}) {
    test::Captured captured;
    EXPECT_EQ(solve({.problem = "josephy", .plot = path}, captured.streams), exit_input);
    EXPECT_EQ(captured.out.str(), "");
    EXPECT_THAT(captured.err.str(), testing::AllOf(HasSubstr(path), HasSubstr("cannot be written")));
  }
  test::Captured alone;
  EXPECT_EQ(solve({.problem = "josephy", .plot_iteration = 2}, alone.streams), exit_input);
  EXPECT_THAT(alone.err.str(), HasSubstr("--plot FILE"));
  test::Captured zero;
  EXPECT_EQ(solve({.problem = "josephy", .plot = folder / "p.svg", .plot_iteration = 0}, zero.streams), exit_input);
  EXPECT_FALSE(std::filesystem::exists(folder / "p.svg"));
}

TEST(Plot, OnTheCommand) {
  const test::Folder folder;
  test::Captured captured;
  EXPECT_EQ(solve({.problem = "josephy", .plot = folder / "p.svg", .plot_iteration = 2}, captured.streams),
            exit_solved);
  EXPECT_THAT(Xml(test::read(folder / "p.svg")).text, HasSubstr("Iteration 2 "));
  test::Captured late;
  EXPECT_EQ(solve({.problem = "josephy", .plot = folder / "p.svg", .plot_iteration = 99}, late.streams), exit_solved);
  EXPECT_THAT(late.err.str(), HasSubstr("--plot-iteration 99"));
}

// Would catch ticks outside the axis or in the wrong place, zeros and infinities that leave it.
TEST(Scales, TicksAndPlaces) {
  for (const auto& values :
       std::vector<std::vector<double>>{{1e-20, 1e3}, {2, 3}, {5, 5}, {}, {0, 1e-300}, {1e300, 1}}) {
    const Scale scale = Scale::logarithmic(values, 100, 0);
    const auto ticks = scale.ticks(9);
    EXPECT_GE(ticks.size(), 2U);
    EXPECT_LE(ticks.size(), 13U);
    for (const Scale::Tick& tick : ticks) {
      EXPECT_GE(scale(tick.value), -1e-6);
      EXPECT_LE(scale(tick.value), 100 + 1e-6);
      EXPECT_NEAR(std::stod(tick.label), tick.value, 1e-9 * tick.value);
    }
    for (const double value : values) EXPECT_TRUE(scale(value) >= 0 && scale(value) <= 100) << value;
    EXPECT_EQ(scale(0), 100);
    EXPECT_TRUE(std::isnan(scale(ncp::infinity)));
  }
  const Scale line = Scale::linear(0, 33, 0, 330);
  EXPECT_EQ(line(3.3), 33);
  EXPECT_EQ(line.ticks(20).front().label, "0");
  EXPECT_EQ(line.ticks(20).back().label, "32");
}

}  // namespace
}  // namespace perp::app

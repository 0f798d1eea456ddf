// SPDX-License-Identifier: Apache-2.0
/// `perp contact FILE... --facets K,K,...`: the errors of polygons by the exact law, their fits and their picture.
#include "app/contact/studies/facets.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <regex>

#include "app/json.hpp"
#include "contact_app_support.hpp"

namespace perp::app::contacts {
namespace {

using test::Answer;
using test::Json;
using test::occurrences;
using test::parse_json;
using test::unclosed;
using testing::HasSubstr;
using testing::Not;

Answer facets_answer(FacetsRequest request) {
  test::Captured captured;
  request.json = "-";
  const int code = facets(request, captured.streams);
  return {code, parse_json(captured.out.str()), captured.err.str()};
}

struct Point {
  double x = 0, y = 0;
};
double distance(Point a, Point b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// The point of the polygon's rim nearest to p, edge by edge: the projection of a p that is outside.
Point nearest(const std::vector<Point>& corners, Point p) {
  Point best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Point a = corners[k];
    const Point b = corners[(k + 1) % corners.size()];
    const double dx = b.x - a.x;
    const double dy = b.y - a.y;
    const double t = std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
    const Point candidate{a.x + t * dx, a.y + t * dy};
    if (distance(candidate, p) < least) least = distance(candidate, p), best = candidate;
  }
  return best;
}

// W = I: r_T is the projection of -q_T on mu r_N P, r_N = 1. Of the exact law r_T = (-0.3, -0.4), u_T = (0.9, 1.2);
// |q| = sqrt 5, |q|_inf = 1.6. Would catch sides that are mixed up, polygons that are not turned, and errors over the
// wrong size.
TEST(Facets, ErrorsByHand) {
  const test::Folder folder;
  test::write(folder / "slip.dat", test::identity_dat(3, 1, "-1 1.2 1.6", "0.5"));
  const Answer run = facets_answer({.problems = {folder / "slip.dat"}, .facets = "7,4"});
  EXPECT_EQ(run.code, exit_solved) << run.err;
  ASSERT_EQ(run.result["runs"].size(), 12U);
  for (const Json& one : run.result["runs"]) {
    const int K = one["facets"];
    const bool outer = one["polygon"] == "outer";
    std::vector<Point> corners;
    for (int j = 0; j < K; ++j) {
      const double angle = one["rotation"].get<double>() + (2 * j + (outer ? 1 : 0)) * std::numbers::pi / K;
      const double size = 0.5 / (outer ? std::cos(std::numbers::pi / K) : 1);
      corners.push_back({size * std::cos(angle), size * std::sin(angle)});
    }
    const Point r = nearest(corners, {-1.2, -1.6});
    const Point u{1.2 + r.x, 1.6 + r.y};
    const Json& errors = one["errors"];
    EXPECT_NEAR(errors["velocity"].get<double>(), distance(r, {-0.3, -0.4}) / std::sqrt(5.0), 1e-9) << one;
    EXPECT_NEAR(errors["cone"].get<double>(), std::max(0.0, std::hypot(r.x, r.y) - 0.5), 1e-9) << one;
    EXPECT_NEAR(errors["slip"].get<double>(), std::abs(0.5 * std::hypot(u.x, u.y) + r.x * u.x + r.y * u.y) / 1.6, 1e-9)
        << one;
    EXPECT_GT(errors["natural"].get<double>(), 1e-4);
  }
  ASSERT_EQ(run.result["lines"].size(), 4U);
  EXPECT_EQ(run.result["lines"][0]["facets"], 4);  // ascending
  EXPECT_EQ(run.result["lines"][0]["solved"], 3);
  std::vector<double> middle;  // of the three positions
  for (const Json& one : run.result["runs"])
    if (one["polygon"] == "outer" && one["facets"] == 7) middle.push_back(one["errors"]["velocity"]);
  std::ranges::sort(middle);
  EXPECT_DOUBLE_EQ(run.result["lines"][3]["medians"]["velocity"].get<double>(), middle.at(1));
}

// Gap and dissipation 1 / K^2, direction and motion 1 / K (contact/README.md): W = I and forces in directions that fill
// the circle, by the golden angle.
TEST(Facets, ErrorsFallAsTheyShould) {
  const test::Folder folder;
  constexpr int n = 24;
  std::ostringstream q;
  std::ostringstream mu;
  for (int a = 0; a < n; ++a) {
    const double angle = 2 * std::numbers::pi * (a * std::numbers::phi);
    q << "-1 " << 2 * std::cos(angle) << ' ' << 2 * std::sin(angle) << ' ';
    mu << "0.5 ";
  }
  test::write(folder / "circle.dat", test::identity_dat(3, n, q.str(), mu.str()));
  const Answer run = facets_answer({.problems = {folder / "circle.dat"}, .facets = "4,8,16,32,64"});
  EXPECT_EQ(run.code, exit_solved) << run.err;
  for (const char* side : {"inner", "outer"}) {
    const Json& powers = run.result["powers"][side];
    for (const char* linear : {"natural", "velocity"}) {
      EXPECT_LT(powers[linear].get<double>(), -0.8) << side << linear;
      EXPECT_GT(powers[linear].get<double>(), -1.2) << side << linear;
    }
    EXPECT_LT(powers["slip"].get<double>(), -1.7) << side;
    EXPECT_GT(powers["slip"].get<double>(), -2.3) << side;
  }
  EXPECT_NEAR(run.result["powers"]["outer"]["cone"].get<double>(), -2, 0.3);
  EXPECT_TRUE(run.result["powers"]["inner"]["cone"].is_null());  // inside of the cone
  for (const Json& line : run.result["lines"]) EXPECT_LE(line["own_residual"].get<double>(), 1e-9);
}

// Medians are over what slips in space: the others' zeros would make every polygon look exact.
TEST(Facets, WhereNothingSlipsDoesNotCount) {
  const test::Folder folder;
  test::write(folder / "plane.dat", test::two_plane_contacts());
  test::write(folder / "slip.dat", test::identity_dat(3, 1, "-1 1.2 1.6", "0.5"));
  const Answer mixed =
      facets_answer({.problems = {folder / "plane.dat", "stack:4", folder / "slip.dat"}, .facets = "5"});
  EXPECT_EQ(mixed.code, exit_solved) << mixed.err;
  const Answer alone = facets_answer({.problems = {folder / "slip.dat"}, .facets = "5"});
  EXPECT_EQ(mixed.result["lines"][0]["runs"], 9);
  EXPECT_EQ(mixed.result["lines"][0]["medians"], alone.result["lines"][0]["medians"]);
  EXPECT_THAT(mixed.err, HasSubstr("3 problems of 1 to 4 contacts, 3 of them solved by the exact law; in 1 something"));
  test::Captured captured;
  EXPECT_EQ(facets({.problems = {"stack:4"}, .facets = "5", .svg = folder / "none.svg"}, captured.streams),
            exit_solved);
  EXPECT_THAT(captured.out.str(), HasSubstr("Nothing slips"));
  EXPECT_THAT(test::read(folder / "none.svg"), testing::AllOf(HasSubstr("nothing slips"), Not(HasSubstr("nan"))));
}

TEST(Facets, FittedPower) {
  std::vector<FacetLine> lines;
  for (const int K : {4, 8, 16, 32}) {
    FacetLine line{.outer = true, .facets = K};
    line.medians = {3.0 / K, 0.2, K == 4 ? 1.0 : 1e-15, 5.0 / (K * K)};
    lines.push_back(line);
  }
  EXPECT_NEAR(fitted_power(lines, true, FacetError::Natural), -1, 1e-12);
  EXPECT_NEAR(fitted_power(lines, true, FacetError::Velocity), 0, 1e-12);
  EXPECT_TRUE(std::isnan(fitted_power(lines, true, FacetError::Cone)));  // one point above rounding
  EXPECT_NEAR(fitted_power(lines, true, FacetError::Slip), -2, 1e-12);
  EXPECT_TRUE(std::isnan(fitted_power(lines, false, FacetError::Slip)));
  lines.back().medians[0] = std::nan("");  // nothing solved there
  EXPECT_NEAR(fitted_power(lines, true, FacetError::Natural), -1, 1e-12);
}

/// A study with errors of exactly c / K and c / K^2.
FacetStudy made_study() {
  FacetStudy study{.facets = {4, 8, 16, 32}};
  study.problems.push_back({.label = "p", .contacts = 1, .slipping = 1, .solved = true});
  for (const bool outer : {false, true})
    for (const int K : study.facets) {
      const double x = (outer ? 2.0 : 1.0) / K;
      study.runs.push_back({.outer = outer, .facets = K, .solved = true, .errors = {x, x, outer ? x * x : 0, x * x}});
    }
  return study;
}

// Lines, guides and fits: in pixels a guide of 1/K^2 is twice as steep as one of 1/K, and parallel to what falls so.
// Would catch axes that differ, natural logarithms on one side only, and guides of a wrong power.
TEST(FacetsPicture, SlopesAreWhatTheySay) {
  const std::string svg = facets_svg(made_study());
  std::vector<double> slopes;
  const std::regex curve(
      R"re(<polyline class="(inner|outer)" points="([0-9.]+),([0-9.]+) [^"]* ([0-9.]+),([0-9.]+)"/>)re");
  for (std::sregex_iterator it(svg.begin(), svg.end(), curve), end; it != end; ++it)
    slopes.push_back((std::stod((*it)[5]) - std::stod((*it)[3])) / (std::stod((*it)[4]) - std::stod((*it)[2])));
  ASSERT_EQ(slopes.size(), 7U);  // nothing of inner is outside of the cone
  std::vector<double> guides;
  const std::regex guide(R"re(<line class="guide" x1="([0-9.]+)" y1="([0-9.]+)" x2="([0-9.]+)" y2="([0-9.]+)"/>)re");
  for (std::sregex_iterator it(svg.begin(), svg.end(), guide), end; it != end; ++it)
    guides.push_back((std::stod((*it)[4]) - std::stod((*it)[2])) / (std::stod((*it)[3]) - std::stod((*it)[1])));
  ASSERT_EQ(guides.size(), 9U);  // the legend's, and two a panel
  for (std::size_t panel = 0; panel < 4; ++panel) EXPECT_NEAR(guides[2 + 2 * panel], 2 * guides[1 + 2 * panel], 2e-3);
  for (std::size_t k = 0; k < slopes.size(); ++k) EXPECT_NEAR(slopes[k], (k < 4 ? 1 : 2) * guides[1], 2e-3) << k;
  EXPECT_THAT(svg, testing::AllOf(HasSubstr("K^-1.00"), HasSubstr("K^-2.00"), HasSubstr("inner: 0, to rounding"),
                                  Not(HasSubstr("nan"))));
}

TEST(FacetsPicture, IsWellFormed) {
  const std::string svg = facets_svg(made_study());
  EXPECT_EQ(unclosed(svg), 0);
  EXPECT_EQ(occurrences(svg, "panel-title\" x="), 4U);
  EXPECT_THAT(svg, Not(HasSubstr("href")));  // nothing from elsewhere
}

TEST(Facets, RefusesBeforeAnythingRuns) {
  const test::Folder folder;
  const std::string good = folder / "three.dat";
  test::write(good, test::three_contacts());
  test::write(folder / "empty.dat", "");
  const auto why = [&](FacetsRequest request) {
    if (request.facets.empty()) request.facets = "4,8";
    test::Captured captured;
    EXPECT_EQ(facets(request, captured.streams), exit_input);
    EXPECT_THAT(captured.out.str(), Not(HasSubstr("polygon")));
    return captured.err.str();
  };
  EXPECT_THAT(why({}), HasSubstr("which problems"));
  EXPECT_THAT(why({.problems = {good}, .facets = "2"}), HasSubstr("2 is not in [3, 1000]"));
  EXPECT_THAT(why({.problems = {good}, .facets = "99999999999"}), HasSubstr("99999999999 is not in [3, 1000]"));
  EXPECT_THAT(why({.problems = {good}, .facets = "4,"}), HasSubstr("'' is no number"));
  EXPECT_THAT(why({.problems = {good}, .facets = "1e9"}), HasSubstr("'1e9' is no number"));
  EXPECT_THAT(why({.problems = {good}, .facets = "4,4"}), HasSubstr("twice"));
  EXPECT_THAT(why({.problems = {good, good}}), HasSubstr("twice"));
  EXPECT_THAT(why({.problems = {folder / "none.dat", folder / "empty.dat", good}}),
              testing::AllOf(HasSubstr("none.dat"), HasSubstr("empty.dat")));
  EXPECT_THAT(why({.problems = {good}, .form = "square"}), HasSubstr("--form: 'square'"));
  EXPECT_THAT(why({.problems = {good}, .tol = 0}), HasSubstr("--tol 0"));
  EXPECT_THAT(why({.problems = {good}, .time_limit = -1}), HasSubstr("--time-limit -1"));
  EXPECT_THAT(why({.problems = {good}, .svg = "-"}), HasSubstr("goes to a file"));
  EXPECT_THAT(why({.problems = {good}, .svg = "/no/such/folder/f.svg"}), HasSubstr("no folder"));
  test::Captured captured;
  EXPECT_EQ(facets({.problems = {good, folder / "none.dat"}, .facets = "4", .json = "-"}, captured.streams),
            exit_input);
  EXPECT_EQ(parse_json(captured.out.str())["status"], "InputError");
}

TEST(Facets, InterruptedIsNotSolved) {
  const std::atomic<bool> interrupt = true;
  test::Captured captured;
  EXPECT_EQ(facets({.problems = {"stack:4"}, .facets = "4"}, captured.streams, &interrupt), exit_unsolved);
  EXPECT_THAT(captured.out.str(), HasSubstr("interrupted"));
}

// A limit that nothing meets: unsolved polygons are told one by one and are in no median.
TEST(Facets, UnsolvedIsSaid) {
  test::Captured captured;
  EXPECT_EQ(facets({.problems = {"spheres:12"}, .facets = "4", .tol = 1e-30}, captured.streams), exit_unsolved);
  EXPECT_THAT(captured.out.str(), HasSubstr("0/3"));
  EXPECT_THAT(captured.out.str(), HasSubstr("spheres:12, inner:4: "));
}

// As a process: flags of other modes are refused with the reason.
TEST(Facets, FlagsOfTheProgram) {
  const test::Folder folder;
  const auto program = [&](const std::string& arguments) {
    const std::string command =
        std::string("'") + PERP_PROGRAM + "' contact " + arguments + " > '" + (folder / "text") + "' 2>&1";
    return WEXITSTATUS(std::system(command.c_str()));
  };
  const auto text = [&] { return test::read(folder / "text"); };
  EXPECT_EQ(program("incline:4 --facets 4,8 --form mixed --tol 1e-8 --time-limit 5 --svg '" + (folder / "f.svg") +
                    "' --json '" + (folder / "f.json") + "'"),
            0);
  EXPECT_THAT(text(), HasSubstr("MLCPs"));
  EXPECT_THAT(test::read(folder / "f.svg"), HasSubstr("Missing dissipation"));
  EXPECT_EQ(parse_json(test::read(folder / "f.json"))["form"], "mixed");
  for (const char* flag : {"--method lemke", "--formulation inner:4", "--encoding A", "--row original", "--full",
                           "--fclib-out o.hdf5", "--log-level quiet", "--compare", "--jobs 2"}) {
    EXPECT_EQ(program("incline:4 --facets 4,8 " + std::string(flag)), exit_input) << flag;
    EXPECT_THAT(text(), testing::AllOf(testing::StartsWith("perp contact: --"), HasSubstr(" "))) << flag;
  }
}

}  // namespace
}  // namespace perp::app::contacts

// SPDX-License-Identifier: Apache-2.0
/// The picture of `perp contact --svg`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "app/contact/contact.hpp"
#include "app/contact/forces_svg.hpp"
#include "contact/io/read.hpp"
#include "contact_app_support.hpp"

namespace perp::app::contacts {
namespace {

using test::occurrences;
using test::unclosed;
using testing::HasSubstr;
using testing::Not;

std::string picture(const Loaded& loaded, const std::string& variant = "glocker") {
  return forces_svg(loaded, run(loaded.problem, parse_variant(variant), {}));
}

Loaded three() {
  const test::Folder folder;
  test::write(folder / "three.dat", test::three_contacts());
  return {"three & <one>", contact::read_problem(folder / "three.dat")};
}

TEST(Forces, OneDiskAContactByItsState) {
  const std::string svg = picture(three());
  EXPECT_EQ(occurrences(svg, "class=\"rim rim-slip\""), 1U);
  EXPECT_EQ(occurrences(svg, "class=\"rim rim-stick\""), 1U);
  EXPECT_EQ(occurrences(svg, "class=\"rim rim-open\""), 1U);
  EXPECT_EQ(unclosed(svg), 0);
  EXPECT_THAT(svg, HasSubstr("three &amp; &lt;one&gt;"));
  EXPECT_THAT(svg, HasSubstr("contact 3: slip"));
  EXPECT_THAT(svg, Not(HasSubstr("NOT SOLVED")));
}

// r_T = (-0.3, -0.4) with mu r_N = 0.5 lies at (-0.6, -0.8) on the rim, T1 to the right and T2 up. Would catch a
// picture turned upside down, and a wrong scale.
TEST(Forces, ForceIsWhereItBelongs) {
  const std::string svg = picture(three());
  std::smatch rim, mark;
  ASSERT_TRUE(std::regex_search(svg, rim,
                                std::regex(R"re(class="rim rim-slip" cx="([0-9.]+)" cy="([0-9.]+)" r="([0-9.]+)")re")));
  const std::string after = rim.suffix();
  // A diamond begins at its top, 1.3 of its size above the centre; its second corner is at its right.
  ASSERT_TRUE(std::regex_search(after, mark,
                                std::regex(R"re(class="slip mark" d="M([0-9.]+) ([0-9.]+) L([0-9.]+) ([0-9.]+))re")));
  const double R = std::stod(rim[3]);
  EXPECT_NEAR((std::stod(mark[1]) - std::stod(rim[1])) / R, -0.6, 1e-3);
  EXPECT_NEAR((std::stod(mark[4]) - std::stod(rim[2])) / R, 0.8, 1e-3);
}

TEST(Forces, PolygonOfAFacetedLaw) {
  EXPECT_THAT(picture(three()), Not(HasSubstr("class=\"polygon\"")));
  const std::string svg = picture(three(), "outer:5");
  EXPECT_EQ(occurrences(svg, "<polyline class=\"polygon\""), 4U);  // three contacts, and all in one disk
  EXPECT_THAT(svg, HasSubstr("not Coulomb"));
}

TEST(Forces, PlaneProblemHasIntervals) {
  const test::Folder folder;
  test::write(folder / "two.dat", test::two_plane_contacts());
  const std::string svg = picture(load(folder / "two.dat"));
  EXPECT_EQ(occurrences(svg, "class=\"interval rim rim-slip\""), 3U);  // the interval and its two ends
  EXPECT_EQ(occurrences(svg, "<circle class=\"rim"), 0U);
  EXPECT_THAT(svg, HasSubstr("interval: |r_T|"));
  EXPECT_EQ(unclosed(svg), 0);
}

TEST(Forces, WithoutFrictionAndOneContact) {
  const test::Folder folder;
  test::write(folder / "smooth.dat", test::identity_dat(3, 1, "-1 1 0", "0"));
  const std::string svg = picture(load(folder / "smooth.dat"));
  EXPECT_EQ(unclosed(svg), 0);
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("all in one disk")));
}

TEST(Forces, UnsolvedIsSaidInThePicture) {
  const Loaded loaded = generate("spheres:12");
  const contacts::Run unsolved =
      run(loaded.problem, parse_variant(std::string("glocker")), {.tol = 1e-30, .seconds = 0.05});
  EXPECT_THAT(forces_svg(loaded, unsolved), HasSubstr("NOT SOLVED"));
}

// A drawing of a thousand contacts stays within a page's width, of more than most_drawn leaves some out and says so.
TEST(Forces, ManyContacts) {
  Loaded many{"many", {}};
  const auto n = static_cast<int>(most_drawn) + 5;
  many.problem.W.given().resize(3 * n, 3 * n);
  many.problem.W.given().setIdentity();
  many.problem.q = lcp::Vec::Zero(3 * n);
  for (int a = 0; a < n; ++a) many.problem.q[3 * a] = -1 - 1e-3 * a;
  many.problem.mu = lcp::Vec::Constant(n, 0.5);
  const std::string svg = picture(many);
  EXPECT_EQ(occurrences(svg, "class=\"rim rim-stick\""), static_cast<std::size_t>(most_drawn));
  EXPECT_THAT(svg, HasSubstr("the 3000 with the largest r_N are drawn"));
  EXPECT_THAT(svg, Not(HasSubstr("contact 5:")));  // the smallest ones are those left out
  EXPECT_THAT(svg, HasSubstr("contact 6:"));
  std::smatch size;
  ASSERT_TRUE(std::regex_search(svg, size, std::regex(R"re(width="([0-9]+)" height="([0-9]+)")re")));
  EXPECT_LE(std::stod(size[1]), 1200);
}

}  // namespace
}  // namespace perp::app::contacts

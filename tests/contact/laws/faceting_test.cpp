// SPDX-License-Identifier: Apache-2.0
/// Laws that hold for all four faceted encodings.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "contact/contact_support.hpp"
#include "contact/laws/faceting_support.hpp"

namespace perp::contact {
namespace {

// The vertices and the edges of one polygon say the same law: all encodings meet it on random problems with polygons
// of any shape, another at every contact, and agree in u. Catches a dual description that is not one, a polygon of the
// wrong contact, a pair of edges that does not span.
TEST(Faceting, AllEncodingsMeetTheLawOfThePolygon) {
  std::mt19937 random(17);
  for (int k = 0; k < 60; ++k) {
    const Index contacts = 1 + static_cast<Index>(random() % 8);
    const Problem p = random_problem(random, contacts, 3, 3 * contacts, 0.5);
    Polygons polygons;
    for (Index a = 0; a < contacts; ++a) polygons.push_back(random_polygon(random));
    for (const NamedEncoding& e : encodings(p, polygons, polygons)) {
      const lcp::Result result = solved(e.encoding);
      ASSERT_TRUE(result.solved()) << e.name << ", problem " << k << ": " << result.message;
      EXPECT_LE(result.residual, 1e-9);
      EXPECT_LE(polygon_law_error(p, polygons, e.encoding.recover(result.z).r), 1e-7) << e.name << ", problem " << k;
    }
  }
}

// The test above must be able to fail: with edges where vertices belong, the law is not met.
TEST(Faceting, JudgeOfTheLawSeesAnotherPolygon) {
  const Problem p{.dimension = 3,
                  .W = support::matrix({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}),
                  .q = support::vec({-1, 3, 1}),
                  .mu = support::vec({0.6})};
  const InnerFaceting inner(p, {Polygon::inscribed(4)});
  const Vec r = inner.recover(solved(inner).z).r;
  EXPECT_LE(polygon_law_error(p, {Polygon::inscribed(4)}, r), 1e-9);
  EXPECT_GE(polygon_law_error(p, {Polygon::inscribed(5)}, r), 1e-2);
}

// In the plane the interval is Coulomb's law itself: the exact judge accepts every encoding's solution.
TEST(Faceting, PlaneFrictionIsExact) {
  std::mt19937 random(23);
  for (int k = 0; k < 60; ++k) {
    const Index contacts = 1 + static_cast<Index>(random() % 10);
    const Problem p = random_problem(random, contacts, 2, 2 * contacts, 0.2);
    for (const NamedEncoding& e : encodings(p, {Polygon::interval()}, {Polygon::interval()})) {
      const lcp::Result result = solved(e.encoding);
      ASSERT_TRUE(result.solved()) << e.name << ", problem " << k << ": " << result.message;
      EXPECT_LE(residual(p, e.encoding.recover(result.z).r).scaled, 1e-9) << e.name << ", problem " << k;
    }
  }
}

// Other units, W' = W / 1000 and q' = 1000 q, make r' = 10^6 r and u' = 1000 u. Catches a factor lost between build and
// recover.
TEST(Faceting, ImpulsesFollowTheUnits) {
  std::mt19937 random(29);
  const Problem p = random_problem(random, 6, 3, 18, 0.5);
  Problem other = p;
  other.W = p.W.matrix() * 1e-3;
  other.q = p.q * 1e3;
  const Polygons polygons{Polygon::inscribed(6, 0.2)};
  for (const Form form : {Form::Mixed, Form::Reduced}) {
    const InnerFaceting a(p, polygons, {.form = form});
    const InnerFaceting b(other, polygons, {.form = form});
    const Vec r = a.recover(solved(a).z).r;
    EXPECT_LE((b.recover(solved(b).z).r / 1e6 - r).norm(), 1e-9 * (1 + r.norm()));
    const OuterFaceting unscaled(p, polygons, {.form = form, .scaled = false});
    const Solution s = unscaled.recover(solved(unscaled).z);
    EXPECT_LE(polygon_law_error(p, polygons, s.r), 1e-8);
  }
}

/// A sliding block, by the direction it is pushed in.
Problem pushed(double direction) {
  return {.dimension = 3,
          .W = support::matrix({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}),
          .q = support::vec({-1, 3 * std::cos(direction), 3 * std::sin(direction)}),
          .mu = support::vec({0.6})};
}

/// Means over directions: of the exact natural map (scaled), and of the dissipation that the polygon leaves out.
struct Errors {
  double natural = 0;
  double slip = 0;
};
Errors mean_errors(bool outer, int K) {
  const Polygons polygons{outer ? Polygon::circumscribed(K) : Polygon::inscribed(K)};
  Errors mean;
  constexpr int directions = 40;
  for (int k = 0; k < directions; ++k) {
    const Problem p = pushed(0.0123 + 2 * std::numbers::pi * k / directions);
    const AffineEncoding form = outer ? AffineEncoding(OuterFaceting(p, polygons)) : InnerFaceting(p, polygons);
    const Residual e = residual(p, form.recover(solved(form).z).r);
    mean.natural += e.scaled / directions;
    mean.slip += std::abs(e.slip) / directions;
  }
  return mean;
}

// A sliding impulse is at a vertex, or its edge's: the angle between it and -u_T is wrong by up to pi / K, so the
// natural map falls like 1 / K whatever the polygon's radius; the dissipation, through 1 - cos(pi / K), like 1 / K^2.
// (The mean slip error of circumscribed polygons: 1 / cos(pi / K) - 1 too much at a vertex.)
TEST(Faceting, OrdersOfTheErrorOfASlidingContact) {
  for (const bool outer : {false, true}) {
    SCOPED_TRACE(outer);
    const Errors coarse = mean_errors(outer, 8);
    const Errors fine = mean_errors(outer, 64);
    const double order = std::log2(coarse.natural / fine.natural) / 3;
    EXPECT_NEAR(order, 1, 0.2);
    EXPECT_NEAR(std::log2(coarse.slip / fine.slip) / 3, 2, 0.3);
  }
}

/// The recorded problems with at most 60 contacts, for K facets.
void solve_recorded(int K) {
  int count = 0;
  for (const Reference& ref : references()) {
    if (ref.contacts > 60) continue;
    const Problem p = recorded(ref.file);
    const bool plane = p.dimension == 2;
    const Polygons outer{plane ? Polygon::interval() : Polygon::circumscribed(K, 0.1)};
    const Polygons inner{plane ? Polygon::interval() : Polygon::inscribed(K, 0.1)};
    for (const NamedEncoding& e : encodings(p, outer, inner)) {
      const lcp::Result result = solved(e.encoding);
      EXPECT_TRUE(result.solved()) << ref.file << ", " << e.name << ", K = " << K << ": " << result.message;
      EXPECT_EQ(result.message, "lemke") << ref.file << ", " << e.name << ", K = " << K;
      EXPECT_LE(result.residual, 1e-9) << ref.file << ", " << e.name << ", K = " << K;
      ++count;
    }
  }
  EXPECT_EQ(count, 4 * 22);
}

TEST(Faceting, SolvesTheRecordedProblems) {
  SKIP_WITHOUT_RECORDED_PROBLEMS();
  for (const int K : {3, 4, 6, 8, 16}) solve_recorded(K);
}

// Up to 570 contacts, some highly redundant: interior points first, Lemke's method where they fail.
TEST(Faceting, SolvesTheLargeRecordedProblems) {
  SKIP_WITHOUT_RECORDED_PROBLEMS();
  int count = 0;
  for (const Reference& ref : references()) {
    if (ref.contacts <= 60) continue;
    const Problem p = recorded(ref.file);
    const lcp::Result result = solved(OuterFaceting(p, {Polygon::circumscribed(4, 0.1)}));
    EXPECT_LE(result.residual, 1e-9) << ref.file << ": " << result.message;
    ++count;
  }
  EXPECT_EQ(count, 8);
}

}  // namespace
}  // namespace perp::contact

// SPDX-License-Identifier: Apache-2.0
#include "contact/laws/outer_faceting.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

#include "contact/contact_support.hpp"
#include "contact/laws/faceting_support.hpp"

namespace perp::contact {
namespace {

using support::vec;

// The matrix of (20), entry by entry: a sign of C, a transposed block or a mu in the wrong row would show.
TEST(OuterFaceting, MixedFormIsEquation20) {
  const Problem p = coupled_contact();
  const Polygon square = Polygon::circumscribed(4);
  const OuterFaceting form(p, {square}, {.form = Form::Mixed, .scaled = false});
  ASSERT_EQ(form.affine().size(), 7);
  support::Dense expected = support::Dense::Zero(7, 7);
  expected.topLeftCorner(3, 3) = p.W.matrix();
  expected.block(1, 3, 2, 4) = square.normals();
  expected.block(3, 1, 4, 2) = -square.normals().transpose();
  expected.block(3, 0, 4, 1).setConstant(0.5);
  EXPECT_LE((support::Dense(form.affine().M) - expected).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_EQ(form.affine().q.head(3), p.q);
  EXPECT_EQ(form.affine().q.tail(4), Vec::Zero(4));
  EXPECT_EQ(form.affine().box.lower[0], 0);
  EXPECT_EQ(form.affine().box.lower[1], -lcp::infinity);
  EXPECT_EQ(form.affine().box.lower[3], 0);
}

// At any r, the reduced form's values are u_N, the two kappa that close the equation -u_T = sum kappa c, and the
// slacks: checked at a random point z against the definitions.
TEST(OuterFaceting, ReducedFormIsThePairOfSlacks) {
  const Problem p = coupled_contact();
  const Polygon pentagon = Polygon::circumscribed(5, 0.2);
  const OuterFaceting form(p, {pentagon}, {.scaled = false});
  ASSERT_EQ(form.affine().size(), 6);
  const Vec z = vec({1.5, 0.25, 0.75, 0.5, 1.25, 2});
  const Vec F = form.affine().M * z + form.affine().q;
  const Solution s = form.recover(z);
  EXPECT_LE((s.u - (p.W * s.r + p.q)).norm(), 1e-15);
  EXPECT_EQ(s.r[0], 1.5);
  EXPECT_NEAR(F[0], s.u[0], 1e-14);
  // Which two normals are the pair is told by their slacks; the three others follow in order.
  const Vec sigma = Vec::Constant(5, 0.5 * 1.5) - pentagon.normals().transpose() * s.r.tail(2);
  Vec kappa = Vec::Constant(5, -1);
  Index rest = 0;
  for (Index i = 0; i < 5; ++i)
    if (std::abs(sigma[i] - 0.25) < 1e-12)
      kappa[i] = F[1];
    else if (std::abs(sigma[i] - 0.75) < 1e-12)
      kappa[i] = F[2];
    else {
      EXPECT_NEAR(sigma[i], F[3 + rest], 1e-14);
      kappa[i] = z[3 + rest++];
    }
  ASSERT_EQ(rest, 3);
  EXPECT_LE((s.u.tail(2) + pentagon.normals() * kappa).norm(), 1e-14);
}

// A block of mass 1/2 on a plane, pushed along (2, 1): with friction the square's facets turn the impulse to the corner
// that dissipates most, (-1, -1) of the circumscribed square. r_N = 1, u_T = q_T + 2 r_T by hand.
TEST(OuterFaceting, SlidingBlockOnTheSquare) {
  const Problem p{
      .dimension = 3, .W = support::matrix({{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}), .q = vec({-2, 4, 2}), .mu = vec({0.5})};
  for (const Form form : {Form::Mixed, Form::Reduced}) {
    const OuterFaceting outer(p, {Polygon::circumscribed(4)}, {.form = form});
    const lcp::Result result = solved(outer);
    ASSERT_TRUE(result.solved()) << result.message;
    const Solution s = outer.recover(result.z);
    EXPECT_LE((s.r - vec({1, -0.5, -0.5})).norm(), 1e-12);
    EXPECT_LE((s.u - vec({0, 3, 1})).norm(), 1e-12);
  }
}

// Redundant contacts, W of rank 6: W_TT is singular and no start basis. Lemke's own start solves the mixed form without
// help from another method, as the reduced form; from the classical ray it fails on some of these.
TEST(OuterFaceting, MixedFormWithRedundantContacts) {
  std::mt19937 random(41);
  for (int k = 0; k < 40; ++k) {
    const Index contacts = 4 + static_cast<Index>(random() % 12);
    Problem p = random_problem(random, contacts, 3, 6, 0);
    Vec r(p.q.size());  // u = W (r - r_0) vanishes at r_0, inside the cones: a solution exists
    for (Index a = 0; a < contacts; ++a) r.segment(3 * a, 3) << 1, 0.3 * p.mu[a], -0.3 * p.mu[a];
    p.q = -(p.W * r);
    const Polygons polygons{Polygon::circumscribed(6, 0.1 * k)};
    for (const Form form : {Form::Mixed, Form::Reduced}) {
      const OuterFaceting outer(p, polygons, {.form = form});
      const lcp::Result result = solved(outer);
      ASSERT_TRUE(result.solved()) << "problem " << k << ": " << result.message;
      EXPECT_EQ(result.message, "lemke") << "problem " << k;
      EXPECT_LE(polygon_law_error(p, polygons, outer.recover(result.z).r), 1e-8) << "problem " << k;
    }
  }
}

TEST(OuterFaceting, RefusesPolygonsThatDoNotFit) {
  const Problem p = coupled_contact();
  const Polygon square = Polygon::circumscribed(4);
  EXPECT_THROW(OuterFaceting(p, {}), std::invalid_argument);
  EXPECT_THROW(OuterFaceting(p, {square, square}), std::invalid_argument);
  EXPECT_THROW(OuterFaceting(p, {Polygon::interval()}), std::invalid_argument);
  Problem bad = p;
  bad.mu[0] = -1;
  EXPECT_THROW(OuterFaceting(bad, {square}), std::invalid_argument);
  EXPECT_THROW(OuterFaceting(p, {square}).recover(Vec::Zero(3)), std::invalid_argument);
}

// K = 64 with 20 contacts of a chain: M has a few entries a row where W has them, not 64 x 64 blocks.
TEST(OuterFaceting, KeepsWSparse) {
  const Index n = 20;
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < 3 * n; ++i) entries.emplace_back(i, i, 2.);
  SpMat W(3 * n, 3 * n);
  W.setFromTriplets(entries.begin(), entries.end());
  const Problem p{.dimension = 3, .W = W, .q = Vec::Constant(3 * n, -1), .mu = Vec::Constant(n, 0.3)};
  for (const Form form : {Form::Mixed, Form::Reduced}) {
    const OuterFaceting outer(p, {Polygon::circumscribed(64)}, {.form = form});
    EXPECT_LE(outer.affine().M.nonZeros(), n * (9 + 5 * 64));
  }
}

}  // namespace
}  // namespace perp::contact

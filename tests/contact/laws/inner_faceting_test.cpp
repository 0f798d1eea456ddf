// SPDX-License-Identifier: Apache-2.0
#include "contact/laws/inner_faceting.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

#include "contact/contact_support.hpp"
#include "contact/laws/faceting_support.hpp"

namespace perp::contact {
namespace {

using support::vec;

// (25)-(26) as they must read: the last row [mu, -1', 0], the last column [0; 1; 0], q = [q_N; D'q_T; 0].
TEST(InnerFaceting, ReducedFormIsEquation25) {
  const Problem p = coupled_contact();
  const Polygon triangle = Polygon::inscribed(3, 0.4);
  const auto& D = triangle.vertices();
  const InnerFaceting form(p, {triangle}, {.scaled = false});
  const support::Dense W = p.W.matrix();
  support::Dense expected = support::Dense::Zero(5, 5);
  expected(0, 0) = W(0, 0);
  expected.block(0, 1, 1, 3) = W.block(0, 1, 1, 2) * D;
  expected.block(1, 0, 3, 1) = D.transpose() * W.block(1, 0, 2, 1);
  expected.block(1, 1, 3, 3) = D.transpose() * W.bottomRightCorner(2, 2) * D;
  expected.block(1, 4, 3, 1).setOnes();
  expected(4, 0) = 0.5;
  expected.block(4, 1, 1, 3).setConstant(-1);
  EXPECT_LE((support::Dense(form.affine().M) - expected).cwiseAbs().maxCoeff(), 1e-15);
  Vec q(5);
  q << p.q[0], D.transpose() * p.q.tail(2), 0;
  EXPECT_LE((form.affine().q - q).norm(), 1e-15);
}

// z'M z = r'W r + mu r_N lambda, for both forms and any z (in the mixed one r_T is an unknown of its own): the identity
// behind copositivity. A wrong sign of D, 1 or mu breaks it.
TEST(InnerFaceting, QuadraticFormIsDissipationPlusSlip) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  const Problem p = random_problem(random, 5, 3, 9, 0);
  for (const Form f : {Form::Mixed, Form::Reduced}) {
    const InnerFaceting form(p, {Polygon::inscribed(7, 0.3)}, {.form = f, .scaled = false});
    for (int k = 0; k < 20; ++k) {
      Vec z(form.affine().size());
      for (Index i = 0; i < z.size(); ++i) z[i] = normal(random);
      const Solution s = form.recover(z);
      double expected = s.r.dot(p.W * s.r);
      for (Index a = 0; a < p.contacts(); ++a)
        if (p.mu[a] > 0) expected += p.mu[a] * s.r[3 * a] * z[form.first(a + 1) - 1];
      EXPECT_NEAR(z.dot(form.affine().M * z), expected, 1e-10 * (1 + std::abs(expected)));
    }
  }
}

// A block of mass 1/2 pushed along (2, 1): of the inscribed square's corners (-1, 0) dissipates most. By hand.
TEST(InnerFaceting, SlidingBlockOnTheSquare) {
  const Problem p{
      .dimension = 3, .W = support::matrix({{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}), .q = vec({-2, 4, 2}), .mu = vec({0.5})};
  for (const Form form : {Form::Mixed, Form::Reduced}) {
    const InnerFaceting inner(p, {Polygon::inscribed(4)}, {.form = form});
    const lcp::Result result = solved(inner);
    ASSERT_TRUE(result.solved()) << result.message;
    EXPECT_LE((inner.recover(result.z).r - vec({1, -0.5, 0})).norm(), 1e-12);
  }
}

// Stewart & Trinkle (1996): for positive definite W the LCP has a solution and Lemke's method finds it; no other method
// is allowed to help here. Any ray would disprove it.
TEST(InnerFaceting, LemkeSolvesWhereWIsPositiveDefinite) {
  std::mt19937 random(1996);
  for (int k = 0; k < 200; ++k) {
    const Index contacts = 1 + static_cast<Index>(random() % 12);
    const Problem p = random_problem(random, contacts, 3, 3 * contacts, k % 2 == 0 ? 0.1 : 1e-3);
    const int K = 3 + static_cast<int>(random() % 10);
    const Polygons polygons{Polygon::inscribed(K, 0.01 * k)};
    for (const Form form : {Form::Mixed, Form::Reduced}) {
      const InnerFaceting inner(p, polygons, {.form = form});
      const lcp::Result result =
          lcp::solve(inner.affine(), Vec::Zero(inner.affine().size()), lcp::Lemke{}, {.tol = 5e-10});
      ASSERT_TRUE(result.solved()) << "problem " << k << ", " << contacts << " contacts, K = " << K << ": "
                                   << result.message;
      EXPECT_LE(result.residual, 1e-9);
      EXPECT_LE(polygon_law_error(p, polygons, inner.recover(result.z).r), 1e-7);
    }
  }
}

// D'W_TT D is left to the reduced form; the mixed one has as many entries of W as W.
TEST(InnerFaceting, MixedFormKeepsW) {
  std::mt19937 random(3);
  const Problem p = random_problem(random, 10, 3, 30, 1);
  const InnerFaceting mixed(p, {Polygon::inscribed(32)}, {.form = Form::Mixed});
  const Index frictional = (p.mu.array() > 0).count();
  EXPECT_LE(mixed.affine().M.nonZeros(), p.W.matrix().nonZeros() + frictional * (6 * 32 + 5));
}

}  // namespace
}  // namespace perp::contact

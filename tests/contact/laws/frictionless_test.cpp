// SPDX-License-Identifier: Apache-2.0
#include "contact/laws/frictionless.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

#include "contact/contact_support.hpp"
#include "contact/laws/faceting_support.hpp"

namespace perp::contact {
namespace {

using support::vec;

// A ball of mass 2 falling with -3 m/s on a floor, e = 0.5: it leaves with 1.5 m/s, and the impulse is m (1 + e) 3 = 9.
// With the minus sign of (10)-(11) the impulse would be m (1 - e) 3 = 3.
TEST(Frictionless, NewtonsImpactLaw) {
  const Problem free{.dimension = 3,
                     .W = support::matrix({{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}}),
                     .q = vec({-3, 1, 0}),
                     .mu = vec({0.4})};
  const Problem p = with_newton_impact(free, vec({0.5}), vec({-3}));
  const Frictionless form(p);
  const lcp::Result result = lcp::solve(form.affine(), Vec::Zero(1));
  ASSERT_TRUE(result.solved());
  const Solution s = form.recover(result.z);
  EXPECT_NEAR(s.r[0], 9, 1e-12);
  const Vec after = free.W * s.r + free.q;  // U_k+1, without the impact law's shift
  EXPECT_NEAR(after[0], 1.5, 1e-12);
  EXPECT_EQ(s.r.tail(2), Vec::Zero(2));
}

// LCP(W_NN, q_N), entry by entry, from the middle of a larger W.
TEST(Frictionless, IsTheLcpOfTheNormalRows) {
  std::mt19937 random(7);
  const Problem p = random_problem(random, 4, 3, 12, 0.1);
  const Frictionless form(p, {.scaled = false});
  const support::Dense W = p.W.matrix();
  const support::Dense M = form.affine().M;
  for (Index a = 0; a < 4; ++a) {
    EXPECT_EQ(form.affine().q[a], p.q[3 * a]);
    for (Index b = 0; b < 4; ++b) EXPECT_EQ(M(a, b), W(3 * a, 3 * b));
  }
}

// Redundant contacts (W of rank 6 for 20 contacts): solved all the same, and the judge of the frictionless problem
// agrees. A problem with mu > 0 would refuse the point.
TEST(Frictionless, RedundantContacts) {
  std::mt19937 random(9);
  for (int k = 0; k < 20; ++k) {
    Problem p = random_problem(random, 20, 3, 6, 0);
    std::normal_distribution<double> normal;  // q = H'v is in the range of W, as velocities of one body are
    Vec x(60);
    for (Index i = 0; i < 60; ++i) x[i] = normal(random);
    p.q = p.W * x;
    const Frictionless form(p);
    const lcp::Result result = solved(form);
    ASSERT_TRUE(result.solved()) << result.message;
    EXPECT_LE(residual(without_friction(p), form.recover(result.z).r).scaled, 1e-9);
  }
}

TEST(Frictionless, SolvesTheRecordedProblems) {
  SKIP_WITHOUT_RECORDED_PROBLEMS();
  for (const Reference& ref : references()) {
    const Problem p = recorded(ref.file);
    const Frictionless form(p);
    const lcp::Result result = solved(form);
    EXPECT_TRUE(result.solved()) << ref.file << ": " << result.message;
    EXPECT_LE(residual(without_friction(p), form.recover(result.z).r).scaled, 1e-8) << ref.file;
  }
}

TEST(Frictionless, RefusesImpactsThatAreNone) {
  const Problem p{.dimension = 2, .W = support::matrix({{1, 0}, {0, 1}}), .q = vec({-1, 0}), .mu = vec({0.1})};
  EXPECT_THROW(with_newton_impact(p, vec({1.5}), vec({-1})), std::invalid_argument);
  EXPECT_THROW(with_newton_impact(p, vec({-0.5}), vec({-1})), std::invalid_argument);
  EXPECT_THROW(with_newton_impact(p, vec({0.5}), vec({NAN})), std::invalid_argument);
  EXPECT_THROW(with_newton_impact(p, vec({0.5, 0.5}), vec({-1})), std::invalid_argument);
}

}  // namespace
}  // namespace perp::contact

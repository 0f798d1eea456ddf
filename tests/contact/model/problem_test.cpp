// SPDX-License-Identifier: Apache-2.0
#include "contact/model/problem.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "contact/model/random_global.hpp"
#include "contact/refusal.hpp"
#include "support/matrices.hpp"

namespace perp::contact {
namespace {

using support::Dense;
using support::sparse;
using support::vec;

Problem good() {
  Problem p;
  p.dimension = 2;
  p.W = sparse(Dense::Identity(4, 4));
  p.q = vec({1, 2, 3, 4});
  p.mu = vec({0, 0.5});
  return p;
}

std::string why_not(const Problem& p) {
  return test::refusal_of([&] { check(p); });
}

// Each refusal names what, where and the value.
TEST(ContactProblem, Check) {
  EXPECT_EQ(why_not(good()), "");
  Problem p = good();
  p.dimension = 4;
  EXPECT_EQ(why_not(p), "contact problem: the dimension is 4, neither 2 nor 3");
  p = good();
  p.dimension = 3;
  EXPECT_EQ(why_not(p),
            "contact problem: W is 4 x 4, not 6 x 6: a row a velocity of the contacts, as many as dimension x "
            "coefficients of friction");
  p = good();
  p.W = sparse(Dense::Ones(4, 3));
  EXPECT_THAT(why_not(p), testing::StartsWith("contact problem: W is 4 x 3, not 4 x 4"));
  p = good();
  p.W = SpMat(4, 4);
  p.W.given().insert(0, 0) = 1;
  EXPECT_EQ(why_not(p), "contact problem: W is not compressed");
  p = good();
  p.q = vec({1, 2, 3});
  EXPECT_EQ(why_not(p), "contact problem: q has 3 entries, not 4: one a velocity of the contacts");
  p = good();
  p.q[3] = NAN;
  EXPECT_EQ(why_not(p), "contact problem: q is nan at contact 1, component T1 (entry 3)");
  p = good();
  p.W.given().coeffRef(2, 2) = INFINITY;
  EXPECT_EQ(why_not(p), "contact problem: W(2, 2) is inf, in the column of contact 1, component N (entry 2)");
  p = good();
  p.mu[1] = -0.1;
  EXPECT_EQ(why_not(p),
            "contact problem: the coefficient of friction of contact 1 is -0.1; it must be finite and not negative");
  p.mu[1] = NAN;
  EXPECT_THAT(why_not(p), testing::HasSubstr("contact 1 is nan"));
  p = good();
  p.global = std::make_shared<const Global>(Global{.M = sparse(Dense::Identity(2, 2)), .H = SpMat(2, 3)});
  EXPECT_THAT(why_not(p), testing::StartsWith("contact problem: H is 2 x 3, not 2 x 4"));
}

/// The same with a W of entries.
Problem by_entries(Problem problem) {
  problem.W = Delassus(SpMat(problem.W.matrix()));
  return problem;
}

/// Whether these are the groups of the problem, whose contacts stand in any order; how many there are.
std::size_t expect_groups_of(const Problem& whole, const std::vector<ContactGroup>& groups) {
  const int d = whole.dimension;
  const Dense W = whole.W.matrix();
  Dense left = W;  // without what the groups have
  std::vector<int> met(static_cast<std::size_t>(whole.contacts()), 0);
  for (const ContactGroup& group : groups) {
    EXPECT_EQ(why_not(group.problem), "");
    EXPECT_EQ(group.problem.W.parts() != nullptr, whole.W.parts() != nullptr);
    std::vector<Index> rows;
    for (const Index a : group.contacts) {
      ++met[static_cast<std::size_t>(a)];
      for (int k = 0; k < d; ++k) rows.push_back(d * a + k);
    }
    const Dense own = W(rows, rows);
    EXPECT_LE((Dense(group.problem.W.matrix()) - own).norm(), 1e-13 * own.norm());
    EXPECT_EQ(group.problem.q, whole.q(rows));
    EXPECT_EQ(group.problem.mu, whole.mu(group.contacts));
    if (whole.rounding.W.size() != 0) {
      EXPECT_EQ(group.problem.rounding.q, whole.rounding.q(rows));
      EXPECT_EQ(group.problem.rounding.W, whole.rounding.W(rows));
    }
    left(rows, rows).setZero();
  }
  if (!groups.empty()) {
    EXPECT_EQ(left.norm(), 0);
    for (const int times : met) EXPECT_EQ(times, 1);
  }
  return groups.size();
}

// W by its parts, with and without constraints, and by entries, in 2D and 3D. Catches rows in wrong places, bodies of
// other groups, parts whose entries are formed, and that a W that was condensed to entries is divided: those are not
// exact enough without the whole.
TEST(ContactProblem, Separated) {
  test::Random random(5);
  std::size_t divided = 0;
  for (const int d : {2, 3})
    for (int k = 0; k < 10; ++k) {
      Global global = test::random_global(random, d, 12, 7, 0);
      Problem whole = condense(global, random.normals(7).cwiseAbs(), d);
      ASSERT_NE(whole.W.parts(), nullptr);
      const std::vector<ContactGroup> groups = separated(whole);
      for (const ContactGroup& group : groups) EXPECT_FALSE(group.problem.W.formed());
      EXPECT_FALSE(whole.W.formed());
      const std::size_t several = expect_groups_of(whole, groups);
      divided += several > 1 ? 1 : 0;
      EXPECT_EQ(expect_groups_of(by_entries(whole), separated(by_entries(whole))), several);
      global.G = sparse(Dense(Vec::Unit(36, 1)));
      global.b = Vec::Zero(1);
      const Problem constrained = condense(global, whole.mu, d);
      ASSERT_TRUE(constrained.W.parts() != nullptr && constrained.W.parts()->inertia().by_lu());
      const std::vector<ContactGroup> held = separated(constrained);
      for (const ContactGroup& group : held) EXPECT_FALSE(group.problem.W.formed());
      EXPECT_EQ(expect_groups_of(constrained, held), several);
      global.M.coeffRef(0, 1) *= 1.5;
      EXPECT_TRUE(separated(condense(global, whole.mu, d)).empty());
    }
  EXPECT_GE(divided, 15U);
  const Problem one = condense(test::random_global(random, 3, 1, 3, 0), Vec::Ones(3));
  EXPECT_TRUE(separated(one).empty());
}

}  // namespace
}  // namespace perp::contact

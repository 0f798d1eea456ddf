// SPDX-License-Identifier: Apache-2.0
#include "contact/model/problem.hpp"

#include <gmock/gmock.h>

#include <cmath>

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
  try {
    check(p);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
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

}  // namespace
}  // namespace perp::contact

// SPDX-License-Identifier: Apache-2.0
#include "contact/laws/first_ncp.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

#include "contact/contact_support.hpp"
#include "contact/laws/faceting_support.hpp"
#include "contact/laws/frictionless.hpp"
#include "ncp/problem/residual.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::contact {
namespace {

using support::vec;

/// A sliding block of mass 1/2: r = (1, -0.4, -0.3), u = (0, 3.2, 2.4) opposed to it, |u_T| = 4.
Problem block() {
  return {
      .dimension = 3, .W = support::matrix({{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}), .q = vec({-2, 4, 3}), .mu = vec({0.5})};
}

double natural(const FirstNcp& f, In x) {
  Vec F(f.size());
  f.eval(x, F);
  return ncp::residual(f.box(), x, F).natural;
}

// The block's solution by hand: kappa = |u_T| = 4. Without mu in the weight of u_T kappa would be 8. The frictionless
// solution, which slips without friction, is none.
TEST(FirstNcp, SlidingBlock) {
  const FirstNcp f(block(), false);
  EXPECT_LE(natural(f, vec({1, -0.4, -0.3, 4})), 1e-14);
  EXPECT_GE(natural(f, vec({1, -0.4, -0.3, 8})), 0.1);
  EXPECT_GE(natural(f, vec({1, 0.4, 0.3, 4})), 0.1);  // along the slip
  EXPECT_GE(natural(f, vec({1, 0, 0, 0})), 0.1);
}

TEST(FirstNcp, JacobianMatchesDifferences) {
  std::mt19937 random(13);
  std::normal_distribution<double> normal;
  for (const int dimension : {2, 3}) {
    const FirstNcp f(random_problem(random, 5, dimension, 4, 0.1));
    for (int k = 0; k < 5; ++k) {
      Vec x(f.size());
      for (Index i = 0; i < x.size(); ++i) x[i] = normal(random);
      EXPECT_EQ(describe(f, check_jacobian(f, x)), "");
    }
    // What is said to be linear is: J's flagged entries do not change.
    const auto flags = f.linear_entries();
    SpMat A = f.jacobian_pattern();
    SpMat B = A;
    f.jacobian(f.start(), A);
    f.jacobian(Vec(2 * f.start()), B);
    for (std::size_t i = 0; i < flags.size(); ++i) {
      if (!flags[i]) continue;
      EXPECT_EQ(A.valuePtr()[i], B.valuePtr()[i]);
    }
  }
}

// Its solutions are Coulomb's: whatever the methods call solved, the judge accepts. And they do solve easy ones.
TEST(FirstNcp, SolutionsAreCoulombs) {
  std::mt19937 random(101);
  int solved_by_first = 0;
  for (int k = 0; k < 40; ++k) {
    const Index contacts = 1 + static_cast<Index>(random() % 3);
    const int dimension = 2 + k % 2;
    const Problem p = random_problem(random, contacts, dimension, dimension * contacts, 1);
    const FirstNcp f(p);
    const ncp::Result result = ncp::solve(f, f.start(), ncp::SemismoothNewton{.stop = {.tol = 1e-10}});
    if (!result.solved()) continue;
    ++solved_by_first;
    EXPECT_LE(residual(p, f.recover(result.x).r).scaled, 1e-6) << "problem " << k;
  }
  EXPECT_GE(solved_by_first, 15);
}

TEST(FirstNcp, NamesAndRefusals) {
  Problem p = block();
  const FirstNcp f(p);
  EXPECT_EQ(f.variable_name(0), "r_N[0]");
  EXPECT_EQ(f.variable_name(2), "r_T2[0]");
  EXPECT_EQ(f.variable_name(3), "kappa[0]");
  EXPECT_EQ(f.equation_name(3), "sigma[0]");
  EXPECT_THROW(f.recover(Vec::Zero(3)), std::invalid_argument);
  p.mu[0] = -0.1;
  EXPECT_THROW(FirstNcp{p}, std::invalid_argument);
}

}  // namespace
}  // namespace perp::contact

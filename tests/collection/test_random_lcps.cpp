// SPDX-License-Identifier: Apache-2.0
// Random LCPs: the class each function promises, the planted solution, the certificate, the same numbers everywhere.
#include "collection/random/random_lcps.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "lcp/classes/classify.hpp"
#include "lcp/iterative/interior_point.hpp"
#include "lcp/judge/result.hpp"
#include "lcp/pivoting/lemke.hpp"

namespace perp::ncp::collection {
namespace {

using lcp::Answer;
using lcp::Diagnosis;
using lcp::Property;
using lcp::Vec;

struct LcpFamily {
  std::string name;
  RandomLcp (*make)(lcp::Index, unsigned);
  lcp::Index least;
  bool planted;
  std::vector<Property Diagnosis::*> yes;
  std::vector<Property Diagnosis::*> no;
};

const std::vector<LcpFamily>& lcp_families() {
  using D = Diagnosis;
  static const std::vector<LcpFamily> all{
      {"pd", random_positive_definite, 1, true, {&D::positive_definite, &D::p}, {}},
      {"psd", random_semidefinite, 2, true, {&D::positive_semidefinite, &D::copositive_plus}, {}},
      {"p", random_p_matrix, 2, true, {&D::p}, {&D::positive_semidefinite}},
      {"strictly copositive",
       random_strictly_copositive,
       2,
       true,
       {&D::strictly_copositive},
       {&D::positive_semidefinite}},
      {"copositive-plus", random_copositive_plus, 4, true, {&D::copositive_plus}, {&D::positive_semidefinite}},
      {"copositive", random_copositive, 2, true, {&D::copositive}, {&D::copositive_plus}},
      {"Z", random_z_matrix, 1, true, {&D::z}, {&D::p}},
      {"degenerate", random_degenerate, 2, true, {&D::positive_semidefinite}, {}},
      {"infeasible", random_infeasible, 2, false, {&D::positive_semidefinite, &D::copositive_plus}, {}},
      {"infeasible row", random_infeasible_row, 1, false, {}, {&D::copositive}}};
  return all;
}

// Catches: a construction that does not keep its class. classify() knows nothing of how the matrices are made.
TEST(RandomLcps, AreOfTheirClass) {
  for (const LcpFamily& family : lcp_families())
    for (unsigned seed = 1; seed <= 15; ++seed) {
      const lcp::Index n = family.least + seed % 10;
      const Diagnosis d = lcp::classify(family.make(n, seed).problem.M);
      for (const auto property : family.yes)
        EXPECT_EQ(to_string((d.*property).answer), "yes") << family.name << ' ' << seed << ": " << (d.*property).reason;
      for (const auto property : family.no)
        EXPECT_EQ(to_string((d.*property).answer), "no") << family.name << ' ' << seed << ": " << (d.*property).reason;
    }
}

// Catches: a planted point that is no solution, a certificate that proves nothing, matrices that fill up.
TEST(RandomLcps, SolutionsAndCertificates) {
  for (const LcpFamily& family : lcp_families())
    for (const lcp::Index n : {family.least, lcp::Index{7}, lcp::Index{60}, lcp::Index{5000}}) {
      const RandomLcp made = family.make(n, 3);
      ASSERT_FALSE(made.problem.invalid()) << family.name;
      EXPECT_EQ(made.problem.size(), n);
      EXPECT_EQ(made.solution.size() == n, family.planted) << family.name;
      EXPECT_EQ(made.certificate.size() == n, !family.planted) << family.name;
      if (family.planted) {
        EXPECT_LE(natural_residual(made.problem, made.solution), 1e-13) << family.name;
      } else {
        EXPECT_TRUE(proves_infeasible(made.problem, made.certificate)) << family.name;
      }
      EXPECT_LE(made.problem.M.nonZeros(), 14 * n + 10) << family.name;
    }
}

// z = F = 0 at about half of the indices. Catches: a "degenerate" family that is not.
TEST(RandomLcps, DegenerateIsDegenerate) {
  const RandomLcp made = random_degenerate(1000, 1);
  const Vec F = made.problem.M * made.solution + made.problem.q;
  lcp::Index both = 0;
  for (lcp::Index i = 0; i < 1000; ++i) both += made.solution[i] == 0 && std::abs(F[i]) < 1e-13;
  EXPECT_GT(both, 400);
  EXPECT_LT(both, 600);
}

// What theory says about Lemke's method (Cottle, Pang & Stone 1992, theorem 4.4.13) on each class that it speaks of.
TEST(RandomLcps, LemkeSolvesOrProves) {
  const lcp::LemkeOptions textbook{.start = lcp::LemkeStart::Ray, .cover = lcp::Cover::Ones};
  for (unsigned seed = 1; seed <= 5; ++seed) {
    for (const auto make : {random_positive_definite, random_semidefinite, random_p_matrix, random_strictly_copositive,
                            random_copositive_plus, random_degenerate}) {
      const RandomLcp made = make(40, seed);
      EXPECT_TRUE(lemke(made.problem, Vec::Zero(40), textbook).solved()) << seed;
    }
    const RandomLcp none = random_infeasible(40, seed);
    EXPECT_TRUE(proves_infeasible(none.problem, lemke(none.problem, Vec::Zero(40), textbook).certificate));
    const RandomLcp game = random_bimatrix(6, 4, seed);
    EXPECT_EQ(game.problem.size(), 10);
    const lcp::Result points = interior_point(none.problem, Vec::Zero(40));
    EXPECT_EQ(points.status, lcp::Status::Infeasible) << points.message;
  }
}

// Catches: other numbers on another platform or version: the values as first drawn, which are sums of a few products.
TEST(RandomLcps, AreReproducible) {
  const RandomLcp psd = random_semidefinite(4, 1);
  EXPECT_EQ(psd.problem.M.nonZeros(), 14);
  EXPECT_NEAR(psd.problem.M.coeff(0, 0), 0.73593583326608425, 1e-15);
  EXPECT_NEAR(psd.problem.q.sum(), 0.66668832417702817, 1e-14);
  EXPECT_EQ(random_z_matrix(3, 7).problem.M.coeff(2, 2), 1.8381644673179836);
  for (const LcpFamily& family : lcp_families()) {
    const RandomLcp one = family.make(30, 5);
    const RandomLcp two = family.make(30, 5);
    const RandomLcp other = family.make(30, 6);
    EXPECT_EQ(one.problem.q, two.problem.q) << family.name;
    EXPECT_TRUE(one.problem.M.isApprox(two.problem.M, 0)) << family.name;
    EXPECT_NE(one.problem.q, other.problem.q) << family.name;
  }
}

TEST(RandomLcps, RefuseSizesWithoutAProblem) {
  for (const LcpFamily& family : lcp_families())
    EXPECT_THROW(family.make(family.least - 1, 1), std::invalid_argument) << family.name;
  EXPECT_THROW(random_bimatrix(0, 1, 1), std::invalid_argument);
  EXPECT_THROW(random_bimatrix(1, 0, 1), std::invalid_argument);
}

}  // namespace
}  // namespace perp::ncp::collection

// SPDX-License-Identifier: Apache-2.0
/// Entries between groups of contacts, and between bodies, that nothing acts by: zeros that are stored, and numbers
/// whose squares vanish. Each group is taken for itself; these entries lie in none.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "contact/existence/infeasible.hpp"
#include "contact/model/facts.hpp"
#include "contact/solvers/solve.hpp"
#include "support/matrices.hpp"

namespace perp::contact {
namespace {

using support::Dense;
using support::Random;
using support::sparse;
using support::vec;

// 40 contacts apart, linked by zeros that are stored, also on one side of the diagonal alone. They were written out of
// bounds. Each contact has the eigenvalues 1/2, 1 and 3/2 in units of its own.
TEST(Facts, StoredZerosBetweenGroups) {
  const int n = 120;
  support::Triplets entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 4);
    if (i % 3 != 2) continue;
    entries.emplace_back(i, i - 1, 2);
    entries.emplace_back(i - 1, i, 2);
    for (const int j : {0, 1, 57, n - 1})
      if (j / 3 != i / 3) entries.emplace_back(i, j, 0.0);
  }
  SpMat W(n, n);
  W.setFromTriplets(entries.begin(), entries.end());
  Problem p;
  p.W = W;
  p.q = Vec::Zero(n);
  p.mu = Vec::Constant(n / 3, 0.5);
  const Facts f = facts(p);
  EXPECT_TRUE(f.known);
  EXPECT_EQ(f.parts, 40);
  EXPECT_NEAR(f.least, 0.5, 1e-14);
  EXPECT_NEAR(f.largest, 1.5, 1e-14);
  EXPECT_EQ(f.rank, n);
}

// Bodies that nothing couples but zeros stored in M and G: as without them. The zeros of bodies that constraints hold
// were written out of bounds in the search for a certificate.
TEST(Condense, StoredZerosBetweenBodies) {
  Random random(23);
  for (const bool constrained : {false, true}) {
    Global plain{.M = sparse(Dense::Identity(18, 18)),
                 .H = SpMat(18, 6),
                 .G = SpMat(18, constrained ? 2 : 0),
                 .f = random.normals(18),
                 .w = -Vec::Ones(6),
                 .b = Vec::Zero(constrained ? 2 : 0)};
    support::Triplets H;
    for (int body = 0; body < 2; ++body)
      for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 4; ++i) H.emplace_back(6 * body + i, 3 * body + k, random.normal());
    plain.H.setFromTriplets(H.begin(), H.end());
    if (constrained)
      for (int body = 0; body < 2; ++body) plain.G.insert(6 * body + 5, body) = 1;
    plain.G.makeCompressed();
    Global stored = plain;
    const auto add_zeros = [](SpMat& A, int count) {
      support::Triplets entries;
      for (Index j = 0; j < A.cols(); ++j)
        for (SpMat::InnerIterator it(A, j); it; ++it)
          entries.emplace_back(static_cast<int>(it.row()), static_cast<int>(j), it.value());
      for (int j = 0; j < A.cols(); ++j)
        for (int k = 0; k < count; ++k) entries.emplace_back((7 * (j + k) + 6) % static_cast<int>(A.rows()), j, 0.0);
      A.setFromTriplets(entries.begin(), entries.end());
    };
    add_zeros(stored.M, 5);
    stored.M = SpMat(0.5 * (stored.M + SpMat(stored.M.transpose())));
    add_zeros(stored.G, 9);
    const Vec mu = vec({0.3, 0.4});
    const Problem p = condense(plain, mu);
    const Problem of_stored = condense(stored, mu);
    EXPECT_LT((Dense(p.W.matrix()) - Dense(of_stored.W.matrix())).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_EQ(facts(of_stored).parts, 2);
    ASSERT_NE(of_stored.W.parts(), nullptr);
    const Inertia& inertia = of_stored.W.parts()->inertia();
    EXPECT_EQ(inertia.by_lu(), constrained);
    for (Index j = 0; j < inertia.M().cols(); ++j)
      for (SpMat::InnerIterator it(inertia.M(), j); it; ++it)
        EXPECT_EQ(inertia.body_of()[at(it.row())], inertia.body_of()[at(j)]) << it.row() << ' ' << j;
    EXPECT_EQ(separated(of_stored).size(), separated(p).size());
    EXPECT_EQ(find_infeasibility(of_stored).has_value(), find_infeasibility(p).has_value());
    EXPECT_EQ(solve(of_stored).status, solve(p).status);
  }
}

// Contact 5 and contact 0 are on one body, on which contact 5 does 1e-170 of what contact 0 does: groups by themselves,
// though W has an entry for both. Each group is the block of W.
TEST(Separated, EntriesThatLinkGroups) {
  Dense H = Dense::Zero(6, 12);
  for (int a = 0; a < 5; ++a) H(0, 2 * a) = H(1, 2 * a + 1) = 1 + a;
  H(0, 10) = H(1, 11) = 1e-170;
  const auto parts = std::make_shared<const DelassusParts>(Inertia::of(sparse(Dense::Identity(6, 6))), sparse(H));
  Problem p;
  p.dimension = 2;
  p.q = Vec::Ones(12);
  p.mu = Vec::Ones(6);
  for (const double shift : {0.0, 1.0}) {
    p.W = Delassus(parts).plus(shift);
    const std::vector<ContactGroup> groups = separated(p);
    ASSERT_EQ(groups.size(), 2u);
    for (const ContactGroup& group : groups) {
      std::vector<Index> rows;
      for (const Index a : group.contacts) rows.insert(rows.end(), {2 * a, 2 * a + 1});
      EXPECT_EQ(Dense(group.problem.W.matrix()), Dense(p.W.matrix())(rows, rows)) << shift;
    }
    EXPECT_EQ(facts(p).parts, 2);
  }
}

}  // namespace
}  // namespace perp::contact

// SPDX-License-Identifier: Apache-2.0
/// Condensation against dense algebra, and what is told of W.
#include <gmock/gmock.h>

#include "contact/contact_support.hpp"
#include "contact/model/facts.hpp"
#include "contact/model/random_global.hpp"
#include "contact/model/residual.hpp"
#include "contact/scenes/generators.hpp"
#include "contact/solvers/solve.hpp"
#include "lcp/dense_factors.hpp"

namespace perp::contact {
namespace {

using support::Dense;
using support::Random;
using support::sparse;
using support::vec;
using test::random_global;
using testing::HasSubstr;
using testing::ThrowsMessage;

// v from the saddle-point system for any r: u = H' v + w must be W r + q, and G' v + b = 0 hold. Catches signs (of b,
// of lambda) and a constraint that is added instead of eliminated.
TEST(Condense, IsTheDenseElimination) {
  Random random(11);
  for (int k = 0; k < 100; ++k) {
    const int d = random.chance(0.5) ? 2 : 3;
    const Index bodies = random.integer(1, 6);
    const Index contacts = random.integer(0, 6);
    const Index constraints = random.integer(0, static_cast<int>(bodies));
    const Global g = random_global(random, d, bodies, contacts, constraints);
    const Problem p = condense(g, Vec::Constant(contacts, 0.3), d, "name");
    EXPECT_EQ(p.name, "name");
    ASSERT_TRUE(p.global);
    const Index m = g.M.rows();
    Dense K = Dense::Zero(m + constraints, m + constraints);
    K.topLeftCorner(m, m) = Dense(g.M);
    K.topRightCorner(m, constraints) = -Dense(g.G);
    K.bottomLeftCorner(constraints, m) = Dense(g.G).transpose();
    const Vec r = random.normals(d * contacts);
    Vec rhs(m + constraints);
    rhs << g.H * r + g.f, -g.b;
    const Vec v = K.fullPivLu().solve(rhs).head(m);
    const Vec u = g.H.transpose() * v + g.w;
    EXPECT_LE((p.W * r + p.q - u).norm(), 1e-10 * (1 + u.norm() + v.norm()));
    EXPECT_LE(Dense(p.W.matrix() - SpMat(p.W.matrix().transpose())).norm(), 0);
    EXPECT_LE((g.G.transpose() * v + g.b).norm(), 1e-10 * (1 + v.norm()));
  }
}

// Contacts without a common body do not act on each other, exactly: that sparsity is what makes large problems
// possible. 3000 bodies in a row, 2999 contacts: 3 contacts a row of W.
TEST(Condense, IsSparse) {
  constexpr int bodies = 3000;
  support::Triplets M;
  support::Triplets H;
  for (int k = 0; k < 3 * bodies; ++k) M.emplace_back(k, k, 1 + k % 7);
  for (int a = 0; a + 1 < bodies; ++a)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        H.emplace_back(3 * a + i, 3 * a + j, 1 + (i + 2 * j) % 3);
        H.emplace_back(3 * a + 3 + i, 3 * a + j, -1 - (2 * i + j) % 3);
      }
  Global g;
  g.M = support::from(3 * bodies, M);
  g.H = SpMat(3 * bodies, 3 * (bodies - 1));
  g.H.setFromTriplets(H.begin(), H.end());
  g.G = SpMat(3 * bodies, 0);
  g.f = Vec::Ones(3 * bodies);
  g.w = Vec::Zero(3 * (bodies - 1));
  const Problem p = condense(g, Vec::Ones(bodies - 1));
  EXPECT_LE(p.W.matrix().nonZeros(), 9 * 3 * (bodies - 1));
  const SpMat W = g.H.transpose() * SpMat(Vec(Vec(g.M.diagonal()).cwiseInverse()).asDiagonal() * g.H);
  EXPECT_LE((p.W.matrix() - W).norm(), 1e-14 * W.norm());
}

// Badly scaled inertia (mm and t beside m and kg) is no singular one.
TEST(Condense, ScalesItself) {
  Global g;
  g.M = sparse(vec({1e-12, 1e9, 1e-3}).asDiagonal().toDenseMatrix());
  g.H = sparse(Dense::Identity(3, 3));
  g.G = SpMat(3, 0);
  g.f = vec({1, 1, 1});
  g.w = vec({0, 0, 0});
  const Problem p = condense(g, vec({0.5}));
  EXPECT_TRUE(Vec(p.W.diagonal()).isApprox(vec({1e12, 1e-9, 1e3}), 1e-14));
}

TEST(Condense, Refuses) {
  Random random(12);
  const Global good = random_global(random, 3, 2, 2, 1);
  const Vec mu = vec({0.3, 0.4});
  const auto expect = [&](const Global& g, const Vec& friction, const char* why, int d = 3) {
    EXPECT_THAT([&] { condense(g, friction, d); }, ThrowsMessage<std::invalid_argument>(HasSubstr(why)));
  };
  EXPECT_NO_THROW(condense(good, mu));
  Global g = good;
  g.M = sparse(Dense::Ones(6, 6));
  expect(g, mu, "condensation: the inertia M is singular");
  g = good;
  g.G = sparse(Dense::Ones(6, 2));
  g.b = vec({1, 1});
  expect(g, mu, "the constraints G' v + b = 0 are linearly dependent");
  g = good;
  g.f = vec({1, 2});
  expect(g, mu, "f has 2 entries, not 6");
  g = good;
  g.H = sparse(Dense::Ones(5, 6));
  expect(g, mu, "H is 5 x 6, not 6 x 6");
  g = good;
  g.M = sparse(Dense::Ones(6, 5));
  expect(g, mu, "M is 6 x 5, not 6 x 6");
  g = good;
  g.b = vec({1, 2});
  expect(g, mu, "b has 2 entries, not 1");
  g = good;
  g.w[3] = NAN;
  expect(g, mu, "w[3] is nan");
  expect(good, vec({0.3, -1}), "the coefficient of friction of contact 1 is -1");
  expect(good, mu, "the dimension is 4", 4);
}

// A pile among bodies that nothing touches is the pile. Catches bodies that are left in, one that is taken for another,
// and an inertia of such a body that is not looked at.
TEST(Condense, BodiesThatNothingTouchesAreNotThere) {
  const Problem pile = make_scene("spheres", 60).problem();
  const Global& g = *pile.global;
  const Index m = g.M.rows();
  const Dense pile_M(g.M);
  const Dense pile_H(g.H);
  Random random(5);
  Dense M = Dense::Zero(2 * m, 2 * m);
  Dense H = Dense::Zero(2 * m, g.H.cols());
  Vec f = random.normals(2 * m);
  for (Index i = 0; i < m; ++i) {  // every second velocity is the pile's
    for (Index j = 0; j < m; ++j) M(2 * i + 1, 2 * j + 1) = pile_M(i, j);
    M(2 * i, 2 * i) = 2;
    H.row(2 * i + 1) = pile_H.row(i);
    f[2 * i + 1] = g.f[i];
  }
  Global among{.M = sparse(M), .H = sparse(H), .G = SpMat(2 * m, 0), .f = f, .w = g.w, .b = Vec(0)};
  const Problem problem = condense(among, pile.mu);
  EXPECT_TRUE(problem.W.same_as(pile.W));
  EXPECT_EQ(problem.q, pile.q);
  EXPECT_EQ(problem.rounding.q, pile.rounding.q);
  EXPECT_EQ(problem.global->M.rows(), 2 * m);
  among.M.coeffRef(0, 0) = 0;
  EXPECT_THAT([&] { condense(among, pile.mu); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("condensation: the inertia M is singular")));
}

// Columns g and g + delta c of G say the same as g and c, without rounding. By a plain LU factorization W and q were
// wrong by 1e-4 of themselves, and points were called solved that were not. Catches that, and a refinement that does
// not converge and is believed: what is nearer to dependent is refused, and what is farther apart is right as well.
TEST(Condense, NearlyDependentConstraintsAreAsGoodAsTheirDifferenceOrRefused) {
  Random random(5);
  int refused = 0;
  int taken = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const auto integers = [&](Index rows, Index cols) {
      return Dense(Dense::NullaryExpr(rows, cols, [&] { return double(random.integer(-3, 3)); }));
    };
    const Dense H = integers(7, 6);
    const Dense G = integers(7, 2);
    const Vec b = vec({1, 2});
    const Vec M = Vec::NullaryExpr(7, [&] { return std::ldexp(1, random.integer(-4, 4)); });
    Global global{.M = sparse(M.asDiagonal()), .H = sparse(H), .G = sparse(G), .f = 1e3 * integers(7, 1), .b = b};
    global.w = integers(6, 1);
    const Vec mu = Vec::Constant(2, 0.3);
    const Problem direct = condense(global, mu);
    for (int power = -26; power <= -6; ++power) {
      const double delta = std::ldexp(1, power);
      Dense near = G;
      near.col(1) = G.col(0) + delta * G.col(1);
      global.G = sparse(near);
      global.b = vec({b[0], b[0] + delta * b[1]});
      try {
        const Problem nearly = condense(global, mu);
        const double tol = power <= -15 ? 1e-12 : 1e-9;
        EXPECT_LE((nearly.q - direct.q).norm(), tol * direct.q.norm()) << trial << ' ' << power;
        EXPECT_LE((nearly.W.matrix() - direct.W.matrix()).norm(), tol * direct.W.matrix().norm())
            << trial << ' ' << power;
        ++taken;
      } catch (const std::invalid_argument& why) {
        EXPECT_LT(power, -21) << why.what();
        ++refused;
      }
    }
  }
  EXPECT_GT(taken, 250);
  EXPECT_GT(refused, 0);
}

// The normal velocity of the contact is three times what the constraint holds: no impulse changes it, W_NN is 0, and
// rounding leaves 1e-17 or so of it. Catches a judge who takes that at its word: a huge impulse then "solves".
TEST(Condense, RoundingOfWIsNoMotion) {
  Random random(6);
  int left = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const auto integers = [&](Index rows, Index cols) {
      return Dense(Dense::NullaryExpr(rows, cols, [&] { return double(random.integer(-9, 9)); }));
    };
    const Dense R = integers(4, 4);
    const Dense G = integers(4, 1);
    Dense H(4, 2);
    H << 3 * G, integers(4, 1);
    const Global global{.M = sparse(R * R.transpose() + Dense::Identity(4, 4)),
                        .H = sparse(H),
                        .G = sparse(G),
                        .f = Vec::Zero(4),
                        .w = vec({0, 1}),
                        .b = vec({1})};
    if (G.isZero(0)) continue;
    const Problem problem = condense(global, vec({0.5}), 2);
    EXPECT_NEAR(problem.q[0], -3, 1e-14);
    Dense K = Dense::Zero(5, 5);
    K << Dense(global.M), G, G.transpose(), Dense::Zero(1, 1);
    Vec N = Vec::Zero(5);
    N.head(4) = H.col(0);
    const double W_NN = N.dot(K.partialPivLu().solve(N));
    if (W_NN <= 0) continue;
    ++left;
    EXPECT_FALSE(accepted(residual(problem, vec({3e16 / W_NN, 0})), 1e-6)) << trial;
    EXPECT_FALSE(accepted(residual(problem, vec({3 / W_NN, 0})), 1e-6)) << trial;
    EXPECT_FALSE(solve(problem).solved()) << trial;
  }
  EXPECT_GT(left, 20);
}

// Two bodies that constraints couple in y, contacts on their x: W_12 is 5e-13, and contact 2 approaches at its full
// speed, 5e-7. Catches contacts of one mechanism that are all compared with the largest of its velocities: r = (100 /
// W_11, 0) was a solution.
TEST(Condense, ContactsOfOneMechanismHaveTheirOwnMeasure) {
  for (const double e : {1e-6, 0.0}) {
    Global global{.M = support::matrix({{1, e, 0, 0}, {e, 1, 0, 0}, {0, 0, 1, e}, {0, 0, e, 1}}),
                  .H = support::matrix({{1, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}),
                  .G = support::matrix({{0}, {1}, {0}, {-1}}),
                  .f = Vec::Zero(4),
                  .w = vec({-100, 0, -5e-7, 0}),
                  .b = vec({0})};
    if (e == 0) global.M.coeffRef(0, 1) = global.M.coeffRef(2, 3) = 0;  // stored
    const Problem problem = condense(global, vec({0, 0}), 2);
    ASSERT_NE(problem.W.parts(), nullptr);
    const double W_11 = problem.W.near(0, 0);
    EXPECT_FALSE(accepted(residual(problem, vec({100 / W_11, 0, 0, 0})), 1e-8)) << e;
    EXPECT_TRUE(accepted(residual(problem, vec({100 / W_11, 0, 5e-7 / problem.W.near(2, 2), 0})), 1e-6)) << e;
    EXPECT_TRUE(solve(problem).solved()) << e;
  }
}

// Contact 1 is held but for 1e-5, beside contact 2 that moves the same bodies by 1e10 against each other, which it does
// not feel: it approaches at its full speed, 1. Catches velocities of bodies for those of contacts.
TEST(Condense, HeldContactsAreNotMeasuredByTheirBodies) {
  const Problem problem = condense({.M = sparse(Dense::Identity(3, 3)),
                                    .H = support::matrix({{1, 0, 0, 0}, {1, 0, 1, 0}, {1e-5, 0, 0, 0}}),
                                    .G = support::matrix({{1}, {1}, {0}}),
                                    .f = Vec::Zero(3),
                                    .w = vec({-1, 0, -1e10, 0}),
                                    .b = vec({0})},
                                   vec({0, 0}), 2);
  EXPECT_FALSE(accepted(residual(problem, vec({0, 0, 2e10, 0})), 1e-8));
  EXPECT_TRUE(accepted(residual(problem, vec({1e10, 0, 2e10, 0})), 1e-8));
}

// Impulses of 2^120 that cancel on a body beside ones of 1 that do not. Catches velocities that are taken for 0.
TEST(Condense, ImpulsesThatCancelBeyondAllDigitsAreNoSolution) {
  Dense H = Dense::Zero(2, 12);
  for (Index a = 0; a < 6; ++a) H(0, 2 * a) = a < 3 ? -1 : 1;
  const Global global{.M = sparse(Dense::Identity(2, 2)),
                      .H = sparse(H),
                      .G = support::matrix({{0}, {1}}),
                      .f = Vec::Zero(2),
                      .w = vec({1, 0, 1, 0, 1, 0, -1, 0, -1, 0, -1, 0}),
                      .b = vec({0})};
  const Problem problem = condense(global, Vec::Zero(6), 2);
  const Vec r = vec({0x1p120, 0, 0x1p60, 0, 1, 0, 0x1p120, 0, 0x1p60, 0, 1, 0});
  EXPECT_FALSE(accepted(residual(problem, r), 1e-6));
}

// A contact of two welded bodies with nothing that drives it, beside one that is pressed: its velocity is 0, and not
// the rounding of what holds it. Catches a sign of 1e-33 that has to be 0 and never is.
TEST(Condense, WhatIsHeldAltogetherIsAtRest) {
  Random random(9);
  for (int trial = 0; trial < 20; ++trial) {
    const Dense X = random.normals(6, 6);
    const Dense T = random.normals(3, 3);
    Dense G = Dense::Zero(6, 3);
    G << T, -T;
    const Dense C = random.normals(3, 2);
    Dense H = Dense::Zero(6, 4);
    H.leftCols(2) << C, -C;
    H.rightCols(2).topRows(3) = random.normals(3, 2);
    const Global global{.M = sparse(X * X.transpose() + Dense::Identity(6, 6)),
                        .H = sparse(H),
                        .G = sparse(G),
                        .f = Vec::Zero(6),
                        .w = vec({0, 0, -1, 0.3}),
                        .b = Vec::Zero(3)};
    const Problem problem = condense(global, vec({0.5, 0.5}), 2);
    EXPECT_EQ(problem.W.near(0, 0), 0);
    EXPECT_TRUE(solve(problem).solved()) << trial;
  }
}

// q = 1 / 3 * 3 - 1 = 0 is 0, with factors of bodies and with those of K: v = 1 / 3 is no double, nor two of them.
// Catches the last digits of two taken for velocities, which contacts then had to balance: all but 1e-33 was their
// metric.
TEST(Condense, WhatCancelsIsZero) {
  for (const Index held : {0, 1}) {
    Global global{.M = sparse((Dense(3, 3) << 3, 0, 0, 0, 7, 0, 0, 0, 1).finished()),
                  .H = sparse((Dense(3, 2) << 3, 0, 7, 1, 0, 0).finished()),
                  .G = sparse(Dense((Dense(3, 1) << 0, 0, 1).finished()).leftCols(held)),
                  .f = vec({1, 1, 1}),
                  .w = vec({-2, 0}),
                  .b = Vec::Zero(held)};
    EXPECT_EQ(condense(global, vec({0.5}), 2).q[0], 0) << held;
    global.w[0] = std::nextafter(-2, 0);
    EXPECT_DOUBLE_EQ(condense(global, vec({0.5}), 2).q[0], 0x1p-52) << held;
  }
}

// q = 10 / 21 - w cancels to what rounding has left of w. Catches v rounded before it is added to w: such a q is 0, and
// impulses of 0 were called solutions.
TEST(Condense, QKeepsWhatCancels) {
  const double w = 10.0 / 21;
  const Global global{.M = sparse((Dense(3, 3) << 3, 0, 0, 0, 7, 0, 0, 0, 1).finished()),
                      .H = sparse((Dense(3, 2) << 1, 0, 1, 1, 0, 0).finished()),
                      .G = sparse((Dense(3, 1) << 0, 0, 1).finished()),
                      .f = vec({1, 1, 1}),
                      .w = vec({-w, 0}),
                      .b = vec({0})};
  const double exact = std::fma(-21, w, 10) / 21;
  ASSERT_NE(exact, 0);
  EXPECT_NEAR(condense(global, vec({0.5}), 2).q[0], exact, 1e-9 * std::abs(exact));
}

// --- facts -----------------------------------------------------------------------------------------------------------

// A table on four feet has six velocities and 12 contact velocities; two tables are two parts.
TEST(Facts, RedundantContacts) {
  Dense H(6, 12);
  for (int a = 0; a < 4; ++a) {
    const Eigen::Vector3d x(a % 2 == 0 ? -1 : 1, a < 2 ? -1 : 1, -1);
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3d t = Eigen::Vector3d::Unit(j == 0 ? 2 : j - 1);
      H.col(3 * a + j) << t, x.cross(t);
    }
  }
  Dense two = Dense::Zero(12, 24);
  two.topLeftCorner(6, 12) = H;
  two.bottomRightCorner(6, 12) = 3 * H;
  const Global g{.M = sparse(Dense::Identity(12, 12)),
                 .H = sparse(two),
                 .G = SpMat(12, 0),
                 .f = Vec::Ones(12),
                 .w = Vec::Zero(24),
                 .b = Vec(0)};
  const Facts f = facts(condense(g, Vec::Constant(8, 0.5)));
  EXPECT_TRUE(f.known);
  EXPECT_EQ(f.rank, 12);
  EXPECT_EQ(f.parts, 2);
  EXPECT_EQ(f.largest_part, 12);
  EXPECT_EQ(f.asymmetry, 0);
  EXPECT_NEAR(f.least, 0, 1e-14);
  EXPECT_GT(f.largest, 1);
  EXPECT_FALSE(facts(condense(g, Vec::Constant(8, 0.5)), {.dense_limit = 11}).known);
}

TEST(Facts, AsymmetryAndIndefiniteness) {
  Problem p;
  p.dimension = 2;
  p.W = sparse((Dense(2, 2) << 4, 7, 5, 4).finished());
  p.q = vec({0, 0});
  p.mu = vec({0.1});
  const Facts f = facts(p);
  EXPECT_NEAR(f.asymmetry, 0.5, 1e-15);
  EXPECT_NEAR(f.least, -0.5, 1e-15);
  EXPECT_NEAR(f.largest, 2.5, 1e-15);
  EXPECT_EQ(f.rank, 2);
  p.W = SpMat(0, 0);
  p.q = p.mu = Vec(0);
  EXPECT_EQ(facts(p).rank, 0);
}

// Capsules lie on each other with more contacts than they have velocities; catches a rank by pivots that counts
// rounding (a sparse QR finds 456 to 464).
TEST(Facts, RecordedRank) {
  SKIP_WITHOUT_RECORDED_PROBLEMS();
  const Facts f = facts(recorded("Capsules-i97-269.hdf5"));
  EXPECT_TRUE(f.known);
  EXPECT_EQ(f.rank, 451);
  EXPECT_NEAR(f.asymmetry, 0.0036, 0.0001);
  EXPECT_GE(f.least, -1e-12);
}

}  // namespace
}  // namespace perp::contact

// SPDX-License-Identifier: Apache-2.0
/// W by its parts: products and entries.
#include "contact/model/delassus.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "contact/model/random_global.hpp"
#include "contact/model/residual.hpp"
#include "contact/model/scaling.hpp"
#include "contact/scenes/generators.hpp"
#include "support/matrices.hpp"

namespace perp::contact {
namespace {

using support::Dense;
using support::Random;

SpMat definite(Index n, Random& random) {
  const Dense X = random.normals(n, n);
  const Dense M = X * X.transpose() + Dense::Identity(n, n);
  return Dense(0.5 * (M + M.transpose())).sparseView();
}

// Dense LU of M is the judge. M in blocks of rigid bodies, and one of 40 coupled velocities, which is factored as a
// whole. Catches a factor or a scale that one of the ways to a product leaves out.
TEST(Delassus, PartsMakeTheProductAndTheEntries) {
  Random random(3);
  const Global bodies = make_scene("wall", 60).bodies.global(0.01, {0, 0, -9.81});
  const SpMat whole = definite(40, random);
  const SpMat H = Dense(random.normals(40, 12)).sparseView();
  for (const auto& [M, of] : {std::pair{bodies.M, bodies.H}, std::pair{whole, H}}) {
    std::vector<Index> rows(at(of.cols()));
    std::iota(rows.begin(), rows.end(), 0);
    const auto parts = std::make_shared<const DelassusParts>(DelassusParts(Inertia::of(M), of), 2.5, rows,
                                                             std::vector<double>(rows.size(), 1));
    EXPECT_EQ(parts->root() != nullptr, M.rows() != 40);
    const Dense W = Dense(of).transpose() * Dense(2.5 * M).partialPivLu().solve(Dense(of));
    const double size = W.cwiseAbs().maxCoeff();
    const Delassus by_parts(parts, [parts] { return parts->form(); });
    const Vec r = random.normals(W.cols());
    EXPECT_LE((by_parts * r - W * r).norm(), 1e-13 * size * r.norm());
    EXPECT_LE((by_parts.plus(0.5) * r - W * r - 0.5 * r).norm(), 1e-13 * size * r.norm());
    for (Index i = 0; i < W.rows(); ++i)
      for (Index j = i; j < std::min(W.rows(), i + 3); ++j) EXPECT_NEAR(by_parts.near(i, j), W(i, j), 1e-13 * size);
    EXPECT_FALSE(by_parts.formed());
    EXPECT_LE((Dense(by_parts.matrix()) - W).cwiseAbs().maxCoeff(), 1e-13 * size);
    EXPECT_TRUE(by_parts.formed());
    EXPECT_EQ(SpMat(by_parts.matrix() - SpMat(by_parts.matrix().transpose())).norm(), 0);
  }
}

// With constraints W is that of the dense elimination, too, also in other units; a contact whose normal is held by one
// of them moves nothing. Catches multipliers that are taken for velocities, shares of what constraints hold (the square
// root of rounding is 1e-8), and entries between contacts that do not act on each other.
TEST(Delassus, PartsOfConstrainedBodiesAreTheMatrix) {
  Random random(8);
  for (const double unsymmetric : {0.0, 1e-12}) {
    Global g = test::random_global(random, 3, 4, 6, 3);
    g.H.coeffRef(0, 1) += 1;  // (0, 1) may be none
    Dense H(g.H);
    H.col(3) = -2 * Dense(g.G).col(1);
    g.H = support::sparse(H);
    g.M.coeffRef(0, 1) *= 1 + unsymmetric;
    const Problem problem = condense(g, Vec::Constant(6, 0.5));
    ASSERT_NE(problem.W.parts(), nullptr);
    const DelassusParts& parts = *problem.W.parts();
    EXPECT_TRUE(parts.inertia().by_lu());
    EXPECT_EQ(parts.inertia().symmetric(), unsymmetric == 0);
    Dense K = Dense::Zero(15, 15);
    K << Dense(g.M), Dense(g.G), Dense(g.G).transpose(), Dense::Zero(3, 3);
    Dense B = Dense::Zero(15, 18);
    B.topRows(12) = H;
    const Dense W = B.transpose() * K.fullPivLu().solve(B);
    const double size = W.cwiseAbs().maxCoeff();
    const Vec r = random.normals(18);
    EXPECT_LE((problem.W * r - W * r).norm(), 1e-12 * size * r.norm());
    EXPECT_LE((velocities(problem, r) - W * r - problem.q).norm(), 1e-12 * size * r.norm());
    const Dense shares = Dense(parts.shares()).transpose() * Dense(parts.shares());
    for (Index i = 0; i < 18; ++i)
      for (Index j = i; j < 18; ++j) {
        const double known = i / 3 == j / 3 ? problem.W.near(i, j) : W(i, j);
        EXPECT_NEAR(known, W(i, j), 1e-12 * size);
        EXPECT_LE(std::abs(W(i, j)), shares(i, j) + 1e-12 * size);
      }
    EXPECT_LE(shares(3, 3), 1e-25 * size);
    std::vector<Index> rows(18);
    std::iota(rows.begin(), rows.end(), 0);
    const DelassusParts heavier(parts, 4, rows, std::vector<double>(18, 3));
    EXPECT_LE((heavier.product(r) - 9. / 4 * W * r).norm(), 1e-12 * size * r.norm());
    EXPECT_LE((heavier.form() - 9. / 4 * W).norm(), 1e-11 * size);
    EXPECT_FALSE(problem.W.formed());
    EXPECT_LE((Dense(problem.W.matrix()) - W).norm(), 1e-11 * size);
  }
}

// Two walls side by side. Catches groups that follow the entries of W alone, or that lose a contact.
TEST(Delassus, GroupsAreThoseOfTheBodies) {
  const Problem wall = make_scene("wall", 30).problem();
  const Index n = wall.contacts();
  const auto twice = [](const SpMat& A) {
    Dense out = Dense::Zero(2 * A.rows(), 2 * A.cols());
    out.topLeftCorner(A.rows(), A.cols()) = out.bottomRightCorner(A.rows(), A.cols()) = Dense(A);
    return support::sparse(out);
  };
  const Global& one = *wall.global;
  const Index m = one.M.rows();
  const Problem two = condense({.M = twice(one.M),
                                .H = twice(one.H),
                                .G = SpMat(2 * m, 0),
                                .f = one.f.replicate(2, 1),
                                .w = one.w.replicate(2, 1),
                                .b = Vec(0)},
                               Vec::Constant(2 * n, 0.5));
  const std::vector<std::vector<Index>> groups = two.W.groups(3);
  ASSERT_EQ(groups.size(), 2);
  for (Index a = 0; a < n; ++a) {
    EXPECT_EQ(groups[0][at(a)], a);
    EXPECT_EQ(groups[1][at(a)], n + a);
  }
  EXPECT_FALSE(two.W.formed());
  EXPECT_EQ(Delassus(SpMat(two.W.matrix())).groups(3), groups);
}

// Catches a sequence that goes on with the factors of another W.
TEST(Delassus, IsTheSameOnlyBitByBit) {
  const Scene scene = make_scene("wall", 30);
  const Delassus W = scene.problem().W;
  EXPECT_TRUE(W.same_as(scene.problem().W));  // made again
  EXPECT_FALSE(W.same_as(W.plus(1e-300)));
  Delassus given = W;
  (void)given.given();
  EXPECT_FALSE(W.same_as(given));
  Delassus other = given;
  EXPECT_TRUE(given.same_as(other));
  other.given().coeffRef(0, 0) *= 1 + 1e-15;
  EXPECT_FALSE(given.same_as(other));
  Global global = *scene.problem().global;
  global.H.valuePtr()[3] *= 1 + 1e-15;
  EXPECT_FALSE(W.same_as(condense(global, scene.problem().mu).W));
}

// Of an M that is not symmetric, or not positive definite, W has no parts and its entries serve.
TEST(Delassus, OtherInertiaHasNoFactors) {
  EXPECT_EQ(Inertia::of(support::matrix({{2, 1}, {0, 2}})), nullptr);
  EXPECT_EQ(Inertia::of(support::matrix({{1, 2}, {2, 1}})), nullptr);
  Global global{.M = support::matrix({{2, 1}, {0, 2}}),
                .H = support::matrix({{1, 0}, {0, 1}}),
                .G = SpMat(2, 0),
                .f = support::vec({-1, 0.1}),
                .w = Vec::Zero(2),
                .b = Vec(0)};
  const Scaled coordinates = scaled(condense(global, support::vec({0.5}), 2));
  EXPECT_EQ(coordinates.W.parts(), nullptr);
  EXPECT_TRUE(coordinates.W.formed());
}

// Who changes W of a problem and leaves M and H solves for the W that is judged: tangents of one contact are exchanged.
// Catches solvers on parts that W is not made of.
TEST(Delassus, ChangedEntriesAreNotThoseOfTheParts) {
  Problem problem = make_scene("wall", 60).problem();
  ASSERT_TRUE(scaled(problem, true, WForm::Parts).W.parts());
  SpMat Q(problem.q.size(), problem.q.size());
  Q.setIdentity();
  Q.coeffRef(4, 4) = Q.coeffRef(5, 5) = 0;
  Q.coeffRef(4, 5) = Q.coeffRef(5, 4) = 1;
  problem.W = SpMat(Q * problem.W.matrix() * Q).pruned();
  const Scaled coordinates = scaled(problem);
  EXPECT_EQ(coordinates.W.parts(), nullptr);
  const Vec r = Vec::Ones(problem.q.size());
  const Vec u = problem.W * r + problem.q;
  const Vec scaled_u = coordinates.W * coordinates.reduce(r) + coordinates.q;
  const double unit = u[0] / scaled_u[0];
  for (Index i = 0; i < u.size(); i += 3) EXPECT_NEAR(scaled_u[i] * unit, u[i], 1e-10 * u.cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace perp::contact

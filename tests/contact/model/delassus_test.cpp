// SPDX-License-Identifier: Apache-2.0
/// W by its parts: products and entries.
#include "contact/model/delassus.hpp"

#include <gtest/gtest.h>

#include <algorithm>

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
    const auto parts = std::make_shared<const DelassusParts>(Inertia::of(M), 2.5, of);
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

// SPDX-License-Identifier: Apache-2.0
/// The systems of Newton steps, by contacts and by bodies.
#include "contact/model/contact_system.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "contact/model/jointed.hpp"
#include "contact/scenes/generators.hpp"
#include "lcp/dense_factors.hpp"
#include "support/matrices.hpp"

namespace perp::contact {
namespace {

using support::Dense;
using support::Random;
using Block = Eigen::Matrix3d;

Block random_block(Random& random) { return Dense(random.normals(3, 3)); }

/// A + W with definite A.
struct Definite {
  std::vector<Block> A{};
  std::vector<Block> inverse{};
  std::vector<ContactRows> rows{};
};
Definite definite_blocks(const Scaled& problem, double scale, Random& random) {
  Definite out;
  for (const Scaled::Block& block : problem.blocks) {
    const Block X = random_block(random);
    const Block& A = out.A.emplace_back(scale * (X * X.transpose() + 0.1 * Block::Identity()));
    out.inverse.emplace_back(Block::Zero()).topLeftCorner(block.size, block.size) =
        Dense(A.topLeftCorner(block.size, block.size)).inverse();
    out.rows.push_back({.A = A, .B = Block::Identity()});
  }
  return out;
}

/// (A + B W) x - c.
Vec residual_of(const Scaled& problem, const std::vector<ContactRows>& rows, const Vec& x, const Vec& c) {
  const Vec Wx = problem.W * x;
  Vec out = -c;
  for (std::size_t a = 0; a < rows.size(); ++a) {
    const Scaled::Block& b = problem.blocks[a];
    out.segment(b.first, b.size) += rows[a].A.topLeftCorner(b.size, b.size) * x.segment(b.first, b.size) +
                                    rows[a].B.topLeftCorner(b.size, b.size) * Wx.segment(b.first, b.size);
  }
  return out;
}

/// Solves, without refinement as well, and with the factors that there are.
void expect_solved(ContactSystem& system, const Scaled& problem, const std::vector<ContactRows>& rows, const Vec& c,
                   double tol) {
  const int factorizations = system.factorizations();
  Vec x;
  Vec once;
  system.solve(c, x);
  EXPECT_LE(residual_of(problem, rows, x, c).norm(), tol * (1 + x.norm()));
  system.solve_once(c, once);
  EXPECT_LE((once - x).norm(), 1e-7 * x.norm());
  EXPECT_EQ(system.factorizations(), factorizations);
}

/// The same problem of which no parts are known.
Scaled without_bodies(Scaled problem) {
  problem.W = Delassus(problem.W.matrix());
  return problem;
}

std::vector<Scaled> scenes() {
  std::vector<Scaled> all;
  for (const char* name : {"wall", "spheres", "stack", "incline"}) {
    Problem problem = make_scene(name, 60).problem();
    problem.mu[0] = 0;  // one contact of one row
    all.push_back(scaled(problem, true, WForm::Parts));
  }
  return all;
}

/// One whose bodies are held together, and one whose inertia is symmetric but for its rounding: no Cholesky.
std::vector<Scaled> constrained_scenes() {
  std::vector<Scaled> all;
  all.push_back(scaled(test::jointed("wall", 60, 10), true, WForm::Parts));
  all.push_back(scaled(test::jointed("spheres", 60, 0, 1e-13), true, WForm::Parts));
  return all;
}

// W~ = H~' M~^-1 H~ entry by entry: catches a weight or a unit that only one of them has.
TEST(ContactSystem, PartsMakeW) {
  for (const Scaled& problem : scenes()) {
    ASSERT_TRUE(problem.W.parts());
    const Dense H(problem.W.parts()->H());
    const Dense W = H.transpose() * Dense(problem.W.parts()->M()).ldlt().solve(H);
    EXPECT_LE((W - Dense(problem.W.matrix())).cwiseAbs().maxCoeff(), 1e-12);
  }
}

// Both forms give the x of (A + W) x = c for definite A of many sizes and for unsymmetric A, the first by Cholesky in
// both; without refinement it is the same but for rounding. Catches entries of H E H' that miss their place, and lost
// digits where A is small.
TEST(ContactSystem, BothFormsSolveTheSameSystem) {
  Random random(1);
  for (const Scaled& problem : scenes()) {
    const Scaled alone = without_bodies(problem);
    ContactSystem bodies(problem);
    ContactSystem contacts(alone);
    ASSERT_EQ(bodies.form(), ContactSystem::Form::Bodies);
    ASSERT_EQ(contacts.form(), ContactSystem::Form::Contacts);
    const Vec c = random.normals(problem.size());
    for (const double scale : {1e3, 1.0, 1e-3, 1e-6}) {
      auto [A, inverse, rows] = definite_blocks(problem, scale, random);
      for (ContactSystem* system : {&bodies, &contacts}) {
        ASSERT_TRUE(system->factor(A, inverse));
        EXPECT_TRUE(system->by_cholesky());
        expect_solved(*system, problem, rows, c, 1e-9);
      }
      for (ContactRows& of : rows) of.A += 0.3 * scale * (random_block(random) - random_block(random));
      for (ContactSystem* system : {&bodies, &contacts}) {
        ASSERT_TRUE(system->factor(rows));
        EXPECT_FALSE(system->by_cholesky());
        expect_solved(*system, problem, rows, c, 1e-8);
      }
    }
    EXPECT_EQ(bodies.factorizations(), 8);
  }
}

// W + 0.3 I, as proximal problems have it. Catches a shift that is left out or counts
// twice.
TEST(ContactSystem, SolvesWithAShift) {
  Random random(4);
  for (const Scaled& problem : scenes()) {
    ContactSystem of_all(problem);
    Scaled shifted = problem;
    shifted.W = problem.W.plus(0.3);
    ContactSystem system(shifted, of_all);
    std::vector<ContactRows> rows = definite_blocks(problem, 1, random).rows;
    for (ContactRows& of : rows) of.B *= 2;
    ASSERT_TRUE(system.factor(rows));
    expect_solved(system, shifted, rows, random.normals(problem.size(), 1), 1e-9);
  }
}

// Of a sequence of problems with given W the second is not symmetric. Catches factors that are Cholesky's because those
// of the first were.
TEST(ContactSystem, AnotherWMayBeUnsymmetric) {
  Random random(6);
  const Scaled first = without_bodies(scenes()[1]);
  Scaled second = first;
  second.W.given().coeffRef(1, 2) += 0.3;
  const std::vector<Block> A(first.blocks.size(), Block::Identity());
  ContactSystem of_first(first);
  ASSERT_TRUE(of_first.factor(A, A));
  EXPECT_TRUE(of_first.by_cholesky());
  ContactSystem system(second, of_first);
  ASSERT_TRUE(system.factor(A, A));
  EXPECT_FALSE(system.by_cholesky());
  const std::vector<ContactRows> rows(A.size(), {.A = Block::Identity(), .B = Block::Identity()});
  expect_solved(system, second, rows, random.normals(first.size()), 1e-9);
}

// Newton's rows on Alart & Curnier's equation: contacts that stick (A = 1e-10, B = 1) and open ones (A = 1, B = 0), in
// which neither A nor B has an inverse of its own size, then a slipping one besides. By bodies the first is symmetric.
// Catches a division by B, and solutions that are not refined: E is 1e10.
TEST(ContactSystem, RowsOfNewtonSteps) {
  Random random(2);
  for (const Scaled& problem : scenes()) {
    ContactSystem bodies(problem);
    std::vector<ContactRows> rows(problem.blocks.size());
    for (std::size_t a = 0; a < rows.size(); ++a)
      if (a % 7 == 3)
        rows[a].A.setIdentity();
      else
        rows[a] = {.A = 1e-10 * Block::Identity(), .B = Block::Identity()};
    const Vec v = random.normals(problem.W.parts()->M().rows());  // velocities that bodies can have
    Vec c = problem.W.parts()->H().transpose() * v;
    Vec x;
    ASSERT_TRUE(bodies.factor(rows));
    EXPECT_TRUE(bodies.by_cholesky());
    bodies.solve(c, x);
    EXPECT_LE(residual_of(problem, rows, x, c).lpNorm<Eigen::Infinity>(), 1e-9 * (1 + c.lpNorm<Eigen::Infinity>()));
    ContactRows& slips = rows[1];
    slips.A << 1e-10, 0, 0, -0.6, 0.36 + 0.1, 0.48, -0.8, 0.48, 0.64 + 0.1;
    slips.B << 1, 0, 0, 0, 0.32, -0.24, 0, -0.24, 0.18;
    ASSERT_TRUE(bodies.factor(rows));
    EXPECT_TRUE(bodies.by_cholesky());
    bodies.solve(c, x);
    EXPECT_LE(residual_of(problem, rows, x, c).lpNorm<Eigen::Infinity>(), 1e-7 * (1 + c.lpNorm<Eigen::Infinity>()));
  }
}

// Couplings p q' of some contacts beside a definite A, by Cholesky's factors and LU of the reduced system, against the
// same rows in one matrix; couplings of all contacts are factored with it at once. In both forms. Catches a wrong
// reduced system.
TEST(ContactSystem, CouplingsAreSolvedApart) {
  Random random(5);
  for (const Scaled& problem : scenes()) {
    const Scaled alone = without_bodies(problem);
    const Definite given = definite_blocks(problem, 0.1, random);
    const Vec c = random.normals(problem.size());
    for (const std::size_t every : {std::size_t{7}, std::size_t{1}}) {
      std::vector<ContactRows> rows = given.rows;
      std::vector<ContactCoupling> couplings;
      for (std::size_t a = 0; a < rows.size(); a += every) {
        const Block X = random_block(random);
        couplings.push_back({.contact = a, .p = X.col(0), .q = 0.1 * X.col(1)});
        rows[a].A += couplings.back().p * couplings.back().q.transpose();
      }
      for (const Scaled* of : {&problem, &alone}) {
        ContactSystem system(*of);
        ASSERT_TRUE(system.factor(given.A, given.inverse, couplings));
        EXPECT_EQ(system.by_cholesky(), every > 1);
        expect_solved(system, problem, rows, c, 1e-9);
      }
    }
  }
}

// More couplings than the dense reduced system is for, so by GMRES. Catches one of the two that solves another system.
TEST(ContactSystem, ManyCouplingsAreSolvedApart) {
  Random random(5);
  const Scaled problem = scaled(make_scene("wall", 600).problem(), true, WForm::Parts);
  auto [A, inverse, rows] = definite_blocks(problem, 1, random);
  std::vector<ContactCoupling> couplings;
  for (std::size_t a = 1; a < A.size(); a += 2) {
    couplings.push_back({.contact = a, .p = Eigen::Vector3d::UnitX(), .q = 0.01 * random_block(random).col(0)});
    rows[a].A += couplings.back().p * couplings.back().q.transpose();
  }
  ASSERT_GT(couplings.size(), 256U);
  ContactSystem system(problem);
  ASSERT_TRUE(system.factor(A, inverse, couplings));
  expect_solved(system, problem, rows, random.normals(problem.size()), 1e-8);
}

/// W, each entry above the diagonal changed by up to this part of the largest.
Scaled unsymmetric(Scaled problem, double by, Random& random) {
  SpMat W = problem.W.matrix();
  const double largest = W.coeffs().abs().maxCoeff();
  for (Index j = 0; j < W.cols(); ++j)
    for (SpMat::InnerIterator it(W, j); it; ++it)
      if (it.row() < j) it.valueRef() += by * largest * random.uniform(-1, 1);
  problem.W = Delassus(W);
  return problem;
}

// Recorded W are symmetric but for rounding (KaplasTower: 1.7e-13). Cholesky's factors serve them, solutions are those
// of W itself. Catches LU where half of its work does.
TEST(ContactSystem, RoundingOfWIsRefinedAway) {
  Random random(8);
  for (const Scaled& problem : scenes())
    for (const double by : {1e-13, 1e-3}) {
      const Scaled alone = unsymmetric(problem, by, random);
      const std::vector<ContactRows> rows = definite_blocks(alone, 1e-3, random).rows;
      const Vec c = random.normals(problem.size());
      ContactSystem system(alone);
      ASSERT_TRUE(system.factor(rows));
      EXPECT_EQ(system.by_cholesky(), by < 1e-12);
      expect_solved(system, alone, rows, c, 1e-12);
    }
}

// Where A is not definite, Cholesky's factorization fails and LU's takes its place.
TEST(ContactSystem, IndefiniteBlocksAreFactoredByLu) {
  for (const Scaled& problem : scenes()) {
    const Scaled alone = without_bodies(problem);
    const std::vector<Block> A(problem.blocks.size(), Block(-50 * Block::Identity()));
    const std::vector<Block> inverse(problem.blocks.size(), Block(-0.02 * Block::Identity()));
    const std::vector<ContactRows> rows(problem.blocks.size(), {.A = A[0], .B = Block::Identity()});
    const Vec c = Vec::LinSpaced(problem.size(), -1, 1);
    for (const Scaled* of : {&problem, &alone}) {
      ContactSystem system(*of);
      ASSERT_TRUE(system.factor(A, inverse));
      expect_solved(system, problem, rows, c, 1e-10);
    }
  }
}

// With bilateral constraints every system is solved in one matrix, whatever A, B and the couplings are. Catches
// multipliers that are left out, Cholesky's factors of what is indefinite, and inverses of A that are lost.
TEST(ContactSystem, BilateralConstraintsAreInTheMatrix) {
  Random random(12);
  for (const Scaled& problem : constrained_scenes()) {
    ASSERT_NE(problem.W.parts(), nullptr);
    ContactSystem system(problem);
    const Vec c = random.normals(problem.size(), 1);
    std::vector<ContactRows> rows(problem.blocks.size());
    for (ContactRows& of : rows) of = {.A = random_block(random), .B = random_block(random)};
    ASSERT_TRUE(system.factor(rows));
    EXPECT_FALSE(system.by_cholesky());
    expect_solved(system, problem, rows, c, 1e-9);

    Definite given = definite_blocks(problem, 1e-3, random);
    const ContactCoupling slips{.contact = 3, .p = {0, 0.5, -0.2}, .q = {1, 0, 0}};
    for (const bool coupled : {false, true}) {
      ASSERT_TRUE(system.factor(given.A, given.inverse, coupled ? std::vector{slips} : std::vector<ContactCoupling>()));
      EXPECT_FALSE(system.by_cholesky());
      if (coupled) given.rows[3].A += slips.p * slips.q.transpose();
      expect_solved(system, problem, given.rows, c, 1e-9);
    }
    EXPECT_FALSE(problem.W.formed());
  }
}

}  // namespace
}  // namespace perp::contact

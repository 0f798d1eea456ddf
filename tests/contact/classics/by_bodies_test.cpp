// SPDX-License-Identifier: Apache-2.0
/// The methods of contact/classics where W is by its parts, against the same with W by entries.
#include <gtest/gtest.h>

#include "contact/classics/classics.hpp"
#include "contact/classics/cylinder.hpp"
#include "contact/classics/trial.hpp"
#include "contact/model/random_global.hpp"
#include "contact/solvers/solve.hpp"
#include "lcp/dense_factors.hpp"

namespace perp::contact {
namespace {

using support::Dense;
using support::Random;

/// Some frictionless; solvable, as q = H' M^-1 f + w with w inside of the dual cone.
Problem random_problem(Random& random, int dimension, Index bodies, Index contacts, double most_friction) {
  Global global = test::random_global(random, dimension, bodies, contacts, 0);
  global.w.setZero();
  Vec mu(contacts);
  for (Index a = 0; a < contacts; ++a) {
    mu[a] = random.chance(0.2) ? 0 : random.uniform(0, most_friction);
    global.w[dimension * a] = random.uniform(0.01, 0.5);
  }
  return condense(std::move(global), mu, dimension);
}

/// The same problem, whose W is nobody else's.
Problem by_entries(const Problem& problem) {
  Problem other = condense(*problem.global, problem.mu, problem.dimension);
  other.W.given();
  return other;
}

/// Never over, and no judge.
class Endless final : public Trial {
 public:
  bool judge_iterate(In /*r*/, const TrialStep& /*step*/) override { return false; }
  bool over() override { return false; }
  bool no_solution() override { return false; }
};

/// A + B (W + alpha I).
Dense dense_matrix(const Scaled& problem, const std::vector<ContactRows>& rows, double alpha) {
  Dense A = Dense::Zero(problem.size(), problem.size());
  Dense B = A;
  for (std::size_t a = 0; a < rows.size(); ++a) {
    const Scaled::Block& block = problem.blocks[a];
    A.block(block.first, block.first, block.size, block.size) = rows[a].A.topLeftCorner(block.size, block.size);
    B.block(block.first, block.first, block.size, block.size) = rows[a].B.topLeftCorner(block.size, block.size);
  }
  return A + B * (Dense(problem.W.matrix()) + alpha * Dense::Identity(A.rows(), A.rows()));
}

/// Each Newton method's equation.
std::vector<RowsOf> equations(const Scaled& problem) {
  using enum AlartCurnierNewton::Function;
  std::vector<RowsOf> all;
  for (const auto function : {Standard, JeanMoreau, Hueeber})
    all.push_back(equation(problem, AlartCurnierNewton{.function = function}));
  all.push_back(equation(problem, FischerBurmeisterNewton{}));
  all.push_back(equation(problem, NaturalMapNewton{}));
  return all;
}

// Directions of every equation at random points, where some contacts stick (A = 0) and some are open (B = 0), with
// redundant contacts and without: those that are given solve the system, by dense products, and one of the alphas gives
// one. Catches rows that are multiplied in another order, an alpha that is left out, digits that A^-1 has taken.
TEST(ClassicsByBodies, NewtonDirections) {
  Random random(21);
  for (int k = 0; k < 40; ++k) {
    const Scaled problem = scaled(random_problem(random, 2 + k % 2, 4, 3 + k % 7, 0.8), true, WForm::Parts);
    ContactSystem matrix(problem);
    ASSERT_EQ(matrix.form(), ContactSystem::Form::Bodies);
    const Vec r = random.normals(problem.size());
    for (const RowsOf& rows_of : equations(problem)) {
      const NewtonSystem system = newton_system(problem, rows_of, r, problem.W * r + problem.q);
      int directions = 0;
      for (const double alpha : {1e-10, 1e-8, 1e-6, 1e-4}) {
        Vec d;
        if (!newton_direction(problem, matrix, system, alpha, d)) continue;
        ++directions;
        const Vec rest = dense_matrix(problem, system.rows, alpha) * d - system.c;
        EXPECT_LE(rest.norm(), 1e-5 * system.c.norm()) << k << ' ' << alpha;
      }
      EXPECT_GT(directions, 0) << k;
    }
  }
}

// A contact without any rows; a contact whose A + alpha B is nothing but rounding, so that M has no digits left beside
// H (A + alpha B)^-1 B H'. Catches a direction that solves nothing.
TEST(ClassicsByBodies, ADirectionSolvesTheSystemOrIsRefused) {
  Random random(22);
  for (int k = 0; k < 40; ++k) {
    const Scaled problem = scaled(random_problem(random, 3, 3, 6, 0.8), true, WForm::Parts);
    ContactSystem matrix(problem);
    std::vector<ContactRows> rows(problem.blocks.size());
    Vec d;
    const Vec c = random.normals(problem.size());
    const auto solves = [&](double alpha) {
      return newton_direction(problem, matrix, {.rows = rows, .c = c}, alpha, d);
    };
    for (ContactRows& of : rows) of = {.A = Eigen::Matrix3d::Identity(), .B = Eigen::Matrix3d::Identity()};
    EXPECT_TRUE(solves(1e-10));
    rows[1] = {};
    EXPECT_FALSE(solves(1e-10));
    for (ContactRows& of : rows)
      of = {.A = -1e-10 * (1 + 1e-12) * Eigen::Matrix3d::Identity(), .B = Eigen::Matrix3d::Identity()};
    if (solves(1e-10)) {
      EXPECT_LE((dense_matrix(problem, rows, 1e-10) * d - c).norm(), 1e-5 * c.norm());
    }
  }
}

// Some sweeps over the friction cylinder move the velocities of the bodies as they move those of the contacts. Catches
// a contact that is left out, velocities that are not those of r at the end.
TEST(ClassicsByBodies, CylinderSweeps) {
  Random random(23);
  using enum CylinderPart;
  for (const int dimension : {2, 3})
    for (int k = 0; k < 20; ++k) {
      const Problem problem = random_problem(random, dimension, 4, 6, 0.8);
      const Vec theta = random.normals(6).cwiseAbs();
      const Vec start = random.normals(scaled(problem).size());
      for (const CylinderPart part : {Both, Normal, Tangential}) {
        std::vector<Vec> impulses;
        for (const Scaled& given : {scaled(problem, true, WForm::Parts), scaled(by_entries(problem))}) {
          Endless trial;
          Vec r = start;
          Vec u;
          CylinderSweeps(trial, given).solve(part, theta, {.sweeps = 7}, r, u);
          EXPECT_LE((u - given.W * r - given.q).norm(), 1e-12 * (1 + u.norm()));
          impulses.push_back(r);
        }
        EXPECT_LE((impulses[0] - impulses[1]).norm(), 1e-10 * (1 + impulses[0].norm()));
      }
    }
}

// Little friction and no redundant contact, so that there is one solution: every method finds the same with W by its
// parts and by its entries, and forms no entry of the former. Catches a method that solves another problem by bodies.
TEST(ClassicsByBodies, SameAnswerAsByEntries) {
  Random random(24);
  for (int k = 0; k < 12; ++k) {
    const Problem problem = random_problem(random, 2 + k % 2, 12, 6, 0.1);
    for (const MethodEntry& entry : methods()) {
      if (entry.glocker || entry.name == "hyperplane") continue;
      const Options options{.max_time = std::chrono::seconds(10), .method = entry.method};
      const Result bodies = solve(problem, options);
      EXPECT_FALSE(problem.W.formed()) << entry.name;
      const Result entries = solve(by_entries(problem), options);
      EXPECT_TRUE(bodies.solved()) << entry.name << ": " << bodies.message;
      EXPECT_TRUE(entries.solved()) << entry.name << ": " << entries.message;
      EXPECT_LE((bodies.solution.r - entries.solution.r).norm(), 1e-5 * entries.solution.r.norm()) << entry.name;
    }
  }
}

}  // namespace
}  // namespace perp::contact

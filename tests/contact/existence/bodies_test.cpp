// SPDX-License-Identifier: Apache-2.0
/// Proofs of global problems: by M and H, without the entries of W. Source: contact/existence/infeasible.hpp and
/// existence.hpp; judged in rationals of M, of powers of two, and of H.
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "contact/contact_support.hpp"
#include "contact/existence/existence.hpp"
#include "contact/model/jointed.hpp"
#include "contact/model/velocities.hpp"
#include "contact/scenes/generators.hpp"
#include "contact/solvers/run.hpp"
#include "contact/solvers/solve.hpp"
#include "exact_certificate.hpp"
#include "unsolvable.hpp"

namespace perp::contact {
namespace {

using support::Dense;
using support::Random;
using support::vec;
using test::unsolvable::power;

SpMat diagonal(const Vec& values) { return Dense(values.asDiagonal()).sparseView(); }

Problem global_problem(SpMat M, const Dense& H, Vec f, Vec w, Vec mu, int d) {
  const Index m = M.rows();
  return condense(
      {.M = std::move(M), .H = H.sparseView(), .G = SpMat(m, 0), .f = std::move(f), .w = std::move(w), .b = {}},
      std::move(mu), d);
}

/// The same by its entries: exact where M is of powers of two and H of small whole numbers.
Problem by_entries(const Problem& problem) {
  Problem out = problem;
  const Dense H(problem.global->H);
  out.W = SpMat((H.transpose() * Dense(problem.global->M).diagonal().cwiseInverse().asDiagonal() * H).sparseView());
  out.global = nullptr;
  out.rounding = {};
  return out;
}

/// Bodies with weights y of contacts that nothing can keep from approaching.
Problem squeezed(Random& random, Vec& y) {
  const int d = random.integer(2, 3);
  const Index n = random.integer(2, random.chance(0.2) ? 80 : 12);
  const Index m = random.integer(2, static_cast<int>(d * n));
  const Dense H =
      test::unsolvable::squeezing(d, n, m, random.integer(2, static_cast<int>(std::min<Index>(n, 6))), y, random);
  const Vec masses = Vec::NullaryExpr(m, [&] { return power(random, 8); });
  Problem velocities{.dimension = d, .W = {}, .q = Vec::Zero(d * n), .mu = Vec::Constant(n, 0.5)};
  test::unsolvable::set_velocities(velocities, y, random);
  return global_problem(diagonal(masses), H, Vec::Zero(m), velocities.q, velocities.mu, d);
}

// Found in nearly all, with weights that hold in rationals. Catches a search that asks for the entries of W, a
// certificate of another product than that of M and H.
TEST(BodiesProofs, CertificatesAreFoundAndHoldExactly) {
  Random random(31);
  int found = 0;
  constexpr int problems = 60;
  constexpr SearchLimits soon{.max_time = std::chrono::milliseconds(20)};
  for (int k = 0; k < problems; ++k) {
    Vec y;
    const Problem problem = squeezed(random, y);
    EXPECT_TRUE(proves_infeasible(problem, y)) << k;
    EXPECT_EQ(infeasibility_radius(problem, y), lcp::infinity) << k;
    const std::optional<Infeasible> proof = find_infeasibility(problem);
    EXPECT_FALSE(find_witness(problem, soon).has_value()) << k;
    EXPECT_FALSE(problem.W.formed()) << k;
    if (!proof) continue;
    ++found;
    if (proof->radius == lcp::infinity)
      EXPECT_TRUE(test::exactly_infeasible(by_entries(problem), proof->y)) << k;
    else
      EXPECT_GE(test::exact_radius(by_entries(problem), proof->y), proof->radius) << k;
  }
  EXPECT_GE(found, 0.95 * problems);
}

// For any y the radius is not larger than in rationals. Catches a norm that is rounded down, or taken of a part.
TEST(BodiesProofs, TheRadiusIsALowerBound) {
  Random random(32);
  int finite = 0;
  for (int k = 0; k < 400; ++k) {
    Vec y;
    const Problem problem = squeezed(random, y);
    const int scale = random.integer(-250, 250);
    y = y.unaryExpr([&](double x) { return std::ldexp(random.chance(0.5) ? x : x * random.uniform(0.5, 2), scale); });
    const double claimed = infeasibility_radius(problem, y);
    const double exact = test::exact_radius(by_entries(problem), y);
    EXPECT_LE(claimed, exact) << k;
    finite += claimed > 0 && claimed < lcp::infinity ? 1 : 0;
  }
  EXPECT_GT(finite, 80);
}

// Bodies that are squeezed and at rest: v = 0 keeps all contacts, and q = H' M^-1 f approaches by its roundings alone.
// Catches a proof from those, which there would be if q were what is given.
TEST(BodiesProofs, RoundedVelocitiesProveNothing) {
  Random random(33);
  int by_roundings = 0;
  for (int k = 0; k < 200; ++k) {
    const Index n = random.integer(3, 6);
    const Index m = random.integer(2, 5);
    Vec y;
    const Dense H = test::unsolvable::squeezing(2, n, m, n, y, random);
    const Vec masses = Vec::NullaryExpr(m, [&] { return random.uniform(0.1, 10); });
    Problem problem =
        global_problem(diagonal(masses), H, random.normals(m), Vec::Zero(2 * n), Vec::Constant(n, 0.3), 2);
    EXPECT_EQ(infeasibility_radius(problem, y), 0) << k;
    EXPECT_FALSE(find_infeasibility(problem).has_value()) << k;
    problem.rounding = {};
    by_roundings += proves_infeasible(problem, y) ? 1 : 0;
  }
  EXPECT_GT(by_roundings, 20);
}

// The first of two bodies is driven by a constraint at the velocity with which its contact goes: q = 0, and r = 0 is a
// solution. Nothing of it is left when q is rounded. Catches an error that is measured by what is left.
TEST(BodiesProofs, RoundedVelocitiesOfADrivenBodyProveNothing) {
  Random random(36);
  int by_roundings = 0;
  for (int k = 0; k < 200; ++k) {
    const double driven = random.uniform(0.01, 1);
    Problem problem = condense({.M = diagonal(vec({random.uniform(0.1, 10), random.uniform(0.1, 10)})),
                                .H = support::matrix({{1, 0}, {0, 0}}),
                                .G = support::matrix({{1}, {0}}),
                                .f = random.normals(2),
                                .w = vec({-driven, 0}),
                                .b = vec({-driven})},
                               vec({0}), 2);
    EXPECT_EQ(infeasibility_radius(problem, vec({1})), 0) << k;
    EXPECT_FALSE(find_infeasibility(problem).has_value()) << k;
    EXPECT_FALSE(find_witness(problem).has_value()) << k;
    problem.q[0] = -1e-15 * driven;  // what rounding may make of it
    EXPECT_EQ(infeasibility_radius(problem, vec({1})), 0) << k;
    problem.rounding = {};
    by_roundings += infeasibility_radius(problem, vec({1})) > 0 ? 1 : 0;
  }
  EXPECT_EQ(by_roundings, 200);
}

// All of q cancels: w = -H'v with v in whole numbers, which H'M^-1 f or the constraints bring about, exactly. Catches
// an error that is a part of q, for bodies that are free and for bodies that are not.
TEST(BodiesProofs, VelocitiesThatCancelProveNothing) {
  Random random(37);
  for (int k = 0; k < 200; ++k) {
    const Index n = random.integer(3, 6);
    const Index m = random.integer(3, 5);
    Vec y;
    const Dense H = test::unsolvable::squeezing(2, n, m, n, y, random);
    const Vec masses = Vec::NullaryExpr(m, [&] { return 2.0 * random.integer(1, 9) + 1; });
    const Vec v = Vec::NullaryExpr(m, [&] { return static_cast<double>(random.integer(-9, 9)); });
    const Dense G = Dense::NullaryExpr(m, k % 2, [&] { return static_cast<double>(random.integer(1, 3)); });
    const Vec lambda = Vec::Constant(k % 2, 5);
    const Problem problem = condense({.M = diagonal(masses),
                                      .H = H.sparseView(),
                                      .G = G.sparseView(),
                                      .f = masses.cwiseProduct(v) - G * lambda,
                                      .w = -H.transpose() * v,
                                      .b = -G.transpose() * v},
                                     Vec::Constant(n, 0.3), 2);
    EXPECT_EQ(infeasibility_radius(problem, y), 0) << k;
    EXPECT_FALSE(find_infeasibility(problem).has_value()) << k;
    EXPECT_FALSE(find_witness(problem).has_value()) << k;
  }
}

// Two velocities that are coupled nearly to singularity, and a third that is held: an elimination leaves few digits of
// W and q. Catches proofs from those, and an error that does not know the condition.
TEST(BodiesProofs, WhatIsBadlyConditionedProvesNothing) {
  for (const double apart : {1e-1, 1e-9}) {
    const double c = 1 - apart;
    const auto with = [&](Vec w) {
      return condense({.M = support::matrix({{1, c, 0}, {c, 1, 0}, {0, 0, 1}}),
                       .H = support::matrix({{0, 1}, {0, 0}, {1, 0}}),
                       .G = support::matrix({{0}, {0}, {1}}),
                       .f = vec({1, -1, 0}),
                       .w = std::move(w),
                       .b = vec({0})},
                      vec({0}), 2);
    };
    EXPECT_EQ(find_infeasibility(with(vec({-1, 0}))).has_value(), apart > 0.01);
    EXPECT_EQ(find_witness(with(vec({1, 0}))).has_value(), apart > 0.01);
  }
}

// A body of 30 velocities whose inertia is that of a long chain: its condition is 1e-9 of what its pivots say. Catches
// norms that are said to be right to a condition that is not there.
TEST(BodiesProofs, TheConditionOfLargeBodiesIsNotThatOfTheirPivots) {
  constexpr Index m = 30;
  Dense L = Dense::Identity(m, m);
  for (Index i = 1; i < m; ++i) L(i, i - 1) = -1;
  const Dense M = L * L.transpose();
  const auto inertia = Inertia::of(M.sparseView());
  ASSERT_NE(inertia, nullptr);
  const Vec D = M.diagonal().cwiseSqrt();
  const Dense unit = D.cwiseInverse().asDiagonal() * M * D.cwiseInverse().asDiagonal();
  const double exact =
      1 / (unit.cwiseAbs().colwise().sum().maxCoeff() * Dense(unit.inverse()).cwiseAbs().colwise().sum().maxCoeff());
  EXPECT_LE(inertia->rcond(), 3 * exact);
  EXPECT_GE(inertia->rcond(), 0.99 * exact);
}

// Walls that are turned by any angle, by bodies and by entries: H (y e_N) = 0, or W (y e_N), to rounding only. Said,
// and with a radius that holds.
TEST(BodiesProofs, TurnedWallsToRounding) {
  Random random(34);
  for (const bool entries : {false, true}) {
    int proven = 0;
    for (int k = 0; k < 50; ++k) {
      Dense H = test::unsolvable::between_walls(3, 4, random);
      const Eigen::Matrix3d Q =
          Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal()).normalized().matrix();
      H.topRows(3) = Q * H.topRows(3);
      H.bottomRows(3) = Q * H.bottomRows(3);
      Problem velocities{.dimension = 3, .W = {}, .q = Vec::Zero(12), .mu = Vec::Constant(4, 0.3)};
      test::unsolvable::set_velocities(velocities, vec({1, 1, 0, 0}), random);
      const Vec masses = vec({2, 2, 2, 0.7, 0.8, 0.9});
      Problem problem = global_problem(diagonal(masses), H, Vec::Zero(6), velocities.q, velocities.mu, 3);
      if (entries) problem = by_entries(problem);
      const std::optional<Infeasible> found = find_infeasibility(problem);
      proven += found ? 1 : 0;
      if (!found || found->radius == lcp::infinity) continue;
      EXPECT_GE(found->radius, 1e12) << k;
      if (entries) {
        EXPECT_LE(found->radius, test::exact_radius(problem, found->y));
      }
    }
    EXPECT_GE(proven, 45) << entries;
  }
}

// Problems with solutions are never refused, whatever the masses: v' inside the dual cones by construction, and a
// witness of it is found without W. Catches a witness that is none in rationals, of multiples too, which mostly are
// none.
TEST(BodiesProofs, WitnessesHoldExactly) {
  Random random(35);
  int found = 0;
  int refused = 0;
  constexpr int problems = 100;
  for (int k = 0; k < problems; ++k) {
    const int d = random.integer(2, 3);
    const Index n = random.integer(1, 6);
    const Index m = random.integer(1, static_cast<int>(d * n));
    const Dense H = Dense::NullaryExpr(m, d * n, [&] { return random.integer(-2, 2); });
    const Vec masses = Vec::NullaryExpr(m, [&] { return power(random, 10); });
    const Vec mu = Vec::Constant(n, 0.5);
    Vec w = -H.transpose() * Vec::NullaryExpr(m, [&] { return static_cast<double>(random.integer(-3, 3)); });
    for (Index a = 0; a < n; ++a) w[d * a] += random.uniform(0.01, 1);
    const Problem problem = global_problem(diagonal(masses), H, Vec::Zero(m), w, mu, d);
    EXPECT_FALSE(find_infeasibility(problem).has_value()) << k;
    const std::optional<Witness> witness = find_witness(problem);
    EXPECT_FALSE(problem.W.formed()) << k;
    if (!witness) continue;
    ++found;
    EXPECT_EQ(witness->shift, 0);
    EXPECT_TRUE(test::exactly_inside(by_entries(problem), witness->r)) << k;
    EXPECT_TRUE(examine_witness(problem, witness->r).has_value()) << k;
    for (const double factor : {-1e3, -1.0, 0.9}) {
      const Vec r = factor * witness->r;
      const bool shown = examine_witness(problem, r).has_value();
      EXPECT_TRUE(!shown || test::exactly_inside(by_entries(problem), r)) << k << ' ' << factor;
      refused += shown ? 0 : 1;
    }
  }
  EXPECT_GE(found, 0.9 * problems);
  EXPECT_GE(refused, problems);
}

// r' loses digits in M^-1 that v' has: of an inertia as badly conditioned as parts are made of, u' = H' v' + q is
// inside in rationals. Catches a v' that is not the one that was looked at.
TEST(BodiesProofs, VelocitiesOfWitnessesHoldExactly) {
  Random random(36);
  int found = 0;
  for (int k = 0; k < 60; ++k) {
    const Index n = random.integer(1, 4);
    const Index m = 3 * n;
    const Dense R = random.normals(m, m);
    const Vec sizes = Vec::LinSpaced(m, 0, -8).unaryExpr([](double x) { return std::pow(10, x); });
    Dense M = R * sizes.asDiagonal() * R.transpose();
    M = (0.5 * (M + M.transpose())).eval();
    Vec w = random.normals(3 * n);
    for (Index a = 0; a < n; ++a) w[3 * a] = random.uniform(-1, 2);
    const Problem problem =
        global_problem(SpMat(M.sparseView()), random.normals(m, 3 * n), Vec::Zero(m), w, Vec::Constant(n, 0.5), 3);
    if (problem.W.parts() == nullptr) continue;
    const std::optional<Witness> witness = find_witness(problem);
    if (!witness) continue;
    ++found;
    const SpMat to_contacts = problem.W.parts()->H().transpose();
    EXPECT_TRUE(test::exactly_inside(problem, to_contacts, witness->v)) << k;
  }
  EXPECT_GE(found, 30);
}

// Nothing is said of an inertia that is positive definite by rounding alone.
TEST(BodiesProofs, AnInertiaOnTheBorderHasNoWitness) {
  const double below = std::nextafter(1, 0);
  const auto inertia = Inertia::of(support::matrix({{1, below}, {below, 1}}));
  ASSERT_NE(inertia, nullptr);
  Problem problem{.dimension = 2, .W = {}, .q = vec({1, 0}), .mu = vec({0.5})};
  problem.W = Delassus(std::make_shared<const DelassusParts>(inertia, support::matrix({{1, 0}, {0, 1}})));
  EXPECT_FALSE(find_witness(problem).has_value());
  const auto clear = Inertia::of(support::matrix({{1, 0.5}, {0.5, 1}}));
  problem.W = Delassus(std::make_shared<const DelassusParts>(clear, support::matrix({{1, 0}, {0, 1}})));
  EXPECT_TRUE(find_witness(problem).has_value());
}

// H_N is 2^38 times the constraint, and 1 that it does not hold: W_NN = 9 / 23, of which rounding leaves nothing, and
// r_N = 6 solves. Catches a certificate that takes condensed entries at their word: "no impulses" was said.
TEST(BodiesProofs, EntriesThatAreRoundingProveNothing) {
  for (const double k : {0x1p26, 0x1p30, 0x1p34, 0x1p38}) {
    const Global global{.M = diagonal(vec({2, 5, 1})),
                        .H = support::matrix({{k + 1, 0}, {-3 * k, -2}, {0, 1}}),
                        .G = support::matrix({{1}, {-3}, {0}}),
                        .f = Vec::Zero(3),
                        .w = vec({-54.0 / 23, 36.0 / 23}),
                        .b = vec({0})};
    const Problem problem = condense(global, vec({0}), 2);
    EXPECT_FALSE(proves_infeasible(problem, vec({1}))) << k;
    EXPECT_FALSE(find_infeasibility(problem).has_value()) << k;
    EXPECT_LE(infeasibility_radius(problem, vec({1})), 6 * (1 + 1e-9)) << k;
  }
}

// The constraint (1, -1e-15) holds the contact's velocity but for 1e-30, and r_N = 1e30 solves it; with (1, -2^-100) it
// is 2^-200. And a heavy body in the same mechanism, which squeezed ones do not move: r = 1e20. Catches a zero within
// the digits that is taken for one, and sizes of other contacts that excuse what is left.
TEST(BodiesProofs, WhatConstraintsLeaveIsNotZero) {
  for (const double left : {1e-7, 1e-11, 1e-15, 0x1p-100}) {
    const Problem problem = condense({.M = diagonal(vec({1, 1, 1})),
                                      .H = support::matrix({{0, 0, 1, 0}, {0, 0, 0, 0}, {1, 0, 0, 0}}),
                                      .G = support::matrix({{1}, {-left}, {0}}),
                                      .f = Vec::Zero(3),
                                      .w = vec({-1, 0, -1, 0}),
                                      .b = vec({0})},
                                     vec({0, 0}), 2);
    EXPECT_FALSE(proves_infeasible(problem, vec({0, 1}))) << left;
    EXPECT_LE(infeasibility_radius(problem, vec({0, 1})), 1.01 * (1 + left * left) / (left * left)) << left;
  }
  const Problem heavy =
      condense({.M = diagonal(vec({1, 1, 1e20, 1})),
                .H = support::matrix({{1, 0, -1, 0, 0, 0}, {0, 0, 0, 0, 0, 0}, {0, 0, 0, 0, 1, 0}, {0, 0, 0, 0, 0, 0}}),
                .G = support::matrix({{0}, {1}, {0}, {-1}}),
                .f = Vec::Zero(4),
                .w = vec({0, 0, 0, 0, -1, 0}),
                .b = vec({0})},
               vec({0, 0, 0}), 2);
  EXPECT_FALSE(proves_infeasible(heavy, vec({1, 1, 1e-5})));
}

// Pairs of bodies that are held together, squeezed between walls: H (y e_N) is a combination of constraints, and not 0.
// And a wall whose bricks are held together, which has solutions: none is disproven, and one is witnessed. Catches
// proofs for constrained bodies that look at H alone, or that form W.
TEST(BodiesProofs, ConstraintsArePartOfTheBodies) {
  for (const double gap : {-1.0, 1.0}) {
    const Global global{.M = diagonal(vec({2, 3, 1})),
                        .H = support::matrix({{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 1}}),
                        .G = support::matrix({{1}, {-1}, {0}}),
                        .f = Vec::Zero(3),
                        .w = vec({gap, 0, -0.5, 0}),
                        .b = vec({0})};
    const Problem problem = condense(global, vec({0.5, 0.5}), 2);
    ASSERT_NE(problem.W.parts(), nullptr);
    const std::optional<Infeasible> found = find_infeasibility(problem);
    EXPECT_EQ(found.has_value(), gap < 0);
    EXPECT_TRUE(!found || std::abs(found->y[0] - found->y[1]) <= 1e-15 * found->y[0]);
    EXPECT_EQ(proves_infeasible(problem, vec({1, 1})), gap < 0);
    EXPECT_FALSE(proves_infeasible(problem, vec({1, 1 + 1e-6})));
    EXPECT_EQ(find_witness(problem).has_value(), gap > 0);
    EXPECT_FALSE(problem.W.formed());
  }
  const Problem wall = test::jointed("wall", 300, 40);
  EXPECT_FALSE(find_infeasibility(wall).has_value());
  EXPECT_TRUE(solve(wall).solved());
  EXPECT_FALSE(wall.W.formed());
}

/// A ball between two walls that approach it, beside the bodies of the scene.
Problem scene_and_squeezed_ball(const char* name, Index contacts) {
  const Scene scene = make_scene(name, contacts);
  Global global = *scene.problem().global;
  const Index m = global.M.rows();
  const Index n = global.w.size();
  global.M.conservativeResize(m + 3, m + 3);
  for (Index k = 0; k < 3; ++k) global.M.coeffRef(m + k, m + k) = 2;
  global.H.conservativeResize(m + 3, n + 6);
  for (Index k = 0; k < 3; ++k) {
    global.H.coeffRef(m + k, n + k) = 1;
    global.H.coeffRef(m + k, n + 3 + k) = -1;
  }
  global.G = SpMat(m + 3, 0);
  global.f.conservativeResize(m + 3);
  global.f.tail(3).setZero();
  global.w.conservativeResize(n + 6);
  global.w.tail(6) << -1, 0, 0, -0.5, 0, 0;
  Vec mu = scene.problem().mu;
  mu.conservativeResize(mu.size() + 2);
  mu.tail(2).setConstant(0.5);
  return condense(std::move(global), mu);
}

// Ten thousand contacts and one squeezed ball: every way to the answer names the two, and none forms W.
TEST(BodiesProofs, OneSqueezedBallAmongThousands) {
  const Problem problem = scene_and_squeezed_ball("wall", 10000);
  const std::optional<Infeasible> found = find_infeasibility(problem);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->radius, lcp::infinity);
  EXPECT_EQ((found->y.array() > 0).count(), 2);
  Variant few_sweeps = variant_of("coulomb+nsgs");
  few_sweeps.solver = Nsgs{.max_iterations = 3};
  const contact::Run end = contact::run(problem, few_sweeps, {.seconds = 600});
  EXPECT_EQ(end.status, Status::Infeasible) << end.message;
  EXPECT_FALSE(problem.W.formed());
}

// The bodies of a large scene are one part: interior points on their own problem see that there is a solution, and the
// witness of the wall is found with factors of their size.
TEST(BodiesProofs, LargeScenesHaveSolutions) {
  for (const char* name : {"wall", "spheres"}) {
    const Problem problem = make_scene(name, 1000).problem();
    const SearchLimits limits{.max_time = std::chrono::duration<double>(20)};
    EXPECT_FALSE(find_infeasibility(problem, limits).has_value()) << name;
    if (name == std::string("wall")) {
      EXPECT_TRUE(find_witness(problem, limits).has_value());
    }
    EXPECT_FALSE(problem.W.formed()) << name;
  }
}

}  // namespace
}  // namespace perp::contact

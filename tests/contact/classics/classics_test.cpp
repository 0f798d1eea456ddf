// SPDX-License-Identifier: Apache-2.0
/// The methods of contact/classics: closed forms, derivatives, limits, and what no method may do.
#include "contact/classics/classics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "contact/classics/gauss_seidel.hpp"
#include "contact/contact_support.hpp"
#include "contact/laws/glocker_support.hpp"
#include "contact/scenes/generators.hpp"
#include "contact/solvers/run.hpp"
#include "contact/solvers/solve.hpp"

namespace perp::contact {
namespace {

using support::Random;
using support::vec;
using test::one_contact;
using test::one_contact_solution;
using test::solvable_problem;

/// Those that work on r alone, by name.
std::vector<MethodEntry> classics() {
  std::vector<MethodEntry> all;
  for (const MethodEntry& entry : methods())
    if (!entry.glocker) all.push_back(entry);
  return all;
}

/// A solution by contact::accepted, or what went wrong.
void expect_accepted(const Problem& problem, const Options& options, std::string_view what) {
  const Result result = solve(problem, options);
  EXPECT_TRUE(result.solved()) << problem.name << ' ' << what << ": " << result.message;
  EXPECT_TRUE(accepted(residual(problem, result.solution.r), options.tol)) << problem.name << ' ' << what;
}

TEST(Classics, AllTenAreThere) { EXPECT_EQ(classics().size(), 10); }

// W = I: open, sticking, sliding, at rest; without friction; in 2D and 3D. Closed forms of test::one_contact_solution.
// Catches a wrong sign of u_T, a projection onto the wrong cone, a contact without friction that is given some.
TEST(Classics, OneContactInClosedForm) {
  for (const MethodEntry& entry : classics())
    for (const double mu : {0.0, 0.4})
      for (const Vec& q : {vec({1, 2, -1}), vec({-1, 0.1, -0.1}), vec({-1, 2, 1}), vec({-2, 0, -5}), vec({0, 1, 1}),
                           vec({-1, 0, 0}), vec({1, 2}), vec({-1, 0.05}), vec({-1, 2})}) {
        const Problem problem = one_contact(q, mu);
        const Result result = solve(problem, {.max_time = std::chrono::seconds(5), .method = entry.method});
        EXPECT_TRUE(result.solved()) << entry.name << ' ' << mu << ": " << q.transpose() << ": " << result.message;
        EXPECT_LE((result.solution.r - one_contact_solution(q, mu)).norm(), 1e-6)
            << entry.name << ' ' << mu << ": " << q.transpose();
      }
}

// Each equation's A + B W is the derivative of its Phi along random directions where that exists. Catches any wrong
// entry; the points are not near kinks but with probability zero.
TEST(Classics, NewtonRowsAreDerivatives) {
  Random random(5);
  using Function = AlartCurnierNewton::Function;
  for (const int dimension : {2, 3})
    for (int k = 0; k < 200; ++k) {
      const Problem problem = solvable_problem(dimension, 4, 14, random, 0.25);
      const Scaled s = scaled(problem);
      const std::vector<std::pair<const char*, RowsOf>> equations{
          {"standard", equation(s, AlartCurnierNewton{})},
          {"jean-moreau", equation(s, AlartCurnierNewton{.function = Function::JeanMoreau})},
          {"xuewen", equation(s, AlartCurnierNewton{.function = Function::Xuewen})},
          {"fischer-burmeister", equation(s, FischerBurmeisterNewton{})},
          {"natural-map", equation(s, NaturalMapNewton{})}};
      const Vec r = random.normals(s.size()) + Vec::Ones(s.size());
      const Vec d = random.normals(s.size());
      const auto phi = [&](const RowsOf& rows, double t) -> Vec {
        const Vec x = r + t * d;
        return -newton_system(s, rows, x, s.W * x + s.q).c;
      };
      for (const auto& [name, rows] : equations) {
        SpMat K = s.W.matrix();
        contact_matrix(s, newton_system(s, rows, r, s.W * r + s.q).rows, 0, K);
        constexpr double h = 1e-7;
        const Vec slope = (phi(rows, h) - phi(rows, -h)) / (2 * h);
        EXPECT_LE((K * d - slope).norm(), 1e-5 * (1 + slope.norm())) << name << ' ' << dimension << "D, " << k;
      }
    }
}

// Every local solver gives a solution of the problem of one contact, by the judge of that problem alone; W_aa full and
// unsymmetric by some per cent. Catches a root that is none, a sliding contact with the wrong sign.
TEST(Classics, LocalSolversObeyTheLaw) {
  Random random(6);
  for (const int dimension : {2, 3})
    for (int k = 0; k < 300; ++k) {
      Problem problem = solvable_problem(dimension, 1, 6, random);
      support::Dense W = support::Dense(problem.W.matrix());
      W += 0.02 * W.norm() * support::Dense::Identity(dimension, dimension);
      W(0, dimension - 1) *= 1.03;
      problem.W = W.sparseView();
      problem.W.given().makeCompressed();
      const Scaled s = scaled(problem);
      for (const LocalSolver local : {LocalSolver::Newton, LocalSolver::Cases}) {
        Vec r = Vec::Zero(s.size());
        Vec u = s.q;
        GaussSeidel(s, local).sweep(r, u);
        EXPECT_LE(natural_map(s, r), 1e-11 * (1 + r.norm())) << dimension << "D, " << k;
      }
    }
}

// Random problems with frictionless contacts, W regular, in 2D and 3D: what is solved is what the judge accepts, the
// share is what was measured. Catches a method that loses contacts of other sizes than 3.
TEST(Classics, RandomProblems) {
  struct Least {
    std::string_view name;
    int solved;
  };
  constexpr int problems = 20;
  for (const auto& [name, least] :
       {Least{"nsgs", 17}, Least{"fixed-point", 17}, Least{"extragradient", 17}, Least{"alart-curnier", 15},
        Least{"fischer-burmeister", 17}, Least{"natural-map", 12}, Least{"tresca", 15}, Least{"panagiotopoulos", 15},
        Least{"cadoux", 15}}) {
    Random random(7);
    int solved = 0;
    for (int k = 0; k < problems; ++k) {
      const int dimension = 2 + k % 2;
      const Problem problem = solvable_problem(dimension, 5, 40, random, 0.2);
      const Result result = solve(problem, {.max_time = std::chrono::seconds(1),
                                            .method = std::ranges::find(methods(), name, &MethodEntry::name)->method});
      EXPECT_EQ(result.solved(), accepted(residual(problem, result.solution.r), 1e-8)) << name;
      solved += result.solved() ? 1 : 0;
    }
    EXPECT_GE(solved, least) << name;
  }
}

// The generated scenes with a solution in closed form, W singular: each method is at most told to have failed.
TEST(Classics, SingularScenes) {
  for (const char* name : {"stack", "incline", "wall"}) {
    const Problem problem = make_scene(name, 6).problem();
    for (const MethodEntry& entry : classics()) {
      const Result result = solve(problem, {.max_time = std::chrono::seconds(1), .method = entry.method});
      EXPECT_TRUE(result.solution.r.allFinite()) << name << ' ' << entry.name;
      EXPECT_EQ(result.solved(), accepted(residual(problem, result.solution.r), 1e-8)) << name << ' ' << entry.name;
      if (entry.name == "nsgs" || entry.name == "alart-curnier") {
        EXPECT_TRUE(result.solved()) << name << ' ' << entry.name << ": " << result.message;
      }
    }
  }
}

// Local solvers, relaxation, equations, line searches, a fixed rho: options that change the method change no answer.
TEST(Classics, OptionsReachTheMethod) {
  Random random(8);
  const Problem problem = solvable_problem(3, 4, 40, random);
  using Function = AlartCurnierNewton::Function;
  using enum ContactLineSearch;
  const std::vector<Method> all{Nsgs{.local = LocalSolver::Projection},
                                Nsgs{.local = LocalSolver::Cases},
                                Nsgs{.omega = 0.7},
                                Nsgs{.omega = 1.2},
                                Nsgs{.scaling = false},
                                FixedPoint{.rule = {.adaptive = false, .rho = 0.2}},
                                Extragradient{.rule = {.adaptive = false, .rho = 0.2}},
                                AlartCurnierNewton{.function = Function::JeanMoreau},
                                AlartCurnierNewton{.function = Function::Hueeber},
                                AlartCurnierNewton{.newton = {.line_search = Armijo}},
                                FischerBurmeisterNewton{.newton = {.line_search = Armijo}},
                                Cadoux{.relaxation = 1}};
  for (std::size_t i = 0; i < all.size(); ++i)
    expect_accepted(problem, {.max_time = std::chrono::seconds(5), .method = all[i]}, std::to_string(i));
}

// Every status. Catches a loop that does not look at the limits, and an unsolvable problem that runs for ever.
TEST(Classics, EveryStatusIsReached) {
  const Problem spheres = make_scene("spheres", 60).problem();
  Problem none = one_contact(vec({-1, 0.5, 0}), 0.3);
  none.W = SpMat(3, 3);
  const std::atomic<bool> interrupt{true};
  for (const MethodEntry& entry : classics()) {
    EXPECT_EQ(solve(spheres, {.max_time = std::chrono::seconds(0), .method = entry.method}).status, Status::TimeLimit)
        << entry.name;
    EXPECT_EQ(solve(spheres, {.interrupt = &interrupt, .method = entry.method}).status, Status::Interrupted)
        << entry.name;
    EXPECT_EQ(solve(none, {.max_time = std::chrono::seconds(2), .method = entry.method}).status, Status::Infeasible)
        << entry.name;
    Method once = entry.method;
    ncp::Fields fields;
    std::visit([&](auto& m) { describe(m, fields); }, once);
    ASSERT_NE(fields.find("max_iterations"), nullptr) << entry.name;
    *std::get<int*>(fields.find("max_iterations")->target) = 1;
    EXPECT_EQ(solve(spheres, {.method = once}).status, Status::NoProgress) << entry.name;
  }
}

// A limit that ends in the middle: the end is near it, whatever the method does.
TEST(Classics, TimeLimitHolds) {
  const Problem spheres = make_scene("spheres", 150).problem();
  for (const MethodEntry& entry : classics()) {
    const Result result =
        solve(spheres, {.tol = 1e-15, .max_time = std::chrono::duration<double>(0.1), .method = entry.method});
    EXPECT_LT(result.stats.time.count(), 1.0) << entry.name;
    EXPECT_TRUE(result.solution.r.allFinite()) << entry.name;
  }
}

// Numbers that overflow, contacts without any inertia, no contact at all. Catches NaN and infinity that get out.
TEST(Classics, NothingThatIsNotFiniteGetsOut) {
  Problem huge = make_scene("spheres", 10).problem();
  huge.mu[0] = 1e308;
  Problem large = make_scene("spheres", 10).problem();
  large.q *= 1e200;
  Problem none{.dimension = 3, .W = SpMat(0, 0), .q = Vec(0), .mu = Vec(0)};
  Problem still = make_scene("stack", 5).problem();
  still.W.given() *= 0;
  for (const MethodEntry& entry : classics())
    for (const Problem* problem : {&huge, &large, &none, &still}) {
      Result result;
      ASSERT_NO_THROW(result =
                          solve(*problem, {.max_time = std::chrono::duration<double>(0.2), .method = entry.method}))
          << entry.name;
      EXPECT_TRUE(result.solution.r.allFinite()) << entry.name;
      EXPECT_EQ(result.solved(), accepted(residual(*problem, result.solution.r), 1e-8)) << entry.name;
    }
}

// A start at the solution is accepted in the first iterations. Catches a start that is dropped.
TEST(Classics, WarmStart) {
  Random random(9);
  const Problem problem = solvable_problem(3, 4, 40, random);
  const Result cold = solve(problem, {.tol = 1e-12});
  ASSERT_TRUE(cold.solved());
  for (const MethodEntry& entry : classics()) {
    const Result warm = solve(problem, {.tol = 1e-6, .method = entry.method, .start = cold.solution.r});
    EXPECT_TRUE(warm.solved()) << entry.name << ": " << warm.message;
    EXPECT_LE(warm.stats.iterations, entry.name == "cadoux" ? 20 : 3) << entry.name;  // its multipliers are cold
  }
}

// Onto the hyperplane and then onto the cone, steps go to zero like the cube of the error where F is not zero at the
// solution, which is at every sliding contact: the error falls like k^(-1/2). Onto both at once it falls linearly.
TEST(Classics, HyperplaneOntoOneAfterTheOther) {
  const Problem sliding = one_contact(vec({-1, 2, 1}), 0.4);
  EXPECT_TRUE(solve(sliding, {.method = Hyperplane{.max_iterations = 1000}}).solved());
  const Result tenth = solve(sliding, {.method = Hyperplane{.intersection = false, .max_iterations = 1'000}});
  const Result whole = solve(sliding, {.method = Hyperplane{.intersection = false, .max_iterations = 100'000}});
  EXPECT_FALSE(whole.solved());
  EXPECT_NEAR(tenth.residual.siconos / whole.residual.siconos, 10, 3);
}

// The recorded sets of up to 31 contacts. Catches a method that solves fewer than it did.
TEST(Classics, RecordedSets) {
  SKIP_WITHOUT_RECORDED_PROBLEMS();
  for (const char* file : {"Box_Stacks-i0035-31-0.hdf5", "Rover1039.dat", "Rover4396.dat", "NESpheres_10_1.dat",
                           "FC3D_Example1.dat", "CubeH8.hdf5"})
    for (const MethodEntry& entry : classics()) {
      if (entry.name == "hyperplane") continue;
      expect_accepted(recorded(file), {.max_time = std::chrono::seconds(10), .method = entry.method}, entry.name);
    }
}

}  // namespace
}  // namespace perp::contact

// SPDX-License-Identifier: Apache-2.0
#include "lcp/qp/bound_qp.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "lcp/qp/bound_qp_support.hpp"

namespace perp::lcp {
namespace {

using testing::HasSubstr;

// Membrane problem of three sizes: at rounding level whatever the scaling of the matrix, by every preconditioner.
// Catches stopping tests that know the scale, preconditioners that are not symmetric, a wrong free boundary.
TEST(BoundQp, MembraneOnObstacle) {
  for (const int N : {3, 16, 60})
    for (const double scale : {1e-6, 1.0, 1e6})
      for (const auto& [name, options] : all_preconditioners()) {
        const AffineMcp problem = membrane(N, scale);
        const Result result = expect_solved(problem, problem.box.lower.cwiseMax(0), options, name);
        EXPECT_LE(violation(problem, result.z), 4e-16 * 8 * 0.1 * scale) << name << " " << N;
      }
}

// The string over |x| <= 1/2 on the obstacle 0.1 - x^2 leaves it at +-a, where the tangent meets (1/2, 0):
// a^2 - a + 0.1 = 0. A million times smoother than rough: the flattest vector has d'M d = 1e-9 d'D d, which is not 0.
TEST(BoundQp, StringOnObstacle) {
  const int n = 99999;
  const double h = 1.0 / (n + 1);
  AffineMcp problem{
      .M = support::tridiagonal(n, -1, 2, -1), .q = Vec::Zero(n), .box = Box::nonnegative(static_cast<Index>(n))};
  const auto x = [&](int i) { return (i + 1) * h - 0.5; };
  for (int i = 0; i < n; ++i) problem.box.lower[i] = 0.1 - x(i) * x(i);
  const Result result = expect_solved(problem, Vec::Zero(n), {}, "string");
  EXPECT_LE(violation(problem, result.z), 1e-16);
  const double a = (1 - std::sqrt(0.6)) / 2;
  for (int i = 0; i < n; ++i) {
    const double t = std::abs(x(i));
    const double exact = t <= a ? 0.1 - t * t : 2 * a * (0.5 - t);
    ASSERT_NEAR(result.z[i], exact, 1e-7) << i;
  }
}

// Starting on coarse grids pays: few steps on the finest, however many points it has. From the obstacle itself the free
// boundary travels from cell to cell instead.
TEST(BoundQp, FewStepsAtAnySize) {
  for (const int N : {40, 80, 160}) {
    const AffineMcp problem = membrane(N);
    const Vec start = problem.box.lower.cwiseMax(0);
    EXPECT_LE(expect_solved(problem, start, {}, "nested").iterations, 5) << N;
    expect_solved(problem, start, {.nested = false}, "not nested");
  }
}

// Every step is a descent of the objective, whatever the preconditioner. Catches projected steps that are not checked.
TEST(BoundQp, NeverRaisesTheObjective) {
  Random random(7);
  const auto phi = [](const AffineMcp& p, const Vec& z) { return z.dot(0.5 * (p.M * z) + p.q); };
  for (int repeat = 0; repeat < 10; ++repeat) {
    AffineMcp problem = planted(gram(80, 80, 3, random), 0, random).problem;
    for (Index i = 0; i < 80; ++i) problem.M.coeffRef(i, i) += 1e-3;
    const Vec start = project(problem.box, 10 * random.normals(80));
    for (const auto& [name, options] : all_preconditioners()) {
      double before = phi(problem, start);
      for (long steps = 1; steps <= 6; ++steps) {
        BoundQp limited = options;
        limited.step_limit = steps;
        const double now = phi(problem, bound_qp(problem, start, limited).z);
        EXPECT_LE(now, before + 1e-12 * std::abs(before)) << name << " " << steps;
        before = now;
      }
    }
  }
}

// A start that solves is kept: nested iteration would only come back to it.
TEST(BoundQp, KeepsAGoodStart) {
  const AffineMcp problem = membrane(50);
  const Vec solution = expect_solved(problem, Vec::Zero(2500), {}, "first").z;
  const Result again = expect_solved(problem, solution, {}, "again");
  EXPECT_LE(again.iterations, 1);
  EXPECT_LE((again.z - solution).lpNorm<Eigen::Infinity>(), 1e-13);
}

// Positive definite problems in boxes of every kind have one solution, which is planted. Catches bounds of one side,
// fixed and free variables, degenerate solutions (F_i = 0 at a bound).
TEST(BoundQp, FindsThePlantedSolution) {
  Random random(1);
  for (int repeat = 0; repeat < 60; ++repeat) {
    const Index n = random.integer(1, 60);
    SpMat M = gram(n, static_cast<int>(n), 3, random);
    for (Index i = 0; i < n; ++i) M.coeffRef(i, i) += 0.1;
    const auto [problem, solution] = planted(M, repeat % 2 ? 0.5 : 0, random);
    for (const auto& [name, options] : all_preconditioners()) {
      const Result result = expect_solved(problem, random.normals(n), options, name);
      EXPECT_LE((result.z - solution).lpNorm<Eigen::Infinity>(), 1e-9) << name;
    }
  }
}

// The same of M-matrices, which the hierarchy is made for, and of matrices scaled from both sides by 1e-4 to 1e4, whose
// entries span 1e-8 to 1e8: the terms of their rows are of size 1e8, and what doubles leave of them is accepted.
TEST(BoundQp, ScaledFromBothSides) {
  Random random(2);
  for (int repeat = 0; repeat < 16; ++repeat) {
    const Index n = random.integer(20, 200);
    const SpMat half = support::m_matrix(n, 2, random);
    SpMat M = half + SpMat(half.transpose());
    for (Index j = 0; j < n; ++j) M.coeffRef(j, j) += std::max(0.0, -M.col(j).sum());
    Vec D = Vec::NullaryExpr(n, [&] { return std::pow(10, random.uniform(-4, 4)); });
    if (repeat % 2) M = D.asDiagonal() * M * D.asDiagonal();
    const AffineMcp problem = planted(M, 0.2, random).problem;
    for (const auto& [name, options] : all_preconditioners())
      if (repeat % 2 == 0)
        expect_solved(problem, Vec::Zero(n), options, name, {.tol = 1e-10});
      else
        EXPECT_TRUE(solve(problem, Vec::Zero(n), options, {.tol = 1e-8}).accepted()) << name << ' ' << repeat;
  }
}

// M of half the rank, and solutions: usually many.
TEST(BoundQp, SolvesSingularProblems) {
  Random random(3);
  for (int repeat = 0; repeat < 60; ++repeat) {
    const Index n = random.integer(2, 80);
    const SpMat M = gram(n, std::max(1, static_cast<int>(n) / 2), 2, random);
    const AffineMcp problem = planted(M, 0.3, random).problem;
    for (const auto& [name, options] : all_preconditioners())
      expect_solved(problem, random.normals(n), options, name + " " + std::to_string(repeat));
  }
}

// A periodic Laplacian has M e = 0: without bounds there are solutions if and only if e'q = 0, with an obstacle if and
// only if e'q >= 0; else -e or e is the direction.
TEST(BoundQp, PeriodicLaplacian) {
  Random random(4);
  for (const int N : {4, 40}) {
    const Index n = static_cast<Index>(N) * N;
    Vec q = random.normals(n);
    q.array() -= q.mean();
    for (const auto& [name, options] : all_preconditioners()) {
      expect_solved({laplacian(N, 1, true), q, Box::free(n)}, Vec::Zero(n), options, name + " free");
      for (const double mean : {0.0, 0.1})
        expect_solved({laplacian(N, 1, true), Vec(q.array() + mean), Box::nonnegative(n)}, Vec::Ones(n), options,
                      name + " on obstacle " + std::to_string(mean));
      for (const Box& box : {Box::nonnegative(n), Box::free(n)}) {
        const AffineMcp problem{laplacian(N, 1, true), Vec(q.array() - 0.1), box};
        const Result result = bound_qp(problem, Vec::Ones(n), options);
        EXPECT_EQ(result.status, Status::Infeasible) << name << ": " << result.message;
        EXPECT_TRUE(proves_infeasible(problem, result.certificate)) << name;
      }
    }
  }
}

// Random problems without a solution: q has a part -v along a null vector v >= 0 of M, and nothing bounds it. All
// numbers are small integers over powers of two: rounded, M would be nonsingular, and a solution far out possible.
TEST(BoundQp, ProvesInfeasibility) {
  Random random(5);
  for (int repeat = 0; repeat < 40; ++repeat) {
    const Index n = random.integer(2, 60);
    const auto integers = [&](Index rows, Index columns) -> Dense {
      return random.normals(rows, columns).unaryExpr([](double a) { return std::round(2 * a); });
    };
    const Vec v = integers(n, 1).cwiseAbs().cwiseMax(1);
    const Dense B = integers(n, n / 2 + 1);
    const Dense project = v.squaredNorm() * Dense::Identity(n, n) - v * v.transpose();
    const Dense C = project * B * std::exp2(-std::round(std::log2(v.squaredNorm())));
    const AffineMcp symmetric{sparse(C * C.transpose()), Vec(C * integers(C.cols(), 1) - 0.125 * v),
                              Box::nonnegative(n)};
    for (const auto& [name, options] : all_preconditioners()) {
      const Result result = bound_qp(symmetric, Vec::Zero(n), options);
      EXPECT_EQ(result.status, Status::Infeasible) << name << ": " << to_string(result.status) << result.message;
      EXPECT_TRUE(proves_infeasible(symmetric, result.certificate)) << name;
    }
  }
}

TEST(BoundQp, ZeroRows) {
  const SpMat M = support::matrix({{2, 0}, {0, 0}});
  EXPECT_EQ(expect_solved({M, vec({-2, 1}), Box::nonnegative(2)}, vec({0, 5}), {}, "held").z, vec({1, 0}));
  EXPECT_EQ(expect_solved({M, vec({-2, 0}), Box::nonnegative(2)}, vec({0, 5}), {}, "anything").z, vec({1, 5}));
  EXPECT_EQ(expect_solved({M, vec({-2, -1}), {Vec::Zero(2), vec({7, 7})}}, vec({0, 5}), {}, "up").z, vec({1, 7}));
  const AffineMcp problem{M, vec({-2, -1}), Box::nonnegative(2)};
  const Result result = bound_qp(problem, Vec::Zero(2));
  EXPECT_EQ(result.status, Status::Infeasible);
  EXPECT_TRUE(proves_infeasible(problem, result.certificate));
}

TEST(BoundQp, SmallAndFixed) {
  EXPECT_TRUE(bound_qp({SpMat(0, 0), Vec(0), Box::nonnegative(0)}, Vec(0)).solved());
  const SpMat M = support::matrix({{2}});
  EXPECT_EQ(expect_solved({M, vec({-4}), Box::nonnegative(1)}, vec({0}), {}, "inside").z, vec({2}));
  EXPECT_EQ(expect_solved({M, vec({4}), Box::nonnegative(1)}, vec({9}), {}, "held").z, vec({0}));
  EXPECT_EQ(expect_solved({M, vec({4}), {vec({3}), vec({3})}}, vec({9}), {}, "fixed").z, vec({3}));
  EXPECT_EQ(expect_solved({M, vec({4}), Box::free(1)}, vec({9}), {}, "free").z, vec({-2}));
}

// Not symmetric, not semidefinite: told with the place and the value.
TEST(BoundQp, RefusesOtherMatrices) {
  const auto message = [](const SpMat& M, const Vec& q) {
    const Result result = bound_qp({M, q, Box::free(q.size())}, Vec::Zero(q.size()));
    EXPECT_EQ(result.status, Status::NotApplicable);
    return result.message;
  };
  EXPECT_THAT(message(support::matrix({{2, 1}, {0, 2}}), vec({1, 1})),
              HasSubstr("entry (1, 2) is 1, the entry (2, 1)"));
  EXPECT_THAT(message(support::matrix({{2, 1}, {1.5, 2}}), vec({1, 1})), HasSubstr("1.5"));
  EXPECT_THAT(message(support::matrix({{2, 0}, {0, -3}}), vec({1, 1})), HasSubstr("diagonal entry 2 is -3"));
  EXPECT_THAT(message(support::matrix({{2, 1}, {1, 0}}), vec({1, 1})), HasSubstr("diagonal entry 2 is 0"));
  EXPECT_THAT(message(support::matrix({{1, 2}, {2, 1}}), vec({1, -1})), HasSubstr("d'M d = -"));
}

// Indefinite matrices with positive diagonals: whatever is answered is true.
TEST(BoundQp, IndefiniteMatrices) {
  Random random(6);
  int refused = 0;
  for (int repeat = 0; repeat < 100; ++repeat) {
    const Index n = random.integer(2, 40);
    const Dense A = random.normals(n, n);
    const Dense M = A + A.transpose() + 3 * Dense::Identity(n, n) * (repeat % 5);
    const AffineMcp problem{sparse(M), random.normals(n), support::mixed_box(n, random)};
    for (const auto& [name, options] : all_preconditioners()) {
      const Result result = bound_qp(problem, random.normals(n), options);
      if (result.solved()) {
        EXPECT_LE(violation(problem, result.z), 1e-8);
      }
      if (result.status == Status::Infeasible) {
        EXPECT_TRUE(proves_infeasible(problem, result.certificate));
      }
      refused += result.status == Status::NotApplicable;
    }
  }
  EXPECT_GT(refused, 100);
}

// Numbers that overflow on the way end in an honest answer, never in a loop or a point that does not solve.
TEST(BoundQp, OverflowOnTheWay) {
  const Vec big = vec({1e308, -1e308});
  for (const double a : {1e-300, 1e-8, 1.0, 1e300})
    for (const auto& [name, options] : all_preconditioners())
      for (const Box& box : {Box::nonnegative(2), Box::free(2)}) {
        const AffineMcp problem{support::matrix({{2 * a, -a}, {-a, 2 * a}}), big, box};
        const Result result = bound_qp(problem, 1e10 * big.cwiseMax(0).cwiseMin(1), options);
        EXPECT_TRUE(result.z.allFinite()) << name;
        if (result.solved()) {
          EXPECT_LE(violation(problem, result.z), 1e-8 * 1e308) << name;
        }
      }
}

// Rows whose entries are not in order, as other codes assemble them.
TEST(BoundQp, TakesColumnsInAnyOrder) {
  AffineMcp problem = membrane(12);
  const Vec expected = expect_solved(problem, Vec::Zero(144), {}, "in order").z;
  SpMat& M = problem.M;
  for (Index j = 0; j < M.cols(); ++j) {
    std::reverse(M.innerIndexPtr() + M.outerIndexPtr()[j], M.innerIndexPtr() + M.outerIndexPtr()[j + 1]);
    std::reverse(M.valuePtr() + M.outerIndexPtr()[j], M.valuePtr() + M.outerIndexPtr()[j + 1]);
  }
  for (const auto& [name, options] : all_preconditioners())
    EXPECT_LE((expect_solved(problem, Vec::Zero(144), options, name).z - expected).norm(), 1e-13) << name;
}

TEST(BoundQp, Limits) {
  const AffineMcp problem = membrane(60);
  const Vec start = Vec::Zero(3600);
  EXPECT_EQ(bound_qp(problem, start, {}, {.interrupted = [] { return true; }}).status, Status::Interrupted);
  EXPECT_EQ(bound_qp(problem, start, {}, {.deadline = std::chrono::steady_clock::now()}).status, Status::TimeLimit);
  const Result result = bound_qp(problem, start, {.nested = false, .step_limit = 1});
  EXPECT_EQ(result.status, Status::IterationLimit);
  EXPECT_EQ(result.iterations, 1);
}

TEST(BoundQp, RefusesBadInput) {
  const AffineMcp problem = membrane(3);
  const Vec start = Vec::Zero(9);
  EXPECT_THROW(bound_qp(problem, Vec::Zero(8)), std::invalid_argument);
  EXPECT_THROW(bound_qp(problem, start, {.direct = 0}), std::invalid_argument);
  EXPECT_THROW(bound_qp(problem, start, {.step_limit = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace perp::lcp

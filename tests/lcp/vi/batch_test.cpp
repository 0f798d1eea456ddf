// SPDX-License-Identifier: Apache-2.0
// Many affine variational inequalities at once.
#include "lcp/vi/batch.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Dense;
using support::Random;
using support::sparse;

/// Games of one M and A, each with its own q, and sides that depend on k.
struct Games {
  Index count, n, m;
  FacePivoting::Rows M, A;
  std::vector<double> q, b, u;

  Games(Index count_, Index n_, Index m_) : count(count_), n(n_), m(m_), M(n_, n_), A(m_, n_) {
    Random random(5);
    const Dense G = random.normals(n, n), S = random.normals(n, n);
    M = G * G.transpose() + Dense::Identity(n, n) + S - S.transpose();
    A = random.normals(m, n);
    for (Index k = 0; k < count * n; ++k) q.push_back(10 * random.normal());
    for (Index k = 0; k < count * m; ++k) b.push_back(-random.uniform(0, 1));
    u.assign(at(n), 2);
  }
  ViBatch batch() const {
    return {.count = count,
            .n = n,
            .m = m,
            .M = {M.data(), 0},
            .q = {q.data(), n},
            .A = {A.data(), 0},
            .b = {b.data(), m},
            .c = {infinities.data(), 0},
            .l = {infinities.data() + m, 0},
            .u = {u.data(), 0}};
  }
  std::vector<double> infinities = [this] {
    std::vector<double> values(at(m), infinity);
    values.insert(values.end(), at(n), -infinity);
    return values;
  }();
};

struct Answers {
  std::vector<double> x, multipliers, residual;
  std::vector<Status> status;
  explicit Answers(const ViBatch& batch, int threads)
      : x(at(batch.count * batch.n)),
        multipliers(at(batch.count * batch.m)),
        residual(at(batch.count)),
        status(at(batch.count)) {
    solve_batch(batch, {x, multipliers, status, residual}, threads);
  }
};

// The same bits by one thread, three threads and in another order, and what solve_vi() finds. Catches what is kept from
// instance to instance and should not be.
TEST(Batch, DependsNeitherOnThreadsNorOnOrder) {
  for (const Index m : {12, 0}) {
    const Games games(60, 8, m);
    const Answers one(games.batch(), 1), three(games.batch(), 3);
    EXPECT_EQ(one.x, three.x);
    EXPECT_EQ(one.multipliers, three.multipliers);
    Games turned = games;
    for (Index k = 0; k < games.count; ++k) {
      const Index other = games.count - 1 - k;
      std::copy_n(games.q.begin() + other * games.n, games.n, turned.q.begin() + k * games.n);
      std::copy_n(games.b.begin() + other * m, m, turned.b.begin() + k * m);
    }
    const Answers back(turned.batch(), 2);
    for (Index k = 0; k < games.count; ++k) {
      ASSERT_EQ(one.status[at(k)], Status::Solved);
      ASSERT_LE(one.residual[at(k)], 1e-9);
      const Eigen::Map<const Vec> x(one.x.data() + k * games.n, games.n);
      const Eigen::Map<const Vec> same(back.x.data() + (games.count - 1 - k) * games.n, games.n);
      ASSERT_EQ(x, same);
      const AffineVi vi{sparse(games.M),
                        Eigen::Map<const Vec>(games.q.data() + k * games.n, games.n),
                        {sparse(games.A),
                         {Eigen::Map<const Vec>(games.b.data() + k * m, m), Vec::Constant(m, infinity)},
                         {Vec::Constant(games.n, -infinity), Vec::Constant(games.n, 2)}}};
      ASSERT_LE((solve_vi(vi).x - x).lpNorm<Eigen::Infinity>(), 1e-8);
    }
  }
}

// Each instance has its own M, A and sides. Catches factors, rows and bounds that are kept of the instance before.
TEST(Batch, VariesEverything) {
  constexpr Index count = 30, n = 5;
  for (const Index m : {7, 0}) {
    Random random(6);
    std::vector<double> M, q, A, b, c, l, u;
    const auto append = [](std::vector<double>& to, const FacePivoting::Rows& entries) {
      to.insert(to.end(), entries.data(), entries.data() + entries.size());
    };
    for (Index k = 0; k < count; ++k) {
      const Dense G = random.normals(n, n), S = random.normals(n, n);
      append(M, Dense(G * G.transpose() + Dense::Identity(n, n) + S - S.transpose()));
      append(A, Dense(random.normals(m, n)));
      for (Index j = 0; j < n; ++j) {
        q.push_back(10 * random.normal());
        l.push_back(-random.uniform(0, 1));
        u.push_back(j == 2 && k % 2 == 0 ? l.back() : random.uniform(0, 1));  // a fixed variable in every other
      }
      for (Index i = 0; i < m; ++i) {
        const double at_lower =
            Eigen::Map<const Vec>(A.data() + (k * m + i) * n, n).dot(Eigen::Map<const Vec>(l.data() + k * n, n));
        b.push_back(at_lower - random.uniform(0, 1));
        c.push_back(at_lower + random.uniform(0, 1));
      }
    }
    const ViBatch batch{.count = count,
                        .n = n,
                        .m = m,
                        .M = {M.data(), n * n},
                        .q = {q.data(), n},
                        .A = {A.data(), m * n},
                        .b = {b.data(), m},
                        .c = {c.data(), m},
                        .l = {l.data(), n},
                        .u = {u.data(), n}};
    const Answers all(batch, 1);
    for (Index k = 0; k < count; ++k) {
      const auto of = [&](const std::vector<double>& values, Index size) {
        return Vec(Eigen::Map<const Vec>(values.data() + k * size, size));
      };
      const Eigen::Map<const FacePivoting::Rows> Mk(M.data() + k * n * n, n, n), Ak(A.data() + k * m * n, m, n);
      const ViResult one = solve_vi({sparse(Mk), of(q, n), {sparse(Ak), {of(b, m), of(c, m)}, {of(l, n), of(u, n)}}});
      ASSERT_EQ(all.status[at(k)], Status::Solved);
      ASSERT_TRUE(one.solved());
      ASSERT_LE((one.x - of(all.x, n)).lpNorm<Eigen::Infinity>(), 1e-8);
    }
  }
}

// A NaN in one instance is said, from whichever thread. Catches exceptions that end the program.
TEST(Batch, RefusesWhatIsNoProblem) {
  Games games(40, 4, 3);
  games.u[1] = -infinity;
  EXPECT_THROW(Answers(games.batch(), 2), std::invalid_argument);
  Games boxes(40, 4, 0);
  boxes.q[150] = infinity;
  EXPECT_THROW(Answers(boxes.batch(), 2), std::invalid_argument);
}

}  // namespace
}  // namespace perp::lcp

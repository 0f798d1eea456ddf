// SPDX-License-Identifier: Apache-2.0
/// Random positive definite LCPs of a simulator's size, dense: DenseSolver cold and warm beside Bullet's Dantzig solver
/// (Debian: libbullet-dev) and the methods of lcp::solve(). Least microseconds a problem. See README.md.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <random>
#include <vector>

#include "lcp/solve/dense.hpp"
#include "lcp/solve/solve.hpp"
#ifdef PERP_BULLET
#include <BulletDynamics/MLCPSolvers/btDantzigLCP.h>
#endif

namespace {

using namespace perp::lcp;
using Clock = std::chrono::steady_clock;

constexpr int problems = 20;
constexpr int repetitions = 50;

struct Lcp {
  Eigen::MatrixXd M;
  Vec q, near;  ///< near: q moved by 1 %
  AffineMcp sparse;
};

/// M = A A' / n + 0.1 I with A uniform in [-1, 1], q uniform in [-1, 1].
std::vector<Lcp> random_lcps(Index n) {
  std::mt19937 engine(static_cast<unsigned>(n));
  const auto uniform = [&engine] { return 2 * static_cast<double>(engine()) / 4294967296.0 - 1; };
  std::vector<Lcp> made;
  for (int k = 0; k < problems; ++k) {
    const Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(n, n, uniform);
    Lcp lcp;
    lcp.M = A * A.transpose() / static_cast<double>(n);
    lcp.M.diagonal().array() += 0.1;
    lcp.q = Vec::NullaryExpr(n, uniform);
    lcp.near = lcp.q + 0.01 * Vec::NullaryExpr(n, uniform);
    lcp.sparse = standard_lcp(lcp.M.sparseView(), lcp.q);
    made.push_back(std::move(lcp));
  }
  return made;
}

/// Prints the mean over the solved problems of the least time of each, in microseconds, and how many are not solved.
template <class Prepare, class Solve>
void print_microseconds(const std::vector<Lcp>& lcps, Prepare prepare, Solve solve) {
  double sum = 0;
  int unsolved = 0;
  for (const Lcp& lcp : lcps) {
    double least = infinity;
    bool solved = true;
    for (int k = 0; k < repetitions; ++k) {
      prepare(lcp);
      const auto begin = Clock::now();
      solved = solve(lcp);
      least = std::min(least, std::chrono::duration<double, std::micro>(Clock::now() - begin).count());
    }
    if (solved)
      sum += least;
    else
      ++unsolved;
  }
  std::printf(" %.2f", sum / (problems - unsolved));
  if (unsolved > 0) std::printf(" (%d not solved)", unsolved);
  std::printf(" |");
  std::fflush(stdout);
}

#ifdef PERP_BULLET
void bullet(const std::vector<Lcp>& lcps) {
  const auto n = lcps.front().q.size();

  std::vector<btScalar> A(static_cast<std::size_t>(n * n));
  std::vector<btScalar> x(at(n)), b(at(n)), w(at(n)), lo(at(n)), hi(at(n));
  std::vector<int> findex(at(n), -1);
  btDantzigScratchMemory scratch;
  print_microseconds(
      lcps,
      [&](const Lcp& lcp) {  // it overwrites its arguments
        for (Index i = 0; i < n; ++i) {
          for (Index j = 0; j < n; ++j) A[at(i * n + j)] = static_cast<btScalar>(lcp.M(i, j));
          b[at(i)] = static_cast<btScalar>(-lcp.q[i]);
          x[at(i)] = w[at(i)] = lo[at(i)] = 0;
          hi[at(i)] = BT_INFINITY;
        }
      },
      [&](const Lcp&) {
        return btSolveDantzigLCP(static_cast<int>(n), A.data(), x.data(), b.data(), w.data(), 0, lo.data(), hi.data(),
                                 findex.data(), scratch);
      });
}
#else
void bullet(const std::vector<Lcp>&) { std::printf(" |"); }
#endif

}  // namespace

int main() {
  std::printf("| n | Bullet | DenseSolver: a new one | kept, from the bounds | from a neighbour |");
  for (const MethodEntry& entry : methods()) std::printf(" %s |", std::string(entry.name).c_str());
  for (const Index n : {6, 12, 24, 48, 96}) {
    const std::vector<Lcp> lcps = random_lcps(n);
    const Vec lower = Vec::Zero(n), upper = Vec::Constant(n, infinity);
    std::printf("\n| %d |", static_cast<int>(n));
    bullet(lcps);
    DenseSolver solver;
    const auto nothing = [](const Lcp&) {};
    const auto by_dense = [&](const Lcp& lcp) { return solver.solve(lcp.M, lcp.q, lower, upper).solved(); };
    print_microseconds(lcps, nothing,
                       [&](const Lcp& lcp) { return DenseSolver().solve(lcp.M, lcp.q, lower, upper).solved(); });
    print_microseconds(
        lcps, [&](const Lcp&) { solver.forget(); }, by_dense);
    print_microseconds(
        lcps, [&](const Lcp& lcp) { solver.solve(lcp.M, lcp.near, lower, upper); }, by_dense);
    for (const MethodEntry& entry : methods())
      if (n <= 12 || entry.name != "enumeration")
        print_microseconds(lcps, nothing,
                           [&](const Lcp& lcp) { return solve(lcp.sparse, lower, entry.method).solved(); });
  }
  std::printf("\n");
}

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Many affine variational inequalities over polyhedra (polyhedron.hpp) of one size, dense, in threads: games, control
/// steps, scenarios. With rows, what is the same for all is factored once a thread. Every instance is solved from
/// scratch, so that its result does not depend on the order of the instances, nor on the threads, to the last bit.
#include <span>

#include "lcp/vi/vi.hpp"

namespace perp::lcp {

/// Numbers of each instance: those of instance k begin at values + k step; step 0: the same for all.
struct Varying {
  const double* values = nullptr;
  Index step = 0;
  const double* of(Index k) const { return values + k * step; }
};

/// M n x n and A m x n by rows; b <= A x <= c; l <= x <= u.
struct ViBatch {
  Index count = 0, n = 0, m = 0;
  Varying M{}, q{}, A{}, b{}, c{}, l{}, u{};
};

/// Places for the answers of each instance, one after the other; empty: not wanted.
struct BatchAnswers {
  std::span<double> x;            ///< count n
  std::span<double> multipliers;  ///< count m, of the rows
  std::span<Status> status;       ///< count
  std::span<double> residual;     ///< count: as ViResult::residual
};

/// threads 0: as many as there are processors. Throws std::invalid_argument for malformed input of any instance, and
/// what else a thread threw.
void solve_batch(const ViBatch& batch, const BatchAnswers& answers, int threads = 0, const Limits& limits = {});

}  // namespace perp::lcp

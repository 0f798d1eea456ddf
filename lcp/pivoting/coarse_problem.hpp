// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The problem on a coarser mesh, made from the matrix alone: where a start for block pivoting comes from. Private to
/// lcp/.
#include <optional>
#include <vector>

#include "lcp/judge/cell.hpp"

namespace perp::lcp {

/// The coarse unknowns C are unknowns of the fine problem and have their bounds. With the interpolation P of algebraic
/// multigrid for the symmetric part of M (lcp/linalg/multilevel.hpp) the coarse problem has M_C = P'M P, q_C = P'q.
struct CoarseProblem {
  AffineMcp problem;
  SpMat P;                     ///< fine rows, coarse columns; its entries are not negative
  std::vector<int> fine_of{};  ///< the fine index of each coarse unknown

  /// Cells of the fine unknowns, whose bounds are `box`: those of C have their own, others the one that weighs most in
  /// their row of P. None is at an infinite bound; fixed ones are Lower.
  Cells finer(const Cells& coarse, const Box& box) const;
};

/// Coarsens. Nothing where M is not of a mesh: entries off the diagonal are not mostly negative, or the coarse problem
/// would have more than 0.7 of the unknowns or more entries.
std::optional<CoarseProblem> coarser(const AffineMcp& problem);

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The complementary cells of an affine MCP: every variable has a place, and a cell is
///     Lower: z_i = l_i     Upper: z_i = u_i     Inside: (M z + q)_i = 0.
/// With F the indices inside and N the others, the cell's point is  M_FF z_F = -(q_F + M_FN z_N). It solves the problem
/// iff l_F <= z_F <= u_F, F_i >= 0 at lower and F_i <= 0 at upper bounds (Cottle, Pang & Stone 1992, section 1.3).
/// Private to lcp/.
#include <cstdint>
#include <vector>

#include "lcp/affine_mcp.hpp"
#include "lcp/judge/result.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace perp::lcp {

using Cells = std::vector<Cell>;

/// The cells of a point: at a bound it touches or lies beyond, else inside. Fixed variables count as Below.
Cells cells_of(const Box& box, In z);
/// The same with every variable that is not fixed inside.
Cells all_inside(const Box& box);
/// A key for sets of cells: different cells have different keys, but with probability 2^-64.
std::uint64_t key_of(const Cells& cells);

/// The points of cells, with what one needs to tell a violated sign from rounding.
class CellSolver {
 public:
  /// The problem must outlive *this. Values count as zero within `tol` times the terms they are the sum of:
  ///     F_i:        tol (|q_i| + sum_j |M_ij z_j|)
  ///     z_i - l_i:  tol ((|q_i| + sum_j |M_ij z_j|) / max_j |M_ij| + |l_i|).
  CellSolver(const AffineMcp& problem, LuBackend lu, double tol);

  /// Solves for the cell's z and F = M z + q. Singular also if z is not finite.
  [[nodiscard]] LuStatus solve(const Cells& cells);

  /// A step of refinement of a point x of that cell, F = F(x): x_I -= M_II^-1 F_I. False if there is nothing to do.
  [[nodiscard]] bool correct(In F, Vec& x) const;

  const Vec& z() const { return z_; }
  const Vec& F() const { return F_; }
  int factorizations() const { return factorizations_; }
  /// Whether index i of the cell solved last violates a sign condition.
  bool violated(const Cells& cells, Index i) const;
  std::vector<Index> all_violated(const Cells& cells) const;
  /// The cell where the variable of a violated index goes: from a bound inside, from inside to the bound it is beyond.
  Cell exchanged(const Cells& cells, Index i) const;

 private:
  SpMat block(const Cells& cells);

  const AffineMcp& problem_;
  double tol_;
  SparseLu lu_;
  int factorizations_ = 0;
  Vec row_max_;  ///< max_j |M_ij|
  Vec z_;
  Vec F_;
  Vec terms_;  ///< |q_i| + sum_j |M_ij z_j|
  std::vector<Index> inside_;
  std::vector<int> position_;  ///< in inside_, or -1
};

/// The best point that a method has met.
class Best {
 public:
  explicit Best(const AffineMcp& problem, In start);
  bool offer(In z);  ///< projected on the box; kept (true) if its natural residual is smaller
  const Vec& z() const { return z_; }
  bool solves(double tol) const { return residual_ <= tol && lcp::solves(problem_, z_, tol); }

 private:
  const AffineMcp& problem_;
  Vec z_;
  double residual_;
};

}  // namespace perp::lcp

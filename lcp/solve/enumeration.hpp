// SPDX-License-Identifier: Apache-2.0
#pragma once
/// All solutions of a small affine MCP(l, u, M z + q), any box, by enumeration of its complementary cells: every
/// bounded variable is at its lower bound (w_i >= 0), at its upper bound (w_i <= 0) or inside (w_i = 0), free variables
/// always inside, fixed ones nowhere; w = M z + q. The solution set is the union over the 2^n or 3^n cells of the
/// polyhedra
///     { z in [l, u] : z_i = l_i, w_i >= 0   or   z_i = u_i, w_i <= 0   or   w_i = 0,  as the cell says }
/// (Cottle, Pang & Stone 1992, section 1.3).
///
/// Depth first, one variable a level, the one farthest from complementarity first. A partial cell whose polyhedron
/// (signs of the bounds kept for the undecided variables) is empty is cut off with all cells below it: emptiness is
/// found by pivoting on z and w with bounds, w - M z = q, from the parent's basis (Dutertre & de Moura 2006), ending by
/// Bland's rule; a row of the tableau, as multipliers y of the rows of M, is the proof, and it is checked without
/// rounding in the data themselves (lcp/judge/infeasible.hpp). A cell that cannot be proved empty so, but in which no
/// solution is found, leaves the enumeration incomplete. So is cut off a cell in which w_i = 0 throughout for a
/// variable at a bound: all of it lies in the cell with that variable inside. That is judged in doubles: if nothing has
/// been found in the end, all is done once more without these cuts.
///
/// A cell with nonsingular M_FF has one point at most. One with singular M_FF may be a continuum: it is reported by a
/// relative interior point with the polyhedron's dimension. Points and polyhedra within others are reported once.
/// References: Murty, Linear Complementarity, Linear and Nonlinear Programming, 1988, chapter 8. Dutertre & de Moura,
/// CAV 2006, LNCS 4144, 81.
#include <vector>

#include "lcp/judge/result.hpp"

namespace perp::lcp {

struct Enumeration {
  Index max_bounded = 20;            ///< problems with more variables between bounds are refused (NotApplicable)
  std::size_t max_solutions = 1000;  ///< the enumeration stops there, incomplete
};
void describe(Enumeration& method, Fields& fields);

struct Solution {
  Vec z;  ///< accepts() with the limits' tolerance
  Index dimension =
      0;  ///< of the polyhedron of solutions it is a relative interior point of; 0: an isolated point of it
};

struct Solutions {
  std::vector<Solution> found;  ///< no polyhedron within another
  bool complete = false;        ///< every cell has been decided: there are no others
  long nodes = 0;               ///< partial cells examined
  Status stopped =
      Status::Solved;     ///< why it is not complete: a limit, NotApplicable, Stalled (a cell could not be decided)
  std::string message{};  ///< the same in words
  /// The proof, cell by cell, if it is complete and empty; its tolerance is 0 where it would be too long to keep.
  Refutation refutation{};
};
/// Two polyhedra that meet are both reported. Throws std::invalid_argument for bad input and options.
Solutions enumerate(const AffineMcp& problem, const Enumeration& options = {}, const Limits& limits = {});

/// The first solution, in enumerate()'s order; Infeasible, with "all cells examined" and their number in the message,
/// if the enumeration is complete and empty. iterations: partial cells. The start is only the point of a failure.
Result enumeration(const AffineMcp& problem, In start, const Enumeration& options = {}, const Limits& limits = {});

}  // namespace perp::lcp

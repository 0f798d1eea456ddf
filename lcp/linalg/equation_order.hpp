// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The order and the signs of equations. A row whose variable is free is an equation F_i = 0. Which of the free
/// variables it stands beside says nothing, nor does its sign, and both depend on who wrote the problem. Classes,
/// proofs and interior points depend on them: the optimality conditions
///     [H  -A'] [x]   [ c]
///     [A   0 ] [y] + [-b],   y free,
/// are monotone with the rows of A in the order of y, and in no class with two of these rows exchanged.
/// equation_order() finds the order in which |M_ij| = |M_ji|, and signs with which rows without a diagonal entry are
/// skew to all others.
///
/// It refines classes of rows and columns: an equation and a free variable can only belong together if the row has the
/// entries that the column has, in columns and rows that belong together. The pairs of bounded variables are known.
/// Where several are alike, the natural pair is tried, and all of it is checked at the end. Time O(entries log n) and
/// memory O(entries), as for the colour refinement of graphs (Cardon & Crochemore, Theor. Comput. Sci. 19 (1982) 85).
#include <optional>
#include <vector>

#include "lcp/judge/refutation.hpp"

namespace perp::lcp {

/// Row i is sign[i] times row row_of[i] of the problem; bounded variables keep theirs.
struct EquationOrder {
  std::vector<Index> row_of;
  Vec sign;

  AffineMcp apply(const AffineMcp& problem) const;
  /// Multipliers of the rows, as certificates are, for the rows of the problem.
  Vec multipliers_back(In y) const;
  /// A certificate for the problem. Equations hold wherever their variables are, so that the pairs do not matter.
  Refutation back(Refutation refutation) const;
};

/// Nothing: the rows are in such an order already, or there is none, or there are equations alone, whose order is no
/// matter. Entries are compared to seven digits.
std::optional<EquationOrder> equation_order(const SpMat& M, const Box& box);

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The judge that cannot be fooled: what a method says of an affine MCP, checked in GMP's rationals for exactly the
/// doubles given. It shares no line with the solvers.
#include <gmpxx.h>

#include <optional>
#include <vector>

#include "lcp/affine_mcp.hpp"

namespace perp::lcp::exact {

/// max_i |mid(z_i - u_i, F_i, z_i - l_i)|,  F = M z + q.  Pre: z finite.
mpq_class residual(const AffineMcp& problem, const Vec& z);

/// Whether in every row |residual_i| <= 8 (n_i + 2) eps t_i,  t_i = sum_j |M_ij z_j| + |q_i|,  n_i entries of row i.
bool solved_to_rounding(const AffineMcp& problem, const Vec& z);

/// What y proves. F of a solution has the sign that a half-bounded variable demands, so with y_i of that sign
/// (y_i = 0 where both bounds are finite) 0 <= y'F = q'y + sum_j g_j z_j, g = M'y; but the terms whose bound is finite
/// are at most  q'y + sum_j max(l_j g_j, u_j g_j) = -margin, and the others at most |z|_inf sum_j |g_j| = |z|_inf
/// wrong.
struct Proof {
  bool signs = false;    ///< of y; nothing is proved otherwise
  mpq_class margin = 0;  ///< nothing is proved unless it is positive
  mpq_class wrong = 0;
  bool proves_nothing() const { return !signs || sgn(margin) <= 0; }
  bool proves_all() const { return signs && sgn(margin) > 0 && sgn(wrong) == 0; }
  /// No solution has |z|_inf below this. Pre: neither of the above.
  mpq_class radius() const { return margin / wrong; }
};
Proof proof(const AffineMcp& problem, const Vec& y);

/// The referee: every cell of a small problem by a simplex method in rationals with Bland's rule.
struct Verdict {
  bool decided = false;               ///< false: more than `most` partial cells
  std::vector<mpq_class> solution{};  ///< exact; empty if there is none (or n = 0)
  bool solvable = false;
};
Verdict decide(const AffineMcp& problem, long most = 20000);

}  // namespace perp::lcp::exact

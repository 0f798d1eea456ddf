// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Presolve and postsolve of an MCP. Presolve takes out what declared linearity (Mcp::linear_entries) settles
/// beforehand. Postsolve puts it back, exactly, once the rest is solved. Pairs (F_i, x_i) stay or go together:
///
///  * Fixed variable, l_i = u_i: F_i is free, so the pair goes.
///  * Forced bound, F_i > 0 (or < 0) throughout the box: x_i = l_i (u_i), or infeasible if that is infinite. A row
///    without variables (F_i constant) is a special case.
///  * Singleton row, F_i = a x_j + b. If i = j: x_i = mid(l_i, -b/a, u_i) where a > 0 or x_i is free. If i != j and x_i
///    is free: x_j = -b/a, and infeasible if that is outside of [l_j, u_j]. If it is strictly inside, F_j has to be 0:
///    F_j is paired with the free x_i from then on, as an equation.
///  * Singleton column, x_i occurs in F_i alone, F_i = a x_i + g(rest): x_i is computed from F_i afterwards, where that
///    has a solution whatever g is: a > 0, or two finite bounds, or none. A free x_i in one equation F_s of a free x_s
///    alone is computed from F_s, and F_i is paired with x_s.
///  * Empty column: the same with a = 0, for two finite bounds or an F_i of a known sign.
///  * Parallel rows, F_i = t F_e + d with F_e = 0 an equation: F_i = d at every solution. That is a forced bound where
///    d != 0, and infeasible between equations.
///
/// Presolve repeats these reductions until none applies. They apply to rows, too, that become affine when their other
/// variables are fixed. Bounds that equations imply ("implied bounds") help to find the signs of other rows. The box
/// itself is never changed, because F_i could then differ from 0 at a bound that is not one of the problem.
///
/// Every solution of the problem gives one of the reduced problem, unless x_i is not determined (F_i = 0 and x_i in no
/// other row, a < 0 with two bounds): then one remains of the many. Every solution of the reduced problem is one of the
/// problem by postsolve(). No tolerance decides a case: signs have to be clear of rounding, contradictions of 1e-6.
///
/// References: Ferris & Munson, Preprocessing complementarity problems, in: Complementarity (Kluwer 2001) 143. Andersen
/// & Andersen, Math. Prog. 71 (1995) 221.
#include <memory>
#include <string>
#include <vector>

#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

/// A pair of which x_col is computed afterwards: l <= x_col <= u  _|_  F_row = coefficient x_col + g(rest).
struct Postponed {
  Index row = -1;
  Index col = -1;
  double coefficient = 0;
};

/// Numbers of pairs taken out, by reason.
struct PresolveCounts {
  Index fixed = 0;              ///< fixed variables
  Index forced = 0;             ///< at a bound by the sign of F_i
  Index singleton_rows = 0;     ///< variables set by an equation of their own
  Index singleton_columns = 0;  ///< variables computed afterwards, empty columns included
  Index empty = 0;              ///< variables that change nothing: left where they start, or at a bound
  Index total() const { return fixed + forced + singleton_rows + singleton_columns + empty; }
};

class Presolved {
 public:
  /// Says why there seems to be no solution, with names and numbers; empty if there is no contradiction. It is none of
  /// exact arithmetic: what proves it carries the rounding of every step (lcp/judge/propagation.hpp). If it is not
  /// empty, the other members have no meaning.
  const std::string& infeasible() const { return infeasible_; }
  /// Returns the reduced problem, or the original if nothing could be removed. Its size may be 0. Its variable k is
  /// columns()[k] of the original, and its equation k is rows()[k]; both keep their names. It lives as long as this
  /// object, and evaluates the original.
  const Mcp& problem() const { return reduced_ ? *reduced_ : *original_; }
  /// Returns its start: x0 projected on the box, without the removed variables.
  const Vec& start() const { return start_; }
  /// Returns the point of the original problem that belongs to x. Throws std::invalid_argument if x has not as many
  /// entries as the reduced problem.
  Vec postsolve(In x) const;
  /// Returns the entries of a full point that were not removed. Throws std::invalid_argument if x has not size()
  /// entries.
  Vec reduce(In x) const;

  const std::vector<Index>& columns() const { return columns_; }
  const std::vector<Index>& rows() const { return rows_; }
  const PresolveCounts& counts() const { return counts_; }
  /// Returns sentences about equations that say the same but could not be removed.
  const std::vector<std::string>& notes() const { return notes_; }
  int F_evals() const { return F_evals_; }  ///< made by presolve()
  int J_evals() const { return J_evals_; }

 private:
  friend Presolved presolve(const Mcp& mcp, In x0);
  Presolved() = default;

  const Mcp* original_ = nullptr;
  std::unique_ptr<Mcp> reduced_;
  std::string infeasible_;
  std::vector<std::string> notes_;
  PresolveCounts counts_;
  std::vector<Index> columns_, rows_;
  Vec start_;
  Vec base_;  // full; the values of what went
  std::vector<Postponed> postponed_;
  SpMat J_;  // at the start: for the constant entries of postponed columns
  int F_evals_ = 0, J_evals_ = 0;
};

/// Presolves the problem. Pre: check_input(mcp, x0) passes. The problem outlives the answer. Evaluates J at most once
/// and F a few times. If the problem declares no linearity, it evaluates neither and only removes fixed variables.
/// Throws std::invalid_argument if the number of flags is not that of the nonzeros, if J leaves its pattern, or if F
/// contradicts the declared linearity.
Presolved presolve(const Mcp& mcp, In x0);
Presolved presolve(Mcp&&, In) = delete;

}  // namespace perp::ncp

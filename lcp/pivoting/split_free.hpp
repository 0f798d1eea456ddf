// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Lemke's method where free variables have a rank-deficient block M_FF; private to lcp/pivoting.
///
/// From a ray, free variables are basic, which takes a regular M_FF. Multipliers of equations in linear programs have
/// M_FF = 0. Artificial variables in the places of dependent columns keep the path going, but what Lemke's method
/// promises of copositive-plus matrices is then lost. So the dependent ones are split instead:
///
///     z_i = z+_i - z-_i,   0 <= z+_i perp F_i >= 0,   0 <= z-_i perp -F_i >= 0.
///
/// The matrix stays copositive-plus or positive semidefinite, the covering vector covers both rows of a pair, and a
/// ray again means that there is no solution (Cottle, Pang & Stone 1992, theorem 4.4.13). Not where the factors of the
/// last piece are asked for (LemkeOptions::keep_basis): those are of another problem.
#include <vector>

#include "lcp/pivoting/lemke.hpp"

namespace perp::lcp {

class SplitFree {
 public:
  /// `dependent`, in ascending order: the variables whose columns of the start basis depend on others. If there are
  /// bounded ones among them, whose unit columns others displaced, all free variables are split.
  SplitFree(const AffineMcp& problem, std::vector<Index> dependent, const LemkeOptions& options);

  const AffineMcp& problem() const { return split_problem_; }
  Vec there(In x) const;
  LemkeOptions there(const LemkeOptions& options) const;
  PivotResult back(PivotResult result) const;

 private:
  Vec back(const Vec& x) const;

  const AffineMcp& problem_;
  std::vector<Index> split_;
  double tolerance_;
  AffineMcp split_problem_;  // z-_k has number n + k
};

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The affine mixed complementarity problem MCP(l, u, M z + q): find z in [l, u] such that for every i
///     l_i < z_i < u_i  =>  (M z + q)_i  = 0
///     z_i = l_i        =>  (M z + q)_i >= 0        (free if l_i = u_i)
///     z_i = u_i        =>  (M z + q)_i <= 0.
/// The box R^n_+ makes it the LCP(q, M); infinite bounds give the equations of an MLCP. M is n x n, sparse.
#include <optional>
#include <string>

#include "lcp/box.hpp"

namespace perp::lcp {

struct AffineMcp {
  SpMat M;
  Vec q;
  Box box;

  Index size() const { return q.size(); }
  /// Says why the parts are not a problem (shapes, bounds, a value of M or q that is not finite). Empty if they are.
  std::optional<std::string> invalid() const;
};

/// Makes LCP(q, M): 0 <= z _|_ M z + q >= 0.
AffineMcp standard_lcp(SpMat M, Vec q);

/// Computes || z - mid(l, z - (M z + q), u) ||_inf, which is zero exactly at the solutions, and +inf where M z + q is
/// not finite. It computes M z + q by plain sums. The function that decides is judge() (lcp/judge/judge.hpp).
double natural_residual(const AffineMcp& problem, In z);

}  // namespace perp::lcp

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
  /// Why the parts do not make a problem (shapes, bounds, a value of M or q that is not finite), if they do not.
  std::optional<std::string> invalid() const;
};

/// LCP(q, M):  0 <= z  _|_  M z + q >= 0.
AffineMcp standard_lcp(SpMat M, Vec q);

/// || z - mid(l, z - (M z + q), u) ||_inf: zero exactly at the solutions; +inf where M z + q is not finite. M z + q in
/// plain sums: what decides is judge() (lcp/judge/judge.hpp).
double natural_residual(const AffineMcp& problem, In z);

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A polyhedron  C = {x in R^n : b <= A x <= c, l <= x <= u},  bounds may be infinite, b_i = c_i is an equation; and
/// the affine variational inequality over it: find x in C with
///     (M x + q)'(y - x) >= 0   for all y in C.
/// With multipliers lambda of the rows and nu of the bounds this is  M x + q = A'lambda + nu,  where lambda_i >= 0 if
/// a_i x = b_i, <= 0 if a_i x = c_i, 0 between; nu_j likewise. Reference: Facchinei & Pang, Finite-Dimensional
/// Variational Inequalities and Complementarity Problems, Springer 2003, proposition 1.2.1.
#include <optional>
#include <string>
#include <vector>

#include "lcp/affine_mcp.hpp"

namespace perp::lcp {

struct Polyhedron {
  SpMat A;   ///< m x n
  Box rows;  ///< b, c
  Box box;   ///< l, u

  Index size() const { return box.size(); }
  /// Says why the parts are no polyhedron. Empty if they are.
  std::optional<std::string> invalid() const;
};

/// The rows and bounds that hold as equations: Below at b or l, Above at c or u, Fixed where both are the same.
struct Face {
  std::vector<Cell> rows;
  std::vector<Cell> bounds;
};

struct AffineVi {
  SpMat M;
  Vec q;
  Polyhedron C;

  Index size() const { return q.size(); }
};

/// The MCP in z = (x, lambda, s), one s in [b_i, c_i] for each row with two different finite bounds,
///     F_x = M x + q - A'lambda,   F_lambda = A x - (b, c, or s),   F_s = lambda,
/// whose solutions are those of the variational inequality with their multipliers. It is monotone if M is.
AffineMcp lifted(const AffineVi& vi);
/// The face that a point (x, lambda, ...) of the lifted MCP is on, as its multipliers beside rounding say.
Face face_of(const Polyhedron& C, In z);

}  // namespace perp::lcp

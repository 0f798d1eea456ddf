// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Which row gives which variable's F: the AMPL/PATH convention (see README.md). Every unknown u of the MCP gets
///     F_u(x, y) = sign_u (v_u(x) - bound_u) - [u is a side inequality] y_u,
/// where v_u is a row c_i(x) of the model or one of its variables.
///
/// Pyomo writes a condition on an expression with an auxiliary variable v of its own:
///     row i: c v + constant  complements x,    row e: a v + g(x) = b,    v free and in no other row.
/// v is no unknown then: F_x = -(c / a) (g(x) - b) + constant. It is computed afterwards. Pre: |c| = |a|, so that
/// nothing is rounded. Where both sides are expressions, 0 <= x - 1 _|_ F >= 0, Pyomo takes F for the variable:
///     row i: v complements w >= 0,    row e: v - x = -1,    row f: w - F(x) = 0,    x free, w in no other row.
/// Then w is no unknown either, and x >= 1 complements F. Pre: the bound of x is not rounded.
#include <vector>

#include "ncp/ampl/names.hpp"
#include "ncp/ampl/nl_check.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp::ampl {

struct Equation {
  bool of_row = true;  ///< v = c_index(x); false: v = x_index
  int index = 0;
  double sign = 1;
  double bound = 0;
  bool side = false;
  int condition = -1;  ///< row i of a condition whose auxiliary variable is gone; `index` is row e then
};

/// v = (bound - row(x)) / coefficient, the row at v = 0.
struct Auxiliary {
  int variable = 0, row = 0;
  double coefficient = 1, bound = 0;
};

struct Pairing {
  Box box;                          ///< variables but the auxiliary ones, and side inequalities
  std::vector<Equation> equations;  ///< one an unknown
  std::vector<int> variables;       ///< of the model, by unknowns; the side inequalities follow them
  std::vector<int> unknowns;        ///< of the model's variables; -1: auxiliary
  std::vector<Auxiliary> auxiliaries;
  std::vector<char> used;  ///< n_con: 0 for free rows, which impose nothing
};

/// Throws ModelError: integer variables (bad_file), empty ranges (inconsistent_bounds), a complementarity row whose
/// kind contradicts its variable's bounds, or two of one variable (bad_file), a model that is not square (nonsquare).
Pairing pair(const NlModel& model, const Names& names);

/// "no row complements x3, which has bounds: they are side inequalities", where most variables with bounds have a row:
/// a slip of the modeller's more often than not. Else empty.
std::string without_row(const NlModel& model, const Names& names);

/// The Jacobian of F in terms of the nonzeros of the model's own Jacobian, which come by columns, rows ascending.
struct JacobianMap {
  SpMat pattern;
  /// A value of J is factor * (own nonzero), or factor alone where the entry is constant (nonzero < 0).
  struct Entry {
    int nonzero = -1;
    double factor = 1;
  };
  std::vector<Entry> entries;  ///< in the pattern's order
};
JacobianMap map_jacobian(const NlModel& model, const Pairing& pairing);

/// Names of an unknown and of its F.
std::string unknown_name(const Pairing& pairing, const Names& names, Index u);
std::string equation_name(const Pairing& pairing, const Names& names, Index u);

}  // namespace perp::ncp::ampl

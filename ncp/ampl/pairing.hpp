// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Which row gives which variable's F: the AMPL/PATH convention (see README.md). Every unknown u of the MCP gets
///     F_u(x, y) = sign_u (v_u(x) - bound_u) - [u is a side inequality] y_u,
/// where v_u is a row c_i(x) of the model or one of its variables. Rows a_i x of a polyhedron, by their suffix, give
/// each side of theirs a multiplier u, complemented by its v_u - bound_u or the negative, and add -A'u to F.
/// conditions.hpp has conditions that are spelt with variables and rows of their own.
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
  bool multiplier = false;  ///< of a row of the polyhedron
  int condition = -1;       ///< row i of a condition whose auxiliary variable is gone; `index` is row e then
};

/// v = (bound - row(x)) / coefficient, the row at v = 0.
struct Auxiliary {
  int variable = 0, row = 0;
  double coefficient = 1, bound = 0;
};

struct Pairing {
  Box box;                          ///< variables but the auxiliary ones, side inequalities, and multipliers
  std::vector<Equation> equations;  ///< one an unknown
  std::vector<int> variables;       ///< of the model, by unknowns; side inequalities and multipliers follow them
  std::vector<int> unknowns;        ///< of the model's variables; -1: auxiliary
  std::vector<Auxiliary> auxiliaries;
  std::vector<char> used;  ///< n_con: 0 for free rows, which impose nothing
  Index multipliers = 0;   ///< the last unknowns
  SpMat forces{};          ///< n x n, -A' in their columns: F has forces * (x, y, u) added
};

/// Throws ModelError: integer variables, rows of a polyhedron that are not linear (bad_file), empty ranges
/// (inconsistent_bounds), a complementarity row whose kind contradicts its variable's bounds, or two of one variable
/// (bad_file), a model that is not square (nonsquare).
Pairing pair(const NlModel& model, const Names& names);

/// "no row complements x3, which has bounds: they are side inequalities", where most variables with bounds have a row:
/// a slip of the modeller's more often than not. Else empty.
std::string without_row(const NlModel& model, const Names& names);

/// "q is in two conditions, supply and market", where a variable that equals q but for a constant, and that has no
/// other row, is in one of them: q is complemented twice, and another variable never. Else empty.
std::string twice(const NlModel& model, const Pairing& pairing, const Names& names);

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

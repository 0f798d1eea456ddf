// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The demands of an affine MCP on z, whatever complements what: the rows F_i >= 0 (only l_i is finite), F_i <= 0 (only
/// u_i is), F_i = 0 (neither is), F = M z + q, and the bounds of z; and the least change with which they do not
/// contradict each other. Private to ncp/.
///
/// The least change in the sum, min sum_k s_k, where demand k, scaled to coefficients of at most 1, is missed by s_k,
/// is a complementarity problem that always has a solution, as it is a linear program with a skew matrix:
///     z_j free  _|_  -(A'y)_j = 0          y_k in [0, 1], [-1, 0] or [-1, 1]  _|_  (A z + c)_k
/// for demands A z + c >= 0, <= 0 or = 0. If the sum is positive, y are Farkas' multipliers of a contradiction: one
/// solution is a repair and a proof. References: Chinneck, Feasibility and Infeasibility in Optimization (2008),
/// chapters 2 and 6; Gleeson & Ryan, ORSA J. Comput. 2 (1990) 61.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lcp/deadline.hpp"
#include "lcp/judge/refutation.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

struct Demand {
  enum Of { Row, Lower, Upper } of = Row;
  Index index = -1;  ///< of the row, or of the variable with the bound
  bool operator==(const Demand&) const = default;
};
using Demands = std::vector<Demand>;
/// "row", "lower bound", "upper bound".
std::string_view to_string(Demand::Of of);
/// The name of the row, or of the variable.
std::string name_of(const Mcp& mcp, const Demand& demand);

class LinearDemands {
 public:
  /// `rows`: those that are known, 1; empty: all. The problem outlives this object.
  LinearDemands(const lcp::AffineMcp& problem, const std::vector<char>& rows);

  /// All rows with a sign, and all finite bounds.
  Demands all() const;
  /// The rows, and the bounds of the variables in them.
  Demands of_rows(const std::vector<Index>& rows) const;

  struct Elastic {
    Vec z;                       ///< of all variables; those in no demand are 0, moved into the box
    std::vector<double> y;       ///< multipliers of the demands as they are, not scaled
    std::vector<double> share;   ///< multipliers of the scaled ones, up to about 1
    std::vector<double> missed;  ///< how much has to be added to the left-hand side of each, with its sign
    double total = 0;            ///< of the scaled ones
  };
  /// Nothing: the methods found no solution in the time.
  std::optional<Elastic> elastic(const Demands& demands, lcp::Deadline deadline) const;
  /// Finds the same among all z in `hard`.
  std::optional<Elastic> elastic(const Demands& demands, const Box& hard, lcp::Deadline deadline) const;
  /// Finds the same with the bounds that are 0, signs of variables, left as they are.
  std::optional<Elastic> repaired(const Demands& demands, lcp::Deadline deadline) const;

  /// Returns whether multipliers of demands that contradict each other are the only ones but for their length: no
  /// demand can go then. The rows have rank one less than their number in the columns without a bound among the demands
  /// (Gleeson & Ryan). False, too, of more than 1000 rows.
  bool has_one_proof(const Demands& demands) const;
  /// The demands with multipliers.
  static Demands support(const Demands& demands, const Elastic& found);
  /// Returns whether y proves exactly that these demands alone contradict each other.
  bool proves(const Demands& demands, In y) const;
  const lcp::AffineMcp& problem() const { return problem_; }

 private:
  bool known(Index row) const { return rows_.empty() || rows_[at(row)] != 0; }

  const lcp::AffineMcp& problem_;
  const std::vector<char>& rows_;
  SpMat by_row_;  // M'
};

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the ranges of J over the box prove of all its values. Private to ncp/analysis.
#include <string>
#include <vector>

#include "ncp/analysis/function_classes.hpp"
#include "ncp/interval/enclosure.hpp"

namespace perp::ncp {

/// Rows and columns of variables that are not fixed, by rows.
struct JacobianRange {
  struct Entry {
    Index col;  ///< in the numbering of `variables`
    Interval value;
  };
  std::vector<std::vector<Entry>> rows;
  std::vector<Index> variables;  ///< the problem's
  /// Says which row is not known to be smooth, or, of a fixed variable, to be defined; empty: all are.
  std::string unknown{};
  Index size() const { return static_cast<Index>(rows.size()); }
};
JacobianRange jacobian_range(const Mcp& mcp, const Enclosure& enclosure);

/// S = J + J' over the box is B + D + E: B one symmetric matrix with the lower ends of the diagonal, less the sums of
/// the radii of what lies beside it, and D, E positive semidefinite. B decides.
struct Definiteness {
  double modulus = 0;          ///< > 0: z'Jz >= modulus ||z||^2 for every J
  std::string semidefinite{};  ///< why every S is positive semidefinite; empty: not known
  std::string why_not{};
};
Definiteness definiteness(const JacobianRange& range, Index dense_to);

/// Why F is a uniform P-function, by one of
///     every J is an H-matrix with positive diagonal: C v > 0 for one v > 0, C_ii = min J_ii, C_ij = -max |J_ij|;
///     every J is a P-matrix, by Schur complements in interval arithmetic (Tsatsomeros & Li, BIT 40 (2000) 796), and
///     the ranges are bounded, so that what is positive is so by a margin.
/// Empty: not known.
std::string uniform_p(const JacobianRange& range, const FunctionClassOptions& options);

/// J_ii >= sum over j != i of |J_ij|, in all rows and for every J.
bool dominant(const JacobianRange& range);

}  // namespace perp::ncp

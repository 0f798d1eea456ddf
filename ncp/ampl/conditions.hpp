// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Conditions that writers spell with variables and rows of their own.
///
/// Pyomo writes a condition on an expression with an auxiliary variable v:
///     row i: c v + constant  complements x,    row e: a v + g(x) = b,    v free and in no other row.
/// v is no unknown then: F_x = -(c / a) (g(x) - b) + constant. It is computed afterwards. Pre: |c| = |a|, so that
/// nothing is rounded. Where both sides are expressions, 0 <= x - 1 _|_ F >= 0, Pyomo takes F for the variable:
///     row i: v complements w >= 0,    row e: v - x = -1,    row f: w - F(x) = 0,    x free, w in no other row.
/// Then w is no unknown either, and x >= 1 complements F. Pre: the bound of x is not rounded.
#include <vector>

#include "ncp/ampl/pairing.hpp"

namespace perp::ncp::ampl {

/// A condition  0 <= v _|_ u >= 0  whose u is an affine function of one free variable x, and whose v stands for F: the
/// bound u >= 0 is one of x, and x complements F.
struct Turned {
  int variable = 0;   ///< x
  bool above = true;  ///< x >= bound; else x <= bound
  double bound = 0;
  int equation = 0;  ///< of v
  double sign = 1;   ///< F = sign (row(x) - its bound), at v = 0
};

struct Conditions {
  std::vector<int> complement{};  ///< of each row: the variable that its condition is of; -1: it is no condition
  std::vector<Equation> own{};    ///< of each variable: its row, where it is one of the conditions spelt so
  std::vector<char> gone_row{};   ///< rows that are part of such a condition
  std::vector<char> gone{};       ///< variables of theirs
  std::vector<int> used{};        ///< rows of theirs that are evaluated
  std::vector<Auxiliary> auxiliaries{};
  std::vector<Turned> turns{};
};
Conditions conditions(const NlModel& model);

/// Not those of a polyhedron.
bool is_equation(const NlRange& row);
inline bool is_free(const NlRange& range) { return range.lower == -infinity && range.upper == infinity; }

}  // namespace perp::ncp::ampl

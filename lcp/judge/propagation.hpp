// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Bounds on the points with a natural residual of at most t, carried from row to row of an affine MCP: what presolve
/// concludes, with the tolerance and the rounding of every step. The proofs are those of lcp/judge/refutation.hpp.
///
/// Each row i and X bound F_i. If F_i > t on all of X, z_i is at its lower bound; if F_i < -t, at its upper one. If (1)
/// of refutation.hpp says F_i <= t or F_i >= -t, the row and the bounds of its other variables bound each variable in
/// it. Rows whose coefficients in the variables without narrow bounds are multiples of each other are compared, too. A
/// row is looked at again when X has become narrower there. References: Andersen & Andersen, Math. Prog. 71 (1995) 221;
/// Achterberg et al., INFORMS J. Comput. 32 (2020) 473, section 3.
#include <vector>

#include "lcp/judge/refutation.hpp"

namespace perp::lcp {

class Propagation {
 public:
  /// `rows`: those that are known, 1; empty: all. All outlive this object.
  Propagation(const AffineMcp& problem, const std::vector<char>& rows, double tolerance);

  /// Returns whether nothing is left of X.
  bool run();
  /// Returns the certificate: the steps that led to the contradiction. Pre: run() has returned true.
  Refutation refutation() const;
  /// Returns the certificate that ends with y, or a vector near it that X refutes; without multipliers if there is
  /// none.
  Refutation refutation(In y) const;
  const Box& X() const { return X_; }

 private:
  /// An assumption and the multipliers that refute it.
  struct Step {
    Index variable;
    bool above, off;
    double value;
    std::vector<Multiplier> y;
  };
  /// A row, or two rows of which one is an equation, as one sum: its range over X.
  struct Range {
    double low = 0, high = 0;  // the finite terms
    int low_infinite = 0, high_infinite = 0;
    double size = 0;  // of the terms
    double lower(double error) const;
    double upper(double error) const;
  };
  struct Term {
    Index column;
    double a;
  };

  bool at_most(Index i) const;   // F_i <= t
  bool at_least(Index i) const;  // F_i >= -t
  bool known(Index i) const { return rows_.empty() || rows_[at(i)] != 0; }
  Range range(const std::vector<Term>& terms, double constant) const;
  void look(Index row);
  void signs(Index row, const std::vector<Term>& terms, const Range& r, double slack, const std::vector<Multiplier>& y);
  void bounds(const std::vector<Term>& terms, const Range& r, double slack, bool at_most, bool at_least,
              const std::vector<Multiplier>& y);
  void narrow(Index variable, bool above, bool off, double value, std::vector<Multiplier> y);
  void end(std::vector<Multiplier> y);
  void push(Index row);
  bool wide(Index j) const;  // not nearly settled by other rows
  bool parallel();
  void compare(Index equation, Index row);
  Refutation pruned(std::vector<Multiplier> y) const;

  const AffineMcp& problem_;
  const std::vector<char>& rows_;
  double t_;
  SpMat by_row_;  // M'
  Box X_;
  std::vector<Step> steps_;
  std::vector<Multiplier> last_;  // of the contradiction
  bool contradiction_ = false;
  std::vector<Index> queue_;
  std::vector<char> queued_;
  std::vector<int> looks_;
};

}  // namespace perp::lcp

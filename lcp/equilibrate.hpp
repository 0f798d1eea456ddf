// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Diagonal scaling of an affine MCP, private to lcp/:  M' = E M D,  q' = E q,  box' = D^-1 box,  z = D z',
/// with positive diagonals E (rows) and D (columns). Since F' = E F, solutions correspond one to one.
///
/// The normal map's points correspond by  x' = D^-1 z + E (x - z),  z = pi(x):  then G'(x') = E G(x), cell by cell, so
/// the path G(x) = (1 - t) r of one problem is that of the other. All factors are powers of two: nothing is rounded.
#include "lcp/affine_mcp.hpp"

namespace perp::lcp {

struct Scaling {
  Vec rows;     ///< E
  Vec columns;  ///< D

  AffineMcp apply(const AffineMcp& problem) const;
  /// Whether no number of apply(problem) was rounded: none overflows, or falls below the least normal double.
  bool loses_nothing(const AffineMcp& problem) const;
  Vec to_scaled(const Box& box, In x) const;                ///< x -> x'; box of the problem as given
  Vec to_original(const Box& scaled_box, In x) const;       ///< x' -> x; box' of the scaled problem
  void make_original(const Box& scaled_box, Vec& x) const;  ///< to_original(), in the place of x'
};

/// The largest entries of every row and column of E M D are near one (Ruiz 2001), and so is the largest of |E q|. All
/// ones if a finite bound would overflow.
Scaling equilibrate(const AffineMcp& problem);

struct Equilibrated {
  Scaling scaling;
  AffineMcp problem;  ///< scaling.apply() to the one given
};
Equilibrated equilibrated(const AffineMcp& problem);

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The box  B = {x in R^n : lower <= x <= upper}  of a mixed complementarity problem.
/// Entries may be -inf / +inf; lower_i = upper_i fixes x_i.
#include <optional>
#include <string>

#include "lcp/types.hpp"

namespace perp::lcp {

struct Box {
  Vec lower;
  Vec upper;

  static Box free(Index n);         ///< R^n
  static Box nonnegative(Index n);  ///< R^n_+
  Index size() const { return lower.size(); }
  bool has_lower(Index i) const { return lower[i] > -infinity; }  ///< a finite one
  bool has_upper(Index i) const { return upper[i] < infinity; }
  bool is_fixed(Index i) const { return lower[i] == upper[i]; }
  bool is_free(Index i) const { return !has_lower(i) && !has_upper(i); }

  /// Returns the first index with an invalid interval: lower > upper, NaN, lower = +inf or upper = -inf. Empty if all
  /// intervals are valid. Pre: both vectors have the same length.
  std::optional<Index> first_invalid() const;
  /// Says why this is not a box: the lengths differ, or the first invalid interval with its values. Empty if it is a
  /// box.
  std::optional<std::string> invalid() const;
};

/// Projects onto the box: mid(lower, z, upper) in each component.
Vec project(const Box& box, In z);
double project(const Box& box, Index i, double z);

/// The place of a variable: at or below its lower bound, between the bounds, at or above the upper one; or it is fixed.
/// In the normal map the column of x_i is M_{.i} if Inside, e_i otherwise.
enum class Cell : signed char { Below, Inside, Above, Fixed };
/// Returns the cell of z_i in the box. A distance of at most `tol` counts as "at the bound".
Cell cell_of(const Box& box, Index i, double z, double tol = 0);

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Certificates that no point has a natural residual of at most t, for affine MCPs, that anybody can check.
///
/// Let r(z) = ||z - mid(l, z - F, u)||_inf, F = M z + q, and let z be a point with r(z) <= t. Then for every i
///     l_i - t <= z_i <= u_i + t,     z_i > l_i + t  =>  F_i <= t,     z_i < u_i - t  =>  F_i >= -t.          (1)
/// A certificate begins with X = [l - t, u + t] and narrows it. An assumption says on which side of a value a variable
/// is; within the assumption X is narrower. Each assumption is refuted by a proof of its own, so that its contrary
/// holds in what follows. A proof ends with multipliers y of the rows that contradict each other:
///     sup over X of y'(M z + q)  +  t sum_i |y_i|  <  0,
/// where (1) and X have to give F_i >= -t if y_i > 0, and F_i <= t if y_i < 0 (Farkas' lemma; Mangasarian 1969, section
/// 2.4). Variables that X does not bound must have (M'y)_j = 0; or the certificate excludes only the points with
/// |z_j| <= radius for these j, and says so. All sums are exact (lcp/judge/product_sum.hpp).
///
/// One assumption with y = +-e_i says that a row has a sign; a chain of them is presolve; assumptions within
/// assumptions are an enumeration of complementary cells.
#include <limits>
#include <vector>

#include "lcp/affine_mcp.hpp"

namespace perp::lcp {

/// y_row = high + low: twice the digits of a double.
struct Multiplier {
  Index row = -1;
  double high = 0, low = 0;
};

struct Refutation {
  struct Assumption;
  struct Proof {
    std::vector<Assumption> assumptions{};  ///< each with its refutation; the next ones know its contrary
    std::vector<Multiplier> y{};            ///< by increasing rows
  };
  struct Assumption {
    Index variable = -1;
    bool above = true;  ///< z_variable >= value is assumed, and z_variable <= value follows; false: the other way round
    /// NaN: that the variable is off its bound, z_variable > l + t (or < u - t) is assumed.
    double value = std::numeric_limits<double>::quiet_NaN();
    Proof refuted{};
  };

  double tolerance = 0;      ///< t: no point has a natural residual of at most this
  double radius = infinity;  ///< of the points excluded: |z_j| for variables without a bound that the proof has used
  Proof proof{};
};

/// Returns whether the certificate proves what it says. Only the rows in it are read. O(nonzeros of its rows), for each
/// proof in it.
bool holds(const AffineMcp& problem, const Refutation& refutation);

/// Returns the certificate that y alone gives, with the largest tolerance it can have; its tolerance is 0 if y proves
/// nothing, or only something about points within a radius below 1e20.
Refutation refutation_by(const AffineMcp& problem, In y);

/// Returns a certificate with a tolerance of at least `tol`, from `y` (may be empty) or by propagation of bounds
/// (lcp/judge/propagation.hpp); one with a smaller tolerance if there is only that, 0 if there is none. `rows`: those
/// that are known; empty: all.
Refutation refute(const AffineMcp& problem, In y, double tol, const std::vector<char>& rows = {});

/// Sets the tolerance of a certificate whose assumptions have no values to nearly the largest one with which it holds,
/// at most `most`; 0: with none.
void raise_tolerance(const AffineMcp& problem, Refutation& refutation, double most);

/// The rows with a multiplier anywhere in the certificate, increasing.
std::vector<Index> rows_of(const Refutation& refutation);

}  // namespace perp::lcp

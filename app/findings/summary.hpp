// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A comparison in one line a method, and when a difference between two methods deserves to be called one.
#include "app/findings/comparisons.hpp"

namespace perp::app::comparison {

struct SummaryRow {
  std::size_t method = 0;
  std::size_t solved = 0;      ///< of the comparison's pairs
  std::size_t after = 0;       ///< with restarts
  std::size_t quickest = 0;    ///< at most as long as any other, ties included
  std::size_t within_two = 0;  ///< at most twice as long as the quickest
  std::size_t fewest_F = 0;    ///< at most as many evaluations of F as any other
  /// Geometric means over the common pairs, each cost at least 1 (1 ms); NaN if there is none, if one is not known, and
  /// for methods that solve less than three quarters of what the best solves: they would leave too few common pairs.
  double iterations = 0, F_evals = 0, factorizations = 0, seconds = 0;
};

struct Summary {
  std::vector<SummaryRow> rows{};  ///< in the comparison's order
  std::size_t pairs = 0;
  std::size_t common = 0;  ///< solved by all but those that solve less than three quarters of what the best solves

  std::size_t compared() const;  ///< methods with a mean
  /// The rows with the least and the greatest of these means. One row at least has to have one.
  std::pair<const SummaryRow*, const SummaryRow*> extremes(double SummaryRow::*mean) const;
};
Summary summary(const CampaignData& data, const Comparison& comparison);

/// What rounding alone does to the difference of two methods, as a share of the pairs: the same methods on the same
/// pairs with another BLAS or processor. Of 403 pairs smooth then solves 384 to 390, proxi 384 to 386, semismooth
/// 351 to 353, others vary by at most 1 (bench/results/collection.md has the table): 6 and 2 together, 2 %.
inline constexpr double rounding_share = 0.02;

/// Pairs on which two methods differ.
struct Duel {
  std::size_t only_a = 0;
  std::size_t only_b = 0;
  std::size_t pairs = 0;  ///< all that were compared
  /// Exact two-sided sign test of equal chances (McNemar): 2 P(X <= min(only_a, only_b)), X ~ B(only_a + only_b, 1/2),
  /// at most 1. Pairs of one problem are not independent: small values are an indication, not a proof.
  double p_value() const;
  /// Do they differ by more than rounding may?
  bool beyond_rounding() const;
  bool clear() const { return beyond_rounding() && p_value() < 0.05; }
};
Duel duel(const CampaignData& data, const std::vector<std::size_t>& pairs, std::size_t a, std::size_t b);

}  // namespace perp::app::comparison

#pragma once
/// What a campaign shows, in plain words, by rules:
///   * who solves most: ties are named as ties, and a lead counts as one only if the pairs on which two methods differ
///     say so (Duel: exact sign test at 5 %, and more than rounding_share of the pairs); otherwise it is "not a clear
///     difference";
///   * classes with fewer than few_pairs pairs are not judged;
///   * nothing is said of methods that were not run, and of pairs that not all have finished.
#include <string>
#include <vector>

#include "app/findings/comparisons.hpp"

namespace perp::app::comparison {

inline constexpr std::size_t few_pairs = 5;

struct Finding {
  std::string topic{};  ///< "Most solved"
  std::string text{};   ///< sentences, plain text
};

/// In the order of their weight; never empty.
std::vector<Finding> findings(const CampaignData& data, const std::vector<Comparison>& comparisons);

}  // namespace perp::app::comparison

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What a campaign shows, in plain words, by rules:
///   * who solves most: ties are named as ties, and a lead counts as one only if the pairs on which two methods differ
///     say so (Duel: exact sign test at 5 %, and more than rounding_share of the pairs); otherwise it is "not a clear
///     difference";
///   * classes with fewer than few_pairs pairs are not judged;
///   * nothing is said of methods that were not run, and of pairs that not all have finished.
#include <cstddef>
#include <string>
#include <string_view>
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

// Small words of sentences made from counts.

/// "a", "a and b", "a, b and c", "a, b, c and 4 others".
std::string listed(const std::vector<std::string>& names);
/// "1 pair", "3 pairs"; `several` for those whose plural is not with an s.
std::string counted(std::size_t count, std::string_view one, std::string_view several = {});
/// "x solves", "x and y solve".
std::string verb(std::size_t subjects, std::string_view infinitive);
std::string is(std::size_t subjects);
/// "24 of 25 (96 %)": one digit more, and never 100 % or 0 % unless it is that.
std::string share_words(std::size_t count, std::size_t of);
std::string percent(std::size_t count, std::size_t of);

}  // namespace perp::app::comparison

// SPDX-License-Identifier: Apache-2.0
#include "ncp/settings/input_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "ncp/problem/words.hpp"

namespace perp::settings {

std::string did_you_mean(std::string_view word, std::span<const std::string_view> candidates) {
  const std::size_t near = std::max<std::size_t>(1, word.size() / 3);
  std::vector<std::pair<std::size_t, std::string_view>> close;
  for (const std::string_view candidate : candidates) {
    // The distance is the difference of the lengths at least; a word may be megabytes long.
    if (word.size() > candidate.size() + near) continue;
    const bool part = word.size() >= 3 && candidate.find(word) != std::string_view::npos;
    if (!part && candidate.size() > word.size() + near) continue;
    const std::size_t distance = ncp::edit_distance(word, candidate);
    if (distance <= near || part) close.emplace_back(distance, candidate);
  }
  if (close.empty()) return "";
  std::ranges::stable_sort(close, {}, [](const auto& entry) { return entry.first; });
  close.resize(std::min<std::size_t>(close.size(), 3));
  std::string text = " Did you mean ";
  for (std::size_t k = 0; k < close.size(); ++k)
    text += fmt::format("{}'{}'", k == 0 ? "" : (k + 1 == close.size() ? " or " : ", "), close[k].second);
  return text + "?";
}

}  // namespace perp::settings

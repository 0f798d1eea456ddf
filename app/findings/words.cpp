// SPDX-License-Identifier: Apache-2.0
#include "app/findings/findings.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace perp::app::comparison {

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t most = 5;
  if (names.empty()) return "none";
  if (names.size() == 1) return names[0];
  const std::size_t shown = names.size() > most ? most - 2 : names.size() - 1;
  const std::string head = fmt::format("{}", fmt::join(names.begin(), names.begin() + static_cast<long>(shown), ", "));
  return names.size() > most ? fmt::format("{} and {} others", head, names.size() - shown)
                             : fmt::format("{} and {}", head, names.back());
}

std::string counted(std::size_t count, std::string_view one, std::string_view several) {
  if (count == 1) return fmt::format("1 {}", one);
  return several.empty() ? fmt::format("{} {}s", count, one) : fmt::format("{} {}", count, several);
}

std::string verb(std::size_t subjects, std::string_view infinitive) {
  return subjects == 1 ? fmt::format("{}s", infinitive) : std::string(infinitive);
}

std::string is(std::size_t subjects) { return subjects == 1 ? "is" : "are"; }

std::string percent(std::size_t count, std::size_t of) {
  if (of == 0) return "-";
  double share = 100 * static_cast<double>(count) / static_cast<double>(of);
  if (count > 0) share = std::max(share, 0.1);
  if (count < of) share = std::min(share, 99.9);
  return count == 0 || count == of ? fmt::format("{:.0f} %", share) : fmt::format("{:.1f} %", share);
}

std::string share_words(std::size_t count, std::size_t of) {
  return fmt::format("{} of {} ({})", count, of, percent(count, of));
}

}  // namespace perp::app::comparison

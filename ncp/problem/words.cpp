// SPDX-License-Identifier: Apache-2.0
#include "ncp/problem/words.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <sstream>
#include <utility>
#include <vector>

namespace perp::ncp {

std::string number(double value) {
  std::array<char, 32> text{};  // as "%.4g", whatever the locale
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 4).ptr;
  return {text.data(), end};
}

std::string number_below(double value) {
  const std::string nearest = number(value);
  if (!std::isfinite(value) || std::strtod(nearest.c_str(), nullptr) <= value) return nearest;
  // One unit of the fourth digit less; where that is nothing, all digits.
  const double unit = std::pow(10, std::floor(std::log10(std::abs(value))) - 3);
  const std::string lower = number(value - unit);
  if (std::strtod(lower.c_str(), nullptr) <= value) return lower;
  std::ostringstream all;
  all.precision(std::numeric_limits<double>::max_digits10);
  all << value;
  return all.str();
}

std::string number_above(double value) {
  const std::string text = number_below(-value);
  return text.front() == '-' ? text.substr(1) : value == 0 ? text : "-" + text;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  const auto lower = [](char letter) { return std::tolower(static_cast<unsigned char>(letter)); };
  std::vector<std::size_t> before(b.size() + 1), row(b.size() + 1), next(b.size() + 1);  // i - 1, i, i + 1 letters of a
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    next[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = row[j] + (lower(a[i]) == lower(b[j]) ? 0 : 1);
      next[j + 1] = std::min({replaced, row[j + 1] + 1, next[j] + 1});
      if (i > 0 && j > 0 && lower(a[i]) == lower(b[j - 1]) && lower(a[i - 1]) == lower(b[j]))
        next[j + 1] = std::min(next[j + 1], before[j - 1] + 1);
    }
    std::swap(before, row);
    std::swap(row, next);
  }
  return row.back();
}

}  // namespace perp::ncp

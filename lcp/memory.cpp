// SPDX-License-Identifier: Apache-2.0
#include "lcp/memory.hpp"

#include <array>
#include <cstdio>

namespace perp::lcp {
namespace {

std::string sentence(const std::string& what_needs, double bytes, double available) {
  return what_needs + " need " + memory_text(bytes) + ", " + memory_text(available) + " are available";
}

}  // namespace

std::string memory_text(double bytes) {
  constexpr std::array units{"bytes", "kB", "MB", "GB", "TB", "PB", "EB"};
  std::size_t unit = 0;
  while (bytes >= 999.5 && unit + 1 < units.size()) {
    bytes /= 1000;
    ++unit;
  }
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), unit > 0 && bytes < 9.95 ? "%.1f %s" : "%.0f %s", bytes, units[unit]);
  return text.data();
}

NotEnoughMemory::NotEnoughMemory(const std::string& what_needs, double bytes, double available)
    : text_(std::make_shared<const std::string>(sentence(what_needs, bytes, available))) {}

const char* NotEnoughMemory::what() const noexcept { return text_->c_str(); }

void require_memory(double bytes, const std::string& what_needs) {
  // A file or two to read: not worth it for what is small.
  constexpr double small = 1 << 24;
  if (!(bytes > small)) return;
  const double available = available_memory();
  if (bytes > available) throw NotEnoughMemory(what_needs, bytes, available);
}

void require_factors(std::ptrdiff_t rows, double bytes) {
  constexpr double little = 1 << 20;  // far less than require_memory() looks at: no words are made
  if (bytes > little) require_memory(bytes, "the factors of " + std::to_string(rows) + " rows");
}

}  // namespace perp::lcp

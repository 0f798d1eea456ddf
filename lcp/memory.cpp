// SPDX-License-Identifier: Apache-2.0
#include "lcp/memory.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>

namespace perp::lcp {
namespace {

constexpr double unknown = 9007199254740992;  // 2^53 bytes

/// Of /proc/meminfo.
double free_of_machine() {
  std::ifstream in("/proc/meminfo");
  std::string name;
  std::string unit;
  double kilobytes = 0;
  while (in >> name >> kilobytes && std::getline(in, unit))
    if (name == "MemAvailable:") return 1024 * kilobytes;
  return unknown;
}

double number_in(const std::string& file) {
  std::ifstream in(file);
  double value = 0;
  return in >> value ? value : unknown;  // "max" is no number
}

/// Of the group the process is in and those about it, where they are told by the second version of control groups.
double free_of_groups() {
  std::ifstream in("/proc/self/cgroup");
  double left = unknown;
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("0::/")) continue;
    for (std::string path = line.substr(3);; path.resize(path.find_last_of('/'))) {
      const std::string folder = "/sys/fs/cgroup" + path + "/memory.";
      const double most = number_in(folder + "max");
      if (most < unknown) left = std::min(left, std::max(0.0, most - number_in(folder + "current")));
      if (path.find('/') == std::string::npos) break;
    }
  }
  return left;
}

double free_of_address_space() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unknown;
  const double pages = number_in("/proc/self/statm");
  if (pages >= unknown) return unknown;
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - pages * static_cast<double>(sysconf(_SC_PAGESIZE)));
}

std::string sentence(const std::string& what_needs, double bytes, double available) {
  return what_needs + " need " + memory_text(bytes) + ", " + memory_text(available) + " are available";
}

}  // namespace

double available_memory() { return std::min({free_of_machine(), free_of_groups(), free_of_address_space()}); }

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

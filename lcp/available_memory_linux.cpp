// SPDX-License-Identifier: Apache-2.0
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "lcp/memory.hpp"

namespace perp::lcp {
namespace {

constexpr double unknown = 9007199254740992;  // 2^53 bytes

/// Reads /proc/meminfo.
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

/// Reads the limits of the group the process is in and those about it, where they are told by the second version of
/// control groups.
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

}  // namespace

double available_memory() { return std::min({free_of_machine(), free_of_groups(), free_of_address_space()}); }

}  // namespace perp::lcp

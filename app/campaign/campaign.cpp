// SPDX-License-Identifier: Apache-2.0
#include "app/campaign/campaign.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sched.h>
#include <sys/sysinfo.h>
#include <sys/utsname.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <fstream>

#include "app/campaign/cell.hpp"
#include "app/program/program.hpp"

namespace perp::app::compare {

namespace {

constexpr std::size_t most_cells = 10'000'000;  // what nobody runs, and a damaged file may ask for

std::string cpu_model() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

template <class T, class Name>
std::vector<std::string> names_of(const std::vector<T>& items, Name name) {
  std::vector<std::string> names;
  names.reserve(items.size());
  for (const T& item : items) names.push_back(item.*name);
  return names;
}

}  // namespace

Machine Machine::here() {
  Machine machine{.cpu = cpu_model()};
  cpu_set_t set;
  CPU_ZERO(&set);
  machine.cores = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
  struct sysinfo memory {};
  if (sysinfo(&memory) == 0)
    machine.memory_mb = static_cast<long long>(memory.totalram) * static_cast<long long>(memory.mem_unit) / (1 << 20);
  utsname name{};
  if (uname(&name) == 0)
    machine.system = fmt::format("{} {} {}", static_cast<const char*>(name.sysname),
                                 static_cast<const char*>(name.release), static_cast<const char*>(name.machine));
  return machine;
}

std::size_t Campaign::pairs() const {
  std::size_t pairs = 0;
  for (const AskedProblem& problem : problems) pairs += static_cast<std::size_t>(problem.starts);
  return pairs;
}

void stamp(Campaign& campaign) {
  campaign.version = version_number();
  campaign.build = file_crc("/proc/self/exe");
  campaign.libraries = library_versions();
  campaign.machine = Machine::here();
  campaign.date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                              fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
}

Campaign parse_campaign(const std::string& text) {
  Campaign campaign = campaign_of<Campaign>(text);
  if (campaign.pairs() > most_cells || campaign.cells() > most_cells)
    throw input_error("more than {} cells", most_cells);
  return campaign;
}

Campaign read_campaign(const std::string& dir) {
  if (!holds_campaign(dir)) throw input_error("'{}/campaign.json' cannot be read", dir);
  return campaign_in(dir, parse_campaign);
}

Shard parse_shard(const std::string& text) {
  constexpr int most = 100'000;
  if (text.empty()) return {};
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, shard.number);
  const bool slash = number.ec == std::errc{} && number.ptr != end && *number.ptr == '/';
  const auto of = slash ? std::from_chars(number.ptr + 1, end, shard.of) : number;
  if (!slash || of.ec != std::errc{} || of.ptr != end || shard.of < 1 || shard.of > most || shard.number < 1 ||
      shard.number > shard.of)
    throw InputError(fmt::format("--shard: '{}' is no K/N with 1 <= K <= N <= {}, such as 3/7", text, most));
  return shard;
}

std::vector<std::string> differences(const Campaign& before, const Campaign& now) {
  std::vector<std::string> found;
  compare_names("methods", names_of(before.methods, &AskedMethod::label), names_of(now.methods, &AskedMethod::label),
                found);
  compare_names("problems", names_of(before.problems, &AskedProblem::name), names_of(now.problems, &AskedProblem::name),
                found);
  for (const AskedMethod& method : now.methods) {
    const auto same = std::ranges::find(before.methods, method.label, &AskedMethod::label);
    if (same == before.methods.end()) continue;
    compare_value("command of " + method.label, same->command, method.command, found);
    for (const auto& [option, value] : method.in_force) {
      const auto old = std::ranges::find(same->in_force, option, &std::pair<std::string, std::string>::first);
      compare_value(fmt::format("option {} of {}", option, method.label),
                    old == same->in_force.end() ? std::string("(none)") : old->second, value, found);
    }
  }
  for (const AskedProblem& problem : now.problems) {
    const auto same = std::ranges::find(before.problems, problem.name, &AskedProblem::name);
    if (same == before.problems.end()) continue;
    compare_value("file of " + problem.name, same->file, problem.file, found);
    compare_value("content (CRC) of " + problem.name, same->crc, problem.crc, found);
    compare_value("size of " + problem.name, same->n, problem.n, found);
    compare_value("starts of " + problem.name, same->starts, problem.starts, found);
  }
  compare_value("--tol", before.tol, now.tol, found);
  compare_value("--time-limit", before.time_limit, now.time_limit, found);
  compare_value("--memory-limit", before.memory_mb, now.memory_mb, found);
  compare_value("--restarts", before.restarts, now.restarts, found);
  compare_value("--seed", before.seed, now.seed, found);
  compare_value("version of perp", before.version, now.version, found);
  return found;
}

}  // namespace perp::app::compare

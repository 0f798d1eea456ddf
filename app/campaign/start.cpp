// SPDX-License-Identifier: Apache-2.0
#include "app/campaign/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "app/campaign/cell.hpp"
#include "app/program/program.hpp"

namespace perp::app::compare {

ncp::Vec perturbed(const ncp::Box& box, ncp::In x0, const Perturbation& rule) {
  if (rule.run <= 0) return x0;
  const std::uint32_t name = crc32(fmt::format("{} {} {}", rule.problem, rule.start, rule.run));
  std::mt19937_64 engine((static_cast<std::uint64_t>(rule.seed) << 32U) | name);
  const double d = std::min(std::ldexp(0.1, rule.run - 1), 1.0);
  ncp::Vec x = x0;
  for (double& value : x)  // std::uniform_real_distribution is not the same on every platform
    value += d * (1 + std::abs(value)) * (static_cast<double>(engine() >> 11U) * 0x1p-52 - 1);
  return lcp::project(box, x);
}

std::string nl_with_start(std::string_view text, ncp::In x) {
  if (!text.starts_with('g')) throw InputError("the initial guess of a binary .nl file is not changed");
  constexpr int header_lines = 10;
  std::string result;
  int variables = 0;
  long long skip = 0;  // lines of the old guess
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
    const std::string line(text.substr(0, end));
    text.remove_prefix(end);
    if (number == 2) std::sscanf(line.c_str(), "%d", &variables);
    if (number > header_lines && line.starts_with('x')) {
      std::sscanf(line.c_str(), "x%lld", &skip);
      continue;
    }
    if (skip > 0) {
      --skip;
      continue;
    }
    if (number > header_lines && line.starts_with('r')) {
      if (variables > x.size()) throw input_error("{} values for {} variables", x.size(), variables);
      result += fmt::format("x{}\n", variables);
      for (int i = 0; i < variables; ++i) result += fmt::format("{} {}\n", i, x[i]);
    }
    result += line;
  }
  return result;
}

}  // namespace perp::app::compare

// SPDX-License-Identifier: Apache-2.0
#include "app/findings/profiles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace perp::app::comparison {

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

void check(const Costs& t) {
  for (std::size_t s = 0; s < t.size(); ++s) {
    if (t[s].size() != t[0].size())
      throw std::invalid_argument(
          fmt::format("costs of method {}: {} problems, of method 0: {}", s, t[s].size(), t[0].size()));
    for (std::size_t p = 0; p < t[s].size(); ++p)
      if (!(t[s][p] > 0)) throw std::invalid_argument(fmt::format("cost t[{}][{}] = {}: not positive", s, p, t[s][p]));
  }
}

/// The distribution of the finite ones among `ratios`.
Profile distribution(std::vector<double> ratios) {
  Profile profile{.steps = {}, .problems = ratios.size()};
  std::ranges::sort(ratios);
  for (std::size_t k = 0; k < ratios.size() && ratios[k] < inf; ++k) {
    if (profile.steps.empty() || profile.steps.back().x < ratios[k]) profile.steps.push_back({ratios[k], 0});
    profile.steps.back().count = k + 1;
  }
  return profile;
}

}  // namespace

std::size_t Profile::count(double x) const {
  const auto after = std::ranges::upper_bound(steps, x, {}, &Step::x);
  return after == steps.begin() ? 0 : std::prev(after)->count;
}

double Profile::share(double x) const {
  return problems == 0 ? 0 : static_cast<double>(count(x)) / static_cast<double>(problems);
}

std::size_t Profile::solved() const { return steps.empty() ? 0 : steps.back().count; }

std::vector<Profile> performance_profiles(const Costs& t) {
  check(t);
  if (t.empty()) return {};
  std::vector<double> least(t[0].size(), inf);
  for (const auto& row : t)
    for (std::size_t p = 0; p < row.size(); ++p) least[p] = std::min(least[p], row[p]);
  std::vector<Profile> profiles;
  for (const auto& row : t) {
    std::vector<double> ratios(row.size(), inf);
    for (std::size_t p = 0; p < row.size(); ++p)
      if (row[p] < inf) ratios[p] = row[p] / least[p];  // else inf / inf where nobody solves it
    profiles.push_back(distribution(std::move(ratios)));
  }
  return profiles;
}

std::vector<Profile> data_profiles(const Costs& t, std::span<const double> unit) {
  check(t);
  if (!t.empty() && unit.size() != t[0].size())
    throw std::invalid_argument(fmt::format("{} units for {} problems", unit.size(), t[0].size()));
  for (std::size_t p = 0; p < unit.size(); ++p)
    if (!(unit[p] > 0 && unit[p] < inf)) throw std::invalid_argument(fmt::format("unit[{}] = {}", p, unit[p]));
  std::vector<Profile> profiles;
  for (const auto& row : t) {
    std::vector<double> budgets(row);
    for (std::size_t p = 0; p < row.size(); ++p) budgets[p] /= unit[p];
    profiles.push_back(distribution(std::move(budgets)));
  }
  return profiles;
}

}  // namespace perp::app::comparison

// SPDX-License-Identifier: Apache-2.0
#include "app/problem/kept_way.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "ncp/reformulation/cfunction.hpp"

namespace perp::app {

namespace {

double merit_at(const ncp::Mcp& mcp, const ncp::Vec& x, ncp::PathMerit merit) {
  const ncp::Vec z = lcp::project(mcp.box(), x);
  ncp::Vec F = ncp::Vec::Zero(z.size());
  if (!mcp.eval(z, F) || !F.allFinite()) return std::numeric_limits<double>::quiet_NaN();
  if (merit == ncp::PathMerit::NormalMap) return 0.5 * (F + x - z).squaredNorm();
  ncp::Vec Phi(z.size());
  ncp::reformulate(ncp::fischer_burmeister(), mcp.box(), z, F, Phi);
  return 0.5 * Phi.squaredNorm();
}

/// About this many evaluations draw a way.
constexpr std::size_t evaluations = 600;

}  // namespace

std::vector<WaySample> merit_along(const ncp::Mcp& mcp, const std::vector<lcp::Breakpoint>& corners,
                                   ncp::PathMerit merit, int samples) {
  std::vector<WaySample> result;
  for (std::size_t k = 0; k + 1 < corners.size(); ++k)
    for (int j = 0; j <= samples; ++j) {
      const double share = static_cast<double>(j) / (samples + 1);
      const ncp::Vec x = corners[k].x + share * (corners[k + 1].x - corners[k].x);
      result.push_back({static_cast<double>(k) + share, merit_at(mcp, x, merit)});
    }
  if (!corners.empty())
    result.push_back({static_cast<double>(corners.size() - 1), merit_at(mcp, corners.back().x, merit)});
  return result;
}

double KeptWay::place(double point) const {
  if (!on_path) return point;
  std::size_t last = segments();
  if (iteration.linear != 'S') last = static_cast<std::size_t>(std::ranges::max_element(t) - t.begin());
  if (point >= 1 || last == 0) return static_cast<double>(last);
  const double wanted = point * t[last];
  std::size_t k = 1;
  while (k < last && t[k] < wanted) ++k;
  const double length = t[k] - t[k - 1];
  return static_cast<double>(k - 1) + (length > 0 ? std::clamp((wanted - t[k - 1]) / length, 0.0, 1.0) : 1);
}

double KeptWay::merit(double s) const {
  const auto nearest = static_cast<std::size_t>(std::max(0L, std::lround(s * (samples_between + 1))));
  return samples[std::min(nearest, samples.size() - 1)].merit;
}

/// A gradient step did not take its way.
bool WayKeeper::worth_keeping(const ncp::Iteration& it) const {
  if (it.way == nullptr || it.problem == nullptr || it.way->kinks.size() < 2) return false;
  if (wanted_) return it.k == *wanted_;
  if (!kept_) return true;
  return std::tuple(it.kind != 'G', it.way->on_path ? it.way->kinks.size() - 2 : 0, it.backtracks) >
         std::tuple(kept_->iteration.kind != 'G', kept_->kinks(), kept_->iteration.backtracks);
}

ncp::Observer WayKeeper::observer() {
  return ncp::of_ways([this](const ncp::Iteration& it) {
    if (!worth_keeping(it)) return ncp::Next::Continue;
    const std::vector<lcp::Breakpoint>& corners = it.way->kinks;
    KeptWay kept{.iteration = it, .on_path = it.way->on_path, .T = it.way->T};
    kept.iteration.x = nullptr;
    kept.iteration.way = nullptr;
    kept.iteration.problem = nullptr;
    for (const lcp::Breakpoint& corner : corners) kept.t.push_back(corner.t);
    kept.samples_between = static_cast<int>(std::clamp<std::size_t>(evaluations / kept.segments(), 1, 60));
    kept.samples = merit_along(*it.problem, corners, merit_, kept.samples_between);
    kept_ = std::move(kept);
    return ncp::Next::Continue;
  });
}

}  // namespace perp::app

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The way of one iteration of PathSearch with the merit along it, kept while a run goes on.
#include <optional>
#include <vector>

#include "ncp/run/observe.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::app {

/// A point of a way: s is 0 at the first corner (the iterate before), 1 at the second, ...
struct WaySample {
  double s = 0;
  double merit = 0;  ///< NaN where F is not defined
};

/// 1/2 ||Phi_FB(z)||^2, z = pi(x), or (NormalMap) 1/2 ||F(z) + x - z||^2, `samples` times between two corners and at
/// the corners.
std::vector<WaySample> merit_along(const ncp::Mcp& mcp, const std::vector<lcp::Breakpoint>& corners,
                                   ncp::PathMerit merit, int samples);

struct KeptWay {
  ncp::Iteration iteration{};  ///< without its pointers
  bool on_path = false;        ///< with kinks: all corners but the first and the last
  double T = 1;                ///< accepted
  std::vector<double> t{};     ///< of the corners
  int samples_between = 0;
  std::vector<WaySample> samples{};

  std::size_t segments() const { return t.size() - 1; }
  std::size_t kinks() const { return on_path ? t.size() - 2 : 0; }
  /// s of the point T: of a path where t first comes to T times that of its end, which is the last corner if the
  /// linearised problem was solved, else the one with the largest t.
  double place(double T) const;
  /// At the sample nearest to s.
  double merit(double s) const;
};

/// Keeps the way of iteration `wanted`, else of the one with the most kinks, and among those with the most points
/// refused.
class WayKeeper {
 public:
  WayKeeper(std::optional<int> wanted, ncp::PathMerit merit) : wanted_(wanted), merit_(merit) {}
  /// The keeper outlives the observer.
  ncp::Observer observer();
  const std::optional<KeptWay>& kept() const { return kept_; }

 private:
  bool worth_keeping(const ncp::Iteration& it) const;
  std::optional<int> wanted_;
  ncp::PathMerit merit_;
  std::optional<KeptWay> kept_;
};

}  // namespace perp::app

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// When entries of lists have their turn. Private to ncp/.
#include <optional>

#include "ncp/run/run.hpp"
#include "ncp/strategy/plan.hpp"
#include "ncp/transforms/scaling.hpp"

namespace perp::ncp {

/// Returns the factors of J at x; nothing where J is not defined there or they bring no entries together.
std::optional<Scaling> factors_at(Run& run, const Vec& x);

/// Decides conditions on a run and its start. Facts about J at the start are computed once.
class Facts {
 public:
  /// The run and its start outlive the facts.
  Facts(Run& run, const Point& start) : run_(run), start_(start) {}
  bool hold(const std::vector<Condition>& conditions);

 private:
  bool holds(Condition condition);

  Run& run_;
  const Point& start_;
  std::optional<bool> monotone_, symmetric_;
};

/// "there is exactly one solution, as F is proven to be strongly monotone", of a problem that has not been solved;
/// empty where nothing is proven.
std::string words_on_existence(const Mcp& mcp, In x);

}  // namespace perp::ncp

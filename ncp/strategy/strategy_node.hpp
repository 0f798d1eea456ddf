// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What a Strategy is made of; private to ncp/.
#include <string>
#include <vector>

#include "ncp/run/run.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::ncp {

struct StrategyNode {
  enum class Kind { Presolved, Scaled, Escaping, FirstOf };
  Kind kind = Kind::FirstOf;
  std::string text;             ///< "scaled(smooth)"
  std::vector<Method> methods;  ///< one, but for FirstOf
  std::vector<std::string> names;
  Escape escape{};  ///< of Escaping
};

void run_strategy(Run& run, In x0, const StrategyNode& node);

}  // namespace perp::ncp

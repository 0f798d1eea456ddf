// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Strategies: methods put together as values, for solve() like any method. In text, with the names of presets:
///
///     first(path, scaled(smooth), escape(semismooth))
///
/// A method keeps its own presolve, restarts and escapes where it has them; limits and tolerance are the strategy's.
#include <memory>
#include <string_view>
#include <vector>

#include "ncp/run/options.hpp"

namespace perp::ncp {

struct StrategyNode;

/// A tree of methods. presolved(), scaled(), escaping(), first_of() (ncp/strategy/solve.hpp) and method_of() make it.
/// Copies share the tree, which is never changed. solve() refuses a strategy without a tree.
struct Strategy {
  Stop stop{};
  std::shared_ptr<const StrategyNode> tree{};
};

/// The attempts that a method makes in turn, until one is not stuck. A run skips attempts whose `when` does not hold.
struct Outline {
  struct Line {
    std::string name;  ///< as in the first record
    std::string what;  ///< as in strategies
    std::string when;  ///< in words; empty: always
  };
  std::vector<Line> lines{};
  bool presolved = false;  ///< all of it, on the presolved problem
};

/// Returns the text that method_of() reads, such as "first(path, scaled(smooth))".
std::string_view name_of(const Strategy& strategy);
void describe(Strategy& strategy, Fields& fields);

}  // namespace perp::ncp

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

/// A copy shares the tree, which nobody changes. Made by presolved(), scaled(), escaping(), first_of()
/// (ncp/strategy/solve.hpp) or method_of(); solve() refuses an empty one.
struct Strategy {
  Stop stop{};
  std::shared_ptr<const StrategyNode> tree{};
};

/// What a method tries in turn, until one does not get stuck. The run leaves out those whose `when` does not hold.
struct Outline {
  struct Line {
    std::string name;  ///< as in the first record
    std::string what;  ///< as in strategies
    std::string when;  ///< in words; empty: always
  };
  std::vector<Line> lines{};
  bool presolved = false;  ///< all of it, on the presolved problem
};

/// "first(path, scaled(smooth))": what method_of() reads.
std::string_view name_of(const Strategy& strategy);
void describe(Strategy& strategy, Fields& fields);

}  // namespace perp::ncp

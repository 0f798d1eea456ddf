// SPDX-License-Identifier: Apache-2.0
#include "ncp/analysis/no_solution.hpp"

#include <vector>

#include "ncp/interval/enclosure.hpp"
#include "ncp/problem/words.hpp"

namespace perp::ncp {
namespace {

/// Each narrows the box at least once; where that goes on for long, it is not what decides.
constexpr int most_rounds = 20;

}  // namespace

std::optional<NoSolution> no_solution(const Mcp& mcp) {
  const Enclosure* enclosure = mcp.enclosure();
  if (enclosure == nullptr) return std::nullopt;
  const Box& box = mcp.box();
  std::vector<Interval> X(at(mcp.size())), F(at(mcp.size()));
  for (Index i = 0; i < mcp.size(); ++i) X[at(i)] = {box.lower[i], box.upper[i]};
  for (int round = 0; round < most_rounds; ++round) {
    enclosure->values(X, F);
    bool narrowed = false;
    for (Index i = 0; i < mcp.size(); ++i) {
      const Interval range = F[at(i)];
      const bool nowhere = range.is_empty();
      if (box.lower[i] == box.upper[i] && !nowhere) continue;
      const bool at_lower = range.lower > 0, at_upper = range.upper < 0;
      if (!nowhere && !at_lower && !at_upper) continue;
      const double bound = at_lower ? box.lower[i] : box.upper[i];
      if (nowhere || bound == -infinity || bound == infinity) return NoSolution{i, range};
      if (X[at(i)] != Interval(bound)) narrowed = true;
      X[at(i)] = bound;
    }
    if (!narrowed) return std::nullopt;
  }
  return std::nullopt;
}

std::string describe(const Mcp& mcp, const NoSolution& proof) {
  const Index i = proof.row;
  const std::string equation = "equation " + mcp.equation_name(i), variable = mcp.variable_name(i);
  if (proof.range.is_empty()) return equation + " is defined nowhere within the bounds";
  const bool positive = proof.range.lower > 0;
  const bool free = mcp.box().lower[i] == -infinity && mcp.box().upper[i] == infinity;
  return equation + " lies in [" + number(proof.range.lower) + ", " + number(proof.range.upper) +
         "] wherever the variables are within their bounds, and " + variable +
         (free       ? " is free"
          : positive ? " has no lower bound"
                     : " has no upper bound");
}

}  // namespace perp::ncp

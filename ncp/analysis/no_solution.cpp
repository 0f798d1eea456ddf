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

std::optional<NoSolution> no_solution(const Mcp& mcp, double tol) {
  return no_solution(mcp, tol, std::vector<char>(at(mcp.size()), 1), mcp.box());
}

std::optional<NoSolution> no_solution(const Mcp& mcp, double tol, const std::vector<char>& rows, const Box& begin) {
  const Enclosure* enclosure = mcp.enclosure();
  if (enclosure == nullptr) return std::nullopt;
  const Box& box = mcp.box();
  std::vector<Interval> X(at(mcp.size())), F(at(mcp.size()));
  for (Index i = 0; i < mcp.size(); ++i) X[at(i)] = {begin.lower[i], begin.upper[i]};
  for (int round = 0; round < most_rounds; ++round) {
    enclosure->values(X, F);
    bool narrowed = false;
    for (Index i = 0; i < mcp.size(); ++i) {
      if (rows[at(i)] == 0) continue;
      const Interval range = F[at(i)];
      const bool nowhere = range.is_empty();
      if (box.lower[i] == box.upper[i] && !nowhere) continue;
      const bool at_lower = range.lower > tol, at_upper = range.upper < -tol;
      if (!nowhere && !at_lower && !at_upper) continue;
      const double bound = at_lower ? box.lower[i] : box.upper[i];
      if (nowhere || bound == -infinity || bound == infinity) return NoSolution{i, range, round > 0};
      const Interval near = intersection(X[at(i)], Interval(bound) + (at_lower ? Interval(0, tol) : Interval(-tol, 0)));
      if (near.is_empty() || near == X[at(i)]) continue;
      narrowed = true;
      X[at(i)] = near;
    }
    if (!narrowed) return std::nullopt;
  }
  return std::nullopt;
}

std::string describe(const Mcp& mcp, const NoSolution& proof) {
  const Index i = proof.row;
  const std::string equation = "equation " + mcp.equation_name(i), variable = mcp.variable_name(i);
  if (proof.range.is_empty())
    return equation + " is defined nowhere " +
           (proof.narrowed ? "that the signs of the other equations leave room for a solution" : "within the bounds");
  const bool positive = proof.range.lower > 0;
  const bool free = mcp.box().is_free(i);
  return equation + " lies in [" + number_below(proof.range.lower) + ", " + number_above(proof.range.upper) +
         "] wherever " +
         (proof.narrowed ? "the signs of the other equations leave room for a solution"
                         : "the variables are within their bounds") +
         ", and " + variable +
         (free       ? " is free"
          : positive ? " has no lower bound"
                     : " has no upper bound");
}

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A test problem of the collection: its starts, its known solutions, its source and one line on why it is hard.
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ncp/problem/mcp.hpp"

namespace perp::ncp::collection {

/// A solution from the literature or in closed form, printed with so many digits that |x - x*|_inf <= tol.
struct KnownSolution {
  std::string label;
  Vec x;
  double tol = 1e-6;
};

struct Problem {
  std::unique_ptr<Mcp> mcp;
  std::vector<Vec> starts;  ///< at least one; `perp solve NAME --start k` counts from 1
  std::vector<KnownSolution> solutions;
  /// A point outside the list may be a solution too (several solutions, or a ray of them).
  bool solutions_complete = false;
  /// Why there is no solution, in one line, if there is none; then `solutions` is empty and complete.
  std::string no_solution{};
  /// Of a KKT system: the objective, of x = (unknowns, multipliers); empty for other problems.
  std::function<double(In)> objective{};
};

/// One line of the catalogue; the problem itself is built on demand.
struct Entry {
  std::string_view name;
  std::string_view problem_class;  ///< "tiny", "economics", "games", "chemical", ...
  Index size;
  std::string_view source;  ///< where problem and data come from
  std::string_view hard;    ///< why it is hard, in one line
  Problem (*make)();
};

}  // namespace perp::ncp::collection

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Says why a model has no solution, which row is the cause, and what would mend it; and what in it looks like a slip
/// though it has one. In the model's own names, the likeliest cause first.
#include <atomic>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ncp/explain/conflict.hpp"
#include "ncp/run/result.hpp"
#include "ncp/strategy/plan.hpp"

namespace perp::ncp {

struct Answer {
  enum class Kind {
    Conflict,   ///< rows and bounds that contradict each other
    Repair,     ///< the least change with which they do not
    Residual,   ///< rows that hold least at the best point found
    Structure,  ///< rows too many or too few, or the same twice
    Mirror,     ///< an entry, a sign or a pair that breaks a symmetry of all others
    Family,     ///< a row that differs from its like
    Start,      ///< the start is outside the bounds, F is not defined there, or a row does not hold that should
  };
  Kind kind = Kind::Conflict;
  bool proven = false;  ///< false: likely
  std::vector<Index> rows{}, variables{};
  std::string text{};  ///< without a full stop
};
std::string_view to_string(Answer::Kind kind);

/// A constant of a row, or a bound, from one value to another. Of a row the constant is what is added to F_i.
struct Change {
  Demand what{};
  double from = 0, to = 0;
};
struct Repair {
  std::vector<Change> changes{};
  /// Up to rounding, in the sum of the changes, each in units of its row's largest coefficient; bounds that are 0,
  /// signs of variables, stay.
  bool least = false;
  bool verified = false;  ///< the changed model was solved
};

struct Explanation {
  Result result{};                ///< of the solve
  std::vector<Answer> answers{};  ///< the first one first
  std::optional<Conflict> conflict{};
  Repair repair{};  ///< without changes: none was found
};

struct ExplainOptions {
  Method method{};      ///< that solves the model
  double seconds = 30;  ///< for all of it
};

/// Throws std::invalid_argument for what solve() refuses. `interrupt` may be null.
Explanation explain(const Mcp& mcp, In x0, const ExplainOptions& options, const std::atomic<bool>* interrupt = nullptr);

}  // namespace perp::ncp

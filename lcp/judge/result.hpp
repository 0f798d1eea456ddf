// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The answer of every method for the affine MCP, and the limits that may stop it. Only the judge (judge.hpp) may call
/// a point Solved, so methods make their Result by judged().
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "lcp/affine_mcp.hpp"
#include "lcp/deadline.hpp"
#include "lcp/judge/infeasible.hpp"
#include "lcp/judge/refutation.hpp"
#include "lcp/status.hpp"

namespace perp {
class Fields;  // lcp/fields.hpp: options of a method, described
}

namespace perp::lcp {

using perp::Status;
using perp::to_string;

struct Limits {
  double tol = 1e-9;  ///< on the natural residual, absolute
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
  std::function<bool()> interrupted{};  ///< polled; true ends the run as Interrupted

  std::optional<Status> reached() const;  ///< Interrupted or TimeLimit, if one of them
};

struct Result {
  Status status = Status::Stalled;
  std::string message;     ///< what happened, with indices (from 1) and values
  Vec z;                   ///< the best point met, in the box
  double residual = 0;     ///< the natural residual of z, by judge()
  double relative = 0;     ///< Accuracy::relative of z: the residual beside the terms of its row
  long iterations = 0;     ///< pivots, sweeps or Newton steps: the method says which
  int factorizations = 0;  ///< of matrices, however small
  Vec certificate{};       ///< y with proves_infeasible(problem, y), if status == Infeasible and there is one
  /// The proof of solve(), if status == Infeasible, with a tolerance of at least that of the limits.
  std::shared_ptr<const Refutation> refutation{};
  bool solved() const { return status == Status::Solved; }
  /// Solved, to the tolerance or to rounding.
  bool accepted() const { return solved() || status == Status::SolvedToRounding; }
};

/// Returns whether the natural residual of z is at most tol.
bool solves(const AffineMcp& problem, In z, double tol);
/// Returns whether it is, or z is solved to rounding.
bool accepts(const AffineMcp& problem, In z, double tol);

/// Makes the result for z, projected on the box. Its status is Solved if the residual is at most limits.tol. It is
/// SolvedToRounding if z is as good as doubles allow and `otherwise` is not a proof. In all other cases it is
/// `otherwise`, with `message`.
Result judged(const AffineMcp& problem, In z, const Limits& limits, Status otherwise, std::string message);

/// Throws std::invalid_argument with `method`'s name if the problem is malformed, the start has another length or is
/// not finite, or the tolerance is not a positive number.
void check_input(const char* method, const AffineMcp& problem, In start, const Limits& limits);
void check_input(const char* method, const AffineMcp& problem, In start);  ///< the same without limits

}  // namespace perp::lcp

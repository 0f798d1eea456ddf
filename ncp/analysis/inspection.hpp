// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What can be said of a problem without solving it, as data. Rows and columns of fixed variables are left out of
/// everything that is said of the Jacobian J and of the size of F: F_i is free there and x_i does not change.
#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "lcp/classes/classify.hpp"
#include "lcp/linalg/structure.hpp"
#include "ncp/analysis/function_classes.hpp"
#include "ncp/problem/residual.hpp"

namespace perp::ncp {

using Indices = std::vector<Index>;

struct VariableKinds {
  Index free = 0;
  Index lower = 0;  ///< a lower bound only
  Index upper = 0;
  Index boxed = 0;
  Indices fixed{};
};

/// Of the pattern of J; where the problem is affine, of its entries other than 0. Indices are the problem's.
struct StructureFindings {
  Index size = 0;  ///< rows and columns: the variables that are not fixed
  Index rank = 0;  ///< structural
  /// The structural rank of J with an entry on the diagonal of every bounded variable. Every basis matrix, in which the
  /// columns of variables at a bound are unit vectors, has at most this rank: below `size`, all are singular.
  Index rank_with_bounds = 0;
  Indices empty_rows{};
  Indices empty_columns{};
  /// Of J with those diagonal entries if that is singular, else of J alone; empty if neither is.
  lcp::StructurePart over{};
  lcp::StructurePart under{};
  bool full() const { return rank == size; }
  bool singular() const { return rank_with_bounds < size; }
};

/// x is the start projected onto the bounds, as every method does first.
struct StartFindings {
  Indices outside{};  ///< variables whose start was not within their bounds
  Vec x{};
  Vec F{};
  SpMat J{};
  std::string undefined{};  ///< why F or J is not defined there, and where solve() starts instead; empty: they are
  bool F_defined = true;
  bool J_defined = true;
  Indices F_undefined{};                               ///< rows that are not finite; may be empty all the same
  std::vector<std::pair<Index, Index>> J_undefined{};  ///< the same for entries of J
  Residual residual{};
  Index largest_F = -1;  ///< where |F_i| is largest, of the finite ones; -1: there is none
  Index zeros_in_F = 0;
  double smallest_F = 0;  ///< |F_i| other than 0
  Indices degenerate{};   ///< x_i at a bound and F_i = 0, both to 1e-8; fixed variables do not count
  Index rank = 0;         ///< structural, of the entries of J that are not 0 there
};

struct Extreme {
  Index index = -1;
  double value = 0;
};
/// Of the finite entries of J at the start that are not 0. Rows and columns by their largest |J_ij|, the largest and
/// the smallest few.
struct ScalingFindings {
  Index entries = 0;
  Index zeros = 0;  ///< entries of the pattern that are 0 at the start
  double smallest = 0, largest = 0;
  std::pair<Index, Index> smallest_at{-1, -1}, largest_at{-1, -1};
  std::vector<Extreme> large_rows{}, small_rows{}, large_columns{}, small_columns{};
  /// The larger of the ratios of the largest to the smallest of the rows, and of the columns.
  double spread() const;
};

/// Estimates of the condition number in the 1-norm, as its reciprocal (0: singular); empty where not estimated.
struct ConditionFindings {
  std::optional<double> all{};  ///< of J
  /// Of the rows and columns of J where the natural residual is |F_i|: the others, x_i - l_i or x_i - u_i, are at a
  /// bound for Newton's method on it, and their rows are unit vectors.
  std::optional<double> active{};
  Index active_size = 0;
  std::string why_not{};  ///< why there is no estimate
};

struct Inspection {
  const Mcp* problem = nullptr;
  VariableKinds kinds{};
  StructureFindings structure{};
  StartFindings start{};
  ScalingFindings scaling{};
  std::optional<JacobianCheck> derivatives{};
  ConditionFindings condition{};
  std::optional<lcp::Diagnosis> classes{};            ///< of affine problems
  std::optional<FunctionClasses> function_classes{};  ///< of the others
  std::string interrupted{};                          ///< what was left out when somebody asked to stop; empty: nothing

  const Mcp& mcp() const { return *problem; }
};

/// What deserves a second look, as sentences with names, by the part of the inspection each belongs to.
struct Concern {
  enum Part { Structure, Start, Scaling, Derivatives, Condition } part;
  std::string text;
};
std::vector<Concern> concerns(const Inspection& inspection);

/// Throws std::invalid_argument if the problem is malformed: what solve() throws. `interrupt` may be null. The problem
/// outlives the answer.
Inspection inspect(const Mcp& mcp, In x0, const std::atomic<bool>* interrupt = nullptr);

}  // namespace perp::ncp

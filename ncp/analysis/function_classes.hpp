// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Which classes of functions F belongs to on the box X = [l, u], with fixed variables at their values. For all x != y
/// of X, d = x - y and D = F(x) - F(y):
///     monotone             d'D >= 0                           (28)   P0-function         max of d_i D_i >= 0, d_i != 0
///     strictly monotone    d'D > 0                            (29)   P-function          max of d_i D_i > 0     (32)
///     strongly monotone    d'D >= mu ||d||^2, one mu > 0      (30)   uniform P-function  ... >= mu ||d||^2      (33)
/// (numbers of lecture 3 of Acary's course; Facchinei & Pang, Finite-Dimensional VIs and CPs (2003),
/// sections 2.3, 3.5).
///
/// Yes is proven from the ranges of J over X: D = A d for an A whose rows are rows of J at points of X, or means of
/// such. No is proven by two points whose D_i, in interval arithmetic, break the inequality. A problem without ranges
/// (Mcp::enclosure) is never proven to be anything; F at two points, beyond what rounding can do, still refutes.
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "lcp/classes/classify.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

struct FunctionProperty {
  lcp::Answer answer = lcp::Answer::NotDecided;
  std::string reason{};
  Vec x{}, y{};  ///< of a No: the two points
};

struct FunctionClasses {
  FunctionProperty monotone, strictly_monotone, strongly_monotone, p0, p, uniform_p;
  double modulus = 0;  ///< of strong monotonicity: a mu that is proven
  std::array<std::pair<std::string_view, const FunctionProperty*>, 6> all() const;
};

struct FunctionClassOptions {
  Index dense_to = 300;  ///< eigenvalues and full matrices up to this n: O(n^3)
  Index minors_to = 20;  ///< P by Schur complements of interval matrices up to this n: O(2^n)
  int samples = 20;      ///< points at which a witness is looked for
  unsigned seed = 1;     ///< of theirs
};

/// x0: where the search for witnesses begins. Throws std::invalid_argument if it has not n finite entries.
FunctionClasses function_classes(const Mcp& mcp, In x0, const FunctionClassOptions& options = {});

}  // namespace perp::ncp

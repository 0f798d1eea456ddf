// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A solver that is kept between solves of neighbouring problems: parametric runs, games, receding horizons.
///
/// The active set of the last solution says which variables are at which bounds, N, and which inside, I. On it the
/// problem is  F_I(x) = 0, x_N at its bounds,  and Newton's method solves it with factors in the order and with the
/// pivots of the last ones:
///     J_II d_I = -F_I,   x_I <- x_I + d_I.
/// A variable that would leave its bounds goes to the bound, one whose F has the wrong sign comes inside (the
/// primal-dual active set method; Hintermueller, Ito & Kunisch 2002). Where that does not settle in a few changes, the
/// path search goes on from the basis, and at last the method itself runs, from the start given. Only the natural
/// residual calls a point solved.
///
/// As long as the active set stays the same, a solve asks for no memory, but for what the problem's F and J ask for.
#include <memory>

#include "ncp/strategy/solve.hpp"

namespace perp::ncp {

class KeptSolver {
 public:
  explicit KeptSolver(Method method = automatic());
  ~KeptSolver();
  KeptSolver(KeptSolver&&) noexcept;
  KeptSolver& operator=(KeptSolver&&) noexcept;

  enum class By {
    Kept,       ///< Newton steps on the active set of the last solution
    Exchanges,  ///< and changes of that set
    Path,       ///< path search from the basis of the last solution
    Anew,       ///< the method, from x0
  };

  /// Solves the problem from the last solution, if there is one of a problem with the same pattern of J, and else from
  /// x0. The result is valid until the next solve. Its message and its notes are short where by() is Kept or Exchanges.
  /// Throws what ncp::solve() throws.
  const Result& solve(const Mcp& mcp, In x0);
  /// What the last solve took.
  By by() const;
  /// Forgets the last solution.
  void forget();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

std::string_view to_string(KeptSolver::By by);

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The proximal perturbation of an MCP and the escape from local minima built on it; private to ncp/.
#include "ncp/run/run.hpp"

namespace perp::ncp {

/// MCP(l, u, s (F(x) + lambda (x - c))), s = 1 / max(1, lambda): for lambda large enough its function is strongly
/// monotone around c. s keeps it in the units of x, so that min and Fischer-Burmeister see both of their arguments.
class ProximalMcp final : public Mcp {
 public:
  ProximalMcp(const Mcp& base, double lambda, Vec center);
  const Box& box() const override { return base_.box(); }
  const SpMat& jacobian_pattern() const override { return pattern_; }
  bool eval(In x, Out F) const override;
  bool jacobian(In x, SpMat& J) const override;
  std::string name() const override { return base_.name(); }
  std::string variable_name(Index i) const override { return base_.variable_name(i); }
  std::string equation_name(Index i) const override { return base_.equation_name(i); }

 private:
  const Mcp& base_;
  double lambda_;
  double s_;
  Vec center_;
  SpMat pattern_;  // base's with the whole diagonal
};

/// Proximal escape (Billups & Ferris 1997, QPCOMP; Billups 1995, PROXI and SEMICOMP): where the base method is stuck at
/// xbar, solve F(x) + lambda (x - xbar) by it to a loose tolerance and move xbar to the solution; where that has a
/// natural residual of the original problem that is small enough beside the best one's, the base goes on from it, else
/// it is tried for a few iterations; repeat. lambda shrinks after each move (xbar follows xdot = -F(x) in the box in
/// longer and longer steps, uphill in the merit function if need be) and grows where the base does not solve the
/// perturbed problem.
///
/// `run` has not ended; it ends unless it is stuck as before, with `center` the best point, of that residual.
/// Records: one of kind E for each move, with its
/// lambda in `prox`, and those of the base method on the problem itself; what perturbed problems take shows in the
/// counters only. Returns the number of moves.
int proximal_escape(Run& run, Vec center, double residual, const Escape& escape, const Body& base);

}  // namespace perp::ncp

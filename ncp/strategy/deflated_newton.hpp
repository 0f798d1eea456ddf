// SPDX-License-Identifier: Apache-2.0
#pragma once
/// One attempt of deflation (deflation.hpp): semismooth Newton on M(x; R) Phi(x) = 0. Private to ncp/.
#include "ncp/run/run.hpp"
#include "ncp/strategy/deflation.hpp"

namespace perp::ncp {

/// M(x; R) = product over the roots r in R of  (D / ||x - r||)^p + sigma,  as its logarithm: it neither over- nor
/// underflows.
class DeflationOperator {
 public:
  struct Root {
    Vec r;
    double D = 1;  ///< > 0
  };
  /// `roots` outlives *this.
  DeflationOperator(const std::vector<Root>& roots, double p, double sigma) : roots_(roots), p_(p), sigma_(sigma) {}

  double log_value(In x) const;  ///< +inf at a root
  /// m = grad M / M = sum of  -p (x - r) / (||x - r||^2 (1 + sigma (||x - r|| / D)^p)). Pre: x is no root.
  Vec log_gradient(In x) const;

 private:
  const std::vector<Root>& roots_;
  double p_, sigma_;
};

/// tau with  (M Phi)' (tau d) = -M Phi  where  H d = -Phi:  (M Phi)' = M (H + Phi m'), and by Sherman & Morrison
///     tau = 1 / (1 - m'd).
/// Negative where the plain step would come too near to a root; infinite where the deflated matrix is singular.
double deflated_length(double m_dot_d);

/// From `point`, which is no root, until the run ends. The judge is the run's: it sees the problem undeflated.
void deflated_newton(Run& run, const DeflationTry& attempt, const std::vector<DeflationOperator::Root>& roots,
                     Point point);

}  // namespace perp::ncp

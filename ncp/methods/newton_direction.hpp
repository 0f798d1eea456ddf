// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The directions of one iteration of SemismoothNewton, from the fastest to the safest: Newton, Levenberg-Marquardt
/// with growing nu, gradient. Private to ncp/.
#include <functional>
#include <optional>
#include <string>

#include "lcp/linalg/krylov.hpp"
#include "ncp/methods/semismooth_newton.hpp"
#include "ncp/reformulation/merit.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {

struct Direction {
  Vec d;
  char kind = 'N';
  double nu = 0;
  char linear = ' ';  ///< Iteration::linear
};

class Directions {
 public:
  Directions(Run& run, const SemismoothNewton& method);

  /// Whether linearisations need no H.
  bool krylov() const { return krylov_; }
  /// H d = -Phi; false if there is no d (H singular, out of memory, stopped()) or none that `descends`.
  bool newton(const Linearisation& lin, const Point& point, const std::function<bool(const Vec&)>& descends,
              Direction& out);
  /// The Newton system of the last newton() that was solved by the Krylov method with another right-hand side, to a
  /// tenth; false if there is none, or it does not converge.
  bool chord(In Phi, Vec& d);
  /// (H'H + nu I) d = -H'Phi.
  bool levenberg_marquardt(const Linearisation& lin, const Point& point, double nu, Direction& out);
  /// The minimiser of ||Phi + H d|| along the negative gradient.
  Direction gradient(const Linearisation& lin, const Point& point) const;
  /// nu to begin with: ||Phi|| keeps fast local convergence.
  double first_nu(const Linearisation& lin, const Point& point) const;
  /// Whether the run's time is over or somebody has asked to stop: what solves that ended early say means nothing.
  bool stopped() const { return limits_.reached().has_value(); }
  /// What to tell of Krylov solves that failed; empty if none did.
  std::string remark() const;

 private:
  bool direct(const Linearisation& lin, const Point& point, Direction& out);
  double forcing_term(double norm);

  Run& run_;
  const SemismoothNewton& method_;
  lcp::Limits limits_;
  bool krylov_;
  int failures_ = 0;  // of Krylov solves
  double norm_ = 0;   // ||Phi|| of the last iteration, and its eta
  double eta_ = 0;
  SpMat J_;  // of system_, where the point's is replaced before the chord steps
  std::optional<lcp::KrylovSystem> system_;
  lcp::SparseLu lu_, lm_;
};

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Newton steps on the equation of Alart & Curnier, each with the proximal term of the iterate itself, shortened where
/// that brings the natural map down. Full ones give a path's point the last digits; shortened ones look for a solution
/// where a path turns back, which is often not far. Private to contact/.
#include "contact/classics/alart_curnier.hpp"
#include "contact/solvers/referee.hpp"

namespace perp::contact {

struct NewtonSteps {
  int most = 12;
  double alpha = 1e-10;  ///< of W + alpha I
  /// Of the lengths 1, 1/2, .. 2^-halvings the first that brings the natural map below `decrease` times the last one,
  /// else the best.
  int halvings = 7;
  double decrease = 0.7;
  Origin full = Origin::Newton;  ///< what makes the points of full steps; those of shorter ones DampedNewton
  int patience = 2;              ///< so many in a row that do not bring it below `decrease` times the least end them
  double most_growth = lcp::infinity;  ///< one that makes it so many times the least ends them
};

/// Takes the steps from r, and counts and judges them. Returns whether the run is over.
template <int Size>
bool newton_steps(Referee& referee, const Scaled& problem, AlartCurnierOf<Size>& newton, Vec r,
                  const NewtonSteps& steps);

}  // namespace perp::contact

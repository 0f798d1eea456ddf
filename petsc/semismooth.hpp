// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A semismooth Newton step on Fischer and Burmeister's equations Phi(x) = 0 (lcp/fischer_burmeister.hpp), kept in the
/// box: with theta = |Phi|^2 / 2 and the rows diag(a) + diag(b) J of a generalised Jacobian,
///     (diag(a) + diag(b) J) d = -Phi,    x+ = P(x + t d),    theta(x+) <= theta(x) + sigma grad'(x+ - x),
/// and the projected gradient where d is not found or does not descend. Slower than active-set steps, but every step
/// lowers theta. Reference: De Luca, Facchinei & Kanzow, Math. Program. 75 (1996) 407; Kanzow, Yamashita & Fukushima,
/// J. Optim. Theory Appl. 94 (1997) 115.
#include <petscsnes.h>

#include "petsc/box.hpp"

namespace perp::petsc {

class Semismooth {
 public:
  /// x and F = F(x), J = J(x) become those of the next point (F alone; J is the caller's). *moved: theta fell.
  PetscErrorCode step(SNES snes, const Box& box, Mat J, Vec x, Vec F, bool* moved);

 private:
  PetscErrorCode create(SNES snes, Mat J, Vec like);
  PetscErrorCode newton_direction(Mat J, bool* found);
  PetscErrorCode search(SNES snes, const Box& box, Vec x, Vec F, bool* moved);

  OwnMat rows_;
  OwnKsp ksp_;
  OwnVec phi_, a_, b_, gradient_, d_, trial_, value_, step_;
  PetscObjectState pattern_ = -1;
  PetscReal theta_ = 0;
};

}  // namespace perp::petsc

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Global problems at random.
#include "contact/model/problem.hpp"
#include "support/matrices.hpp"

namespace perp::contact::test {

using support::Random;

/// Bodies of 3 velocities with block-diagonal inertia, each contact between two of them or a body and the ground.
inline Global random_global(Random& random, int d, Index bodies, Index contacts, Index constraints) {
  const Index m = 3 * bodies;
  support::Dense M = support::Dense::Zero(m, m);
  for (Index k = 0; k < bodies; ++k) {
    const support::Dense B = random.normals(3, 3);
    M.block(3 * k, 3 * k, 3, 3) = B * B.transpose() + support::Dense::Identity(3, 3);
  }
  support::Dense H = support::Dense::Zero(m, d * contacts);
  const auto touch = [&](Index a) {
    H.block(3 * random.integer(0, static_cast<int>(bodies) - 1), d * a, 3, d) += random.normals(3, d);
  };
  for (Index a = 0; a < contacts; ++a) {
    touch(a);
    if (random.chance(0.7)) touch(a);
  }
  support::Dense G = support::Dense::Zero(m, constraints);
  for (Index j = 0; j < constraints; ++j) G.col(j) = random.normals(m);
  return {.M = support::sparse(M),
          .H = support::sparse(H),
          .G = support::sparse(G),
          .f = random.normals(m),
          .w = random.normals(d * contacts),
          .b = random.normals(constraints)};
}

}  // namespace perp::contact::test

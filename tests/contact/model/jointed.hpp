// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Scenes whose bodies are held together.
#include "contact/scenes/generators.hpp"
#include "support/matrices.hpp"

namespace perp::contact::test {

/// The scene with these many pairs of neighbours, 0 and 1, 2 and 3, .. as bodies of 6 velocities, that turn and move as
/// one in one direction each; `unsymmetric` is what rounding has made of one entry of M.
inline Problem jointed(const char* name, Index contacts, Index joints, double unsymmetric = 0) {
  const Problem scene = make_scene(name, contacts).problem();
  Global global = *scene.global;
  support::Triplets G;
  int column = 0;
  for (int pair = 0; pair < joints && 12 * pair + 11 < global.M.rows(); ++pair)
    for (const int axis : {pair % 3, 3 + pair % 3}) {
      G.emplace_back(12 * pair + axis, column, 1);
      G.emplace_back(12 * pair + 6 + axis, column++, -1);
    }
  global.G = SpMat(global.M.rows(), column);
  global.G.setFromTriplets(G.begin(), G.end());
  global.b = Vec::Zero(column);
  if (unsymmetric != 0) {
    global.M.coeffRef(0, 1) += unsymmetric * global.M.coeff(0, 0);
    global.M.makeCompressed();
  }
  return condense(std::move(global), scene.mu, 3, std::string("jointed ") + name);
}

}  // namespace perp::contact::test

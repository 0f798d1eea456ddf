// SPDX-License-Identifier: Apache-2.0
#include "contact/model/bodies_matrix.hpp"

#include <gtest/gtest.h>

#include "contact/model/random_global.hpp"

namespace perp::contact {
namespace {

using support::Dense;

/// diag(E_a), of the contacts' sizes.
Dense block_diagonal(const Scaled& problem, const std::vector<Eigen::Matrix3d>& E) {
  Dense out = Dense::Zero(problem.size(), problem.size());
  for (std::size_t a = 0; a < E.size(); ++a) {
    const Scaled::Block& block = problem.blocks[a];
    out.block(block.first, block.first, block.size, block.size) = E[a].topLeftCorner(block.size, block.size);
  }
  return out;
}

// The matrix against what it stands for, in 2D and 3D, with contacts without friction, contacts of one body and of two.
// Catches entries in wrong places, an upper triangle that is left as it was, what an E has beyond its contact's size.
TEST(BodiesMatrix, IsWhatItSays) {
  test::Random random(3);
  for (const int d : {2, 3})
    for (int k = 0; k < 5; ++k) {
      Vec mu = random.normals(8).cwiseAbs();
      mu[2] = 0;
      const Problem problem = condense(test::random_global(random, d, 4, 8, 0), mu, d);
      const Scaled coordinates = scaled(problem, true, WForm::Parts);
      ASSERT_NE(coordinates.W.parts(), nullptr);
      const Dense M = coordinates.W.parts()->M();
      const Dense H = coordinates.W.parts()->H();
      BodiesMatrixOf<3> matrix(coordinates);
      std::vector<Eigen::Matrix3d> E(8);
      for (int round = 0; round < 2; ++round) {  // nothing is left of the first
        for (Eigen::Matrix3d& e : E) e = random.normals(3, 3);
        const Dense whole = M + H * block_diagonal(coordinates, E) * H.transpose();
        matrix.assemble(E);
        EXPECT_LE((Dense(matrix.matrix()) - whole).norm(), 1e-13 * whole.norm());
        Vec scale;
        const Dense unit = matrix.with_unit_diagonal(scale);
        EXPECT_LE((unit - scale.asDiagonal() * whole * scale.asDiagonal()).norm(), 1e-13 * unit.norm());
        for (Eigen::Matrix3d& e : E) e = (e + e.transpose()).eval();
        const Dense symmetric = M + H * block_diagonal(coordinates, E) * H.transpose();
        matrix.assemble_lower(E);
        const Dense lower = (Dense(matrix.matrix()) - symmetric).triangularView<Eigen::Lower>();
        EXPECT_LE(lower.norm(), 1e-13 * symmetric.norm());
      }
    }
}

}  // namespace
}  // namespace perp::contact

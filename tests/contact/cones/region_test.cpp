// SPDX-License-Identifier: Apache-2.0
/// Coulomb's law at some contacts while the others are held.
#include "contact/cones/region.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "contact/scenes/generators.hpp"
#include "support/matrices.hpp"

namespace perp::contact {
namespace {

using support::Dense;
using support::Random;
using Block = Eigen::Matrix3d;

// Source: the laws that contact/cones/region.hpp states. For any impulses of the region, the others' velocities must be
// -D (r - r0), and those of the region what its own problem says. By contacts and by bodies, and after the region has
// grown. Catches a wrong sign or weight of the elimination, and columns in another order than the contacts.
TEST(Region, TheOthersAreHeldAndItsVelocitiesAreThoseOfAll) {
  for (const bool bodies : {false, true}) {
    SCOPED_TRACE(bodies ? "by bodies" : "by contacts");
    Random random(5);
    Scaled problem = scaled(make_scene("spheres", 60, 3).problem());
    if (!bodies) (void)problem.W.given();
    const auto n = problem.blocks.size();
    std::vector<Block> D;
    std::vector<Block> inverse;
    for (std::size_t a = 0; a < n; ++a) {
      const Block X = Dense(random.normals(3, 3));
      D.emplace_back(0.1 * X * X.transpose() + 0.01 * Block::Identity());
      inverse.emplace_back(D.back().inverse());
    }
    Vec r0 = Dense(random.normals(problem.size(), 1));
    for (const Scaled::Block& block : problem.blocks) r0[block.first] = 10;
    ContactSystem system(problem);
    Region region(problem, system, D, inverse, r0, {7, 2, 11});
    ASSERT_TRUE(region.factor());
    std::vector<std::size_t> inside{7, 2, 11};
    for (int round = 0; round < 2; ++round) {
      const Problem small = region.problem();
      ASSERT_EQ(small.contacts(), static_cast<Index>(inside.size()));
      const Vec own = Dense(random.normals(3 * small.contacts(), 1));
      const Vec r = region.whole(own);
      const Vec u = problem.W * r + problem.q;
      const Vec own_u = small.W * own + small.q;
      const Vec slips = region.slips(own_u);
      EXPECT_EQ((slips.array() > 0).count(), small.contacts());
      EXPECT_EQ(slips[static_cast<Index>(inside[1])], own_u.segment<2>(4).norm());
      for (std::size_t k = 0; k < inside.size(); ++k) {
        const Scaled::Block& block = problem.blocks[inside[k]];
        const auto i = 3 * static_cast<Index>(k);
        EXPECT_LE((block.of(r) - own.segment<3>(i)).norm(), 1e-8);
        EXPECT_LE((block.of(u) - own_u.segment<3>(i)).norm(), 1e-8);
      }
      for (std::size_t a = 0; a < n; ++a) {
        if (std::find(inside.begin(), inside.end(), a) != inside.end()) continue;
        const Scaled::Block& block = problem.blocks[a];
        EXPECT_LE((block.of(u) + D[a] * (block.of(r) - block.of(r0))).norm(), 1e-8);
      }
      Vec out = r0;  // three contacts out of the cone
      for (const std::size_t a : {0, 5, 9}) out[problem.blocks[a].first] = -1;
      if (round > 0) continue;
      for (std::size_t a = 0; a < n; ++a) out.segment<2>(problem.blocks[a].first + 1).setZero();
      const std::vector<std::size_t> leaving = region.leaving(out);
      ASSERT_EQ(leaving, (std::vector<std::size_t>{0, 5, 9}));
      region.grow(leaving);
      ASSERT_TRUE(region.leaving(out).empty());
      inside.insert(inside.end(), {0, 5, 9});
    }
  }
}

}  // namespace
}  // namespace perp::contact

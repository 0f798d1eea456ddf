// SPDX-License-Identifier: Apache-2.0
/// The judge on the recorded problems: it must see in the reference solutions what the solver that made them saw.
#include <gmock/gmock.h>

#include <array>

#include "contact/contact_support.hpp"

namespace perp::contact {
namespace {

/// Rounding of W r + q, relative to the sizes the metric divides by.
constexpr double rounding = 2e-13;

// Catches a misread matrix (rows for columns, blocks), a wrong metric, a wrong projection: each changes the residual of
// a solution from 1e-12 to something that is seen.
TEST(Recorded, ReferencesAreSolutions) {
  SKIP_WITHOUT_RECORDED_PROBLEMS();
  for (const Reference& ref : references()) {
    SCOPED_TRACE(ref.file);
    const Problem p = recorded(ref.file);
    const Solution s = ref.solution();
    const Residual e = residual(p, s.r);
    EXPECT_EQ(p.contacts(), ref.contacts);
    EXPECT_NEAR(e.siconos, ref.siconos, rounding + 0.01 * ref.siconos);
    const double scale = ref.siconos > 0 ? ref.natural / ref.siconos : 1;
    EXPECT_NEAR(e.natural, ref.natural, rounding * scale + 0.01 * ref.natural);
    EXPECT_LE(e.scaled, 2e-11);
    EXPECT_TRUE(accepted(e, 1e-8)) << e.largest();
    EXPECT_LE((p.W * s.r + p.q - s.u).norm(), 1e-12 * (p.q.norm() + s.u.norm()));
  }
}

// Catches margins and thresholds that tell a sticking contact from a slipping one by the rounding of its velocity.
TEST(Recorded, States) {
  SKIP_WITHOUT_RECORDED_PROBLEMS();
  int same = 0;
  for (const Reference& ref : references()) {
    SCOPED_TRACE(ref.file);
    const Problem p = recorded(ref.file);
    const Vec r = ref.solution().r;
    std::array<Index, 3> count{};
    for (const ContactState& c : states(p, r)) {
      ++count[static_cast<std::size_t>(c.state)];
      EXPECT_GE(c.margin, -1e-6 * (r.lpNorm<Eigen::Infinity>() + p.q.lpNorm<Eigen::Infinity>()));
    }
    EXPECT_LE(count[2], ref.slip);
    same += count == std::array<Index, 3>{ref.open, ref.stick, ref.slip} ? 1 : 0;
  }
  // Where bodies rest the record makes slip of contacts at their limit of friction whose |u_T| is 1e-17.
  EXPECT_GE(same, 27);
}

// Solutions of one problem are none of another: any impulse 1 % larger is seen.
TEST(Recorded, NearbyPointsAreNoSolutions) {
  SKIP_WITHOUT_RECORDED_PROBLEMS();
  for (const Reference& ref : references()) {
    SCOPED_TRACE(ref.file);
    const Problem p = recorded(ref.file);
    Vec r = ref.solution().r;
    if (r.norm() == 0) continue;
    const Residual at = residual(p, r);
    r *= 1.01;
    const Residual near = residual(p, r);
    EXPECT_GT(near.scaled, 1e3 * at.scaled + 1e-8);
    EXPECT_FALSE(accepted(near, 1e-8)) << near.largest();
  }
}

}  // namespace
}  // namespace perp::contact

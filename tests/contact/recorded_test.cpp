/// The judge on the recorded problems: it must see in the reference solutions what the solver that made them saw.
#include <gtest/gtest.h>

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
    EXPECT_LE((p.W * s.r + p.q - s.u).norm(), 1e-12 * (p.q.norm() + s.u.norm()));
  }
}

}  // namespace
}  // namespace perp::contact

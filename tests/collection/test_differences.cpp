// SPDX-License-Identifier: Apache-2.0
// The collection without its Jacobians: J by coloured differences on its patterns.
#include <gtest/gtest.h>

#include "each_entry.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::ncp::collection {
namespace {

/// The same problem with nothing but F and the pattern.
std::unique_ptr<Mcp> without_J(const Mcp& mcp, bool central) {
  return make_mcp({.name = mcp.name(),
                   .box = mcp.box(),
                   .pattern = mcp.jacobian_pattern(),
                   .F = [&mcp](In x, Out F) { return mcp.eval(x, F); },
                   .differences = {.central = central}});
}

/// Largest |D - J| / max(1, |J|, |F|): rounding in F limits what a difference can tell.
double worst_gap(const Mcp& mcp, const Vec& x, bool central) {
  SpMat J = mcp.jacobian_pattern(), D = J;
  Vec F = Vec::Zero(x.size());
  if (!mcp.eval(x, F) || !mcp.jacobian(x, J)) return 0;
  const auto differences = without_J(mcp, central);
  if (!differences->jacobian(x, D)) return infinity;
  double worst = 0;
  for (Index j = 0; j < J.cols(); ++j)
    for (SpMat::InnerIterator a(J, j), b(D, j); a; ++a, ++b)
      worst =
          std::max(worst, std::abs(a.value() - b.value()) / std::max({1.0, std::abs(a.value()), std::abs(F[a.row()])}));
  return worst;
}

class EachDifference : public EachEntry {};
INSTANTIATE_TEST_SUITE_P(Collection, EachDifference, each_name(), test_name);

// J by differences against the problem's own, in the box beside the first start. The error is curvature times the step:
// 1e-8 and 1e-10 relative to second and third derivatives, of which these problems have up to 1e4. Catches a group
// whose columns share a row, a value put into another place, and central differences that are no better.
TEST_P(EachDifference, AgreesWithTheProblemsOwnJacobian) {
  const Problem problem = entry.make();
  const Box& box = problem.mcp->box();
  Vec x = lcp::project(box, problem.starts.front());
  for (Index i = 0; i < x.size(); ++i) {
    const double moved = x[i] + 0.05 * (0.1 + std::abs(x[i]));  // upwards, from kinks and bounds
    x[i] = moved > box.upper[i] ? 0.5 * (x[i] + box.upper[i]) : moved;
  }
  EXPECT_LE(worst_gap(*problem.mcp, x, false), 1e-4);
  EXPECT_LE(worst_gap(*problem.mcp, x, true), 1e-6);
}

// path from the first start, with J and without. Catches differences that are good enough for a test of derivatives
// only.
TEST_P(EachDifference, SolveWhatTheirJacobianSolves) {
  if (entry.size > 300) GTEST_SKIP() << "size";
  const Problem problem = entry.make();
  const Method method = path({.stop = {.max_time = Seconds(20)}});
  const Result with = solve(*problem.mcp, problem.starts.front(), method);
  const Result without = solve(*without_J(*problem.mcp, false), problem.starts.front(), method);
  EXPECT_TRUE(!with.accepted() || without.accepted()) << without.message;
  EXPECT_EQ(without.stats.J_colours > 0, entry.size > 0);
}

}  // namespace
}  // namespace perp::ncp::collection

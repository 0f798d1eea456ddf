// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the suites of Lemke's method share.
#include <gtest/gtest.h>

#include "lcp/pivoting/lemke.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {

inline LemkeOptions from_ray() {
  LemkeOptions options;
  options.start = LemkeStart::Ray;
  return options;
}

inline PivotResult lemke_ray(const AffineMcp& problem) { return lemke(problem, Vec::Zero(problem.size()), from_ray()); }

/// The classical method of an LCP with covering vector d > 0 and nothing perturbed:  w = q + d z0 + M z  from z0 so
/// large that w > 0. In the normal map's coordinates that is the start x0 = -(q + d z0), where G(x0) = -d z0.
inline PivotResult lemke_covering(const AffineMcp& lcp, const Vec& d, LemkeOptions options = {}) {
  const double z0 = 1 + (-lcp.q).cwiseQuotient(d).maxCoeff();
  options.start = LemkeStart::Regular;
  options.perturbation = 0;
  return lemke(lcp, -(lcp.q + d * std::max(z0, 1.0)), options);
}

/// The normal map  M pi(x) + q + x - pi(x).
inline Vec normal_map(const AffineMcp& problem, const Vec& x) {
  const Vec z = x.cwiseMax(problem.box.lower).cwiseMin(problem.box.upper);
  return problem.M * z + problem.q + x - z;
}

/// Solved, and the independent judge agrees.
inline void expect_solved(const AffineMcp& problem, const PivotResult& result, const char* what = "") {
  EXPECT_EQ(to_string(result.end), "solved") << what << ": t = " << result.t << " after " << result.pivots << " pivots";
  if (!result.solved()) return;
  EXPECT_LT(support::violation(problem, result.z), 2e-9 * (1 + problem.q.lpNorm<Eigen::Infinity>())) << what;
  EXPECT_EQ(result.t, 1) << what;
}

}  // namespace perp::lcp

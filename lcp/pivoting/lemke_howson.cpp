// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/lemke_howson.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "lcp/judge/shared_options.hpp"

namespace perp::lcp {

Vec howson_start(const AffineMcp& problem, Index k) {
  const Vec q = problem.q + problem.M * problem.box.lower;
  double s = 0;
  Index j = -1;
  for (SpMat::InnerIterator it(problem.M, k); it; ++it)
    if (const double needed = -q[it.row()] / it.value(); it.value() > 0 && needed > s) {
      s = needed;
      j = it.row();
    }
  if (j < 0) return {};
  Vec F = q + s * problem.M.col(k);
  double large = 1;
  for (SpMat::InnerIterator it(problem.M, j); it; ++it)
    if (it.value() > 0) large = std::max(large, -2 * F[it.row()] / it.value());
  F += large * problem.M.col(j);
  Vec x = problem.box.lower - F.cwiseAbs();
  x[k] = problem.box.lower[k] + s;
  x[j] = problem.box.lower[j] + (j == k ? s : large);
  return x;
}

void describe(LemkeHowson& m, Fields& f) {
  f.add("lemke_howson_labels", &m.labels, at_least(0), {});
  describe(m.options, f);
  f.hide("lemke_cover");  // no path begins on a ray of its own
}

Result lemke_howson(const AffineMcp& problem, In start, const LemkeHowson& options, const Limits& limits) {
  check_input("lemke-howson", problem, start, limits);
  refuse_invalid("lemke-howson", options);
  const Index n = problem.size();
  for (Index i = 0; i < n; ++i)
    if (std::isinf(problem.box.lower[i]) || problem.box.upper[i] < infinity)
      return judged(problem, start, limits, Status::NotApplicable,
                    "variable " + std::to_string(i + 1) + " is not bounded below only");
  LemkeOptions path_options = options.options;
  path_options.residual_tol = limits.tol;
  path_options.deadline = limits.deadline;
  path_options.interrupted = limits.interrupted;
  Result best = judged(problem, start, limits, Status::Stalled, "no label's path ends in a solution");
  const Index labels = std::min<Index>(n, options.labels);
  for (Index k = 0; k < labels && !best.accepted(); ++k) {
    const Vec x0 = howson_start(problem, k * n / labels);
    if (x0.size() == 0 || !x0.allFinite()) continue;
    const PivotResult path = lemke(problem, x0, path_options);
    const long iterations = best.iterations + path.pivots;
    const int factorizations = best.factorizations + path.refactorizations;
    if (path.residual < best.residual) best = judged(problem, path.z, limits, best.status, best.message);
    best.iterations = iterations;
    best.factorizations = factorizations;
    if (const auto stopped = limits.reached(); stopped && !best.accepted()) {
      best.status = *stopped;
      best.message = std::string(to_string(*stopped));
      break;
    }
  }
  return best;
}

}  // namespace perp::lcp

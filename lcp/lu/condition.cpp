// SPDX-License-Identifier: Apache-2.0
#include "lcp/lu/condition.hpp"

#include <algorithm>
#include <cmath>

namespace perp::lcp {

double norm1(const SpMat& A) {
  double worst = 0;
  for (Index j = 0; j < A.cols(); ++j) worst = std::max(worst, A.col(j).cwiseAbs().sum());
  return worst;
}

double reciprocal_condition(double norm1, Index n, const std::function<void(In, Out)>& solve,
                            const std::function<void(In, Out)>& solve_transposed) {
  if (n == 0) return 1;
  // Maximise ||A^-1 v||_1 over the unit ball by its vertices e_j.
  Vec v = Vec::Constant(n, 1.0 / static_cast<double>(n));
  Vec y(n);
  Vec z(n);
  solve(v, y);
  double estimate = y.lpNorm<1>();
  Vec signs = y.unaryExpr([](double a) { return a < 0 ? -1.0 : 1.0; });
  solve_transposed(signs, z);
  for (int k = 0; k < 4; ++k) {
    Index j = 0;
    const double largest = z.cwiseAbs().maxCoeff(&j);
    if (k > 0 && !(largest > z.dot(v))) break;
    v = Vec::Unit(n, j);
    solve(v, y);
    const double previous = estimate;
    estimate = std::max(previous, y.lpNorm<1>());
    const Vec new_signs = y.unaryExpr([](double a) { return a < 0 ? -1.0 : 1.0; });
    if (new_signs == signs || !(estimate > previous)) break;
    signs = new_signs;
    solve_transposed(signs, z);
  }
  // The alternating vector guards against the estimate's known worst cases.
  for (Index i = 0; i < n; ++i)
    v[i] = (i % 2 ? -1.0 : 1.0) * (1.0 + static_cast<double>(i) / static_cast<double>(std::max<Index>(n - 1, 1)));
  solve(v, y);
  estimate = std::max(estimate, 2 * y.lpNorm<1>() / (3 * static_cast<double>(n)));
  const double condition = norm1 * estimate;
  return std::isfinite(condition) && condition > 0 ? std::min(1.0, 1 / condition) : 0;
}

}  // namespace perp::lcp

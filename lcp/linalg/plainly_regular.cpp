// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/plainly_regular.hpp"

#include "lcp/dense_factors.hpp"

namespace perp::lcp {

bool plainly_regular(const SpMat& B) {
  constexpr Index small = 40;
  constexpr double far = 1e-9;
  if (B.rows() > small) return false;
  if (B.rows() == 0) return true;
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu{Eigen::MatrixXd(B)};
  const Vec pivots = lu.matrixLU().diagonal().cwiseAbs();  // the estimate counts on there being none of 0
  return pivots.minCoeff() > far * pivots.maxCoeff() && lu.rcond() > far;
}

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// GMRES without restarts (Saad & Schultz, SIAM J. Sci. Stat. Comput. 7 (1986) 856), for systems that are near the
/// identity and whose products cost much more than vectors do.
#include <optional>

#include "lcp/dense_factors.hpp"
#include "lcp/types.hpp"

namespace perp::lcp {

/// x with |b - A x| <= tol |b|, product(v) = A v. Nothing where `most` products do not lead there, or one is not
/// finite. Vectors are made orthogonal twice.
template <class Product>
std::optional<Vec> gmres(const Product& product, In b, double tol, int most) {
  const double size = b.norm();
  if (size == 0) return Vec::Zero(b.size());
  Eigen::MatrixXd V(b.size(), most + 1);
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(most + 1, most);
  V.col(0) = b / size;
  for (int k = 0; k < most; ++k) {
    Vec w = product(Vec(V.col(k)));
    if (!w.allFinite()) return std::nullopt;
    for (int pass = 0; pass < 2; ++pass) {
      const Vec h = V.leftCols(k + 1).transpose() * w;
      w -= V.leftCols(k + 1) * h;
      H.col(k).head(k + 1) += h;
    }
    H(k + 1, k) = w.norm();
    const auto projected = H.topLeftCorner(k + 2, k + 1);
    const Vec right = size * Vec::Unit(k + 2, 0);
    const Vec y = Eigen::MatrixXd(projected).colPivHouseholderQr().solve(right);
    if ((projected * y - right).norm() <= tol * size) return Vec(V.leftCols(k + 1) * y);
    if (H(k + 1, k) == 0) return std::nullopt;
    V.col(k + 1) = w / H(k + 1, k);
  }
  return std::nullopt;
}

}  // namespace perp::lcp

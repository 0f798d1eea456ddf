// SPDX-License-Identifier: Apache-2.0
#include "lcp/cholesky/symmetric.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace perp::lcp {

bool symmetric(const SpMat& J, double tol) {
  if (J.rows() != J.cols()) return false;
  if (!J.isCompressed()) {
    SpMat compressed = J;
    compressed.makeCompressed();
    return symmetric(compressed, tol);
  }
  const Vec size = J.diagonal().cwiseAbs().cwiseSqrt();
  // Column by column the entries (i, j), i > j, meet their mirror images, which come in the same order in column i if
  // rows are ascending within columns: next[i] is the first of column i not met.
  std::vector<int> next(J.outerIndexPtr(), J.outerIndexPtr() + J.cols());
  const auto close = [&](Index i, Index j, double a, double b) {
    return std::abs(a - b) <= tol * std::max({std::abs(a), std::abs(b), size[i] * size[j]});
  };
  for (int j = 0; j < J.cols(); ++j) {
    for (; next[at(j)] < J.outerIndexPtr()[j + 1]; ++next[at(j)]) {
      const int s = next[at(j)];
      const int i = J.innerIndexPtr()[s];
      if (i == j) continue;
      if (i < j) {  // left over: column i had no (j, i)
        if (!close(i, j, J.valuePtr()[s], 0)) return false;
        continue;
      }
      int& t = next[at(i)];
      while (t < J.outerIndexPtr()[i + 1] && J.innerIndexPtr()[t] < j) {
        if (!close(J.innerIndexPtr()[t], i, J.valuePtr()[t], 0)) return false;
        ++t;
      }
      const bool mirrored = t < J.outerIndexPtr()[i + 1] && J.innerIndexPtr()[t] == j;
      if (!close(i, j, J.valuePtr()[s], mirrored ? J.valuePtr()[t] : 0)) return false;
      if (mirrored) ++t;
    }
  }
  return true;
}

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/blocks.hpp"

namespace perp::lcp {

SpMat principal_block(const SpMat& M, const std::vector<Index>& I) {
  std::vector<int> place(static_cast<std::size_t>(M.rows()), -1);
  for (std::size_t k = 0; k < I.size(); ++k) place[static_cast<std::size_t>(I[k])] = static_cast<int>(k);
  const auto m = static_cast<Index>(I.size());
  SpMat block(m, m);
  Index most = 0;
  for (const Index j : I) most += M.outerIndexPtr()[j + 1] - M.outerIndexPtr()[j];
  block.reserve(most);
  bool sorted = true;
  for (Index k = 0; k < m; ++k) {
    block.startVec(k);
    int last = -1;
    for (SpMat::InnerIterator it(M, I[static_cast<std::size_t>(k)]); it; ++it) {
      const int row = place[static_cast<std::size_t>(it.row())];
      if (row < 0) continue;
      sorted = sorted && row > last;
      last = row;
      block.insertBackByOuterInnerUnordered(k, row) = it.value();
    }
  }
  block.finalize();
  if (!sorted) block = SpMat(Eigen::SparseMatrix<double, Eigen::RowMajor, int>(block));
  return block;
}

SpMat least_squares_system(const SpMat& H, double nu) {
  const auto m = static_cast<int>(H.rows());
  const auto n = static_cast<int>(H.cols());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(2 * H.nonZeros() + m + n));
  for (int i = 0; i < m; ++i) entries.emplace_back(i, i, 1);
  for (int j = 0; j < n; ++j) {
    entries.emplace_back(m + j, m + j, -nu);
    for (SpMat::InnerIterator it(H, j); it; ++it) {
      entries.emplace_back(static_cast<int>(it.row()), m + j, it.value());
      entries.emplace_back(m + j, static_cast<int>(it.row()), it.value());
    }
  }
  SpMat K(m + n, m + n);
  K.setFromTriplets(entries.begin(), entries.end());
  return K;
}

bool damped_least_squares(SparseLu& lu, const SpMat& H, In b, double nu, Vec& d) {
  if (lu.factor(least_squares_system(H, nu)) != LuStatus::Ok) return false;
  Vec rhs = Vec::Zero(H.rows() + H.cols());
  rhs.head(H.rows()) = b;
  Vec solution(rhs.size());
  lu.solve_refined(rhs, solution);
  d = solution.tail(H.cols());
  return d.allFinite();
}

}  // namespace perp::lcp

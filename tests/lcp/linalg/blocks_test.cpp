// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "support/problems.hpp"

namespace perp::lcp {
namespace {

// M_II by its definition, for I in any order. Catches columns whose rows are not in order, which the factorizations and
// Eigen's sums take for granted.
TEST(PrincipalBlock, HasTheOrderOfI) {
  support::Random random(1);
  for (const Index n : {1, 2, 7, 30}) {
    support::Dense M = random.normals(n, n);
    M = (M.array().abs() > 0.7).select(M, 0);
    std::vector<Index> I;
    for (Index i = 0; i < n; i += 1 + i % 2) I.push_back(i);
    for (int turn = 0; turn < 3; ++turn) {
      const SpMat block = principal_block(support::sparse(M), I);
      ASSERT_TRUE(block.isCompressed());
      for (Index a = 0; a < block.rows(); ++a)
        for (Index b = 0; b < block.cols(); ++b)
          EXPECT_EQ(block.coeff(a, b), M(I[static_cast<std::size_t>(a)], I[static_cast<std::size_t>(b)]));
      for (Index j = 0; j < block.cols(); ++j) {
        const int* rows = block.innerIndexPtr();
        EXPECT_TRUE(std::is_sorted(rows + block.outerIndexPtr()[j], rows + block.outerIndexPtr()[j + 1]));
      }
      std::rotate(I.begin(), I.begin() + static_cast<std::ptrdiff_t>(I.size() / 3), I.end());
      if (turn == 1) std::reverse(I.begin(), I.end());
    }
  }
}

}  // namespace
}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
/// Sequences of matrices with one pattern, with and without SparseLu::reuse_pivots().
#include <gtest/gtest.h>

#include <string>

#include "lcp/lu/sparse_lu.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Random;

class ReusePivots : public testing::TestWithParam<LuBackend> {};

INSTANTIATE_TEST_SUITE_P(Backends, ReusePivots,
                         testing::Values(LuBackend::General, LuBackend::Klu, LuBackend::Eigen, LuBackend::Dense,
                                         LuBackend::Auto),
                         [](const auto& backend) { return std::string(to_string(backend.param)); });

// The entries change by a little, by much, and to zero. By default no digit depends on the matrices before; pivots that
// are taken again must be as accurate, and give way where they no longer do.
TEST_P(ReusePivots, ASequenceIsSolvedAsEachMatrixAlone) {
  Random random(6);
  SparseLu lu(GetParam());
  SparseLu reusing(GetParam());
  reusing.reuse_pivots();
  for (const Index n : {20, 60, 150}) {
    SpMat A = support::random_sparse(n, 4, random);
    for (int k = 0; k < 12; ++k) {
      for (Index e = 0; e < A.nonZeros(); ++e) A.valuePtr()[e] *= k % 3 == 2 ? random.uniform(-2, 2) : 1.01;
      if (k == 6) A.valuePtr()[n] = 0;
      const Vec b = random.normals(n);
      SparseLu alone(GetParam());
      Vec fresh(n);
      Vec x(n);
      Vec again(n);
      ASSERT_EQ(alone.factor(A), LuStatus::Ok);
      ASSERT_EQ(lu.factor(A), LuStatus::Ok);
      ASSERT_EQ(reusing.factor(A), LuStatus::Ok);
      alone.solve(b, fresh);
      lu.solve(b, x);
      reusing.solve(b, again);
      EXPECT_EQ(x, fresh) << n << ' ' << k;
      const SpMat sizes = A.cwiseAbs();
      const Vec terms = sizes * again.cwiseAbs() + b.cwiseAbs();
      EXPECT_LT((A * again - b).lpNorm<Eigen::Infinity>(), 1e-12 * terms.maxCoeff()) << n << ' ' << k;
    }
  }
}

}  // namespace
}  // namespace perp::lcp

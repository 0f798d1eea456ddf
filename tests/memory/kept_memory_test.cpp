// SPDX-License-Identifier: Apache-2.0
// A kept solver, where no request for memory may come.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <new>

#include "ncp/problem/affine.hpp"
#include "ncp/strategy/kept.hpp"
#include "support/matrices.hpp"

namespace {

long requests = 0;  // of this process: it has one thread

}  // namespace

// The C library's malloc, counted: Eigen, SuiteSparse and operator new call it.
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) noexcept {
  ++requests;
  return __libc_malloc(size);
}

namespace perp {
namespace {

using ncp::KeptSolver;
using ncp::Vec;

constexpr ncp::Index n = 60;

/// An obstacle problem under a load: the contact set stays for small changes of it.
std::unique_ptr<ncp::Mcp> loaded(double load) {
  return ncp::make_affine_mcp(
      {support::tridiagonal(n, -1, 2, -1),
       Vec::NullaryExpr(n, [=](ncp::Index i) { return load - 0.1 * (i > 20 && i < 40); }), lcp::Box::nonnegative(n)},
      "loaded");
}

// The active set of the last solution is that of the next one: factors, solve and judgement find their memory there.
// Catches a copy in the loop.
TEST(Kept, AsksForNoMemoryWhileTheActiveSetRepeats) {
  KeptSolver kept;
  (void)kept.solve(*loaded(0.05), Vec::Zero(n));
  (void)kept.solve(*loaded(0.0501), Vec::Zero(n));
  ASSERT_EQ(kept.by(), KeptSolver::By::Kept);
  for (const double load : {0.0502, 0.0503, 0.05}) {
    const auto mcp = loaded(load);
    const Vec x0 = Vec::Zero(n);
    const long before = requests;
    (void)kept.solve(*mcp, x0);
    EXPECT_EQ(requests, before);
    ASSERT_EQ(kept.by(), KeptSolver::By::Kept);
  }
  EXPECT_GT(requests, 0);  // they are counted
}

}  // namespace
}  // namespace perp

// SPDX-License-Identifier: Apache-2.0
// Running out of memory: SparseLu must say so, keep no half factors, and work when there is memory again.
#include <SuiteSparse_config.h>
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <limits>
#include <new>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "lcp/gpl.hpp"
#include "lcp/lu/basis_factor.hpp"
#include "lcp/lu/sparse_lu.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Random;
using support::sparse;
using support::vec;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif
#else
constexpr bool sanitized = false;
#endif

/// Replaces SuiteSparse's allocator, which is global, while it lives: requests number `first` up to (excluding) `last`,
/// counted from 0, fail.
class FailingAllocator {
 public:
  FailingAllocator(long first, long last) {
    count_ = 0;
    first_ = first;
    last_ = last;
    SuiteSparse_config.malloc_func = [](std::size_t size) { return refused() ? nullptr : std::malloc(size); };
    SuiteSparse_config.calloc_func = [](std::size_t n, std::size_t size) {
      return refused() ? nullptr : std::calloc(n, size);
    };
    SuiteSparse_config.realloc_func = [](void* p, std::size_t size) {
      return refused() ? nullptr : std::realloc(p, size);
    };
  }
  FailingAllocator(const FailingAllocator&) = delete;
  FailingAllocator& operator=(const FailingAllocator&) = delete;
  ~FailingAllocator() {
    SuiteSparse_config.malloc_func = malloc_;
    SuiteSparse_config.calloc_func = calloc_;
    SuiteSparse_config.realloc_func = realloc_;
  }
  static long requests() { return count_; }

 private:
  static bool refused() {
    const long k = count_++;
    return k >= first_ && k < last_;
  }
  static inline long count_ = 0;
  static inline long first_ = 0;
  static inline long last_ = 0;
  decltype(SuiteSparse_config.malloc_func) malloc_ = SuiteSparse_config.malloc_func;
  decltype(SuiteSparse_config.calloc_func) calloc_ = SuiteSparse_config.calloc_func;
  decltype(SuiteSparse_config.realloc_func) realloc_ = SuiteSparse_config.realloc_func;
};

class LuMemory : public testing::TestWithParam<LuBackend> {};

INSTANTIATE_TEST_SUITE_P(Backends, LuMemory, testing::Values(LuBackend::General, LuBackend::Klu),
                         [](const auto& backend) { return std::string(to_string(backend.param)); });

// Every request of memory fails once, alone or with all that follow. Catches a failure taken for singularity, a null
// pointer read, and factors of the last matrix used after the failure.
TEST_P(LuMemory, FactorSaysSoWhicheverRequestFails) {
  Random random(1);
  const SpMat A = support::random_sparse(60, 3, random);
  const SpMat small = support::matrix({{2, 1}, {1, 3}});
  const Vec b = random.normals(60);
  for (const bool one : {false, true}) {
    int failures = 0;
    for (long k = 0;; ++k) {
      SparseLu lu(GetParam());
      ASSERT_EQ(lu.factor(small), LuStatus::Ok);
      LuStatus status = LuStatus::Ok;
      long requests = 0;
      {
        const FailingAllocator failing(k, one ? k + 1 : std::numeric_limits<long>::max());
        status = lu.factor(A);
        requests = FailingAllocator::requests();
      }
      Vec x(60);
      if (status != LuStatus::Ok) {
        ++failures;
        ASSERT_EQ(status, LuStatus::OutOfMemory) << "request " << k;
        EXPECT_EQ(lu.rcond(), 0);
        EXPECT_THROW(lu.solve(b, x), std::logic_error);
        ASSERT_EQ(lu.factor(A), LuStatus::Ok) << "with memory again, after request " << k;
      }
      lu.solve(b, x);
      ASSERT_LT((A * x - b).norm(), 1e-10) << "request " << k;
      if (requests <= k) break;  // the k-th request was never made
    }
    EXPECT_GT(failures, 5);
  }
}

// A solve has no status to answer with: it must throw, or not need memory from the library. Catches x left as it was.
TEST_P(LuMemory, SolveIsRightOrThrows) {
  Random random(2);
  const SpMat A = support::random_sparse(60, 3, random);
  SparseLu lu(GetParam());
  ASSERT_EQ(lu.factor(A), LuStatus::Ok);
  const Vec b = random.normals(60);
  for (const bool transposed : {false, true}) {
    Vec x = Vec::Constant(60, 7);
    bool thrown = false;
    {
      const FailingAllocator failing(0, std::numeric_limits<long>::max());
      try {
        transposed ? lu.solve_transposed(b, x) : lu.solve(b, x);
      } catch (const std::bad_alloc&) {
        thrown = true;
      }
    }
    const Vec Ax = transposed ? Vec(A.transpose() * x) : Vec(A * x);
    EXPECT_TRUE(thrown || (Ax - b).norm() < 1e-10) << transposed;
  }
}

// A basis copies the factors of its block. Catches solves without them where there was no memory for the copy.
TEST(BasisMemory, NothingIsSolvedAfterAFailure) {
  if (!gpl_linked()) GTEST_SKIP() << "only UMFPACK asks for memory to show its factors";
  Random random(4);
  const SpMat A = support::random_sparse(60, 3, random);
  const Vec b = random.normals(60);
  std::vector<Index> columns(60);
  std::iota(columns.begin(), columns.end(), 0);
  int thrown = 0;
  bool made = true;  // the k-th request
  for (long k = 0; made; ++k) {
    BasisFactor basis(A, {.lu = LuBackend::General});
    LuStatus status = LuStatus::OutOfMemory;
    {
      const FailingAllocator failing(k, k + 1);
      try {
        status = basis.factor(columns);
      } catch (const std::bad_alloc&) {
        ++thrown;
      }
      made = FailingAllocator::requests() > k;
    }
    Vec x(60);
    if (status != LuStatus::Ok) {
      EXPECT_THROW(basis.ftran(b, x), std::logic_error) << "request " << k;
      ASSERT_EQ(basis.factor(columns), LuStatus::Ok) << "with memory again, after request " << k;
    }
    basis.ftran(b, x);
    ASSERT_LT((A * x - b).norm(), 1e-10) << "request " << k;
  }
  EXPECT_GT(thrown, 0);
}

std::size_t address_space() {
  std::ifstream statm("/proc/self/statm");
  std::size_t pages = 0;
  statm >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

/// Factors under ever tighter limits of the address space. Exit status: 0 if each answer was Ok or OutOfMemory, and
/// both were among them.
[[noreturn]] void factor_under_limits(LuBackend backend) {
  Random random(3);
  const SpMat A = support::random_sparse(1200, 4, random);  // its factors have about 0.6 million entries
  const SpMat small = support::matrix({{2, 1}, {1, 3}});
  int ok = 0;
  int refused = 0;
  for (std::size_t spare = std::size_t{1} << 28; spare > 1000; spare = spare * 3 / 4) {
    SparseLu lu(backend);
    if (lu.factor(small) != LuStatus::Ok) std::_Exit(2);
    rlimit limit{};
    getrlimit(RLIMIT_AS, &limit);
    limit.rlim_cur = address_space() + spare;
    setrlimit(RLIMIT_AS, &limit);
    const LuStatus status = lu.factor(A);
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_AS, &limit);
    if (status == LuStatus::Ok)
      ++ok;
    else if (status == LuStatus::OutOfMemory)
      ++refused;
    else
      std::_Exit(3);
    Vec x(2);
    if (lu.factor(small) != LuStatus::Ok) std::_Exit(4);
    lu.solve(vec({3, 4}), x);
    if ((x - vec({1, 1})).norm() > 1e-14) std::_Exit(5);
  }
  std::cerr << ok << " ok, " << refused << " out of memory\n";
  std::_Exit(ok > 0 && refused > 0 ? 0 : 6);
}

class AddressSpace : public testing::TestWithParam<LuBackend> {};

INSTANTIATE_TEST_SUITE_P(Backends, AddressSpace, testing::Values(LuBackend::General, LuBackend::Klu, LuBackend::Eigen),
                         [](const auto& backend) { return std::string(to_string(backend.param)); });

// The real thing, in a process of its own. Eigen's SparseLU answers a refused allocation with the status of a singular
// matrix, with that of the factorization before, with std::bad_alloc, or by freeing a vector twice.
TEST_P(AddressSpace, FactorSurvivesItsEnd) {
  if (sanitized) GTEST_SKIP() << "a sanitizer's shadow memory is larger than any limit";
  if (GetParam() == LuBackend::General && dlsym(RTLD_DEFAULT, "openblas_get_config") != nullptr)
    GTEST_SKIP() << "OpenBLAS, which UMFPACK calls here, ends the process itself when it gets no memory";
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(factor_under_limits(GetParam()), testing::ExitedWithCode(0), "ok");
}

}  // namespace
}  // namespace perp::lcp

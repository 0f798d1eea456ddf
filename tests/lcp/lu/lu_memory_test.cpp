// SPDX-License-Identifier: Apache-2.0
// Running out of address space: SparseLu must say so, and not end the process. That each single request may fail is
// tested with the methods (tests/faults).
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iostream>

#include "lcp/lu/sparse_lu.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {
namespace {

using support::Random;
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

// SPDX-License-Identifier: Apache-2.0
#include "lcp/memory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace perp::lcp {
namespace {

// Catches a file of the system that is read wrongly: nothing, or more than any machine has.
TEST(Memory, IsThereAndNotEndless) {
  EXPECT_GT(available_memory(), 1e7);
  EXPECT_LT(available_memory(), 1e14);
}

TEST(Memory, Text) {
  EXPECT_EQ(memory_text(0), "0 bytes");
  EXPECT_EQ(memory_text(999), "999 bytes");
  EXPECT_EQ(memory_text(1536), "1.5 kB");
  EXPECT_EQ(memory_text(24e9), "24 GB");
  EXPECT_EQ(memory_text(999.9e6), "1.0 GB");
  EXPECT_EQ(memory_text(2e22), "20000 EB");
}

// A file of 60 bytes may announce anything. Catches a refusal without its figures.
TEST(Memory, WhatIsTooMuchIsRefusedWithTheFigure) {
  require_memory(1e6, "the vectors");
  try {
    require_memory(1e17, "the vectors");
    FAIL();
  } catch (const std::bad_alloc& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("the vectors need 100 PB, "));
    EXPECT_THAT(error.what(), testing::EndsWith(" are available"));
  }
}

TEST(Memory, FactorsThatAreTooMuchAreRefused) {
  EXPECT_NO_THROW(require_factors(100, 1e6));
  EXPECT_THROW(require_factors(100, 1e18), NotEnoughMemory);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
// `ulimit -v`: what the process has counts. In a child, whose limit is its own.
TEST(Memory, TheLimitOfTheAddressSpaceCounts) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const rlimit limit{.rlim_cur = rlim_t{2} << 30, .rlim_max = RLIM_INFINITY};
    setrlimit(RLIMIT_AS, &limit);
    const double left = available_memory();
    _exit(left < 2.2e9 && left > 0 ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}
#endif

}  // namespace
}  // namespace perp::lcp

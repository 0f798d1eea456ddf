// SPDX-License-Identifier: Apache-2.0
#include "app/program/bounded_call.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <stdexcept>
#include <thread>

namespace perp::app {
namespace {

using namespace std::chrono_literals;

TEST(BoundedCall, ComesBack) {
  int value = 0;
  EXPECT_FALSE(bounded_call([&value] { value = 7; }, {}));
  EXPECT_EQ(value, 7);
}

// Catches exceptions that end the process on the other thread.
TEST(BoundedCall, WhatItThrowsIsThrownHere) {
  EXPECT_THROW(bounded_call([] { throw std::invalid_argument("no"); }, {}), std::invalid_argument);
}

// A call that looks at the flag or the clock itself has `grace` to come back. Catches a wait that ends with the limit.
TEST(BoundedCall, WaitsForThoseThatLookThemselves) {
  std::atomic<bool> flag{true};
  EXPECT_FALSE(bounded_call([] { std::this_thread::sleep_for(grace / 10); }, {.interrupt = &flag}));
  EXPECT_FALSE(bounded_call([] { std::this_thread::sleep_for(grace / 10); }, {.deadline = Clock::now()}));
}

/// Does not end before it is told to, nor before that is seen.
struct Deaf {
  std::atomic<bool> end{false};
  std::atomic<bool> ended{false};
  void run() {
    while (!end) std::this_thread::sleep_for(1ms);
    ended = true;
  }
};

TEST(BoundedCall, LeavesDeafOnesBehind) {
  const auto deaf = std::make_shared<Deaf>();
  EXPECT_EQ(bounded_call([deaf] { deaf->run(); }, {.deadline = Clock::now()}), GivenUp::TimeLimit);
  std::atomic<bool> flag{true};
  EXPECT_EQ(bounded_call([deaf] { deaf->run(); }, {.interrupt = &flag}), GivenUp::Interrupted);
  EXPECT_TRUE(calls_left_behind());
  EXPECT_FALSE(deaf->ended);
  deaf->end = true;
  while (!deaf->ended) std::this_thread::sleep_for(1ms);
}

// Limits of a century and of infinity. Catches deadlines that overflow to the past.
TEST(BoundedCall, LongLimits) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double seconds : {3e9, 1e300, infinity})
    EXPECT_GT(patience(std::chrono::duration<double>(seconds), nullptr).deadline, Clock::now() + 24h) << seconds;
  EXPECT_FALSE(bounded_call([] {}, patience(std::chrono::duration<double>(infinity), nullptr)));
}

}  // namespace
}  // namespace perp::app

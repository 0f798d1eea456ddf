// SPDX-License-Identifier: Apache-2.0
/// Two solves may run in two threads (CONTRIBUTING.md). Under PERP_SANITIZE=thread this finds data races; here it finds
/// state that one solve leaves to another.
#include <gtest/gtest.h>

#include <barrier>
#include <functional>
#include <thread>

#include "ncp/strategy/solve.hpp"
#include "support/methods.hpp"
#include "support/problems.hpp"

namespace perp::ncp {
namespace {

/// What a solve did, to the bit.
struct Trace {
  Result result;
  std::vector<Iteration> records;
};

Trace trace(const Functions& functions, const Vec& x0, const Method& method) {
  Trace out;
  out.result = solve(*make_mcp(functions), x0, method, record(out.records));
  return out;
}

void expect_same(const Trace& a, const Trace& b) {
  EXPECT_EQ(a.result.status, b.result.status);
  EXPECT_EQ(a.result.message, b.result.message);
  EXPECT_EQ(a.result.x, b.result.x);
  EXPECT_EQ(a.result.F, b.result.F);
  EXPECT_EQ(a.result.stats.iterations, b.result.stats.iterations);
  EXPECT_EQ(a.result.stats.F_evals, b.result.stats.F_evals);
  EXPECT_EQ(a.result.stats.J_evals, b.result.stats.J_evals);
  EXPECT_EQ(a.result.stats.factorizations, b.result.stats.factorizations);
  EXPECT_EQ(a.result.stats.pivots, b.result.stats.pivots);
  ASSERT_EQ(a.records.size(), b.records.size());
  for (std::size_t k = 0; k < a.records.size(); ++k) {
    EXPECT_EQ(a.records[k].residual, b.records[k].residual) << k;
    EXPECT_EQ(a.records[k].merit, b.records[k].merit) << k;
    EXPECT_EQ(a.records[k].step, b.records[k].step) << k;
  }
}

using Work = std::function<Trace()>;

/// One after the other, then both at once, again and again.
void expect_independent(const Work& first, const Work& second, int rounds) {
  const Trace one = first();
  const Trace two = second();
  expect_same(one, first());
  expect_same(two, second());
  std::barrier together(2);
  const auto repeat = [&together, rounds](const Work& work) {
    std::vector<Trace> out;
    for (int k = 0; k < rounds; ++k) {
      together.arrive_and_wait();
      out.push_back(work());
    }
    return out;
  };
  std::vector<Trace> beside;
  std::vector<Trace> here;
  {
    const std::jthread other([&] { beside = repeat(first); });
    here = repeat(second);
  }
  for (const Trace& each : beside) expect_same(one, each);
  for (const Trace& each : here) expect_same(two, each);
}

TEST(Threads, TwoSolvesAtOnceAnswerAsOneAfterTheOther) {
  for (const auto& [first_name, first] : support::methods())
    for (const auto& [second_name, second] : support::methods()) {
      SCOPED_TRACE(first_name + " beside " + second_name);
      expect_independent([&first = first] { return trace(support::nash10(), Vec::Constant(10, 100), first); },
                         [&second = second] { return trace(support::obstacle(8), Vec::Zero(64), second); }, 20);
    }
}

// With escapes, which solve perturbed problems inside, and KLU, whose workspace is part of its factors.
TEST(Threads, TwoSolvesAtOnceWithEscapesAndKlu) {
  const SemismoothNewton klu{.lu = lcp::LuBackend::Klu};
  const NewtonJosephy josephy{.lemke = {.basis = {.lu = lcp::LuBackend::Klu}}};
  expect_independent([&] { return trace(support::billups(), Vec::Zero(1), klu); },
                     [&] { return trace(support::kojima_shindo(), Vec::Constant(4, 100), josephy); }, 30);
}

// Restarts, presolve and pivoting, with a list of attempts in each run.
TEST(Threads, TwoSolvesAtOnceWithRestarts) {
  const PathSearch pivoting{.crash = {.on = false}};
  expect_independent([] { return trace(support::billups(), Vec::Zero(1), path()); },
                     [&] { return trace(support::obstacle(12), Vec::Zero(144), pivoting); }, 10);
}

// One problem shared by nobody, one method value by both. Catches a method that keeps state in itself.
TEST(Threads, OneMethodServesTwoSolves) {
  for (const auto& [label, method] : support::methods()) {
    SCOPED_TRACE(label);
    const Work work = [&method = method] { return trace(support::kojima_shindo(), Vec::Zero(4), method); };
    expect_independent(work, work, 30);
  }
}

}  // namespace
}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#include "faults/harness.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <optional>

#if defined(__SANITIZE_ADDRESS__)
/// README.md, "Excepted".
extern "C" const char* __lsan_default_suppressions() { return "leak:gsl_matrix_alloc\n"; }
#endif

namespace perp::faults {
namespace {

std::array<char, 256> where{};  // what the handlers print

extern "C" void tell(int signal) {
  constexpr const char* crashed = " crashed, or ended the process\n";
  const char* end = signal == SIGALRM ? " takes too long\n" : crashed;
  (void)!write(STDERR_FILENO, where.data(), std::strlen(where.data()));
  (void)!write(STDERR_FILENO, end, std::strlen(end));
  _exit(1);
}

void watch_signals() {
#if defined(__SANITIZE_ADDRESS__)
  std::signal(SIGALRM, tell);  // the others the sanitizer tells of
#else
  for (const int signal : {SIGALRM, SIGABRT, SIGSEGV, SIGBUS, SIGFPE}) std::signal(signal, tell);
#endif
}

std::optional<long> number(const char* variable) {
  const char* text = std::getenv(variable);
  return text != nullptr ? std::optional(std::atol(text)) : std::nullopt;
}

/// A crash is to name the call, so that it can be run alone.
void mark(const std::string& name, long k) {
  std::snprintf(where.data(), where.size(), "%s, with request %ld failing,", name.c_str(), k);
  constexpr unsigned most_seconds = 60;
  alarm(most_seconds);
}

/// For libraries whose requests are not ours to answer for: what happens, each time in a process of its own.
void try_module(const std::string& name, const Scenario& scenario, const char* module) {
  count_only(module);
  scenario(0);
  const long calls = Armed::calls();
  constexpr int first_code = 100;  // not one that a library ends the process with
  std::array<int, 5> ends{};       // out of memory, right, wrong, crashed, too long
  for (long k = 1; k <= std::min(2000L, calls); ++k) {
    std::fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
      for (const int signal : {SIGALRM, SIGABRT, SIGSEGV}) std::signal(signal, SIG_DFL);
      alarm(10);
      const Outcome outcome = scenario(k);
      if (!outcome.out_of_memory && !outcome.right)
        std::fprintf(stderr, "%s, request %ld: %.160s\n", name.c_str(), k, outcome.all.c_str());
      _exit(first_code + (outcome.out_of_memory ? 0 : outcome.right ? 1 : 2));
    }
    int status = 0;
    waitpid(child, &status, 0);
    const bool slow = WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM;
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) - first_code : -1;
    ++ends[code >= 0 && code <= 2 ? static_cast<std::size_t>(code) : slow ? 4 : 3];
  }
  std::printf("%-40s %7ld requests of %s: %d out of memory, %d right, %d wrong, %d ended the process, %d too long\n",
              name.c_str(), calls, module, ends[0], ends[1], ends[2], ends[3], ends[4]);
  count_only("");
}

}  // namespace

void every_request_fails_once(const std::string& name, const Scenario& scenario, long some) {
  using Clock = std::chrono::steady_clock;
  watch_signals();
  const auto begin = Clock::now();
  mark(name, 0);
  scenario(0);  // what is made once, tables and locales, is made here
  const Outcome usual = scenario(0);
  const long calls = Armed::calls();
  ASSERT_TRUE(usual.right && !usual.out_of_memory) << name << ": " << usual.all;
  ASSERT_EQ(scenario(0).all, usual.all) << name << ": not the same twice";
  const double once = std::chrono::duration<double>(Clock::now() - begin).count() / 3;

  if (const char* module = std::getenv("PERP_FAULT_MODULE")) return try_module(name, scenario, module);
  long first = 1;
  long step = 1;
  long last = std::min(number("PERP_FAULTS").value_or(2000), calls);
  if (const auto alone = number("PERP_FAULT_REQUEST")) {
    first = last = *alone;
    trace(true);
  } else if (!number("PERP_FAULTS")) {
    // Primes, so that the requests of a loop are met at all its places.
    for (const long prime : {1, 2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 53, 67, 83, 101, 131, 163, 199})
      if (step = prime; last / prime <= some) break;
  }
  int without = 0;
  int right = 0;
  for (long k = first; k <= last; k += step) {
    mark(name, k);
    const Outcome outcome = scenario(k);
    if (outcome.out_of_memory)
      ++without;
    else if (outcome.right)
      ++right;
    else
      ADD_FAILURE() << name << ", request " << k << ": " << outcome.all;
    const Outcome after = scenario(0);
    EXPECT_EQ(after.all, usual.all) << name << ": after request " << k << " had failed";
  }
  alarm(0);
  trace(false);
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  std::printf("%-40s %7ld requests, %5d failed: %5d out of memory, %5d right; %.1f s (%.2g s a call)\n", name.c_str(),
              calls, without + right, without, right, seconds, once);
}

}  // namespace perp::faults

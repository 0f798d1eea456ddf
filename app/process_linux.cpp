// SPDX-License-Identifier: Apache-2.0
#include "app/process.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <malloc.h>
#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "app/program/signals.hpp"
#include "lcp/memory.hpp"

namespace perp::app {
namespace {

/// Before the libraries are initialized: a thread that one of them makes then, as OpenBLAS does, would take a signal
/// for which wait_for_signals() waits.
[[gnu::section(".preinit_array"), gnu::used]] void (*const before_libraries)() = block_signals;

bool address_space_is_limited() {
  rlimit limit{};
  return getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
}

/// OpenBLAS' threads cost more than they bring on the fronts of sparse factorizations. Other BLAS have no such
/// function. Under `ulimit -v` each asks for its buffer for ever where there is no room, from before main() on: the
/// program begins once more without them.
void pin_blas(char** argv) {
  void* set = dlsym(RTLD_DEFAULT, "openblas_set_num_threads");
  if (set == nullptr || std::getenv("OPENBLAS_NUM_THREADS") != nullptr) return;
  if (address_space_is_limited() && setenv("OPENBLAS_NUM_THREADS", "1", 1) == 0) execv("/proc/self/exe", argv);
  reinterpret_cast<void (*)(int)>(set)(1);
}

}  // namespace

std::vector<std::string> arguments_of(int argc, char** argv) { return {argv, argv + argc}; }

void begin_process(char** argv, std::atomic<bool>& interrupted) {
  pin_blas(argv);
  mallopt(M_ARENA_MAX, 1);  // one thread works at a time, and each arena takes 64 MB of address space
  wait_for_signals(interrupted);
  std::signal(SIGPIPE, SIG_IGN);  // `perp list | head`: the reader has had enough; files are still written
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit is an error like a full disk
}

/// Returns whether OpenBLAS finds room for the buffer of one thread, 32 MB x 4 (its BUFFER_SIZE); else it asks for
/// ever.
bool can_factor(std::ostream& err) {
  constexpr double buffer = 140e6;
  if (dlsym(RTLD_DEFAULT, "openblas_set_num_threads") == nullptr || !address_space_is_limited()) return true;
  const double available = perp::lcp::available_memory();
  if (available >= buffer) return true;
  err << fmt::format("perp: OpenBLAS needs {} of address space for its buffers, {} are available: raise ulimit -v\n",
                     perp::lcp::memory_text(buffer), perp::lcp::memory_text(available));
  return false;
}

bool reader_has_gone() {
  pollfd reader{.fd = STDOUT_FILENO, .events = POLLOUT, .revents = 0};
  return poll(&reader, 1, 0) > 0 && (reader.revents & POLLERR) != 0;
}

void end_process(int code) { _exit(code); }

}  // namespace perp::app

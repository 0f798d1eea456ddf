// SPDX-License-Identifier: Apache-2.0
/// The program `perp`: its signals, BLAS and exit codes. app/command_line.cpp reads what it is asked for.
#include <dlfcn.h>
#include <fmt/format.h>
#include <malloc.h>
#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>

#include "app/command_line.hpp"
#include "app/commands/ampl_driver.hpp"
#include "app/program/bounded_call.hpp"
#include "app/program/files.hpp"
#include "app/program/signals.hpp"
#include "lcp/memory.hpp"

namespace {

using namespace perp::app;

std::atomic<bool> interrupted{false};

/// Before the libraries are initialized: a thread that one of them makes then, as OpenBLAS does, would take a signal
/// for which wait_for_signals() waits.
[[gnu::section(".preinit_array"), gnu::used]] void (*const before_libraries)() = block_signals;

void set_up_signals() {
  wait_for_signals(interrupted);
  std::signal(SIGPIPE, SIG_IGN);  // `perp list | head`: the reader has had enough; files are still written
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit is an error like a full disk
}

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

/// Whether OpenBLAS finds room for the buffer of one thread, 32 MB x 4 (its BUFFER_SIZE); else it asks for ever.
bool blas_fits(std::ostream& err) {
  constexpr double buffer = 140e6;
  if (dlsym(RTLD_DEFAULT, "openblas_set_num_threads") == nullptr || !address_space_is_limited()) return true;
  const double available = perp::lcp::available_memory();
  if (available >= buffer) return true;
  err << fmt::format("perp: OpenBLAS needs {} of address space for its buffers, {} are available: raise ulimit -v\n",
                     perp::lcp::memory_text(buffer), perp::lcp::memory_text(available));
  return false;
}

/// Whether the command may factor a matrix.
bool factors(const std::vector<std::string>& arguments) {
  constexpr std::array<std::string_view, 3> commands{"solve", "inspect", "contact"};
  return !arguments.empty() && std::ranges::find(commands, arguments[0]) != commands.end();
}

/// A reader who has gone is no error, a full disk is. (errno may be of an earlier write, or lost.)
int checked_output(int code) {
  std::cout.flush();
  if (std::cout) return code;
  pollfd reader{.fd = STDOUT_FILENO, .events = POLLOUT, .revents = 0};
  if (poll(&reader, 1, 0) > 0 && (reader.revents & POLLERR) != 0) return code;
  std::cerr << "perp: standard output cannot be written\n";
  return code == exit_internal ? code : exit_input;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    pin_blas(argv);
    mallopt(M_ARENA_MAX, 1);  // one thread works at a time, and each arena takes 64 MB of address space
    set_up_signals();
    const Guard guard(interrupted);
    const std::string program = argc > 0 ? std::filesystem::path(argv[0]).filename().string() : "perp";
    const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
    const PrintableStream out(std::cout);
    PrintableStream err(std::cerr);
    const Streams streams{std::cout, std::cerr, &err.raw()};
    const bool ampl = is_ampl_call(program, arguments);
    if ((ampl || factors(arguments)) && !blas_fits(streams.err)) return exit_input;
    const int code =
        ampl ? ampl_driver({.program = program,
                            .arguments = arguments,
                            .environment = [](const char* name) -> const char* { return std::getenv(name); }},
                           streams, &interrupted)
             : run_command(arguments, streams, &interrupted);
    const int checked = checked_output(code);
    if (calls_left_behind()) _exit(checked);  // they use what the destructors of the program would take away
    return checked;
  } catch (const std::bad_alloc&) {
    std::cerr << "perp: out of memory\n";
  } catch (const std::exception& error) {
    std::cerr << "perp: internal error: " << error.what() << '\n';
  } catch (...) {
    std::cerr << "perp: internal error\n";
  }
  return exit_internal;
}

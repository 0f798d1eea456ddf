// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A process under limits of wall clock and memory, with everything it starts.
#include <sys/types.h>
#include <atomic>
#include <chrono>
#include <string>
#include <vector>

namespace perp::app::compare {

struct ProcessLimits {
  double seconds = 60;         ///< then SIGTERM
  double grace = 2;            ///< s after it, then SIGKILL
  long long memory_mb = 4096;  ///< resident: of the process, or of all it started; beyond it SIGKILL
};

struct ProcessRequest {
  std::vector<std::string> arguments;  ///< the first is the program's path
  std::string log;                     ///< file for its standard output and error; standard input is empty
  ProcessLimits limits;
  /// It runs others: their memory counts, and it is told by SIGUSR1, not killed, when this process dies.
  bool runs_others = false;
};

struct ProcessEnd {
  enum class Why { Itself, TimeLimit, MemoryLimit, Interrupted, NotStarted };
  Why why = Why::Itself;
  int status = 0;       ///< of wait4
  double seconds = 0;   ///< from its start to its end
  double peak_mb = 0;   ///< largest resident memory, by rusage or, of all it started together, as it was seen
  std::string error{};  ///< NotStarted
};

/// Runs it to its end, in a process group of its own that is killed as a whole, with one thread for BLAS, no core dumps
/// and files of 1 GiB at most. It dies with the calling process, however that ends. Several threads may call at once;
/// a thread that does must not end before the process. `interrupt` (may be null) ends it at once.
ProcessEnd run_process(const ProcessRequest& request, const std::atomic<bool>* interrupt);

/// Kills all that `root` started, directly or not, group and session regardless; not `root` itself.
void kill_descendants(pid_t root);

double seconds_since(std::chrono::steady_clock::time_point begin);
/// "signal 11 (Segmentation fault)".
std::string signal_name(int signal);
/// How a process ended that was to leave a result and has not: the signal, or "exit code 3, no result".
std::string sudden_end(const ProcessEnd& end);
/// The beginning of what a program says, in one line that a terminal can show.
std::string in_one_line(const std::string& text);

}  // namespace perp::app::compare

// SPDX-License-Identifier: Apache-2.0
#include "app/campaign/process.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <thread>

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX leaves its declaration to the program

namespace perp::app::compare {

namespace {

using Clock = std::chrono::steady_clock;

constexpr rlim_t mib = 1 << 20;

// Sanitizers reserve address space by the terabyte.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool limits_address_space = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool limits_address_space = false;
#else
constexpr bool limits_address_space = true;
#endif
#else
constexpr bool limits_address_space = true;
#endif

/// The environment with one thread for every BLAS.
std::vector<std::string> pinned_environment() {
  std::vector<std::string> variables;
  constexpr std::array<std::string_view, 5> threads{"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS",
                                                    "BLIS_NUM_THREADS", "GOTO_NUM_THREADS"};
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string text = *variable;
    if (std::ranges::find(threads, text.substr(0, text.find('='))) == threads.end()) variables.push_back(text);
  }
  for (const std::string_view name : threads) variables.push_back(fmt::format("{}=1", name));
  return variables;
}

/// Everything the child needs, made before the fork: after it, in a program of several threads, nothing may be
/// allocated.
struct Prepared {
  std::vector<std::string> arguments, variables;
  std::vector<char*> argv, envp;
  int log = -1;
  int null = -1;
  pid_t parent = 0;
  int death_signal = SIGKILL;
  rlim_t address_space = RLIM_INFINITY;

  explicit Prepared(const ProcessRequest& request)
      : arguments(request.arguments),
        variables(pinned_environment()),
        log(open(request.log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0666)),
        null(open("/dev/null", O_RDONLY | O_CLOEXEC)),
        parent(getpid()),
        death_signal(request.runs_others ? SIGUSR1 : SIGKILL) {
    for (std::string& argument : arguments) argv.push_back(argument.data());
    for (std::string& variable : variables) envp.push_back(variable.data());
    argv.push_back(nullptr);
    envp.push_back(nullptr);
    // Resident memory is what counts and what is watched; this is for what grows faster than one can look.
    if (limits_address_space && !request.runs_others)
      address_space = 2 * mib * static_cast<rlim_t>(request.limits.memory_mb) + 1024 * mib;
  }
  Prepared(const Prepared&) = delete;
  Prepared& operator=(const Prepared&) = delete;
  ~Prepared() {
    if (log >= 0) close(log);
    if (null >= 0) close(null);
  }
};

void limit(int resource, rlim_t value) {
  rlimit limits{};
  if (getrlimit(static_cast<__rlimit_resource_t>(resource), &limits) != 0) return;
  limits.rlim_cur = std::min(limits.rlim_max, value);
  limits.rlim_max = limits.rlim_cur;
  setrlimit(static_cast<__rlimit_resource_t>(resource), &limits);
}

/// In the child. Async-signal-safe.
[[noreturn]] void become(const Prepared& prepared) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, prepared.death_signal);
  if (getppid() != prepared.parent) _exit(127);  // it died before
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 1024 * mib);
  if (prepared.address_space != RLIM_INFINITY) limit(RLIMIT_AS, prepared.address_space);
  dup2(prepared.null, STDIN_FILENO);
  dup2(prepared.log, STDOUT_FILENO);
  dup2(prepared.log, STDERR_FILENO);
  for (const int signal : {SIGPIPE, SIGXFSZ, SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  execve(prepared.argv[0], prepared.argv.data(), prepared.envp.data());
  _exit(127);
}

/// Resident memory in MiB; 0 if it is gone.
double resident_mb(pid_t pid) {
  std::FILE* file = std::fopen(fmt::format("/proc/{}/statm", pid).c_str(), "re");
  if (file == nullptr) return 0;
  long total = 0;
  long resident = 0;
  const int read = std::fscanf(file, "%ld %ld", &total, &resident);  // NOLINT(cert-err34-c): numbers of the kernel
  std::fclose(file);
  return read == 2 ? static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20) : 0;
}

/// Parent of every process.
std::map<pid_t, pid_t> parents() {
  std::map<pid_t, pid_t> all;
  DIR* processes = opendir("/proc");
  if (processes == nullptr) return all;
  while (const dirent* entry = readdir(processes)) {  // NOLINT(concurrency-mt-unsafe): a stream of our own
    const pid_t pid = std::atoi(static_cast<const char*>(entry->d_name));
    if (pid <= 0) continue;
    std::FILE* file = std::fopen(fmt::format("/proc/{}/stat", pid).c_str(), "re");
    if (file == nullptr) continue;
    std::array<char, 512> text{};
    const std::size_t length = std::fread(text.data(), 1, text.size() - 1, file);
    std::fclose(file);
    // "pid (name) state parent ...": the name may hold anything, also brackets.
    const char* end = std::strrchr(text.data(), ')');
    int parent = 0;
    if (length > 0 && end != nullptr && std::sscanf(end + 1, " %*c %d", &parent) == 1) all[pid] = parent;
  }
  closedir(processes);
  return all;
}

std::vector<pid_t> descendants(pid_t root) {
  const std::map<pid_t, pid_t> all = parents();
  std::vector<pid_t> found;
  for (const auto& [pid, parent] : all) {
    pid_t ancestor = parent;
    for (std::size_t steps = 0; ancestor > 1 && ancestor != root && steps < all.size(); ++steps) {
      const auto next = all.find(ancestor);
      ancestor = next == all.end() ? 0 : next->second;
    }
    if (ancestor == root) found.push_back(pid);
  }
  return found;
}

/// Of it and of all it started.
double tree_mb(pid_t root) {
  double sum = resident_mb(root);
  for (const pid_t pid : descendants(root)) sum += resident_mb(pid);
  return sum;
}

bool has_ended(pid_t pid) {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid == pid;
}

/// The watch over one running process.
class Watch {
 public:
  Watch(pid_t pid, const ProcessRequest& request, const std::atomic<bool>* interrupt)
      : pid_(pid), request_(request), interrupt_(interrupt) {}

  /// Until it has ended; why.
  ProcessEnd::Why until_end() {
    std::chrono::microseconds pause{500};
    constexpr std::chrono::microseconds longest{10'000};
    while (!has_ended(pid_)) {
      look();
      std::this_thread::sleep_for(pause);
      pause = std::min(pause * 5 / 4, longest);
    }
    return why_;
  }
  double seconds() const { return seconds_since(begin_); }
  double largest_mb() const { return largest_mb_; }  // that was seen

 private:
  void look() {
    const ProcessLimits& limits = request_.limits;
    const double now = seconds();
    if (interrupt_ != nullptr && interrupt_->load()) end(ProcessEnd::Why::Interrupted);
    if (now >= limits.seconds && !told_) {
      told_ = true;
      if (why_ == ProcessEnd::Why::Itself) why_ = ProcessEnd::Why::TimeLimit;
      kill(-pid_, SIGTERM);
    }
    if (now >= limits.seconds + limits.grace) end(why_);
    // A look at others reads all of /proc.
    if (request_.runs_others && now < next_look_) return;
    next_look_ = now + 0.05;
    const double mb = request_.runs_others ? tree_mb(pid_) : resident_mb(pid_);
    largest_mb_ = std::max(largest_mb_, mb);
    if (mb > static_cast<double>(limits.memory_mb)) end(ProcessEnd::Why::MemoryLimit);
  }

  void end(ProcessEnd::Why why) {
    why_ = why;
    kill(-pid_, SIGSTOP);  // so that nobody starts another while one after the other dies
    if (request_.runs_others) kill_descendants(pid_);
    kill(-pid_, SIGKILL);
  }

  pid_t pid_;
  const ProcessRequest& request_;
  const std::atomic<bool>* interrupt_;
  Clock::time_point begin_ = Clock::now();
  ProcessEnd::Why why_ = ProcessEnd::Why::Itself;
  bool told_ = false;
  double next_look_ = 0;
  double largest_mb_ = 0;
};

}  // namespace

void kill_descendants(pid_t root) {
  constexpr int rounds = 20;  // what was started meanwhile is found in the next one
  for (int round = 0; round < rounds; ++round) {
    const std::vector<pid_t> found = descendants(root);
    if (found.empty()) return;
    for (const pid_t pid : found) kill(pid, SIGKILL);
    // Those that are gone but not waited for are still there.
    if (std::ranges::all_of(found, [](pid_t pid) { return resident_mb(pid) == 0; })) return;
  }
}

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

std::string signal_name(int signal) {
  const char* name = sigdescr_np(signal);
  return fmt::format("signal {} ({})", signal, name != nullptr ? name : "unknown");
}

std::string sudden_end(const ProcessEnd& end) {
  if (WIFSIGNALED(end.status)) return signal_name(WTERMSIG(end.status));
  return fmt::format("exit code {}, no result", WEXITSTATUS(end.status));
}

std::string in_one_line(const std::string& text) {
  constexpr std::size_t longest = 600;
  std::string line = text.substr(0, longest);
  std::ranges::replace_if(
      line, [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  return line;
}

ProcessEnd run_process(const ProcessRequest& request, const std::atomic<bool>* interrupt) {
  ProcessEnd end;
  const Prepared prepared(request);
  const pid_t pid = prepared.log < 0 || prepared.null < 0 ? -1 : fork();
  if (pid == 0) become(prepared);
  if (pid < 0) {
    end.why = ProcessEnd::Why::NotStarted;
    end.error = std::strerror(errno);  // NOLINT(concurrency-mt-unsafe): glibc's is
    return end;
  }
  setpgid(pid, pid);  // here too: whoever comes first
  Watch watch(pid, request, interrupt);
  end.why = watch.until_end();
  end.seconds = watch.seconds();
  kill(-pid, SIGKILL);  // what it left behind; not waited for yet, the group's number is still its own
  rusage usage{};
  while (wait4(pid, &end.status, 0, &usage) < 0 && errno == EINTR) {
  }
  end.peak_mb = std::max(static_cast<double>(usage.ru_maxrss) / 1024, watch.largest_mb());
  return end;
}

}  // namespace perp::app::compare

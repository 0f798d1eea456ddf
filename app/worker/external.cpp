// SPDX-License-Identifier: Apache-2.0
#include "app/worker/external.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <optional>
#include <regex>
#include <string_view>

#include "app/campaign/process.hpp"
#include "app/problem/problem.hpp"
#include "app/program/files.hpp"
#include "app/program/program.hpp"
#include "app/worker/sol_file.hpp"
#include "ncp/ampl/nl_writer.hpp"

namespace perp::app::compare {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::size_t longest_tail = 400;  // of what it prints

sigset_t death_notice() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGUSR1);
  return set;
}

/// A private copy of the model with the start of the rule, written anew where it is no file; its stub, or nothing.
std::optional<std::string> copy_model(const Task& task, const LoadedProblem& problem) {
  const fs::path stub = fs::path(task.folder) / "model";
  const ncp::Vec x0 = perturbed(problem.mcp->box(), problem.x0, task.rule);
  if (problem.model == nullptr) {
    const std::optional<std::string> text = ncp::ampl::nl_text(*problem.mcp, x0);
    if (!text) return std::nullopt;
    app::write_file(stub.string() + ".nl", *text, lcp::Sync::No);
    return stub.string();
  }
  const std::string text = read_text(task.problem);
  app::write_file(stub.string() + ".nl", task.rule.run > 0 ? nl_with_start(text, x0) : text, lcp::Sync::No);
  for (const char* names : {".col", ".row"}) {
    std::error_code ignored;
    const fs::path source = fs::path(task.problem).replace_extension(names);
    if (fs::is_regular_file(source, ignored)) fs::copy_file(source, stub.string() + names, ignored);
  }
  return stub.string();
}

/// The program while it runs.
class Running {
 public:
  Running(const std::string& command, const std::string& stub) {
    const std::string script = "exec " + command + " \"$0\" -AMPL";
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw input_error("pipe: {}", std::strerror(errno));
    const pid_t parent = getpid();
    pid_ = fork();
    if (pid_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (getppid() != parent) _exit(127);
      dup2(ends[1], STDOUT_FILENO);
      dup2(ends[1], STDERR_FILENO);
      for (const int signal : {SIGPIPE, SIGXFSZ, SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
      sigset_t none;
      sigemptyset(&none);
      sigprocmask(SIG_SETMASK, &none, nullptr);
      execl("/bin/sh", "sh", "-c", script.c_str(), stub.c_str(), nullptr);
      _exit(127);
    }
    close(ends[1]);
    output_ = ends[0];
    if (pid_ < 0) throw input_error("fork: {}", std::strerror(errno));
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
  ~Running() { close(output_); }

  /// Until it ends; its status of wait4. What it leaves running is killed. Where the campaign dies, this process does,
  /// with all it runs.
  int wait() {
    const sigset_t notice = death_notice();
    int status = 0;
    for (bool open = true;;) {
      constexpr timespec at_once{};
      if (sigtimedwait(&notice, nullptr, &at_once) == SIGUSR1) {
        kill_descendants(getpid());
        _exit(exit_internal);
      }
      if (wait4(pid_, &status, WNOHANG, &usage_) == pid_) break;
      if (open)
        open = read_some(10);
      else
        poll(nullptr, 0, 10);
    }
    kill_descendants(getpid());  // before the rest is read: they could write for ever
    while (read_some(0)) {
    }
    return status;
  }
  /// The end of what it printed, in one line.
  std::string tail() const {
    const std::string text = in_one_line(tail_);
    const std::size_t first = text.find_first_not_of(' ');
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') + 1 - first);
  }
  double peak_mb() const { return static_cast<double>(usage_.ru_maxrss) / 1024; }

 private:
  /// Reads what is there, waiting for it at most so long; false at its end, or if there is nothing and no waiting.
  bool read_some(int milliseconds) {
    pollfd reader{.fd = output_, .events = POLLIN, .revents = 0};
    if (poll(&reader, 1, milliseconds) <= 0) return milliseconds > 0;
    std::array<char, 65536> buffer{};
    const ssize_t n = read(output_, buffer.data(), buffer.size());
    if (n <= 0) return false;
    tail_.append(buffer.data(), static_cast<std::size_t>(n));
    if (tail_.size() > longest_tail) tail_.erase(0, tail_.size() - longest_tail);
    return true;
  }

  pid_t pid_ = -1;
  int output_ = -1;
  std::string tail_;
  rusage usage_{};
};

/// "exit code 1", with the signal where a shell reports one so.
std::string exit_text(int status) {
  if (WIFSIGNALED(status)) return signal_name(WTERMSIG(status));
  return fmt::format("exit code {}", WEXITSTATUS(status));
}

/// The signal that ended it or, by a shell's exit code, what it ran; 0 if there was none.
int signal_of(int status) {
  if (WIFSIGNALED(status)) return WTERMSIG(status);
  constexpr int shells_base = 128;
  const int signal = WEXITSTATUS(status) - shells_base;
  return signal > 0 && sigabbrev_np(signal) != nullptr ? signal : 0;
}

void take_sol(Answer& answer, const std::string& text, ncp::Index variables, const std::string& folder) {
  constexpr int solved_below = 100;  // then AMPL's "solved?"
  constexpr int claims_below = 200;
  constexpr int infeasible_below = 300;
  const SolFile sol = parse_sol(text, variables);
  answer.status = fmt::format("solve_result_num {}", sol.code);
  answer.message = sol.message;
  answer.claimed = sol.code >= 0 && sol.code < solved_below;
  answer.to_rounding = sol.code >= solved_below && sol.code < claims_below;
  answer.infeasible = sol.code >= claims_below && sol.code < infeasible_below;
  answer.not_applicable = sol.code == ncp::ampl::not_applicable;
  answer.has_x = sol.x.size() > 0 || variables == 0;
  if ((answer.claimed || answer.to_rounding) && !answer.has_x)
    throw InputError("it claims a solution and gives no values");
  if (answer.has_x) write_point(folder, sol.x);
}

}  // namespace

std::string with_tolerance(const std::string& command, double tol) {
  constexpr std::string_view word = "{tol}";
  std::string text;
  std::size_t from = 0;
  for (std::size_t at = command.find(word); at != std::string::npos; at = command.find(word, at + 1)) {
    if (at > 0 && command[at - 1] == '$') continue;
    text += command.substr(from, at - from) + fmt::format("{}", tol);
    from = at + word.size();
  }
  return text + command.substr(from);
}

std::vector<std::string> unfilled_words(const std::string& command) {
  const std::regex bare("(^|[^$])(\\{[A-Za-z_]+\\})");
  std::vector<std::string> words;
  for (std::sregex_iterator it(command.begin(), command.end(), bare), end; it != end; ++it)
    if ((*it)[2] != "{tol}") words.push_back((*it)[2]);
  return words;
}

Answer run_external(const Task& task) {
  const sigset_t notice = death_notice();
  sigprocmask(SIG_BLOCK, &notice, nullptr);
  prctl(PR_SET_CHILD_SUBREAPER, 1);  // orphans of the program come to this process, which finds and ends them
  const LoadedProblem problem = load_problem(ProblemSource{.problem = task.problem, .start = task.rule.start});
  Answer answer;
  const std::optional<std::string> model = copy_model(task, problem);
  if (!model) {
    answer.not_applicable = true;
    answer.message = "neither an .nl file nor written as one";
    return answer;
  }
  const std::string& stub = *model;
  const Clock::time_point begin = Clock::now();
  Running program(task.method.command, stub);
  const int status = program.wait();
  answer.seconds = seconds_since(begin);
  answer.peak_mb = program.peak_mb();
  while (waitpid(-1, nullptr, WNOHANG) > 0) {
  }
  const std::string said = program.tail();
  const std::string end = exit_text(status) + (said.empty() ? "" : fmt::format("; it said: {}", said));
  if (WIFSIGNALED(status)) {
    answer.crashed = end;
    return answer;
  }
  try {
    std::error_code ignored;
    const std::string path = stub + ".sol";
    if (!fs::is_regular_file(path, ignored)) throw InputError("there is none");
    take_sol(answer, read_text(path), problem.own_variables(), task.folder);
  } catch (const InputError& error) {
    answer.claimed = answer.to_rounding = answer.infeasible = answer.not_applicable = answer.has_x = false;
    if (const int signal = signal_of(status); signal != 0)
      answer.crashed = fmt::format("{} of what it ran; {}", signal_name(signal), end);
    else
      answer.garbage = fmt::format(".sol file: {}; {}", error.what(), end);
  }
  return answer;
}

}  // namespace perp::app::compare

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// perp compare as a process, and shell scripts as its peers.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "app/campaign/cell.hpp"
#include "app/support.hpp"

namespace perp::app::compare {

/// A child whose output goes to files in `folder`.
class Child {
 public:
  Child(const test::Folder& folder, std::vector<std::string> arguments)
      : out_(folder / "stdout.txt"), err_(folder / "stderr.txt") {
    arguments.insert(arguments.begin(), PERP_PROGRAM);
    std::vector<char*> argv;
    argv.reserve(arguments.size() + 1);
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ != 0) return;
    dup2(open(out_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666), STDOUT_FILENO);
    dup2(open(err_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666), STDERR_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
  }
  pid_t pid() const { return pid_; }
  void signal(int number) const { kill(pid_, number); }
  /// The exit code, or minus the signal that ended it.
  int wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  std::string out() const { return test::read(out_); }
  std::string err() const { return test::read(err_); }

 private:
  std::string out_, err_;
  pid_t pid_ = -1;
};

struct Finished {
  int code = 0;
  std::string out, err;
};
inline Finished compare(const test::Folder& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "compare");
  Child child(folder, std::move(arguments));
  const int code = child.wait();
  return {code, child.out(), child.err()};
}

/// Waits until test() holds, at most 20 s.
template <class Test>
bool eventually(Test test) {
  for (int k = 0; k < 4000; ++k) {
    if (test()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

inline bool alive(const std::string& pid_file) {
  const std::string text = test::read(pid_file);
  if (text.empty()) return false;
  const std::string stat = test::read("/proc/" + std::to_string(std::stoi(text)) + "/stat");
  return !stat.empty() && stat.substr(stat.rfind(')') + 2, 1) != "Z";
}

inline Cell only(const std::vector<Cell>& cells, const std::string& method) {
  for (const Cell& cell : cells)
    if (cell.method == method) return cell;
  ADD_FAILURE() << "no cell of " << method;
  return {};
}

/// A .sol file for one variable.
inline std::string sol(const std::string& x, int code) {
  return "peer\n\nOptions\n3\n1\n1\n0\n1\n0\n1\n1\n" + x + "\nobjno 0 " + std::to_string(code) + "\n";
}

/// A shell script that AMPL could call; $1 is the stub.
inline std::string script(const test::Folder& folder, const std::string& name, const std::string& body) {
  const std::string path = folder / (name + ".sh");
  test::write(path, "#!/bin/sh\n" + body + "\n");
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return name + "=" + path;
}

/// cat > $1.sol of that text.
inline std::string writes(const std::string& text) { return "cat > $1.sol <<'END'\n" + text + "END\n"; }

inline std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

}  // namespace perp::app::compare

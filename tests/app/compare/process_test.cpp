// SPDX-License-Identifier: Apache-2.0
/// The program as a process: exit codes, streams, names it is called by, signals, closed pipes.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <optional>

#include "app/commands/solve.hpp"
#include "app/json.hpp"
#include "app/options/options.hpp"
#include "app/support.hpp"

namespace perp::app {
namespace {

using test::Json;
using test::parse_json;
using testing::HasSubstr;

/// A running child whose standard output and error are read through pipes.
class Child {
 public:
  /// `environment` holds NAME=value; the child has no other variables.
  explicit Child(std::vector<std::string> arguments, std::vector<std::string> environment = {},
                 const std::string& program = PERP_PROGRAM) {
    arguments.insert(arguments.begin(), program);
    std::vector<char*> argv, envp;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    for (std::string& variable : environment) envp.push_back(variable.data());
    argv.push_back(nullptr);
    envp.push_back(nullptr);
    std::array<int, 2> out_pipe{}, err_pipe{};
    if (pipe2(out_pipe.data(), O_CLOEXEC) != 0 || pipe2(err_pipe.data(), O_CLOEXEC) != 0)
      throw std::runtime_error("pipe2");
    pid_ = fork();
    if (pid_ == 0) {
      dup2(out_pipe[1], STDOUT_FILENO);
      dup2(err_pipe[1], STDERR_FILENO);
      execve(argv[0], argv.data(), envp.data());
      _exit(127);
    }
    close(out_pipe[1]);
    close(err_pipe[1]);
    out_ = out_pipe[0];
    err_ = err_pipe[0];
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (!status_) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    if (out_ >= 0) close(out_);
    close(err_);
  }

  /// Reads until standard output contains `text`; false if it ends before.
  bool read_until(const std::string& text) {
    while (out.find(text) == std::string::npos)
      if (!read_some()) return false;
    return true;
  }
  /// Reads the rest and waits; the exit code, or minus the signal that ended the child.
  int wait() {
    while (read_some()) {
    }
    int status = 0;
    waitpid(pid_, &status, 0);
    status_ = status;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  void close_output() {
    close(out_);
    out_ = -1;
  }
  void signal(int number) const { kill(pid_, number); }

  std::string out, err;

 private:
  bool read_some() {
    std::array<pollfd, 2> files{pollfd{out_, POLLIN, 0}, pollfd{err_, POLLIN, 0}};
    if (poll(files.data(), 2, 60'000) <= 0) throw std::runtime_error("the child is silent");
    bool open = false;
    for (std::size_t k = 0; k < 2; ++k) {
      if (files[k].revents == 0) continue;
      std::array<char, 4096> buffer{};
      const ssize_t n = ::read(files[k].fd, buffer.data(), buffer.size());
      if (n > 0) (k == 0 ? out : err).append(buffer.data(), static_cast<std::size_t>(n));
      open = open || n > 0;
    }
    return open;
  }

  pid_t pid_ = 0;
  int out_ = -1, err_ = -1;
  std::optional<int> status_;
};

struct Finished {
  int code;
  std::string out, err;
};
Finished run(const std::vector<std::string>& arguments, const std::vector<std::string>& environment = {},
             const std::string& program = PERP_PROGRAM) {
  Child child(arguments, environment, program);
  const int code = child.wait();
  return {code, child.out, child.err};
}

// 0 solved, 1 not solved, 2 wrong usage or input (app/README.md).
TEST(Process, ExitCodes) {
  const test::Folder folder;
  test::write(folder / "infeasible.nl", test::infeasible_nl());
  test::write(folder / "square.nl", test::nonsquare_nl());
  EXPECT_EQ(run({"solve", "kojshin"}).code, 0);
  EXPECT_EQ(run({"solve", folder / "infeasible.nl"}).code, 1);
  EXPECT_EQ(run({"solve", "kojshin", "--max-iterations", "1"}).code, 1);
  const std::vector<std::vector<std::string>> wrong{{"solve"},
                                                    {"solve", folder / "square.nl"},
                                                    {"solve", "no-such-problem"},
                                                    {"solve", "kojshin", "--no-such-flag"},
                                                    {"solve", "kojshin", "--start", "x"},
                                                    {"solve", "kojshin", "--tol", "-1"},
                                                    {"solve", "kojshin", "--log-level", "loud"},
                                                    {"solve", "kojshin", "surplus"},
                                                    {"list", "no-such-problem"},
                                                    {"no-such-command"},
                                                    {"--no-such-flag"}};
  for (const auto& arguments : wrong) {
    const Finished finished = run(arguments);
    EXPECT_EQ(finished.code, 2) << testing::PrintToString(arguments);
    EXPECT_EQ(finished.out, "") << testing::PrintToString(arguments);
    EXPECT_THAT(finished.err, testing::StartsWith("perp")) << testing::PrintToString(arguments);
  }
  EXPECT_EQ(run({}).code, 2);
  EXPECT_THAT(run({}).out, HasSubstr("perp solve"));
}

// A problem that does not fit is an input that is refused, by name; not an internal error.
TEST(Process, OutOfMemoryNamesTheProblem) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need more address space than the limit";
#endif
  const test::Folder folder;
  for (const char* command : {"inspect", "solve"}) {
    const std::string file = folder / "out.json";
    const Finished finished = run({"-c", std::string("ulimit -v 2000000; exec " PERP_PROGRAM " ") + command +
                                             " obstacle:20000x20000 --json " + file},
                                  {"OPENBLAS_NUM_THREADS=1"}, "/bin/sh");
    EXPECT_EQ(finished.code, 2) << command;
    EXPECT_THAT(finished.err, testing::StartsWith("perp: 'obstacle:20000x20000': out of memory")) << command;
    const Json refused = parse_json(test::read(file));
    EXPECT_EQ(refused["status"], "InputError");
    EXPECT_EQ(refused["problem"], "obstacle:20000x20000");
  }
}

TEST(Process, Suggestions) {
  EXPECT_THAT(run({"solv", "kojshin"}).err, HasSubstr("'solve'"));
  EXPECT_THAT(run({"kojshin"}).err, HasSubstr("'perp solve kojshin'"));
  EXPECT_THAT(run({"model.nl"}).err, HasSubstr("'perp solve model.nl'"));
  EXPECT_THAT(run({"solve", "kojshin", "--tool", "3"}).err, HasSubstr("'--tol'"));
  EXPECT_THAT(run({"solve", "kojshim"}).err, HasSubstr("'kojshin'"));
  EXPECT_THAT(run({"solve", "kojshin", "-o", "sigmb=0.1"}).err, HasSubstr("'sigma'"));
}

// Every flag arrives: as the option in force that JSON shows.
TEST(Process, FlagsSetOptions) {
  const Finished finished =
      run({"solve", "kojshin", "--start=3", "--method", "josephy", "--tol", "1e-5", "--max-iterations", "44",
           "--time-limit", "5", "--check-derivatives", "-o", "lu=klu", "--option", "sigma=0.01", "--json", "-"});
  ASSERT_EQ(finished.code, 0) << finished.err;
  const Json parsed = parse_json(finished.out);
  const Json& options = parsed["options"];
  EXPECT_EQ(parsed["start"], 3);
  EXPECT_EQ(parsed["method"], "josephy");
  EXPECT_EQ(options["convergence_tolerance"], 1e-5);
  EXPECT_EQ(options["major_iteration_limit"], 44);
  EXPECT_EQ(options["time_limit"], 5.0);
  EXPECT_EQ(options["check_derivatives"], true);
  EXPECT_EQ(options["lu"], "klu");
  EXPECT_EQ(options["sigma"], 0.01);
}

/// The long flags a help text shows.
std::vector<std::string> flags_in(const std::string& help) {
  std::vector<std::string> flags;
  for (std::size_t at = help.find("\n  "); at != std::string::npos; at = help.find("\n  ", at + 1)) {
    const std::string line = help.substr(at + 1, help.find('\n', at + 1) - at - 1);
    const std::size_t dashes = line.find("--");
    if (line.find_first_not_of(' ') != line.find('-') || dashes == std::string::npos) continue;
    flags.push_back(line.substr(dashes, line.find_first_of(" ,", dashes) - dashes));
  }
  return flags;
}

// Help, man page and completion must know the same flags.
TEST(Process, HelpManPageAndCompletionAgree) {
  const std::string page = test::read(PERP_MAN_PAGE);
  for (const char* command : {"solve", "list", "methods", "cfunctions", "compare"}) {
    const Finished finished = run({command, "--help"});
    EXPECT_EQ(finished.code, 0);
    EXPECT_EQ(run({"help", command}).out, finished.out);
    EXPECT_THAT(finished.out, HasSubstr("Examples:"));
    EXPECT_THAT(run({"--help"}).out, HasSubstr(std::string("\n  ") + command));
    EXPECT_THAT(test::offered("''"), HasSubstr(fmt::format(" {} ", command)));
    const std::string completion = test::offered(fmt::format("{} --", command));
    const std::vector<std::string> flags = flags_in(finished.out);
    EXPECT_THAT(flags, testing::Contains("--help"));
    for (const std::string& flag : flags) {
      EXPECT_THAT(completion, HasSubstr(fmt::format(" {} ", flag)));
      if (flag != "--help") {
        EXPECT_THAT(page, HasSubstr("Fl -" + flag.substr(2)));
      }
    }
  }
  EXPECT_GT(flags_in(run({"solve", "--help"}).out).size(), 10U);
  for (const MethodEntry& method : methods())
    EXPECT_THAT(run({"solve", "--help"}).out, HasSubstr(std::string(method.name)));
}

TEST(Process, Versions) {
  EXPECT_EQ(run({"-v"}).out, version_line() + "\n");
  EXPECT_EQ(run({"--version"}).out, version_text());
  EXPECT_EQ(run({"--version"}).code, 0);
}

// Pyomo's solver `path` runs an executable of the name pathampl: without -AMPL, too.
TEST(Process, Pathampl) {
  const std::string pathampl = std::filesystem::path(PERP_PROGRAM).parent_path() / "pathampl";
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  EXPECT_EQ(run({"-v"}, {}, pathampl).out, version_line() + "\n");
  const Finished finished = run({folder / "m"}, {}, pathampl);
  EXPECT_EQ(finished.code, 0);
  EXPECT_THAT(finished.out, HasSubstr("solution found"));
  EXPECT_THAT(test::read(folder / "m.sol"), HasSubstr("objno 0 0"));
  EXPECT_EQ(run({}, {}, pathampl).code, 2);
}

TEST(Process, AmplReadsTheEnvironment) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  EXPECT_EQ(run({folder / "m", "-AMPL"}, {"path_options=major_iteration_limit=1"}).code, 0);
  EXPECT_THAT(test::read(folder / "m.sol"), HasSubstr("objno 0 400"));
  EXPECT_EQ(run({"solve", folder / "m"}, {"path_options=major_iteration_limit=1"}).code, 0) << "AMPL's calls alone";
}

TEST(Process, ClosedPipeIsNoCrash) {
  const test::Folder folder;
  Child child({"solve", "kojshin", "--json", folder / "out.json"});
  child.close_output();
  EXPECT_EQ(child.wait(), 0) << child.err;
  EXPECT_EQ(parse_json(test::read(folder / "out.json"))["status"], "Solved") << "files are still written";
  EXPECT_EQ(child.err, "");
}

TEST(Process, FullDiskIsAnError) {
  Child child({"-c", std::string("'") + PERP_PROGRAM + "' list > /dev/full"}, {}, "/bin/sh");
  EXPECT_EQ(child.wait(), 2);
  EXPECT_THAT(child.err, HasSubstr("standard output"));
}

/// A run that lasts much longer than the test, and has begun to iterate.
std::vector<std::string> endless(const test::Folder& folder) {
  test::write(folder / "m.nl", test::endless_nl(20'000));
  return {"solve", folder / "m.nl", "--tol", "1e-300", "--json", folder / "out.json"};
}

// Would catch a signal that kills the run without its result, or that nobody listens to.
TEST(Process, FirstSignalEndsTheRunWithItsBestPoint) {
  for (const int number : {SIGINT, SIGTERM}) {
    const test::Folder folder;
    Child child(endless(folder));
    ASSERT_TRUE(child.read_until("\n    1 ")) << child.out << child.err;
    child.signal(number);
    EXPECT_EQ(child.wait(), 1);
    EXPECT_THAT(child.out, HasSubstr("Interrupted:"));
    const Json parsed = parse_json(test::read(folder / "out.json"));
    EXPECT_EQ(parsed["status"], "Interrupted");
    EXPECT_EQ(parsed["variables"].size(), 20'000U);
    // exp(-x) fell from 1 at x = 0, so the best point is not the start.
    EXPECT_LT(parsed["residual"]["natural"].get<double>(), 0.5);
    EXPECT_GT(parsed["variables"][7]["value"].get<double>(), 0.9);
  }
}

TEST(Process, InterruptedRunsAnswerAmpl) {
  const test::Folder folder;
  test::write(folder / "m.nl", test::endless_nl(20'000));
  Child child({folder / "m", "-AMPL", "tol=1e-300", "output=yes"});
  ASSERT_TRUE(child.read_until("\n    1 ")) << child.out << child.err;
  child.signal(SIGINT);
  EXPECT_EQ(child.wait(), 0);
  EXPECT_THAT(test::read(folder / "m.sol"), HasSubstr("objno 0 403"));
}

// The second signal must end the program even where the first is not polled. SIGSTOP holds the child while both arrive.
TEST(Process, SecondSignalKills) {
  const test::Folder folder;
  Child child(endless(folder));
  ASSERT_TRUE(child.read_until("\n    1 ")) << child.out << child.err;
  child.signal(SIGSTOP);
  child.signal(SIGINT);
  child.signal(SIGTERM);
  child.signal(SIGCONT);
  const int code = child.wait();
  EXPECT_TRUE(code == -SIGINT || code == -SIGTERM) << code;
  EXPECT_FALSE(std::filesystem::exists(folder / "out.json"));
}

// Every shared sample must end with an answer, whatever it is, and the malformed ones with a refusal.
TEST(Process, SharedSamples) {
  const std::filesystem::path samples = std::filesystem::path(PERP_SOURCE_DIR) / "../shared/data/nl";
  if (!std::filesystem::exists(samples)) GTEST_SKIP() << "no samples at " << samples;
  for (const auto& entry : std::filesystem::directory_iterator(samples)) {
    const Finished finished = run({"solve", entry.path(), "--json", "-", "--log-level", "quiet"});
    const Json parsed = parse_json(finished.out);
    EXPECT_EQ(parsed["exit_code"], finished.code) << entry.path();
    const bool malformed = entry.path().filename().string().starts_with("malformed");
    if (malformed) {
      EXPECT_EQ(finished.code, 2) << entry.path();
    }
    if (finished.code == 0) {
      EXPECT_LE(parsed["residual"]["natural"].get<double>(), 1e-8) << entry.path();
    }
  }
}

}  // namespace
}  // namespace perp::app

// SPDX-License-Identifier: Apache-2.0
/// Every command that writes, as a process that is killed at random moments or whose disk fills up: each file is as it
/// was, or whole.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <random>
#include <thread>

#include "app/json.hpp"
#include "app/support.hpp"
#include "contact/io/fclib.hpp"
#include "lcp/io/matrix_market.hpp"

namespace perp::app {
namespace {

namespace fs = std::filesystem;
using std::chrono::duration;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;
using test::is_json;

/// The program with its output in `log`, and files of `room` bytes at most.
pid_t start(std::vector<std::string> arguments, const std::string& log, rlim_t room = RLIM_INFINITY) {
  arguments.insert(arguments.begin(), PERP_PROGRAM);
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child != 0) return child;
  std::array<char*, 1> environment{nullptr};
  const int out = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  dup2(out, STDOUT_FILENO);
  dup2(out, STDERR_FILENO);
  const rlimit limit{room, RLIM_INFINITY};
  setrlimit(RLIMIT_FSIZE, &limit);
  execve(argv[0], argv.data(), environment.data());
  _exit(127);
}

/// The exit code, or minus the signal.
int end(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/// Does the file hold all that its kind ends with?
bool whole(const std::string& path) {
  const std::string text = test::read(path);
  if (path.ends_with(".json")) return is_json(text);
  if (path.ends_with(".svg")) return text.ends_with("</svg>\n") && text.starts_with("<");
  if (path.ends_with(".sol")) return text.rfind("\nobjno 0 ") != std::string::npos && text.ends_with("\n");
  try {
    if (path.ends_with(".hdf5")) return contact::read_fclib(path).solution.has_value();
    if (path.ends_with("F.mtx")) return lcp::read_matrix(path).rows() > 0;
    if (path.ends_with(".mtx")) return lcp::read_vector(path, true).size() > 0;
  } catch (const std::exception&) {
    return false;
  }
  return false;
}

struct Command {
  std::vector<std::string> arguments;
  std::vector<std::string> outputs;
};

/// Every command that writes, in this folder, small problems.
std::vector<Command> commands(const test::Folder& folder) {
  test::write(folder / "m.nl", test::sqrt2_nl());
  const auto paths = [&](std::vector<std::string> names) {
    for (std::string& name : names) name = folder / name;
    return names;
  };
  const std::string J = folder / "a.json", S = folder / "a.svg", F = folder / "F.mtx", H = folder / "a.hdf5";
  return {{{"solve", "josephy", "--json", J, "--plot", S, "--solution", folder / "x.mtx"},
           paths({"a.json", "a.svg", "x.mtx"})},
          {{"inspect", "josephy", "--json", J}, paths({"a.json"})},
          {{"explain", "josephy", "--json", J}, paths({"a.json"})},
          {{"export", "ahn:50", "-o", F, "--force"},
           paths({"F.mtx", "F-q.mtx", "F-lower.mtx", "F-upper.mtx", "F-start.mtx"})},
          {{"contact", "chain:3", "--json", J, "--fclib-out", H}, paths({"a.json", "a.hdf5"})},
          {{"judge", "josephy", "--json", J, "--tol", "1000"}, paths({"a.json"})},
          {{folder / "m", "-AMPL"}, paths({"m.sol"})}};
}

/// Drafts that are there; removed.
int drafts(const test::Folder& folder) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder / "."))
    if (entry.path().extension() == ".part") found.push_back(entry.path());
  for (const fs::path& path : found) fs::remove(path);
  return static_cast<int>(found.size());
}

constexpr const char* old = "what was there before\n";

// IEEE 1003.1: a rename is seen whole. Would catch files written in place, and drafts that a signal leaves behind where
// the program ends by itself. SIGKILL may leave a draft, never a torn file.
TEST(OutputProcess, KilledAtRandomMoments) {
  const test::Folder folder;
  std::minstd_rand random(7);
  int ended = 0;
  int killed = 0;
  for (const Command& command : commands(folder)) {
    SCOPED_TRACE(testing::PrintToString(command.arguments));
    const Clock::time_point begin = Clock::now();
    ASSERT_EQ(end(start(command.arguments, folder / "log")), 0) << test::read(folder / "log");
    const double seconds = duration<double>(Clock::now() - begin).count();
    for (const std::string& output : command.outputs) EXPECT_TRUE(whole(output)) << output;
    constexpr int runs = 10;
    for (int run = 0; run < runs; ++run) {
      for (const std::string& output : command.outputs) test::write(output, old);
      const int signal = std::array{SIGKILL, SIGTERM, SIGINT}[static_cast<std::size_t>(run % 3)];
      const pid_t child = start(command.arguments, folder / "log");
      std::this_thread::sleep_for(duration<double>(std::uniform_real_distribution<>(0, 1.2 * seconds)(random)));
      kill(child, signal);
      ++(end(child) < 0 ? killed : ended);
      for (const std::string& output : command.outputs)
        EXPECT_TRUE(test::read(output) == old || whole(output)) << output << ", signal " << signal;
      const int left = drafts(folder);
      EXPECT_TRUE(left == 0 || signal == SIGKILL) << signal;
    }
  }
  EXPECT_GT(ended, 0);
  EXPECT_GT(killed, 0);
}

// Killed at the first sign that the file changes, while a megabyte is written. Catches files written in place, which a
// random moment rarely meets.
TEST(OutputProcess, KilledWhileItWrites) {
  const test::Folder folder;
  const std::string F = folder / "F.mtx";
  for (int run = 0; run < 5; ++run) {
    test::write(F, old);
    const pid_t child = start({"export", "obstacle:100x100", "-o", F, "--force"}, folder / "log");
    struct stat before {};
    struct stat now {};
    ASSERT_EQ(stat(F.c_str(), &before), 0);
    const Clock::time_point begin = Clock::now();
    do {
      if (stat(F.c_str(), &now) != 0) break;
    } while (now.st_ino == before.st_ino && now.st_size == before.st_size &&
             Clock::now() - begin < std::chrono::seconds(20));
    kill(child, SIGKILL);
    end(child);
    EXPECT_TRUE(now.st_ino != before.st_ino || now.st_size != before.st_size) << test::read(folder / "log");
    EXPECT_TRUE(whole(F));
    drafts(folder);
  }
}

// A disk that is full after so many bytes: told with the file's name, exit code 2, and all files are as they were.
TEST(OutputProcess, DiskThatFillsUp) {
  const test::Folder folder;
  for (const Command& command : commands(folder)) {
    SCOPED_TRACE(testing::PrintToString(command.arguments));
    for (const std::string& output : command.outputs) test::write(output, old);
    EXPECT_EQ(end(start(command.arguments, "/dev/null", 10)), 2);
    for (const std::string& output : command.outputs) EXPECT_EQ(test::read(output), old) << output;
    EXPECT_EQ(drafts(folder), 0);
  }
  ASSERT_EQ(end(start({"solve", "josephy", "--solution", folder / "x.mtx"}, folder / "log", 3000)), 0);
  ASSERT_EQ(end(start({"solve", "josephy", "--json", folder / "a.json", "--log-level", "quiet"}, folder / "log", 3000)),
            2);
  EXPECT_THAT(test::read(folder / "log"), HasSubstr("a.json: cannot be written: File too large"));
}

// ESC of a file's name reaches no terminal as it is.
TEST(OutputProcess, ShowsControlCharacters) {
  const test::Folder folder;
  EXPECT_EQ(end(start({"solve", folder / "\033[2J\xC2\x9B.nl"}, folder / "log")), 2);
  EXPECT_THAT(test::read(folder / "log"), HasSubstr("\\x1b[2J\\xc2\\x9b.nl"));
}

}  // namespace
}  // namespace perp::app

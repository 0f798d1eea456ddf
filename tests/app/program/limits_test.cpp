// SPDX-License-Identifier: Apache-2.0
/// The program ends at its limits and when it is asked to, whatever it is doing, and writes the best point.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "app/json.hpp"
#include "app/process_support.hpp"
#include "lcp/gpl.hpp"
#include "lcp/io/matrix_market.hpp"

namespace perp::app {
namespace {

using test::Child;
using test::Folder;
using testing::HasSubstr;
using Seconds = std::chrono::duration<double>;
using test::Json;
using test::parse_json;

/// The program's own figure is 1 s; the rest is for machines that are slow or have other things to do. What these
/// tests would catch takes from half a minute to for ever.
constexpr Seconds slack{5};

struct Ended {
  int code = 0;
  Seconds took{0};
  std::string err;
};

/// Until the program ends; a signal comes after `wait` (0: none), and the time counts from there.
Ended ended(const Folder& folder, std::vector<std::string> arguments, int signal = 0, Seconds wait = Seconds(0)) {
  Child child(folder, std::move(arguments));
  if (signal != 0) std::this_thread::sleep_for(wait);
  const auto begin = std::chrono::steady_clock::now();
  if (signal != 0) child.signal(signal);
  const int code = child.wait();
  return {code, std::chrono::steady_clock::now() - begin, child.err()};
}

Json written(const std::string& path) { return parse_json(test::read(path)); }

/// One iteration of path on it is a pivotal method on 8,000 rows: half a minute without a look at the clock.
const std::string deaf_problem = "random-degenerate-own:8000";
const Seconds within_it{0.7};

// Catches phases of linear algebra that look at no clock: this one ended after 34 s.
TEST(ProgramLimits, TimeLimitWithinLinearAlgebra) {
  const Folder folder;
  const Ended end = ended(folder, {"solve", deaf_problem, "--method", "path", "--time-limit", "0.3", "--json",
                                   folder / "o.json", "--solution", folder / "x.mtx", "--log-level", "quiet"});
  EXPECT_EQ(end.code, exit_unsolved) << end.err;
  EXPECT_LE(end.took, Seconds(0.3) + slack);
  const Json result = written(folder / "o.json");
  ASSERT_TRUE(result.is_object());
  EXPECT_EQ(result["status"], "TimeLimit");
  EXPECT_EQ(result["variables"].size(), 8000U);
  EXPECT_LT(result["residual"]["natural"].get<double>(), 1e3);
  EXPECT_EQ(lcp::read_vector(folder / "x.mtx").size(), 8000);
}

TEST(ProgramLimits, SignalsWithinLinearAlgebra) {
  for (const int signal : {SIGTERM, SIGINT}) {
    const Folder folder;
    const Ended end =
        ended(folder, {"solve", deaf_problem, "--method", "path", "--json", folder / "o.json", "--log-level", "quiet"},
              signal, within_it);
    EXPECT_EQ(end.code, exit_unsolved) << end.err;
    EXPECT_LE(end.took, slack);
    EXPECT_EQ(written(folder / "o.json").value("status", ""), "Interrupted");
  }
}

/// 27 neighbours in three dimensions: what UMFPACK asks METIS to order.
lcp::SpMat neighbours(int N) {
  std::vector<Eigen::Triplet<double>> entries;
  const int n = N * N * N;
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 27; ++k) {
      const int x = i / (N * N) + k / 9 - 1;
      const int y = i / N % N + k / 3 % 3 - 1;
      const int z = i % N + k % 3 - 1;
      const auto inside = [N](int a) { return a >= 0 && a < N; };
      const int j = (x * N + y) * N + z;
      if (inside(x) && inside(y) && inside(z)) entries.emplace_back(i, j, i == j ? 27.5 : -1.0);
    }
  lcp::SpMat A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

/// Whether the process catches that signal now.
bool catches(pid_t pid, int signal) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("SigCgt:")) return (std::stoull(line.substr(7), nullptr, 16) >> (signal - 1) & 1) != 0;
  return false;
}

// While METIS works, SIGABRT and SIGTERM are caught by METIS, for the whole process, with a jump to where only its own
// thread may go. Catches a program that crashes then. The variable is of its environment.
void expect_interrupted_within_metis(const char* variable = nullptr, const char* value = nullptr) {
  if (!lcp::gpl_linked()) GTEST_SKIP() << lcp::not_in_this_build("METIS");
  const Folder folder;
  const lcp::SpMat M = neighbours(30);
  lcp::write_matrix(folder / "M.mtx", M, "");
  lcp::write_vector(folder / "q.mtx", lcp::Vec::Constant(M.rows(), -1), "");
  if (variable != nullptr) setenv(variable, value, 1);
  Child child(folder, {"solve", folder / "M.mtx", folder / "q.mtx", "--method", "semismooth", "--option",
                       "linear_solver=direct", "--json", folder / "o.json", "--log-level", "quiet"});
  if (variable != nullptr) unsetenv(variable);
  bool met = false;
  for (int look = 0; look < 60'000 && !met && !std::filesystem::exists(folder / "o.json"); ++look) {
    met = catches(child.pid(), SIGABRT);
    if (!met) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  child.signal(SIGTERM);
  const int code = child.wait();
  if (!met) GTEST_SKIP() << "METIS was not met: SuiteSparse orders without it";
  EXPECT_EQ(code, exit_unsolved) << child.err();
  EXPECT_EQ(written(folder / "o.json").value("status", ""), "Interrupted");
}

TEST(ProgramLimits, WithinMetis) { expect_interrupted_within_metis(); }

// OpenBLAS makes its threads when it is loaded, before the program can say which signals are theirs to take.
TEST(ProgramLimits, WithinMetisBesideThreadsOfLibraries) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer has to be loaded first";
#endif
  expect_interrupted_within_metis("LD_PRELOAD", PERP_THREAD_AT_LOAD);
}

// A reader that waits for somebody who never writes. Catches readers that are deaf to the clock and to signals.
TEST(ProgramLimits, WithinReading) {
  const Folder folder;
  const std::string pipe = folder / "pipe.mtx";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const Ended late = ended(folder, {"solve", pipe, pipe, "--time-limit", "0.1", "--json", folder / "o.json"});
  EXPECT_EQ(late.code, exit_unsolved);
  EXPECT_LE(late.took, Seconds(0.1) + slack);
  EXPECT_THAT(late.err, HasSubstr("the time limit was reached while '" + pipe + "' was being read"));
  EXPECT_EQ(written(folder / "o.json").value("status", ""), "TimeLimit");
  const Ended asked = ended(folder, {"solve", pipe, pipe}, SIGTERM, Seconds(0.2));
  EXPECT_EQ(asked.code, exit_unsolved);
  EXPECT_LE(asked.took, slack);
  EXPECT_THAT(asked.err, HasSubstr("interrupted"));
  const Ended inspecting = ended(folder, {"inspect", pipe, pipe}, SIGTERM, Seconds(0.2));
  EXPECT_EQ(inspecting.code, exit_unsolved);
  EXPECT_LE(inspecting.took, slack);
}

// A result that nobody takes. Catches a program that can only be killed then.
TEST(ProgramLimits, WithinWriting) {
  const Folder folder;
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const Ended end = ended(folder, {"solve", "kojshin", "--json", pipe, "--log-level", "quiet"}, SIGTERM, Seconds(0.3));
  EXPECT_EQ(end.code, exit_unsolved);
  EXPECT_LE(end.took, slack);
}

// AMPL learns of it in the .sol file.
TEST(ProgramLimits, Ampl) {
  const Folder folder;
  test::write(folder / "m.nl", test::sqrt2_nl());
  const Ended end = ended(folder, {folder / "m", "-AMPL", "time_limit=1e-9"});
  EXPECT_EQ(end.code, 0) << end.err;
  EXPECT_THAT(test::read(folder / "m.sol"), HasSubstr("objno 0 402"));
}

// Contact: the formulation takes minutes to build; the sweeps' best point is there.
TEST(ProgramLimits, Contact) {
  const Folder folder;
  const Ended end = ended(
      folder, {"contact", "spheres:10000", "--time-limit", "0.5", "--json", folder / "o.json", "--log-level", "quiet"});
  EXPECT_EQ(end.code, exit_unsolved) << end.err;
  EXPECT_LE(end.took, Seconds(0.5) + slack);
  EXPECT_EQ(written(folder / "o.json").value("status", ""), "TimeLimit");
  const Ended encoding =
      ended(folder, {"contact", "spheres:200", "--formulation", "inner:100", "--json", folder / "o.json"}, SIGTERM,
            Seconds(3));
  EXPECT_EQ(encoding.code, exit_unsolved) << encoding.err;
  EXPECT_LE(encoding.took, slack);
  const Json result = written(folder / "o.json");
  EXPECT_EQ(result.value("status", ""), "Interrupted");
  EXPECT_GT(result["contacts"].size(), 100U);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
// `ulimit -v`: OpenBLAS asks for its buffers for ever where they do not fit, from before main() on. Catches a program
// that has to be killed then.
TEST(ProgramLimits, SmallAddressSpace) {
  const std::string command = std::string("timeout -s KILL 20 ") + PERP_PROGRAM;
  EXPECT_EQ(std::system(("ulimit -v 100000; " + command + " --version > /dev/null").c_str()), 0);
  const int status = std::system(("ulimit -v 100000; " + command + " solve kojshin > /dev/null 2>&1").c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_THAT(WEXITSTATUS(status), testing::AnyOf(exit_solved, exit_input));  // by another BLAS; refused
}
#endif

// 200 contacts with 1,000 facets each have 6e9 entries. Catches encodings that are built until the machine dies.
TEST(ProgramLimits, EncodingsAreEstimatedFirst) {
  const Folder folder;
  const Ended end = ended(folder, {"contact", "spheres:200", "--formulation", "inner:1000"});
  EXPECT_EQ(end.code, exit_input);
  EXPECT_THAT(end.err, HasSubstr("the encoding's 5.99e+09 entries are more than 2^31"));
}

}  // namespace
}  // namespace perp::app

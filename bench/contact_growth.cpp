/// bench_contact_growth: how the cost of contact::solve grows with the number of contacts in a generated scene. Each
/// run makes its scene and solves it in a process of its own. README.md says how to read it.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "contact/scenes/generators.hpp"
#include "contact/solvers/solve.hpp"

namespace {

using namespace perp;
using contact::Index;

/// What a run sends back.
struct Run {
  Index contacts = 0;
  double entries = 0;    ///< of W, a row
  double make = 0;       ///< seconds for the scene, W included
  double seconds = 0;    ///< of the solve
  double megabytes = 0;  ///< peak of the process
  int factorizations = 0;
  bool solved = false;
};

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

Run solve_scene(const std::string& scene, Index contacts, unsigned seed, double limit) {
  Run run;
  const auto begin = std::chrono::steady_clock::now();
  const contact::Problem problem = contact::make_scene(scene, contacts, seed).problem();
  run.make = seconds_since(begin);
  run.contacts = problem.contacts();
  run.entries = static_cast<double>(problem.W.nonZeros()) / static_cast<double>(problem.W.rows());
  const contact::Result result = contact::solve(problem, {.max_time = std::chrono::duration<double>(limit)});
  run.seconds = result.stats.time.count();
  run.factorizations = result.stats.factorizations;
  run.solved = result.solved();
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  run.megabytes = static_cast<double>(usage.ru_maxrss) / 1024;
  return run;
}

/// The same in a child, whose peak of memory is its own. A child that dies leaves a run that is not solved.
Run in_process(const std::string& scene, Index contacts, unsigned seed, double limit) {
  Run run;
  int ends[2];
  if (pipe(ends) != 0) return run;
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    const Run mine = solve_scene(scene, contacts, seed, limit);
    _exit(write(ends[1], &mine, sizeof mine) == sizeof mine ? 0 : 1);
  }
  close(ends[1]);
  Run got;
  if (read(ends[0], &got, sizeof got) == sizeof got) run = got;
  close(ends[0]);
  waitpid(child, nullptr, 0);
  return run;
}

/// The exponent p of y ~ x^p, by least squares in logarithms.
double exponent(const std::vector<std::pair<double, double>>& points) {
  double mean_x = 0;
  double mean_y = 0;
  const auto n = static_cast<double>(points.size());
  for (const auto& [x, y] : points) {
    mean_x += std::log(x) / n;
    mean_y += std::log(y) / n;
  }
  double xx = 0;
  double xy = 0;
  for (const auto& [x, y] : points) {
    xx += (std::log(x) - mean_x) * (std::log(x) - mean_x);
    xy += (std::log(x) - mean_x) * (std::log(y) - mean_y);
  }
  return xy / xx;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{"how the cost of contact::solve grows with a generated scene"};
  std::string scene = "spheres";
  std::vector<Index> sizes{100, 300, 1000, 3000, 10000};
  unsigned seeds = 3;
  double limit = 120;
  app.add_option("--scene", scene, "stack, spheres, arch, chain, wall, incline");
  app.add_option("--contacts", sizes, "sizes")->delimiter(',');
  app.add_option("--seeds", seeds, "scenes of each size");
  app.add_option("--limit", limit, "seconds a run");
  CLI11_PARSE(app, argc, argv);

  std::printf("%9s %5s %9s %9s %9s %5s %9s  %s\n", "contacts", "seed", "W a row", "make", "solve", "LU", "MB", "");
  std::vector<std::pair<double, double>> seconds;
  std::vector<std::pair<double, double>> memory;
  for (const Index size : sizes)
    for (unsigned seed = 1; seed <= seeds; ++seed) {
      const Run run = in_process(scene, size, seed, limit);
      std::printf("%9ld %5u %9.1f %9.3f %9.3f %5d %9.1f  %s\n", static_cast<long>(run.contacts), seed, run.entries,
                  run.make, run.seconds, run.factorizations, run.megabytes, run.solved ? "" : "not solved");
      std::fflush(stdout);
      if (!run.solved) continue;
      seconds.emplace_back(static_cast<double>(run.contacts), run.seconds);
      memory.emplace_back(static_cast<double>(run.contacts), run.megabytes);
    }
  if (seconds.size() < 2) return 1;
  std::printf("solved runs: seconds grow like contacts^%.2f, megabytes like contacts^%.2f\n", exponent(seconds),
              exponent(memory));
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 2;
}

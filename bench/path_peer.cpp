// SPDX-License-Identifier: Apache-2.0
/// A method of Perp beside PATH 4.7 in one process, on everything PATH's unlicensed library takes. See README.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include "cases.hpp"
#include "ncp/problem/residual.hpp"
#include "ncp/settings/settings.hpp"
#include "path_library.hpp"

namespace {

using namespace perp;

struct Options {
  std::string method = "path";
  std::string only;
  std::vector<std::string> models;
  std::vector<std::string> random_problems{"kehoe", "colvdual"};
  int random = 200;
  int programs = 0;
  int model_starts = 0;
  std::vector<std::string> set;
  std::uint64_t seed = 1;
  double tolerance = 1e-6;
  double seconds = 60;
  int repetitions = 5;
  std::string crash = "default";
  bool all_lines = false;
  bool processor = false;
};

/// Seconds by one of two clocks.
double time_of(bool processor) {
  if (processor) return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// What one of the two did with a (problem, start).
struct Run {
  bool claimed = false;
  double residual = ncp::infinity;  ///< by the judge, of the point returned
  std::string status;
  std::array<int, 3> iterations{};  ///< major, minor, crash
  int F_evals = 0;
  int J_evals = 0;
  int restarts = 0;
  double seconds = 0;  ///< median

  bool solved(double tolerance) const { return residual <= tolerance; }
  bool lied(double tolerance) const { return claimed && !solved(tolerance); }
};

std::string text(double value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.17g", value);
  return buffer.data();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

ncp::Method method_of(const Options& options) {
  std::vector<settings::Assignment> given{{"method", options.method, "--method"}};
  for (const std::string& text : options.set) given.push_back(settings::parse_assignment(text, "--option"));
  return settings::apply_options(given).settings.method;
}

class Contest {
 public:
  Contest(const Options& options, const bench::PathLibrary& path)
      : options_(options), path_(path), method_(method_of(options)) {
    ncp::stop(method_).tol = options.tolerance;
    ncp::stop(method_).max_time = std::chrono::duration<double>(options.seconds);
    path_options_ = {{"convergence_tolerance", text(options.tolerance)}, {"time_limit", text(options.seconds)}};
    if (options.crash == "none") {
      path_options_.emplace_back("crash_method", "none");
      if (auto* search = std::get_if<ncp::PathSearch>(&method_)) search->crash.on = false;
    }
  }

  /// Both, in turn, so often as said; once where one takes more than a second.
  std::pair<Run, Run> run(const bench::Case& c) const {
    Run theirs;
    Run ours;
    std::vector<double> their_seconds;
    std::vector<double> our_seconds;
    for (int k = 0; k < options_.repetitions; ++k) {
      const double begin = time_of(options_.processor);
      const bench::PathAnswer answer = path_.solve(*c.mcp, c.x0, path_options_);
      const double between = time_of(options_.processor);
      const ncp::Result result = ncp::solve(*c.mcp, c.x0, method_);
      our_seconds.push_back(time_of(options_.processor) - between);
      their_seconds.push_back(options_.processor ? between - begin : answer.seconds);
      if (k == 0) {
        theirs = {answer.claimed, ncp::residual(*c.mcp, answer.x).natural,
                  answer.status,  {answer.majors, answer.minors, answer.crash},
                  answer.F_evals, answer.J_evals,
                  answer.restarts};
        const ncp::Stats& s = result.stats;
        ours = {result.solved(),
                ncp::residual(*c.mcp, result.x).natural,
                std::string(ncp::to_string(result.status)),
                {s.iterations, s.pivots, s.crash_iterations},
                s.F_evals,
                s.J_evals,
                s.restarts};
      }
      if (std::max(their_seconds.back(), our_seconds.back()) > 1) break;
    }
    theirs.seconds = median(their_seconds);
    ours.seconds = median(our_seconds);
    return {theirs, ours};
  }

 private:
  const Options& options_;
  const bench::PathLibrary& path_;
  ncp::Method method_;
  bench::PathOptions path_options_;
};

void print_side(const Run& r, double tolerance) {
  std::printf("| %c %8.1e %4d %6d %4d %5d %4d %3d %9.0f ", r.lied(tolerance) ? '!' : (r.solved(tolerance) ? '+' : '-'),
              r.residual, r.iterations[0], r.iterations[1], r.iterations[2], r.F_evals, r.J_evals, r.restarts,
              1e6 * r.seconds);
}

void print_line(const bench::Case& c, const Run& theirs, const Run& ours, double tolerance) {
  std::printf("%-31s %-10s %4ld ", c.problem.c_str(), c.start.c_str(), static_cast<long>(c.mcp->size()));
  print_side(theirs, tolerance);
  print_side(ours, tolerance);
  std::printf("| %6.2f", ours.seconds / theirs.seconds);
  if (!theirs.solved(tolerance)) std::printf(" PATH: %s.", theirs.status.c_str());
  if (!ours.solved(tolerance)) std::printf(" Perp: %s.", ours.status.c_str());
  std::printf("\n");
  std::fflush(stdout);
}

/// Sums over a group of cases: the published starts, or the random ones of one problem.
struct Totals {
  int runs = 0;
  int solvable = 0;
  std::array<int, 2> solved{};  ///< PATH, Perp
  std::array<int, 2> lies{};
  std::array<double, 2> seconds{};         ///< where both solve
  std::array<double, 2> seconds_in_all{};  ///< with what is not solved
  std::vector<double> ratios;              ///< of times, where both solve
  std::string worst;

  void add(const bench::Case& c, const Run& theirs, const Run& ours, double tolerance) {
    ++runs;
    solvable += c.solvable;
    const std::array<const Run*, 2> both{&theirs, &ours};
    for (std::size_t k = 0; k < 2; ++k) {
      solved[k] += both[k]->solved(tolerance);
      lies[k] += both[k]->lied(tolerance);
      seconds_in_all[k] += both[k]->seconds;
    }
    if (!theirs.solved(tolerance) || !ours.solved(tolerance)) return;
    for (std::size_t k = 0; k < 2; ++k) seconds[k] += both[k]->seconds;
    ratios.push_back(ours.seconds / theirs.seconds);
    if (ratios.back() == *std::max_element(ratios.begin(), ratios.end())) worst = c.problem + ", " + c.start;
  }

  void print(const std::string& name, const std::string& method) const {
    std::printf("%s: %d runs, %d with a solution\n", name.c_str(), runs, solvable);
    std::printf("  solved           PATH %d, %s %d\n", solved[0], method.c_str(), solved[1]);
    std::printf("  false claims     PATH %d, %s %d\n", lies[0], method.c_str(), lies[1]);
    if (!ratios.empty())
      std::printf("  time, both solve PATH %.3f s, %s %.3f s: ratio %.2f; of one case: median %.2f, worst %.2f (%s)\n",
                  seconds[0], method.c_str(), seconds[1], seconds[1] / seconds[0], median(ratios),
                  *std::max_element(ratios.begin(), ratios.end()), worst.c_str());
    std::printf("  time in all      PATH %.3f s, %s %.3f s: ratio %.2f\n\n", seconds_in_all[0], method.c_str(),
                seconds_in_all[1], seconds_in_all[1] / seconds_in_all[0]);
  }
};

std::vector<bench::Case> cases_of(const Options& o) {
  std::vector<bench::Case> cases = bench::collection_cases(o.only);
  for (const std::string& name : o.random_problems)
    if (name.find(o.only) != std::string::npos)
      for (bench::Case& c : bench::random_cases(name, o.random, o.seed)) cases.push_back(std::move(c));
  for (bench::Case& c : bench::random_programs(o.programs, o.seed)) cases.push_back(std::move(c));
  for (const std::string& path : o.models) {
    cases.push_back(bench::model_case(path));
    for (bench::Case& c : bench::starts_of(bench::Case(cases.back()), o.model_starts, o.seed))
      cases.push_back(std::move(c));
  }
  return cases;
}

void print_list(const std::string& title, const std::vector<std::string>& lines, bool all) {
  std::printf("%s: %zu\n", title.c_str(), lines.size());
  const std::size_t shown = all ? lines.size() : std::min<std::size_t>(lines.size(), 30);
  for (std::size_t k = 0; k < shown; ++k) std::printf("  %s\n", lines[k].c_str());
  if (shown < lines.size()) std::printf("  and %zu more; --all lists them\n", lines.size() - shown);
}

std::string group(const bench::Case& c) {
  if (c.random) return c.problem + " from random starts";
  if (!c.solvable) return "collection, no solution";
  return c.start == "model" ? "models" : "collection";
}

int run(const Options& o) {
  const bench::PathLibrary path(bench::library_to_load(PERP_PATH_LIBRARY), PERP_PATH_STUB);
  const Contest contest(o, path);
  std::printf("%s beside Perp's %s; + solved (natural residual <= %g), - not, ! claimed but not; times in us\n",
              path.version().c_str(), o.method.c_str(), o.tolerance);
  const std::string side = "|   residual  maj    min  cr     F    J rst        us ";
  std::printf("%-31s %-10s %4s %s%s|  ratio\n", "problem", "start", "n", side.c_str(), side.c_str());

  std::map<std::string, Totals> totals;
  std::vector<std::string> lost;
  std::vector<std::string> slow;
  for (const bench::Case& c : cases_of(o)) {
    if (!path.takes(c.mcp->size(), c.mcp->jacobian_pattern().nonZeros())) continue;
    const auto [theirs, ours] = contest.run(c);
    const bool path_solved = theirs.solved(o.tolerance);
    const bool perp_solved = ours.solved(o.tolerance);
    const bool differ = path_solved != perp_solved || theirs.lied(o.tolerance) || ours.lied(o.tolerance);
    if (!c.random || o.all_lines || differ) print_line(c, theirs, ours, o.tolerance);
    totals[group(c)].add(c, theirs, ours, o.tolerance);
    const std::string name = c.problem + ", start " + c.start;
    if (path_solved && !perp_solved) lost.push_back(name + ": " + ours.status);
    if (path_solved && perp_solved && ours.seconds > 3 * theirs.seconds) slow.push_back(name);
  }
  std::printf("\n");
  for (const auto& [name, sums] : totals) sums.print(name, o.method);
  print_list("Solved by PATH, not by " + o.method, lost, o.all_lines);
  print_list("Solved by both, " + o.method + " taking more than 3 times as long", slow, o.all_lines);
  return EXIT_SUCCESS;
}

int main_or_throw(int argc, char** argv) {
  Options o;
  CLI::App app{"A method of Perp beside PATH 4.7 in one process."};
  app.add_option("--method", o.method, "semismooth, josephy, path")->capture_default_str();
  app.add_option("-o,--option", o.set, "KEY=VALUE of the method")->allow_extra_args(false);
  app.add_option("--only", o.only, "problems whose name contains this");
  app.add_option("--random", o.random, "so many random starts of each of --random-problems")->capture_default_str();
  app.add_option("--programs", o.programs, "so many random sparse quadratic programs")->capture_default_str();
  app.add_option("--random-problems", o.random_problems)->delimiter(',')->capture_default_str();
  app.add_option("--model-starts", o.model_starts, "so many other starts of each model")->capture_default_str();
  app.add_option("--seed", o.seed, "of the random starts")->capture_default_str();
  app.add_option("--tolerance", o.tolerance, "of both, and of the judge")->capture_default_str();
  app.add_option("--seconds", o.seconds, "limit of one solve, for both")->capture_default_str();
  app.add_option("--repetitions", o.repetitions, "of which the median is taken")->capture_default_str();
  app.add_option("--crash", o.crash, "default, or none for both")->check(CLI::IsMember({"default", "none"}));
  app.add_flag("--all", o.all_lines, "a line for every random start, not only where the two differ");
  app.add_flag("--cpu", o.processor, "times of the processor, for machines that do other things meanwhile");
  app.add_option("models", o.models, ".nl files to run as well");
  CLI11_PARSE(app, argc, argv);
  return run(o);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return main_or_throw(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bench_path_peer: %s\n", e.what());
    return 2;
  }
}

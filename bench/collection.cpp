/// One method over the whole collection and over models, in one process: a line for each (problem, start), what is not
/// solved, totals. See README.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "cases.hpp"

namespace {

using namespace perp;

struct Totals {
  int runs = 0;
  int solvable = 0;
  int solved = 0;
  ncp::Stats stats;
};

void print_header() {
  std::printf("%-31s %-10s %6s %-16s %9s %6s %5s %8s %7s %6s %6s %4s %10s\n", "problem", "start", "n", "status",
              "residual", "major", "crash", "minor", "F", "J", "LU", "rst", "ms");
}

void print_line(const bench::Case& c, const ncp::Result& r) {
  const ncp::Stats& s = r.stats;
  std::printf("%-31s %-10s %6ld %-16s %9.1e %6d %5d %8d %7d %6d %6d %4d %10.3f\n", c.problem.c_str(), c.start.c_str(),
              static_cast<long>(c.mcp->size()), std::string(ncp::to_string(r.status)).c_str(), r.residual.natural,
              s.iterations, s.crash_iterations, s.pivots, s.F_evals, s.J_evals, s.factorizations, s.restarts,
              1e3 * s.time.count());
  std::fflush(stdout);
}

struct Options {
  std::string method = "path";
  std::string only;
  std::vector<std::string> models;
  int random = 0;
  std::uint64_t seed = 1;
  double tolerance = 1e-8;
  double seconds = 60;
  bool no_crash = false;
  bool no_collection = false;
  bool quiet = false;
  bool messages = false;
};

ncp::Method method_of(const Options& o) {
  ncp::Method method = bench::method_called(o.method);
  ncp::stop(method).tol = o.tolerance;
  ncp::stop(method).max_time = std::chrono::duration<double>(o.seconds);
  if (o.no_crash)
    if (auto* path = std::get_if<ncp::PathSearch>(&method)) path->crash.on = false;
  return method;
}

std::vector<bench::Case> cases_of(const Options& o) {
  std::vector<bench::Case> cases;
  if (!o.no_collection) cases = bench::collection_cases(o.only);
  std::vector<std::string> names;
  for (const bench::Case& c : cases)
    if (c.mcp->size() <= 300 && (names.empty() || names.back() != c.problem)) names.push_back(c.problem);
  if (o.random > 0)
    for (const std::string& name : names)
      for (bench::Case& c : bench::random_cases(name, o.random, o.seed)) cases.push_back(std::move(c));
  for (const std::string& path : o.models) cases.push_back(bench::model_case(path));
  return cases;
}

int run(const Options& o) {
  const ncp::Method method = method_of(o);
  std::vector<std::string> unsolved;
  Totals totals;
  print_header();
  for (const bench::Case& c : cases_of(o)) {
    ncp::Result r;
    try {
      r = ncp::solve(*c.mcp, c.x0, method);
    } catch (const std::exception& e) {
      r.status = ncp::Status::NotApplicable;
      r.message = std::string("exception: ") + e.what();
    }
    const bool as_expected = r.solved() == c.solvable;
    if (!o.quiet || !as_expected) print_line(c, r);
    if (o.messages) std::printf("    %s\n", r.message.c_str());
    ++totals.runs;
    totals.solvable += c.solvable;
    totals.solved += r.solved();
    totals.stats += r.stats;
    if (!as_expected) unsolved.push_back(c.problem + ", start " + c.start + ": " + r.message);
  }
  const ncp::Stats& s = totals.stats;
  std::printf("\n%s: %d runs, %d with a solution, %d solved\n", o.method.c_str(), totals.runs, totals.solvable,
              totals.solved);
  std::printf(
      "major %d, crash %d, minor %d, F %d, J %d, LU %d, restarts %d, gradient steps %d, watchdogs %d, ray starts "
      "%d, rank-deficient %d, proximal %d, %.3f s\n",
      s.iterations, s.crash_iterations, s.pivots, s.F_evals, s.J_evals, s.factorizations, s.restarts, s.gradient_steps,
      s.watchdogs, s.ray_starts, s.rank_deficient, s.proximal_steps, s.time.count());
  if (!unsolved.empty()) std::printf("\nNot as they should be (%zu):\n", unsolved.size());
  for (const std::string& line : unsolved) std::printf("  %s\n", line.c_str());
  return unsolved.empty() ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main_or_throw(int argc, char** argv) {
  Options o;
  CLI::App app{"One method over the collection and over .nl models, in one process."};
  app.add_option("--method", o.method, "semismooth, josephy, path")->capture_default_str();
  app.add_option("--only", o.only, "problems whose name contains this");
  app.add_option("--random", o.random, "so many random starts more for each problem with n <= 300");
  app.add_option("--seed", o.seed, "of the random starts")->capture_default_str();
  app.add_option("--tolerance", o.tolerance, "on the natural residual")->capture_default_str();
  app.add_option("--seconds", o.seconds, "limit of one solve")->capture_default_str();
  app.add_flag("--no-crash", o.no_crash, "path without its crash");
  app.add_flag("--no-collection", o.no_collection, "the .nl files only");
  app.add_flag("--quiet", o.quiet, "lines only for what is not as it should be");
  app.add_flag("--messages", o.messages, "with the message of every solve");
  app.add_option("models", o.models, ".nl files");
  CLI11_PARSE(app, argc, argv);
  return run(o);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return main_or_throw(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bench_collection: %s\n", e.what());
    return 2;
  }
}

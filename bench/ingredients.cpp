// SPDX-License-Identifier: Apache-2.0
/// Does each ingredient of PathSearch, and each entry of the list `path`, earn its place? The collection, random starts
/// and models with the default options and with one ingredient or entry at a time left out. See bench/README.md.
#include <cstdio>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "bench/cases.hpp"

namespace {

using namespace perp;

struct Variant {
  const char* name;
  std::function<void(ncp::PathSearch&)> change;
};

const std::vector<Variant>& variants() {
  static const std::vector<Variant> all{
      {"default", [](ncp::PathSearch&) {}},
      {"no crash", [](ncp::PathSearch& m) { m.crash.on = false; }},
      {"no non-monotone stabilisation", [](ncp::PathSearch& m) { m.nms.on = false; }},
      {"line search", [](ncp::PathSearch& m) { m.search = ncp::Searchtype::Line; }},
      {"arc search", [](ncp::PathSearch& m) { m.search = ncp::Searchtype::Arc; }},
      {"no proximal terms", [](ncp::PathSearch& m) { m.proximal_adaptive = false; }},
      {"no chord steps", [](ncp::PathSearch& m) { m.chord_steps = 0; }},
      {"no gradient steps", [](ncp::PathSearch& m) { m.gradient_step_limit = 0; }},
      {"normal map's merit", [](ncp::PathSearch& m) { m.merit = ncp::PathMerit::NormalMap; }},
      {"rays always", [](ncp::PathSearch& m) { m.start = ncp::PathStart::Always; }},
  };
  return all;
}

struct Total {
  int runs = 0, solved = 0;
  long majors = 0, crash = 0, pivots = 0, F = 0, J = 0, factorizations = 0;
  double seconds = 0;
  void add(const ncp::Result& r) {
    ++runs;
    solved += r.solved() ? 1 : 0;
    majors += r.stats.iterations;
    crash += r.stats.crash_iterations;
    pivots += r.stats.pivots;
    F += r.stats.F_evals;
    J += r.stats.J_evals;
    factorizations += r.stats.factorizations;
    seconds += r.stats.time.count();
  }
};

void measure(const char* group, const std::vector<bench::Case>& cases) {
  std::printf("\n%s\n%-30s %-9s %9s %8s %6s %9s %8s %7s %7s %8s\n", group, "", "restarts", "solved", "majors", "crash",
              "pivots", "F", "J", "lu", "s");
  for (const Variant& variant : variants())
    for (const bool restarts : {true, false}) {
      Total total;
      for (const bench::Case& c : cases) {
        if (!c.solvable) continue;
        ncp::PathSearch kernel;
        kernel.stop.max_time = std::chrono::seconds(20);
        variant.change(kernel);
        total.add(ncp::solve(*c.mcp, c.x0, restarts ? ncp::path(kernel) : ncp::path(kernel, 0)));
      }
      std::printf("%-30s %-9s %4d/%-4d %8ld %6ld %9ld %8ld %7ld %7ld %8.3f\n", variant.name, restarts ? "yes" : "no",
                  total.solved, total.runs, total.majors, total.crash, total.pivots, total.F, total.J,
                  total.factorizations, total.seconds);
      std::fflush(stdout);
    }
}

/// The list of restarts within the method.
ncp::First& list_of(ncp::Method& path) { return std::get<ncp::First>(*std::get<ncp::On>(path).method); }

/// What each entry of the list is worth, on the cases that its first entry does not solve: how many are lost without
/// it, and what the others cost then.
void leave_out(const std::vector<bench::Case>& cases) {
  constexpr std::chrono::seconds limit{5};
  ncp::Method whole = ncp::path();
  ncp::stop(whole).max_time = limit;
  std::vector<const bench::Case*> hard;
  Total all;
  for (const bench::Case& c : cases) {
    if (!c.solvable) continue;
    const ncp::Result result = ncp::solve(*c.mcp, c.x0, whole);
    if (result.solved() && result.stats.restarts == 0) continue;
    hard.push_back(&c);
    all.add(result);
  }
  std::printf("\nwithout an entry of path, %zu of %zu cases\n%-60s %4d/%-4d %8ld %8.3f\n", hard.size(), cases.size(),
              "all", all.solved, all.runs, all.majors, all.seconds);
  for (std::size_t k = 1; k < list_of(whole).entries.size(); ++k) {
    ncp::Method method = whole;
    auto& entries = list_of(method).entries;
    entries.erase(entries.begin() + static_cast<std::ptrdiff_t>(k));
    Total total;
    for (const bench::Case* c : hard) total.add(ncp::solve(*c->mcp, c->x0, method));
    const ncp::Entry& without = list_of(whole).entries[k];
    std::printf("%-60s %4d/%-4d %8ld %8.3f\n", (ncp::name(*without.method) + " " + std::string(without.title)).c_str(),
                total.solved, total.runs, total.majors, total.seconds);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) try {
  std::vector<bench::Case> cases = bench::collection_cases("");
  for (int i = 1; i < argc; ++i) cases.push_back(bench::model_case(argv[i]));
  const std::size_t given = cases.size();
  for (std::size_t i = 0; i < given; ++i)
    if (cases[i].mcp->size() <= 300)
      for (bench::Case& c : bench::starts_of(cases[i], 5)) cases.push_back(std::move(c));
  leave_out(cases);
  measure("collection", bench::collection_cases(""));
  measure("kehoe, 200 random starts", bench::random_cases("kehoe", 200));
  measure("colvdual, 200 random starts", bench::random_cases("colvdual", 200));
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "bench_ingredients: %s\n", error.what());
  return 1;
}

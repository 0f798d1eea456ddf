/// Every preset, and SemismoothNewton over every C-function of the catalogue, on every (problem, start) of the
/// collection: solved, Newton steps, evaluations, failures by name. See bench/README.md.
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "bench/cases.hpp"
#include "ncp/strategy/presets.hpp"

namespace {

using namespace perp;

struct Total {
  int runs = 0, solved = 0, wrong = 0;
  long majors = 0, F = 0, J = 0, factorizations = 0;
  double seconds = 0;
  std::string failures;
};

/// Whether the natural residual at x, evaluated here, is what the answer says.
bool honest(const ncp::Mcp& mcp, const ncp::Result& result, double tol) {
  ncp::Vec F(mcp.size());
  return mcp.eval(result.x, F) && ncp::residual(mcp.box(), result.x, F).natural <= tol;
}

Total run(const std::vector<bench::Case>& cases, ncp::Method method, double seconds) {
  Total total;
  ncp::stop(method).max_time = std::chrono::duration<double>(seconds);
  for (const bench::Case& c : cases) {
    const ncp::Result r = ncp::solve(*c.mcp, c.x0, method);
    if (r.solved() && !(c.solvable && honest(*c.mcp, r, ncp::stop(method).tol))) {
      ++total.wrong;
      total.failures += " WRONG:" + c.problem + '/' + c.start;
    }
    if (!c.solvable) continue;
    ++total.runs;
    total.solved += r.solved() ? 1 : 0;
    if (!r.solved()) total.failures += ' ' + c.problem + '/' + c.start;
    total.majors += r.stats.iterations + r.stats.crash_iterations;
    total.F += r.stats.F_evals;
    total.J += r.stats.J_evals;
    total.factorizations += r.stats.factorizations;
    total.seconds += r.stats.time.count();
  }
  return total;
}

void print(const std::string& name, const Total& t) {
  std::printf("%-32s %4d/%-4d %6.1f%% %6d %9ld %9ld %9ld %9ld %9.2f\n", name.c_str(), t.solved, t.runs,
              100.0 * t.solved / t.runs, t.wrong, t.majors, t.F, t.J, t.factorizations, t.seconds);
  if (!t.failures.empty()) std::printf("    %s\n", t.failures.c_str());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) try {
  const double seconds = argc > 1 ? std::stod(argv[1]) : 20;
  const std::string only = argc > 2 ? argv[2] : "";
  const std::vector<bench::Case> cases = bench::collection_cases("");
  std::printf("%-32s %9s %7s %6s %9s %9s %9s %9s %9s\n", "", "solved", "", "wrong", "steps", "F", "J", "lu", "s");
  for (const ncp::Preset& preset : ncp::presets())
    if (preset.name.find(only) != std::string_view::npos)
      print(std::string(preset.name), run(cases, preset.method, seconds));
  for (const ncp::CFunction& c : ncp::cfunctions())
    if (const std::string name = "semismooth over " + c.name; name.find(only) != std::string::npos)
      print(name, run(cases, ncp::SemismoothNewton{.cfunction = c}, seconds));
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "bench_presets: %s\n", error.what());
  return 1;
}

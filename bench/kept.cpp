// SPDX-License-Identifier: Apache-2.0
/// A kept solver on sequences of neighbouring problems, beside solves from nothing. See README.md.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "cases.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/strategy/kept.hpp"

namespace {

using namespace perp;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values.empty() ? 0 : values[values.size() / 2];
}

struct Share {
  std::vector<double> kept, cold;
};

/// `steps` neighbours of each program: q changes by `change` of its size, entry by entry.
void sequence(const bench::Case& c, double change, int steps, std::vector<Share>& by) {
  ncp::KeptSolver solver;
  std::mt19937_64 engine(7);
  const auto first = ncp::affine_part(*c.mcp);
  for (int k = 0; k <= steps; ++k) {
    lcp::AffineMcp problem = *first;
    if (k > 0)
      for (double& q : problem.q) q *= 1 + change * (2 * static_cast<double>(engine() >> 11U) * 0x1p-53 - 1);
    const auto mcp = ncp::make_affine_mcp(std::move(problem), "neighbour");
    auto begin = Clock::now();
    const bool solved = solver.solve(*mcp, c.x0).solved();
    const double kept = seconds_since(begin);
    begin = Clock::now();
    const bool cold_solved = ncp::solve(*mcp, c.x0, ncp::automatic()).solved();
    const double cold = seconds_since(begin);
    if (k == 0 || !solved || !cold_solved) continue;
    Share& share = by[static_cast<std::size_t>(solver.by())];
    share.kept.push_back(kept);
    share.cold.push_back(cold);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int programs = argc > 1 ? std::atoi(argv[1]) : 100;
  const int steps = argc > 2 ? std::atoi(argv[2]) : 10;
  std::printf(
      "| q changes by | solved by | problems | kept, us | from nothing, us | median share "
      "|\n|---|---|---|---|---|---|\n");
  for (const double change : {0.0001, 0.001, 0.01}) {
    std::vector<Share> by(4);
    for (const bench::Case& c : bench::random_programs(programs)) sequence(c, change, steps, by);
    for (std::size_t k = 0; k < by.size(); ++k) {
      std::vector<double> ratios;
      for (std::size_t i = 0; i < by[k].kept.size(); ++i) ratios.push_back(by[k].kept[i] / by[k].cold[i]);
      std::printf("| %g | %s | %zu | %.0f | %.0f | %.3f |\n", change,
                  std::string(to_string(static_cast<ncp::KeptSolver::By>(k))).c_str(), ratios.size(),
                  1e6 * median(by[k].kept), 1e6 * median(by[k].cold), median(ratios));
    }
  }
  return EXIT_SUCCESS;
}

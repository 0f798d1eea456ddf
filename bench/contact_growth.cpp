// SPDX-License-Identifier: Apache-2.0
/// bench_contact_growth MU SEEDS CONTACTS CONTACTS...: how the time of piles grows with their size, beside one
/// factorization of the matrix of their steps. README.md says how to read it.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "contact/model/contact_system.hpp"
#include "contact/scenes/generators.hpp"
#include "contact/solvers/run.hpp"
#include "timing.hpp"

namespace {

using namespace perp;

/// Factorizations of W~ + 1, as a step of the cone path makes them [s].
struct Factorization {
  double first = 0;  ///< with the analysis of the pattern
  double next = 0;   ///< of another matrix of the pattern
};

Factorization factorization(const contact::Problem& problem) {
  const contact::Scaled scaled = contact::scaled(problem);
  std::vector<Eigen::Matrix3d> one;
  for (const auto& block : scaled.blocks) {
    one.emplace_back(Eigen::Matrix3d::Zero());
    one.back().topLeftCorner(block.size, block.size).setIdentity();
  }
  const auto factor = [&one](contact::ContactSystem& system) {
    if (!system.factor(one, one)) throw std::runtime_error("W~ + 1 has no factors");
  };
  contact::ContactSystem kept(scaled);
  factor(kept);
  return {.first = bench::least_seconds([&] {
            contact::ContactSystem system(scaled);
            factor(system);
          }),
          .next = bench::least_seconds([&] { factor(kept); })};
}

/// y = c n^p through the points (n, y): p, by least squares of the logarithms.
double exponent(const std::vector<double>& n, const std::vector<double>& y) {
  double x1 = 0, y1 = 0, xx = 0, xy = 0;
  for (std::size_t k = 0; k < n.size(); ++k) {
    const double a = std::log(n[k]), b = std::log(y[k]);
    x1 += a, y1 += b, xx += a * a, xy += a * b;
  }
  const auto points = static_cast<double>(n.size());
  return (points * xy - x1 * y1) / (points * xx - x1 * x1);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 5) {
    std::fprintf(stderr, "usage: bench_contact_growth MU SEEDS CONTACTS CONTACTS...\n");
    return 2;
  }
  const double mu = std::atof(argv[1]);
  const int seeds = std::atoi(argv[2]);
  if (seeds < 1) throw std::invalid_argument(std::string("SEEDS is '") + argv[2] + "'; it is at least 1");
  std::printf(
      "| pile | rows | solved by | natural map | factorizations | solve, s | first factorization, s | next, s | solve "
      "/ "
      "first |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  std::vector<double> sizes, solves, firsts, nexts;
  for (int k = 3; k < argc; ++k) {
    std::vector<double> rows, solve, first, next;
    for (int seed = 1; seed <= seeds; ++seed) {
      contact::Problem problem =
          contact::make_scene("spheres", std::atol(argv[k]), static_cast<unsigned>(seed)).problem();
      problem.mu.setConstant(mu);
      const contact::Run run = contact::run(problem, contact::variant_of("glocker"), {.seconds = 600});
      const Factorization one = factorization(problem);
      long factorizations = 0;
      for (const auto& [what, count] : run.counts)
        if (what == "factorizations") factorizations = count;
      std::printf("| %s, %d | %td | %s | %.1e | %ld | %.3g | %.3g | %.3g | %.3g |\n", argv[k], seed, problem.q.size(),
                  run.solved ? run.solved_by.c_str() : "not solved", run.residual.siconos, factorizations, run.seconds,
                  one.first, one.next, run.seconds / one.first);
      std::fflush(stdout);
      if (!run.solved) continue;
      rows.push_back(static_cast<double>(problem.q.size()));
      solve.push_back(run.seconds);
      first.push_back(one.first);
      next.push_back(one.next);
    }
    if (rows.empty()) continue;
    sizes.push_back(bench::median(rows));
    solves.push_back(bench::median(solve));
    firsts.push_back(bench::median(first));
    nexts.push_back(bench::median(next));
  }
  std::printf(
      "Of the solved ones, medians grow with the rows to the power %.2f (solve), %.2f (first factorization) and %.2f "
      "(next).\n",
      exponent(sizes, solves), exponent(sizes, firsts), exponent(sizes, nexts));
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "bench_contact_growth: %s\n", error.what());
  return 2;
}

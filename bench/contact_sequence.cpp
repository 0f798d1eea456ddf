// SPDX-License-Identifier: Apache-2.0
/// bench_contact_sequence STEPS AMPLITUDE VARIANT SCENE...: made scenes stepped on a shaking table, each step solved
/// cold and from the step before. README.md says how to read it.
#include <algorithm>
#include <cstdlib>
#include <exception>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include "contact/scenes/shaken_scene.hpp"
#include "contact/solvers/sequence.hpp"
#include "timing.hpp"

namespace {

using namespace perp;
using contact::Run;

/// NAME:CONTACTS[:SEED].
contact::Scene scene_of(const std::string& text) {
  const auto colon = text.find(':');
  const auto second = text.find(':', colon + 1);
  const unsigned seed = second == std::string::npos ? 1 : static_cast<unsigned>(std::stoul(text.substr(second + 1)));
  return contact::make_scene(text.substr(0, colon), std::stol(text.substr(colon + 1)), seed);
}

void measure(const std::string& name, int steps, double amplitude, const contact::Variant& variant) {
  contact::ShakenScene scene(scene_of(name), {.amplitude = amplitude});
  contact::Sequence warm({.variant = variant});
  contact::Sequence cold({.variant = variant, .warm = false});
  std::vector<double> seconds[2];
  double worst = 0;
  long states[3] = {};
  for (int k = 0; k < steps; ++k) {
    const contact::Problem problem = scene.problem();
    // In turn: what the first warms up in caches is not always the other's.
    const Run first = (k % 2 == 0 ? cold : warm).step(problem);
    const Run second = (k % 2 == 0 ? warm : cold).step(problem);
    const Run& from_before = k % 2 == 0 ? second : first;
    seconds[0].push_back((k % 2 == 0 ? first : second).seconds);
    seconds[1].push_back(from_before.seconds);
    worst = std::max(worst, from_before.residual.largest());
    for (const auto& state : from_before.states) ++states[static_cast<int>(state.state)];
    scene.advance(from_before.solution.r);
  }
  const auto share = [](double a, double b) { return b > 0 ? a / b : 0; };
  const long all = std::max(1L, states[0] + states[1] + states[2]);
  std::cout << "| " << name << " | " << cold.stats().solved << " | " << warm.stats().solved << " | "
            << warm.stats().cold_again << " | " << std::setprecision(3) << 1e3 * cold.stats().seconds / steps << " | "
            << 1e3 * warm.stats().seconds / steps << " | " << 100 * share(warm.stats().seconds, cold.stats().seconds)
            << " % | " << 100 * share(bench::median(seconds[1]), bench::median(seconds[0])) << " % | "
            << share(double(cold.stats().factorizations), steps) << " | "
            << share(double(warm.stats().factorizations), steps) << " | "
            << share(double(cold.stats().iterations), steps) << " | " << share(double(warm.stats().iterations), steps)
            << " | " << worst << " | " << 100 * states[0] / all << "/" << 100 * states[1] / all << "/"
            << 100 * states[2] / all << " |" << std::endl;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 5) {
    std::cerr << "usage: bench_contact_sequence STEPS AMPLITUDE VARIANT SCENE...\n";
    return 2;
  }
  std::cout
      << "| scene | solved cold | warm | cold again | ms cold | warm | time | median | factorizations cold | warm | "
         "steps cold | warm | worst residual | open/stick/slip % |\n"
         "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (int k = 4; k < argc; ++k) measure(argv[k], std::atoi(argv[1]), std::atof(argv[2]), contact::variant_of(argv[3]));
  return 0;
} catch (const std::exception& error) {
  std::cerr << "bench_contact_sequence: " << error.what() << '\n';
  return 1;
}

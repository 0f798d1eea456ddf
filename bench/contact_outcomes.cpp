// SPDX-License-Identifier: Apache-2.0
/// bench_contact_outcomes LIMIT PROBLEMS...: a line for each of them, files, made scenes NAME:CONTACTS:SEED[:MU], or
/// shaken ones, shaken/NAME:CONTACTS:SEED:STEPS:AMPLITUDE. README.md says how to read it.
#include <cstdlib>
#include <ctime>
#include <exception>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "contact/io/read.hpp"
#include "contact/scenes/shaken_scene.hpp"
#include "contact/solvers/sequence.hpp"
#include "contact/solvers/solve.hpp"

namespace {

using namespace perp;

std::vector<std::string> parts(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ':');) all.push_back(part);
  return all;
}

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Prints the name, how many are solved of how many, what solved it, factorizations, and seconds of the processor.
void line(const std::string& name, long solved, long of, std::string_view by, long factorizations, double seconds) {
  std::cout << name << ' ' << solved << ' ' << of << ' ' << by << ' ' << factorizations << ' ' << seconds << std::endl;
}

void solve_one(const std::string& name, double limit) {
  const auto part = parts(name);
  contact::Problem problem;
  if (part.size() >= 3) {
    problem = contact::make_scene(part[0], std::stol(part[1]), static_cast<unsigned>(std::stoul(part[2]))).problem();
    if (part.size() > 3) problem.mu.setConstant(std::stod(part[3]));
  } else {
    problem = contact::read_problem(name);
  }
  const double begin = cpu_seconds();
  contact::Options options;
  options.max_time = std::chrono::duration<double>(limit);
  const contact::Result result = contact::solve(problem, options);
  line(name, result.solved(), 1, to_string(result.by), result.stats.factorizations, cpu_seconds() - begin);
}

void shake(const std::string& name) {
  const auto part = parts(name.substr(name.find('/') + 1));
  contact::ShakenScene scene(
      contact::make_scene(part.at(0), std::stol(part.at(1)), static_cast<unsigned>(std::stoul(part.at(2)))),
      {.amplitude = std::stod(part.at(4))});
  contact::Sequence sequence;
  const long steps = std::stol(part.at(3));
  const double begin = cpu_seconds();
  for (long k = 0; k < steps; ++k) scene.advance(sequence.step(scene.problem()).solution.r);
  line(name, sequence.stats().solved - sequence.stats().cold_again, steps, "-", sequence.stats().factorizations,
       cpu_seconds() - begin);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::cerr << "usage: bench_contact_outcomes LIMIT PROBLEMS...\n";
    return 2;
  }
  for (int k = 2; k < argc; ++k)
    if (const std::string name = argv[k]; name.starts_with("shaken/"))
      shake(name);
    else
      solve_one(name, std::atof(argv[1]));
  return 0;
} catch (const std::exception& error) {
  std::cerr << "bench_contact_outcomes: " << error.what() << '\n';
  return 1;
}

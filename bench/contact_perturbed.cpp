// SPDX-License-Identifier: Apache-2.0
/// bench_contact_perturbed FOLDER ROUNDS[:SEED] FILES...: variants of recorded contact problems as FCLIB files in
/// FOLDER, for `perp-compare contact`. README.md says how to read it.
#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "contact/io/fclib.hpp"
#include "contact/io/read.hpp"

namespace {

using namespace perp;
using contact::Index;
using contact::Problem;
using contact::SpMat;
using contact::Vec;

/// Tangent frames turned by random angles: W, q in other coordinates of the same problem.
Problem turned(const Problem& problem, std::mt19937& random) {
  Problem out = problem;
  std::vector<Eigen::Triplet<double>> entries;
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  for (Index a = 0; a < problem.contacts(); ++a) {
    const auto i = static_cast<int>(3 * a);
    const double t = angle(random);
    entries.emplace_back(i, i, 1);
    entries.emplace_back(i + 1, i + 1, std::cos(t));
    entries.emplace_back(i + 1, i + 2, -std::sin(t));
    entries.emplace_back(i + 2, i + 1, std::sin(t));
    entries.emplace_back(i + 2, i + 2, std::cos(t));
  }
  SpMat Q(problem.q.size(), problem.q.size());
  Q.setFromTriplets(entries.begin(), entries.end());
  SpMat W = Q * problem.W.matrix() * SpMat(Q.transpose());
  W.makeCompressed();
  out.W = std::move(W);
  out.q = Q * problem.q;
  return out;
}

/// q + 30 % of its size in a random direction of the range of W, so that existence is not lost.
Problem pushed(const Problem& problem, std::mt19937& random) {
  Problem out = problem;
  std::normal_distribution<double> normal;
  Vec y(problem.q.size());
  for (Index i = 0; i < y.size(); ++i) y[i] = normal(random);
  const Vec d = problem.W * y;
  out.q += 0.3 * problem.q.norm() / d.norm() * d;
  return out;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 4) {
    std::cerr << "usage: bench_contact_perturbed FOLDER ROUNDS[:SEED] FILES...\n";
    return 2;
  }
  const std::string_view how_many = argv[2];
  const int rounds = std::atoi(argv[2]);
  const auto colon = how_many.find(':');
  const unsigned seed = colon == how_many.npos ? 1 : static_cast<unsigned>(std::atoi(argv[2] + colon + 1));
  for (int k = 3; k < argc; ++k) {
    Problem problem = contact::read_problem(argv[k]);
    problem.global.reset();
    const auto write = [&](const Problem& variant, const std::string& how) {
      const std::string name = std::filesystem::path(argv[k]).stem().string() + "-" + how;
      contact::write_fclib(std::string(argv[1]) + "/" + name + ".hdf5", {.problem = variant, .title = name});
    };
    std::mt19937 random(seed);
    for (int round = 1; round <= rounds; ++round) {
      if (problem.dimension == 3) write(turned(problem, random), "turned-" + std::to_string(round));
      write(pushed(problem, random), "pushed-" + std::to_string(round));
    }
    for (const char* mu : {"0.2", "0.9"}) {
      Problem other = problem;
      other.mu.setConstant(std::atof(mu));
      write(other, std::string("mu-") + mu);
    }
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << "bench_contact_perturbed: " << error.what() << '\n';
  return 1;
}

// SPDX-License-Identifier: Apache-2.0
/// make_scenes FOLDER: writes the problems of committed_scenes.hpp, each with the best solution that solve() finds, and
/// prints their sizes and residuals: the table of data/contact/README.md.
#include <cstdio>
#include <exception>
#include <stdexcept>

#include "contact/io/fclib.hpp"
#include "contact/model/residual.hpp"
#include "contact/scenes/committed_scenes.hpp"
#include "contact/solvers/solve.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace {

void write(const std::filesystem::path& folder, const perp::contact::Scene& scene) {
  using namespace perp::contact;
  Fclib file{.problem = scene.problem(), .title = scene.name};
  file.description = "rigid bodies under gravity, one step of 0.01 s; generated, see contact/scenes/generators.hpp";
  file.math_info = "M v = H r + f, u = H' v; velocity level, gaps are not in it";
  const auto result = solve(file.problem, {.tol = 1e-12});
  const Residual e = residual(file.problem, result.solution.r);
  const Global& global = *file.problem.global;
  // v from M v = H r + f: M is block diagonal.
  perp::lcp::SparseLu lu;
  FclibPoint point{.v = perp::lcp::Vec(global.f.size()), .u = result.solution.u, .r = result.solution.r};
  if (lu.factor(global.M) != perp::lcp::LuStatus::Ok) throw std::runtime_error("the inertia is singular");
  lu.solve_refined(global.f + global.H * point.r, point.v);
  file.solution = point;
  write_fclib(committed_file(folder, scene).string(), file);
  int open = 0;
  int stick = 0;
  int slip = 0;
  for (const ContactState& c : states(file.problem, point.r))
    ++(c.state == State::Open ? open : c.state == State::Stick ? stick : slip);
  std::printf("| %s | %ld | %zu | %d / %d / %d | %.0e | %.0e |\n", scene.name.c_str(),
              static_cast<long>(file.problem.contacts()), scene.bodies.bodies().size(), open, stick, slip, e.siconos,
              e.rr9118);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_scenes FOLDER\n");
    return 2;
  }
  try {
    for (const auto& scene : perp::contact::committed_scenes()) write(argv[1], scene);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_scenes: %s\n", error.what());
    return 1;
  }
  return 0;
}

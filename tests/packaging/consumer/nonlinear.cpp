// SPDX-License-Identifier: Apache-2.0
#include <contact/elastic_rod.hpp>
#include <contact/nonlinear.hpp>
#include <contact/pendulum_chain.hpp>
#include <iostream>
#include <string>

using namespace perp::contact;

// A second of the scene, and Newton's steps in the step that took most.
template <class Scene>
int run(const Scene& scene, Motion at, const NonlinearOptions& options) {
  NonlinearResult hardest;
  for (double t = 0; t < 1; t += scene.h) {
    const NonlinearResult step = solve(scene.step(at), at.v, options);
    if (!step.solved()) {
      std::cerr << t << " s: " << step.message << '\n';
      return 1;
    }
    if (step.history.size() >= hardest.history.size()) hardest = step;
    at = scene.moved(at, step.v);
  }
  std::cout << "k |R - H r| law t\n";
  for (const NonlinearRecord& p : hardest.history)
    std::cout << p.k << ' ' << p.dynamics << ' ' << p.law << ' ' << p.step << '\n';
  return 0;
}

int main(int, char** argv) {  // chain|rod VARIANT, as glocker or coulomb+nsgs
  const NonlinearOptions options{.tol = 1e-10, .inner = variant_of(argv[2])};
  if (argv[1] == std::string("rod")) return run(ElasticRod{}, ElasticRod{}.straight(), options);
  const PendulumChain chain{.links = 20, .floor = -1.2};
  return run(chain, chain.straight(1.5), options);
}

// SPDX-License-Identifier: Apache-2.0
#include <contact/read.hpp>
#include <contact/run.hpp>
#include <iostream>

int main(int, char** argv) {  // FILE METHOD
  const auto problem = perp::contact::read_problem(argv[1]);
  const auto run = perp::contact::run(problem, perp::contact::variant_of(argv[2]));
  std::cout << run.status << ' ' << run.residual.largest() << '\n';
  return run.solved ? 0 : 1;
}

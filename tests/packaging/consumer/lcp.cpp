// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <lcp/solve.hpp>

using namespace perp::lcp;

int main() {  // 0 <= z _|_ M z + q >= 0
  const Eigen::MatrixXd M{{2, 1}, {1, 2}};
  const AffineMcp problem = standard_lcp(M.sparseView(), Vec{{-5, -6}});
  const Result result = solve(problem, Vec::Zero(2));
  std::cout << result.message << "\nz = " << result.z.transpose() << '\n';
  return result.status == Status::Solved ? 0 : 1;
}

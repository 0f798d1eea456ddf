// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <ncp/solve.hpp>

using namespace perp::ncp;

bool F(In x, Out F) {
  F << x[0] * x[0] + x[1] - 2, x[0] - x[1] + 1;
  return true;
}

int main() {  // 0 <= x _|_ F(x) >= 0
  const auto mcp = make_mcp({.name = "example", .box = Box::nonnegative(2), .F = F});
  const Result result = solve(*mcp, Vec::Ones(2), NewtonJosephy{});
  std::cout << result << "\nx = " << result.x.transpose() << '\n';
  return result.solved() ? 0 : 1;
}

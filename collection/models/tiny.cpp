// SPDX-License-Identifier: Apache-2.0
/// Nonlinear complementarity problems with a handful of unknowns.
#include <cmath>

#include "collection/base/build.hpp"
#include "collection/models/problems.hpp"

namespace perp::ncp::collection {

namespace {

constexpr double root = 1.2247448713915890491;  // sqrt(6) / 2

Shape ncp_shape(std::string name, Index n) { return {std::move(name), Box::nonnegative(n), indexed("z", n)}; }

}  // namespace

/// F1 = 3 z1^2 + 2 z1 z2 + 2 z2^2 + z3 + 3 z4 - 6,     F2 = 2 z1^2 + z1 + z2^2 + 10 z3 + 2 z4 - 2,
/// F3 = 3 z1^2 + z1 z2 + 2 z2^2 + 2 z3 + 9 z4 - 9,     F4 = z1^2 + 3 z2^2 + 2 z3 + 3 z4 - 3.
/// At (sqrt(6)/2, 0, 0, 1/2) F = (0, 2 + sqrt(6)/2, 0, 0): z3 = F3 = 0 is degenerate.
Problem kojshin() {
  Problem p;
  p.mcp = make_problem(ncp_shape("kojshin", 4), [](const auto& z, const auto& F) {
    const auto &z1 = z[0], &z2 = z[1], &z3 = z[2], &z4 = z[3];
    F[0] = 3 * z1 * z1 + 2 * z1 * z2 + 2 * z2 * z2 + z3 + 3 * z4 - 6;
    F[1] = 2 * z1 * z1 + z1 + z2 * z2 + 10 * z3 + 2 * z4 - 2;
    F[2] = 3 * z1 * z1 + z1 * z2 + 2 * z2 * z2 + 2 * z3 + 9 * z4 - 9;
    F[3] = z1 * z1 + 3 * z2 * z2 + 2 * z3 + 3 * z4 - 3;
  });
  p.starts = eight_starts();
  p.solutions = {{"degenerate", vec({root, 0, 0, 0.5}), 1e-15}, {"nondegenerate", vec({1, 0, 3, 0}), 0}};
  p.solutions_complete = true;
  return p;
}

/// As kojshin but for F2 = 2 z1^2 + z1 + z2^2 + 3 z3 + 2 z4 - 2 and F3 = 3 z1^2 + z1 z2 + 2 z2^2 + 2 z3 + 3 z4 - 1.
Problem josephy() {
  Problem p;
  p.mcp = make_problem(ncp_shape("josephy", 4), [](const auto& z, const auto& F) {
    const auto &z1 = z[0], &z2 = z[1], &z3 = z[2], &z4 = z[3];
    F[0] = 3 * z1 * z1 + 2 * z1 * z2 + 2 * z2 * z2 + z3 + 3 * z4 - 6;
    F[1] = 2 * z1 * z1 + z1 + z2 * z2 + 3 * z3 + 2 * z4 - 2;
    F[2] = 3 * z1 * z1 + z1 * z2 + 2 * z2 * z2 + 2 * z3 + 3 * z4 - 1;
    F[3] = z1 * z1 + 3 * z2 * z2 + 2 * z3 + 3 * z4 - 3;
  });
  p.starts = eight_starts();
  p.solutions = {{"Josephy", vec({root, 0, 0, 0.5}), 1e-15}};
  p.solutions_complete = true;
  return p;
}

/// F = (z1 + 2 z2 + 3 z3 - 1, z2 - z3 + 1, z2 + z3 + 1). The matrix is a P-matrix: its principal minors are 1, 1, 1, 1,
/// 1, 2, 2; so there is exactly one solution.
Problem munson1() {
  Problem p;
  p.mcp = make_problem(ncp_shape("munson1", 3), [](const auto& z, const auto& F) {
    F[0] = z[0] + 2 * z[1] + 3 * z[2] - 1;
    F[1] = z[1] - z[2] + 1;
    F[2] = z[1] + z[2] + 1;
  });
  p.starts = {Vec::Zero(3), Vec::Ones(3), Vec::Constant(3, 10)};
  p.solutions = {{"unique", vec({1, 0, 0}), 0}};
  p.solutions_complete = true;
  return p;
}

/// F = (z - 1)^2 - 1.01. F(0) = -0.01 < 0, so z = 0 is no solution, but merit functions have a local minimum there.
Problem billups() {
  Problem p;
  p.mcp = make_problem(ncp_shape("billups", 1),
                       [](const auto& z, const auto& F) { F[0] = (z[0] - 1) * (z[0] - 1) - 1.01; });
  for (const double start : {0.0, 1.5, 2.0, 3.0, 5.0}) p.starts.emplace_back(Vec::Constant(1, start));
  p.solutions = {{"unique", vec({1 + std::sqrt(1.01)}), 1e-15}};
  p.solutions_complete = true;
  return p;
}

/// F_i = 2 exp(sum_k (z_k - k + 2)^2) (z_i - i + 2), the gradient of exp(|z - a|^2), a = (-1, 0, 1, 2, 3): strictly
/// monotone. Not defined where exp overflows, |z - a|^2 > 709.
Problem watson4() {
  Problem p;
  p.mcp = make_problem(ncp_shape("watson4", 5), [](const auto& z, const auto& F) {
    using std::exp;
    Number<decltype(z)> square = 0;
    for (int k = 0; k < 5; ++k) square += (z[k] - (k - 1)) * (z[k] - (k - 1));
    const auto factor = 2 * exp(square);
    for (int i = 0; i < 5; ++i) F[i] = factor * (z[i] - (i - 1));
  });
  p.starts = {Vec::Zero(5), vec({0, 0, 1, 2, 3}), vec({0.5, 0.5, 1, 1.5, 2.5})};
  p.solutions = {{"unique", vec({0, 0, 1, 2, 3}), 0}};
  p.solutions_complete = true;
  return p;
}

}  // namespace perp::ncp::collection

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Symmetric problems for the tests of bound_qp, which are all solved by every preconditioner.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "lcp/qp/bound_qp.hpp"
#include "lcp/solve/solve.hpp"
#include "support/matrices.hpp"

namespace perp::lcp {

using support::Dense;
using support::from;
using support::Random;
using support::sparse;
using support::Triplets;
using support::vec;
using support::violation;
using Kind = BoundQp::Preconditioner;

/// The five-point Laplacian of N x N points times `scale`, on a torus if periodic (then singular: M e = 0).
inline SpMat laplacian(int N, double scale = 1, bool periodic = false) {
  Triplets entries;
  const auto couple = [&](int a, int b) {
    entries.emplace_back(a, b, -scale);
    entries.emplace_back(b, a, -scale);
  };
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; ++i) {
      const int k = j * N + i;
      entries.emplace_back(k, k, 4 * scale);
      if (i + 1 < N || periodic) couple(k, j * N + (i + 1) % N);
      if (j + 1 < N || periodic) couple(k, (j + 1) % N * N + i);
    }
  return from(static_cast<Index>(N) * N, entries);
}

/// Membrane over the unit square, fixed at zero around, pressed by 1e-6 on the obstacle 0.1 - |x|^2, x from the centre.
inline AffineMcp membrane(int N, double scale = 1) {
  const double h = 1.0 / (N + 1);
  AffineMcp problem{.M = laplacian(N, scale), .q = {}, .box = Box::nonnegative(static_cast<Index>(N) * N)};
  problem.q = Vec::Constant(problem.M.rows(), 1e-6 * h * h * scale);
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; ++i) {
      const double x = (i + 1) * h - 0.5;
      const double y = (j + 1) * h - 0.5;
      problem.box.lower[j * N + i] = 0.1 - x * x - y * y;
    }
  return problem;
}

struct NamedOptions {
  std::string name;
  BoundQp options;
};

inline std::vector<NamedOptions> all_preconditioners() {
  return {{"auto", {}},
          {"multilevel", {.preconditioner = Kind::Multilevel, .direct = 20}},
          {"cholesky", {.preconditioner = Kind::Cholesky}},
          {"gauss-seidel", {.preconditioner = Kind::GaussSeidel}}};
}

/// Solved, and a judge that shares nothing with the library's agrees.
inline Result expect_solved(const AffineMcp& problem, const Vec& start, const BoundQp& options, const std::string& what,
                            const Limits& limits = {}) {
  Result result = bound_qp(problem, start, options, limits);
  EXPECT_EQ(result.status, Status::Solved)
      << what << ": " << to_string(result.status) << ", " << result.message << ", residual " << result.residual;
  if (result.solved()) {
    EXPECT_LE(violation(problem, result.z), 1.001 * limits.tol) << what;
  }
  return result;
}

/// A problem with M, and a solution of it: z in a box with every kind of interval, F_i = 0 inside; at a bound F_i is 0
/// with probability `degenerate`.
struct PlantedQp {
  AffineMcp problem;
  Vec solution;
};
inline PlantedQp planted(const SpMat& M, double degenerate, Random& random) {
  const Index n = M.rows();
  const Box box = support::mixed_box(n, random);
  const Vec z = project(box, random.normals(n));
  Vec q = -(M * z);
  for (Index i = 0; i < n; ++i) {
    if (random.chance(degenerate)) continue;
    const double size = M.coeff(i, i) > 0 ? M.coeff(i, i) : 1;
    const double F = size * random.uniform(0.1, 2);
    if (box.lower[i] == box.upper[i])
      q[i] += random.chance(0.5) ? F : -F;
    else if (z[i] == box.lower[i])
      q[i] += F;
    else if (z[i] == box.upper[i])
      q[i] -= F;
  }
  return {{M, q, box}, z};
}

/// B B', B n x rank with about `per_row` entries a row.
inline SpMat gram(Index n, int rank, int per_row, Random& random) {
  Triplets entries;
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < per_row; ++k) entries.emplace_back(i, random.integer(0, rank - 1), random.normal());
  SpMat B(n, rank);
  B.setFromTriplets(entries.begin(), entries.end());
  return B * SpMat(B.transpose());
}

}  // namespace perp::lcp

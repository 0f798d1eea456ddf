// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Matrices and affine MCPs for the tests, and a judge of solutions that shares nothing with the library's.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "lcp/affine_mcp.hpp"
#include "lcp/dense_factors.hpp"

namespace perp::support {

using lcp::AffineMcp;
using lcp::Box;
using lcp::Index;
using lcp::infinity;
using lcp::SpMat;
using lcp::Vec;
using Dense = Eigen::MatrixXd;
using Triplets = std::vector<Eigen::Triplet<double>>;

inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();

inline Vec vec(std::initializer_list<double> values) {
  Vec v(static_cast<Index>(values.size()));
  std::copy(values.begin(), values.end(), v.begin());
  return v;
}

/// The matrix with these rows; zeros are no entries.
inline SpMat matrix(std::initializer_list<std::initializer_list<double>> rows) {
  Triplets entries;
  int i = 0;
  for (const auto& row : rows) {
    int j = 0;
    for (const double a : row) {
      if (a != 0) entries.emplace_back(i, j, a);
      ++j;
    }
    ++i;
  }
  SpMat A(i, rows.size() > 0 ? static_cast<Index>(rows.begin()->size()) : 0);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

inline SpMat sparse(const Dense& A) { return A.sparseView(); }

inline SpMat from(Index n, const Triplets& entries) {
  SpMat A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

/// The 27-point stencil on m^3 points, unsymmetric: nearly what convection and diffusion by trilinear elements give.
inline SpMat stencil(int m) {
  Triplets entries;
  const auto inside = [m](int i) { return i >= 0 && i < m; };
  const auto number = [m](int i, int j, int k) { return (i * m + j) * m + k; };
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j)
      for (int k = 0; k < m; ++k)
        for (int a = -1; a <= 1; ++a)
          for (int b = -1; b <= 1; ++b)
            for (int c = -1; c <= 1; ++c)
              if (inside(i + a) && inside(j + b) && inside(k + c))
                entries.emplace_back(number(i, j, k), number(i + a, j + b, k + c),
                                     a == 0 && b == 0 && c == 0 ? 27 : -1 - 0.1 * a);
  return from(m * m * m, entries);
}

/// One seeded stream of everything random in a test.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  double normal() { return std::normal_distribution<double>()(engine_); }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }  ///< both included
  bool chance(double p) { return uniform(0, 1) < p; }
  Vec normals(Index n) {
    return Vec::NullaryExpr(n, [this] { return normal(); });
  }
  Dense normals(Index m, Index n) {
    return Dense::NullaryExpr(m, n, [this] { return normal(); });
  }

 private:
  std::mt19937 engine_;
};

/// About `per_row` normal entries off the diagonal a row, at random places (those that fall together add up).
inline Triplets scatter(Index n, int per_row, Random& random) {
  Triplets entries;
  const int last = static_cast<int>(n) - 1;
  for (Index k = 0; k < per_row * n; ++k) {
    const int i = random.integer(0, last);
    const int j = random.integer(0, last);
    if (i != j) entries.emplace_back(i, j, random.normal());
  }
  return entries;
}

/// Random, with a diagonal of order one: nonsingular with probability one, no dominance.
inline SpMat random_sparse(Index n, int per_row, Random& random) {
  Triplets entries = scatter(n, per_row, random);
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, random.uniform(0.5, 2));
  return from(n, entries);
}

/// B B' + (C - C'), B with half as many columns as rows: positive semidefinite, singular symmetric part.
inline SpMat psd_plus_skew(Index n, int per_row, Random& random) {
  SpMat M = from(n, scatter(n, per_row, random));
  Triplets factor;
  for (int i = 0; i < n; ++i) {
    factor.emplace_back(i, random.integer(0, static_cast<int>(n / 2)), random.normal());
    factor.emplace_back(i, random.integer(0, static_cast<int>(n / 2)), random.normal());
  }
  const SpMat B = from(n, factor);
  const SpMat Mt = M.transpose();
  const SpMat Bt = B.transpose();
  return SpMat(M - Mt) + SpMat(B * Bt);
}

/// The sum of the absolute entries of every row off the diagonal.
inline Vec row_sums(Index n, const Triplets& entries) {
  Vec sums = Vec::Zero(n);
  for (const auto& e : entries) sums[e.row()] += std::abs(e.value());
  return sums;
}

/// Row diagonally dominant with a positive diagonal: an H-matrix with positive diagonal, hence P (Cottle, Pang & Stone
/// 1992, section 3.3).
inline SpMat h_plus(Index n, int per_row, Random& random) {
  Triplets entries = scatter(n, per_row, random);
  const Vec sums = row_sums(n, entries);
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, sums[i] + random.uniform(0.01, 1));
  return from(n, entries);
}

/// The same with negative entries off the diagonal: a nonsingular M-matrix (K-matrix).
inline SpMat m_matrix(Index n, int per_row, Random& random) {
  Triplets entries = scatter(n, per_row, random);
  for (auto& e : entries) e = {e.row(), e.col(), -std::abs(e.value())};
  const Vec sums = row_sums(n, entries);
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, sums[i] + random.uniform(0.01, 1));
  return from(n, entries);
}

/// D H E with H of h_plus and positive diagonals D, E over four orders of magnitude: P, not dominant, not monotone.
inline SpMat p_matrix(Index n, int per_row, Random& random) {
  SpMat M = h_plus(n, per_row, random);
  const auto diagonal = [&] { return Vec(Vec::NullaryExpr(n, [&] { return std::pow(10, random.uniform(-2, 2)); })); };
  return diagonal().asDiagonal() * M * diagonal().asDiagonal();
}

inline Dense hilbert(Index n) {
  return Dense::NullaryExpr(n, n, [](Index i, Index j) { return 1.0 / static_cast<double>(i + j + 1); });
}

/// The five-point grid of N x N points: -1 to each neighbour.
inline SpMat five_point(int N, double diagonal) {
  Triplets entries;
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; ++i) {
      const int k = j * N + i;
      entries.emplace_back(k, k, diagonal);
      if (i > 0) entries.emplace_back(k, k - 1, -1);
      if (i + 1 < N) entries.emplace_back(k, k + 1, -1);
      if (j > 0) entries.emplace_back(k, k - N, -1);
      if (j + 1 < N) entries.emplace_back(k, k + N, -1);
    }
  return from(static_cast<Index>(N) * N, entries);
}

inline SpMat tridiagonal(Index n, double below, double diagonal, double above) {
  Triplets entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, diagonal);
    if (i > 0) entries.emplace_back(i, i - 1, below);
    if (i + 1 < n) entries.emplace_back(i, i + 1, above);
  }
  return from(n, entries);
}

/// Unit diagonal, 2 above it: Murty's example, with q = -e (Murty 1988, section 6.2).
inline SpMat murty(Index n) {
  Triplets entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 1);
    for (int j = i + 1; j < n; ++j) entries.emplace_back(i, j, 2);
  }
  return from(n, entries);
}

/// How far z is from the sign conditions of the problem, in extended precision and without a projection:
///     max_i max(l - z, z - u, min(F+, z - l), min(F-, u - z)),   F = M z + q.
inline double violation(const AffineMcp& problem, const Vec& z) {
  std::vector<long double> F(problem.q.begin(), problem.q.end());
  for (Index j = 0; j < problem.M.cols(); ++j)
    for (SpMat::InnerIterator it(problem.M, j); it; ++it)
      F[static_cast<std::size_t>(it.row())] += static_cast<long double>(it.value()) * static_cast<long double>(z[j]);
  long double worst = 0;
  for (Index i = 0; i < z.size(); ++i) {
    const long double f = F[static_cast<std::size_t>(i)];
    if (!std::isfinite(f) || !std::isfinite(z[i])) return infinity;
    const long double above_lower = static_cast<long double>(z[i]) - static_cast<long double>(problem.box.lower[i]);
    const long double below_upper = static_cast<long double>(problem.box.upper[i]) - static_cast<long double>(z[i]);
    const long double zero = 0;
    worst = std::max({worst, -above_lower, -below_upper, std::min(std::max(f, zero), above_lower),
                      std::min(std::max(-f, zero), below_upper)});
  }
  return static_cast<double>(worst);
}

/// A box with every kind of interval: free, one-sided both ways, two-sided, fixed.
inline Box mixed_box(Index n, Random& random) {
  Box box = Box::nonnegative(n);
  for (Index i = 0; i < n; ++i) {
    const int kind = random.integer(0, 5);
    if (kind == 1) box.lower[i] = -infinity;
    if (kind == 2) box.lower[i] = -infinity, box.upper[i] = random.normal();
    if (kind == 3) box.lower[i] = random.normal();
    if (kind == 4) box.lower[i] = random.normal(), box.upper[i] = box.lower[i] + random.uniform(0.01, 2);
    if (kind == 5) box.lower[i] = box.upper[i] = random.normal();
  }
  return box;
}

}  // namespace perp::support

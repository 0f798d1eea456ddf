// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Certificates checked in rational arithmetic, of exactly the doubles given, by nothing of contact/ but the problem.
#include <gmpxx.h>

#include <cmath>
#include <vector>

#include "contact/model/problem.hpp"

namespace perp::contact::test {

/// W'(y e_N) and q_N.y.
struct ExactProduct {
  std::vector<mpq_class> g{};
  mpq_class approach{};
};
inline ExactProduct exact_product(const Problem& problem, const Vec& y) {
  const int d = problem.dimension;
  ExactProduct out;
  out.g.resize(static_cast<std::size_t>(problem.q.size()));
  for (Index j = 0; j < problem.W.matrix().outerSize(); ++j)
    for (SpMat::InnerIterator it(problem.W.matrix(), j); it; ++it)
      if (it.row() % d == 0) out.g[static_cast<std::size_t>(j)] += mpq_class(it.value()) * mpq_class(y[it.row() / d]);
  for (Index a = 0; a < y.size(); ++a) out.approach += mpq_class(problem.q[d * a]) * mpq_class(y[a]);
  return out;
}

/// y >= 0, q_N.y < 0 and g_N <= 0, mu^2 |g_T|^2 <= g_N^2 in every contact: no r solves.
inline bool exactly_infeasible(const Problem& problem, const Vec& y) {
  if (y.size() != problem.contacts() || !y.allFinite() || (y.size() > 0 && y.minCoeff() < 0)) return false;
  const ExactProduct product = exact_product(problem, y);
  if (product.approach >= 0) return false;
  const int d = problem.dimension;
  for (Index a = 0; a < problem.contacts(); ++a) {
    const auto at = static_cast<std::size_t>(d * a);
    mpq_class squares = 0;
    for (std::size_t k = 1; k < static_cast<std::size_t>(d); ++k) squares += product.g[at + k] * product.g[at + k];
    const mpq_class mu(problem.mu[a]);
    if (product.g[at] > 0 || mu * mu * squares > product.g[at] * product.g[at]) return false;
  }
  return true;
}

/// -q_N.y / |P_K(W'(y e_N))| to 400 bits; infinite where the product is in the cone, 0 where y proves nothing.
inline double exact_radius(const Problem& problem, const Vec& y) {
  constexpr unsigned bits = 400;
  if (exactly_infeasible(problem, y)) return lcp::infinity;
  const ExactProduct product = exact_product(problem, y);
  if (product.approach >= 0 || y.minCoeff() < 0) return 0;
  mpf_class sum(0, bits);
  const int d = problem.dimension;
  for (Index a = 0; a < problem.contacts(); ++a) {
    const auto at = static_cast<std::size_t>(d * a);
    mpf_class squares(0, bits);
    for (std::size_t k = 1; k < static_cast<std::size_t>(d); ++k)
      squares += mpf_class(product.g[at + k], bits) * mpf_class(product.g[at + k], bits);
    const mpf_class T(sqrt(squares), bits);
    const mpf_class N(product.g[at], bits);
    const mpf_class mu(problem.mu[a], bits);
    const mpf_class reach(N + mu * T, bits);
    if (N > 0 && T <= mu * N)
      sum += N * N + squares;
    else if (reach > 0)
      sum += reach * reach / (1 + mu * mu);
  }
  const mpf_class radius(mpf_class(-product.approach, bits) / sqrt(sum), bits);
  return radius.get_d();
}

/// u_N > mu |u_T| of u = A x + q in every contact, exactly.
inline bool exactly_inside(const Problem& problem, const SpMat& A, const Vec& x) {
  std::vector<mpq_class> u;
  for (const double q : problem.q) u.emplace_back(q);
  for (Index j = 0; j < A.outerSize(); ++j)
    for (SpMat::InnerIterator it(A, j); it; ++it)
      u[static_cast<std::size_t>(it.row())] += mpq_class(it.value()) * mpq_class(x[j]);
  const int d = problem.dimension;
  for (Index a = 0; a < problem.contacts(); ++a) {
    const auto at = static_cast<std::size_t>(d * a);
    mpq_class squares = 0;
    for (std::size_t k = 1; k < static_cast<std::size_t>(d); ++k) squares += u[at + k] * u[at + k];
    const mpq_class mu(problem.mu[a]);
    if (u[at] <= 0 || mu * mu * squares >= u[at] * u[at]) return false;
  }
  return true;
}

/// The same of u = W r + q.
inline bool exactly_inside(const Problem& problem, const Vec& r) {
  return exactly_inside(problem, problem.W.matrix(), r);
}

/// Whether W + shift diag(W) is symmetric and positive semidefinite: L D L' in rationals, small W alone.
inline bool exactly_semidefinite(const Problem& problem, double shift) {
  const auto m = static_cast<std::size_t>(problem.q.size());
  std::vector<std::vector<mpq_class>> A(m, std::vector<mpq_class>(m));
  for (Index j = 0; j < problem.W.matrix().outerSize(); ++j)
    for (SpMat::InnerIterator it(problem.W.matrix(), j); it; ++it)
      A[static_cast<std::size_t>(it.row())][static_cast<std::size_t>(j)] += mpq_class(it.value());
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j < m; ++j)
      if (A[i][j] != A[j][i]) return false;
    A[i][i] += A[i][i] * mpq_class(shift);
  }
  for (std::size_t k = 0; k < m; ++k) {
    if (A[k][k] < 0) return false;
    for (std::size_t i = k + 1; i < m; ++i) {
      if (A[k][k] == 0 && A[i][k] != 0) return false;
      if (A[i][k] == 0) continue;
      const mpq_class factor = A[i][k] / A[k][k];
      for (std::size_t j = k + 1; j < m; ++j) A[i][j] -= factor * A[k][j];
    }
  }
  return true;
}

}  // namespace perp::contact::test

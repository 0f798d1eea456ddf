// SPDX-License-Identifier: Apache-2.0
/// The cost of a replacement in lcp::BasisFactor, refactorizations included, in units of one fresh UMFPACK
/// factorization of the same basis. Bases of a five-point Laplacian on a square grid and unit columns; the positions
/// exchanged are random.
#include <Eigen/SparseCore>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <utility>
#include <vector>

#include "lcp/lu/basis_factor.hpp"

namespace {

using perp::lcp::BasisFactor;
using perp::lcp::Index;
using perp::lcp::LuStatus;
using perp::lcp::SparseLu;
using perp::lcp::SparseVector;
using perp::lcp::SpMat;
using perp::lcp::Vec;
using Clock = std::chrono::steady_clock;

double since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

SpMat laplacian(int side) {
  const Index n = Index{side} * side;
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < n; ++k) {
    entries.emplace_back(k, k, 4);
    if (k >= side) entries.emplace_back(k, k - side, -1);
    if (k + side < n) entries.emplace_back(k, k + side, -1);
    if (k % side != 0) entries.emplace_back(k, k - 1, -1);
    if ((k + 1) % side != 0) entries.emplace_back(k, k + 1, -1);
  }
  SpMat A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

SpMat columns(const SpMat& A, const std::vector<Index>& basis) {
  SpMat B(A.rows(), A.rows());
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t p = 0; p < basis.size(); ++p) {
    const int column = static_cast<int>(p);
    if (basis[p] >= A.cols()) {
      entries.emplace_back(static_cast<int>(basis[p] - A.cols()), column, 1.0);
      continue;
    }
    for (SpMat::InnerIterator it(A, basis[p]); it; ++it)
      entries.emplace_back(static_cast<int>(it.row()), column, it.value());
  }
  B.setFromTriplets(entries.begin(), entries.end());
  return B;
}

/// false: a replacement went wrong.
bool measure(const char* what, int side, int replacements, const std::vector<Index>& basis) {
  const SpMat A = laplacian(side);
  const Index n = A.rows();
  const SpMat B = columns(A, basis);
  double fresh = 1e300;
  for (int k = 0; k < 3; ++k) {
    SparseLu lu;
    const auto begin = Clock::now();
    if (lu.factor(B) != LuStatus::Ok) return false;
    fresh = std::min(fresh, since(begin));
  }
  BasisFactor factor(A);
  if (factor.factor(basis) != LuStatus::Ok) return false;
  std::mt19937 random(1);
  SparseVector d(n);
  double places = 0;
  const auto begin = Clock::now();
  for (int made = 0; made < replacements;) {
    const auto p = std::uniform_int_distribution<Index>(0, n - 1)(random);
    const Index old = factor.basis()[static_cast<std::size_t>(p)];
    const Index q = old < n ? n + p : p;
    factor.ftran_column(q, d);
    if (factor.replace(p, q, d) == BasisFactor::Update::Singular) continue;
    ++made;
    places += d.full() ? static_cast<double>(n) : static_cast<double>(d.places().size());
    if (!factor.stale()) continue;
    const std::vector<Index> now = factor.basis();
    if (factor.factor(now) != LuStatus::Ok) return false;
  }
  const double each = since(begin) / replacements;
  const Vec b = Vec::Ones(n);
  Vec x(n);
  factor.ftran(b, x);
  std::printf(
      "%-22s n = %6ld, %4d replacements: fresh %8.3f ms, each %8.4f ms = 1/%-5.0f %3d refactorizations, "
      "%7.0f entries a column, residual %.1e\n",
      what, static_cast<long>(n), replacements, 1e3 * fresh, 1e3 * each, fresh / each, factor.factorizations() - 1,
      places / replacements, factor.residual(b, x).lpNorm<Eigen::Infinity>());
  return true;
}

}  // namespace

int main() {
  for (const auto& [side, replacements] : {std::pair{100, 200}, {316, 2000}}) {
    const Index n = Index{side} * side;
    std::vector<Index> scattered(static_cast<std::size_t>(n));
    std::vector<Index> halves(static_cast<std::size_t>(n));
    std::mt19937 random(2);
    for (Index i = 0; i < n; ++i) {
      scattered[static_cast<std::size_t>(i)] = random() % 2 ? i : n + i;
      halves[static_cast<std::size_t>(i)] = i < n / 2 ? i : n + i;
    }
    if (!measure("scattered half slacks", side, replacements, scattered) ||
        !measure("half of the grid", side, replacements, halves)) {
      std::fputs("a basis could not be factored\n", stderr);
      return EXIT_FAILURE;
    }
  }
  return EXIT_SUCCESS;
}

// SPDX-License-Identifier: Apache-2.0
#include "collection/random/random_lcps.hpp"

#include <cstddef>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "collection/base/build.hpp"

namespace perp::ncp::collection {
namespace {

using Entries = std::vector<Eigen::Triplet<double>>;

/// The Mersenne twister's numbers over 2^32. Not std::uniform_real_distribution, whose numbers are the library's
/// choice.
class Rng {
 public:
  explicit Rng(unsigned seed) : twister_(seed + 1U) {}
  Rng(const Rng&) = delete;
  Rng& operator=(const Rng&) = delete;

  double uniform(double low, double high) { return low + (high - low) * unit(); }
  bool chance(double p) { return unit() < p; }
  /// In 0, ..., n - 1.
  Index below(Index n) { return static_cast<Index>(unit() * static_cast<double>(n)); }

 private:
  double unit() { return static_cast<double>(twister_()) / 4294967296.0; }
  std::mt19937 twister_;
};

SpMat matrix(Index rows, Index columns, const Entries& entries) {
  SpMat M(rows, columns);
  M.setFromTriplets(entries.begin(), entries.end());
  return M;
}

/// `per_row` entries a row on the average, off the diagonal, each from `value`; entries in one place are added.
Entries scatter(Index rows, Index columns, Index per_row, Rng& rng, const std::function<double()>& value) {
  Entries entries;
  for (Index k = 0; k < per_row * rows; ++k) {
    const Index i = rng.below(rows);
    const Index j = rng.below(columns);
    const double entry = value();
    if (i != j) entries.emplace_back(static_cast<int>(i), static_cast<int>(j), entry);
  }
  return entries;
}

/// B B', two entries a row of B, at random places of all its columns.
SpMat gram(Index n, Index rank, Rng& rng) {
  Entries entries;
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 2; ++k) {
      const int column = static_cast<int>(rng.below(rank));
      entries.emplace_back(i, column, rng.uniform(-1, 1));
    }
  const SpMat B = matrix(n, rank, entries);
  const SpMat Bt = B.transpose();
  return B * Bt;
}

SpMat skew(Index n, Rng& rng) {
  const SpMat C = matrix(n, n, scatter(n, n, 1, rng, [&] { return rng.uniform(-1, 1); }));
  const SpMat Ct = C.transpose();
  return C - Ct;
}

/// The skew part is drawn first: compilers do not agree on which operand of + is.
SpMat gram_plus_skew(Index n, Index rank, Rng& rng) {
  const SpMat S = skew(n, rng);
  return gram(n, rank, rng) + S;
}

SpMat nonnegative(Index n, double least, Rng& rng) {
  Entries entries = scatter(n, n, 3, rng, [&] { return rng.uniform(0, 1); });
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, rng.uniform(least, 2));
  return matrix(n, n, entries);
}

/// Sets entries of M, which may be new.
SpMat with(SpMat M, const Entries& entries) {
  for (const auto& e : entries) M.coeffRef(e.row(), e.col()) = e.value();
  M.makeCompressed();
  return M;
}

SpMat strictly_copositive_matrix(Index n, Rng& rng) {
  return with(nonnegative(n, 0.5, rng), {{0, 0, 1}, {1, 1, 1}, {0, 1, 3}, {1, 0, 3}});
}

/// q = F - M z; an index is degenerate, z_i = F_i = 0, with that probability.
RandomLcp planted(SpMat M, double degenerate, Rng& rng) {
  const Index n = M.rows();
  Vec z = Vec::Zero(n);
  Vec F = Vec::Zero(n);
  for (Index i = 0; i < n; ++i) {
    const double size = rng.uniform(0.5, 2);
    const bool inside = rng.chance(0.5);
    if (rng.chance(degenerate)) continue;
    (inside ? z : F)[i] = size;
  }
  Vec q = F - M * z;
  return {.problem = lcp::standard_lcp(std::move(M), std::move(q)), .solution = z};
}

/// A right-hand side without meaning.
Vec any_q(Index n, Rng& rng) {
  Vec q(n);
  for (double& value : q) value = rng.uniform(-1, 1);
  return q;
}

}  // namespace

RandomLcp random_positive_definite(Index n, unsigned seed) {
  require_at_least("random-pd-own", "n", n, 1);
  Rng rng(seed);
  const SpMat M = gram_plus_skew(n, n, rng);
  Entries diagonal;
  for (int i = 0; i < n; ++i) diagonal.emplace_back(i, i, rng.uniform(0.1, 1));
  return planted(M + matrix(n, n, diagonal), 0, rng);
}

RandomLcp random_semidefinite(Index n, unsigned seed) {
  require_at_least("random-psd-own", "n", n, 2);
  Rng rng(seed);
  const SpMat M = gram_plus_skew(n, n / 2, rng);
  return planted(M, 0, rng);
}

RandomLcp random_p_matrix(Index n, unsigned seed) {
  require_at_least("random-p-own", "n", n, 2);
  Rng rng(seed);
  Entries entries = scatter(n, n, 3, rng, [&] { return rng.uniform(-1, 1); });
  std::erase_if(entries, [](const auto& e) { return e.row() < 2; });
  Vec sums = Vec::Zero(n);
  for (const auto& e : entries) sums[e.row()] += std::abs(e.value());
  for (int i = 2; i < n; ++i) entries.emplace_back(i, i, sums[i] + rng.uniform(0.1, 1));
  Vec E(n);
  for (double& value : E) value = std::exp2(rng.uniform(-3, 3));
  E[0] = 1;
  E[1] = 10;
  const SpMat H = with(matrix(n, n, entries), {{0, 0, 1}, {0, 1, 0.9}, {1, 1, 1}});
  return planted(with(H * E.asDiagonal(), {{0, 1, 9}}), 0, rng);
}

RandomLcp random_strictly_copositive(Index n, unsigned seed) {
  require_at_least("random-strictly-copositive-own", "n", n, 2);
  Rng rng(seed);
  return planted(strictly_copositive_matrix(n, rng), 0, rng);
}

RandomLcp random_copositive_plus(Index n, unsigned seed) {
  require_at_least("random-copositive-plus-own", "n", n, 4);
  Rng rng(seed);
  const Index half = n / 2;
  const SpMat M1 = gram(half, half / 2, rng);
  const SpMat M2 = strictly_copositive_matrix(n - half, rng);
  std::vector<int> order(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) {
    const auto j = static_cast<std::size_t>(rng.below(i + 1));
    order[static_cast<std::size_t>(i)] = order[j];
    order[j] = static_cast<int>(i);
  }
  Entries entries;
  const auto add = [&](const SpMat& part, Index first) {
    for (Index j = 0; j < part.cols(); ++j)
      for (SpMat::InnerIterator it(part, j); it; ++it)
        entries.emplace_back(order[static_cast<std::size_t>(first + it.row())],
                             order[static_cast<std::size_t>(first + j)], it.value());
  };
  add(M1, 0);
  add(M2, half);
  const SpMat M = matrix(n, n, entries) + skew(n, rng);
  return planted(M, 0, rng);
}

RandomLcp random_copositive(Index n, unsigned seed) {
  require_at_least("random-copositive-own", "n", n, 2);
  Rng rng(seed);
  return planted(with(nonnegative(n, 0, rng), {{0, 0, 0}, {0, 1, 1}}), 0, rng);
}

RandomLcp random_z_matrix(Index n, unsigned seed) {
  require_at_least("random-z-own", "n", n, 1);
  Rng rng(seed);
  Entries entries = scatter(n, n, 2, rng, [&] { return rng.uniform(-1, 0); });
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, i == 0 ? -0.2 : rng.uniform(-0.2, 2));
  return planted(matrix(n, n, entries), 0, rng);
}

RandomLcp random_bimatrix(Index m, Index n, unsigned seed) {
  require_at_least("random-bimatrix-own", "m", m, 1);
  require_at_least("random-bimatrix-own", "n", n, 1);
  Rng rng(seed);
  Entries entries;
  for (Index i = 0; i < m; ++i)
    for (Index j = 0; j < n; ++j) {
      entries.emplace_back(static_cast<int>(i), static_cast<int>(m + j), rng.uniform(0.1, 1));
      entries.emplace_back(static_cast<int>(m + j), static_cast<int>(i), rng.uniform(0.1, 1));
    }
  return {.problem = lcp::standard_lcp(matrix(m + n, m + n, entries), -Vec::Ones(m + n))};
}

RandomLcp random_degenerate(Index n, unsigned seed) {
  require_at_least("random-degenerate-own", "n", n, 2);
  Rng rng(seed);
  const SpMat M = gram_plus_skew(n, n / 2, rng);
  return planted(M, 0.5, rng);
}

RandomLcp random_infeasible(Index n, unsigned seed) {
  require_at_least("infeasible-monotone-own", "n", n, 2);
  Rng rng(seed);
  Entries B;
  for (int i = 1; i < n; ++i)
    for (int k = 0; k < 2; ++k) {
      const int column = static_cast<int>(rng.below(n));
      const double value = rng.uniform(-1, 1);
      B.emplace_back(i, column, value);
      if (i == 1) B.emplace_back(0, column, -value);
    }
  Entries W;
  for (const auto& e : scatter(n, n, 1, rng, [&] { return rng.uniform(-1, 1); })) {
    if (e.row() == 0 || e.col() == 0 || e.col() == 1) continue;  // rows 1 and 2 below, their columns by skewness
    W.emplace_back(e.row(), e.col(), e.value());
    W.emplace_back(e.col(), e.row(), -e.value());
    if (e.row() != 1) continue;
    W.emplace_back(0, e.col(), -e.value());
    W.emplace_back(e.col(), 0, e.value());
  }
  const SpMat factor = matrix(n, n, B);
  const SpMat transposed = factor.transpose();
  const SpMat M = factor * transposed + matrix(n, n, W);
  Vec q = any_q(n, rng);
  q[0] = -1 - q[1];
  return {.problem = lcp::standard_lcp(M, q), .certificate = Vec::Unit(n, 0) + Vec::Unit(n, 1)};
}

RandomLcp random_infeasible_row(Index n, unsigned seed) {
  require_at_least("infeasible-row-own", "n", n, 1);
  Rng rng(seed);
  Entries entries = scatter(n, n, 3, rng, [&] { return rng.uniform(-1, 1); });
  for (auto& e : entries)
    if (e.row() == 0) e = {e.row(), e.col(), -std::abs(e.value())};
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, i == 0 ? -1 : rng.uniform(0.5, 2));
  Vec q = any_q(n, rng);
  q[0] = -1;
  return {.problem = lcp::standard_lcp(matrix(n, n, entries), q), .certificate = Vec::Unit(n, 0)};
}

}  // namespace perp::ncp::collection

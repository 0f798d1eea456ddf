// SPDX-License-Identifier: Apache-2.0
/// Bimatrix games as linear complementarity problems.
#include "collection/base/build.hpp"
#include "collection/base/random.hpp"
#include "collection/scalable/generators.hpp"

namespace perp::ncp::collection {

namespace {

/// k positive weights in random places.
Vec mixed_strategy(Index n, Index k, Random& random) {
  Vec x = Vec::Zero(n);
  const std::vector<Index> order = random.order(n);
  for (Index i = 0; i < k; ++i) x[order[static_cast<std::size_t>(i)]] = random.uniform(0.5, 1.5);
  return x;
}

/// Positive costs of the strategies (rows) of one player against those of the other such that the costs against
/// `opponent` are 1 where `own` plays and more than 1 elsewhere.
Eigen::MatrixXd costs(const Vec& own, const Vec& opponent, Random& random) {
  Eigen::MatrixXd made(own.size(), opponent.size());
  for (Index i = 0; i < made.rows(); ++i) {
    for (Index j = 0; j < made.cols(); ++j) made(i, j) = random.uniform(0.1, 1);
    const double wanted = own[i] > 0 ? 1 : random.uniform(1.1, 1.5);
    made.row(i) *= wanted / made.row(i).dot(opponent);
  }
  return made;
}

}  // namespace

Problem bimatrix_own(Index m, Index n, unsigned seed) {
  require_at_least("bimatrix-own", "m", m, 1);
  require_at_least("bimatrix-own", "n", n, 1);
  Random random(seed);
  const Index support = std::max<Index>(1, std::min(m, n) / 2);
  const Vec x = mixed_strategy(m, support, random), y = mixed_strategy(n, support, random);
  const Eigen::MatrixXd A = costs(x, y, random), transposed_B = costs(y, x, random);

  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < m; ++i)
    for (Index j = 0; j < n; ++j) {
      entries.emplace_back(i, m + j, A(i, j));
      entries.emplace_back(m + j, i, transposed_B(j, i));
    }
  SpMat M(m + n, m + n);
  M.setFromTriplets(entries.begin(), entries.end());

  Problem p;
  p.mcp = make_affine({"bimatrix-own", Box::nonnegative(m + n), joined({indexed("x", m), indexed("y", n)}),
                       joined({indexed("row_cost", m), indexed("column_cost", n)})},
                      M, -Vec::Ones(m + n));
  p.starts = {Vec::Zero(m + n), Vec::Ones(m + n), Vec::Constant(m + n, 0.01)};
  p.solutions = {{"planted", joined({x, y}), 1e-12}};
  return p;
}

}  // namespace perp::ncp::collection

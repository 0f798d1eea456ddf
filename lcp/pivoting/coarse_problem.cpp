// SPDX-License-Identifier: Apache-2.0
#include "lcp/pivoting/coarse_problem.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "lcp/linalg/multilevel.hpp"

namespace perp::lcp {
namespace {

constexpr double strong = 0.25;  // share of the largest entry: Ruge & Stueben 1987

bool of_mesh(const SpMat& S) {
  Index positive = 0;
  Index diagonal = 0;
  for (Index j = 0; j < S.cols(); ++j)
    for (SpMat::InnerIterator it(S, j); it; ++it) {
      diagonal += it.row() == j && it.value() > 0;
      positive += it.row() != j && it.value() > 0;
    }
  return diagonal == S.cols() && 10 * positive < S.nonZeros();
}

SpMat matrix_of(const SparseRows& rows, Index columns) {
  return Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor, int>>(
      rows.rows(), columns, static_cast<Index>(rows.value.size()), rows.start.data(), rows.column.data(),
      rows.value.data());
}

}  // namespace

std::optional<CoarseProblem> coarser(const AffineMcp& problem) {
  const Index n = problem.size();
  const SpMat S = 0.5 * (SpMat(problem.M.transpose()) + problem.M);
  if (!of_mesh(S)) return std::nullopt;
  Hierarchy hierarchy(rows_of(S), strong, static_cast<int>(n - 1));
  if (hierarchy.grids.size() < 2) return std::nullopt;
  Grid& fine = hierarchy.grids.front();
  const Index size = static_cast<Index>(fine.c_points.size());
  if (10 * size > 7 * n) return std::nullopt;
  CoarseProblem coarse{.problem = {}, .P = matrix_of(fine.P, size), .fine_of = std::move(fine.c_points)};
  const SpMat transposed = coarse.P.transpose();
  coarse.problem.M = transposed * SpMat(problem.M * coarse.P);
  if (coarse.problem.M.nonZeros() > problem.M.nonZeros()) return std::nullopt;
  coarse.problem.q = transposed * problem.q;
  coarse.problem.box = {problem.box.lower(coarse.fine_of), problem.box.upper(coarse.fine_of)};
  return coarse;
}

Cells CoarseProblem::finer(const Cells& coarse, const Box& box) const {
  std::vector<std::array<double, 3>> weight(static_cast<std::size_t>(P.rows()), {0, 0, 0});
  for (Index j = 0; j < P.cols(); ++j)
    for (SpMat::InnerIterator it(P, j); it; ++it)
      weight[static_cast<std::size_t>(it.row())][static_cast<std::size_t>(coarse[static_cast<std::size_t>(j)])] +=
          it.value();
  Cells fine = all_inside(box);
  for (std::size_t i = 0; i < fine.size(); ++i) {
    const auto& [lower, inside, upper] = weight[i];  // in the order of Cell
    const auto k = static_cast<Index>(i);
    if (box.lower[k] == box.upper[k]) continue;
    if (lower > std::max(upper, inside) && box.lower[k] > -infinity) fine[i] = Cell::Below;
    if (upper > std::max(lower, inside) && box.upper[k] < infinity) fine[i] = Cell::Above;
  }
  return fine;
}

}  // namespace perp::lcp

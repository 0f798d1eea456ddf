// SPDX-License-Identifier: Apache-2.0
#include "contact/model/facts.hpp"
#include "lcp/dense_factors.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace perp::contact {
namespace {

using Rows = std::vector<Index>;

SpMat unit_diagonal(const SpMat& W) {
  Vec D = W.diagonal();
  for (double& d : D) {
    const double root = std::sqrt(std::abs(d));
    d = root > 0 && std::isfinite(1 / root) ? 1 / root : 1;
  }
  SpMat S = D.asDiagonal() * W * D.asDiagonal();
  S.makeCompressed();
  return S;
}

double asymmetry(const SpMat& S) {
  const SpMat skew = S - SpMat(S.transpose());
  double largest = 0;
  for (Index j = 0; j < skew.cols(); ++j)
    for (SpMat::InnerIterator it(skew, j); it; ++it) largest = std::max(largest, std::abs(it.value()));
  return largest;
}

/// The rows of each group of contacts.
std::vector<Rows> parts(const Delassus& W, int d) {
  std::vector<Rows> all;
  for (const std::vector<Index>& group : W.groups(d)) {
    Rows& rows = all.emplace_back();
    for (const Index a : group)
      for (int k = 0; k < d; ++k) rows.push_back(d * a + k);
  }
  return all;
}

/// Of (S + S') / 2 in these rows and columns. `place` is workspace, -1 everywhere. Entries in other rows are zeros that
/// are stored, or too small for a group.
Vec eigenvalues(const SpMat& S, const Rows& rows, std::vector<Index>& place) {
  const auto size = static_cast<Index>(rows.size());
  for (Index k = 0; k < size; ++k) place[static_cast<std::size_t>(rows[static_cast<std::size_t>(k)])] = k;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(size, size);
  for (Index j = 0; j < size; ++j)
    for (SpMat::InnerIterator it(S, rows[static_cast<std::size_t>(j)]); it; ++it) {
      const Index i = place[static_cast<std::size_t>(it.row())];
      if (i < 0) continue;
      A(std::max(i, j), std::min(i, j)) += (i == j ? 1 : 0.5) * it.value();
    }
  for (const Index row : rows) place[static_cast<std::size_t>(row)] = -1;
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace

Facts facts(const Problem& problem, const FactsOptions& options) {
  check(problem);
  Facts out;
  const std::vector<Rows> all = parts(problem.W, problem.dimension);
  out.parts = static_cast<Index>(all.size());
  for (const Rows& rows : all) out.largest_part = std::max(out.largest_part, static_cast<Index>(rows.size()));
  out.known = out.largest_part <= options.dense_limit;
  if (const DelassusParts* parts = problem.W.parts(); parts != nullptr && !out.known) {
    out.asymmetry = asymmetry(unit_diagonal(parts->M()));  // nobody needs the entries
    return out;
  }
  const SpMat S = unit_diagonal(problem.W.matrix());
  out.asymmetry = asymmetry(S);
  if (!out.known || all.empty()) return out;
  std::vector<Index> place(static_cast<std::size_t>(S.rows()), -1);
  std::vector<double> values;
  for (const Rows& rows : all) {
    const Vec of_part = eigenvalues(S, rows, place);
    values.insert(values.end(), of_part.begin(), of_part.end());
  }
  const auto [least, largest] = std::minmax_element(values.begin(), values.end());
  out.least = *least;
  out.largest = *largest;
  const double none = options.rank_tol * std::max(std::abs(*least), std::abs(*largest));
  out.rank = std::count_if(values.begin(), values.end(), [&](double value) { return std::abs(value) > none; });
  return out;
}

}  // namespace perp::contact

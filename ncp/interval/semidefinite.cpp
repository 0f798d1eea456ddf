// SPDX-License-Identifier: Apache-2.0
#include "ncp/interval/semidefinite.hpp"

#include <cfloat>  // which gmpxx.h uses

#include <gmpxx.h>

#include <cmath>
#include <utility>
#include <vector>

#include "ncp/interval/interval.hpp"

namespace perp::ncp {
namespace {

using lcp::Index;
using lcp::SpMat;
using Rows = std::vector<Index>;

/// The connected components of B's graph.
std::vector<Rows> components(const SpMat& B) {
  std::vector<Rows> all;
  std::vector<char> reached(static_cast<std::size_t>(B.cols()), 0);
  for (Index first = 0; first < B.cols(); ++first) {
    if (std::exchange(reached[static_cast<std::size_t>(first)], 1) != 0) continue;
    Rows rows{first};
    for (std::size_t k = 0; k < rows.size(); ++k)
      for (SpMat::InnerIterator it(B, rows[k]); it; ++it)
        if (it.value() != 0 && std::exchange(reached[static_cast<std::size_t>(it.row())], 1) == 0)
          rows.push_back(it.row());
    all.push_back(std::move(rows));
  }
  return all;
}

bool dominant(const SpMat& B, const Rows& rows) {
  for (const Index j : rows) {
    Interval rest = 0;
    for (SpMat::InnerIterator it(B, j); it; ++it) rest += it.row() == j ? it.value() : -std::abs(it.value());
    if (!(rest.lower >= 0)) return false;
  }
  return true;
}

bool exactly_semidefinite(const SpMat& B, const Rows& rows) {
  const std::size_t n = rows.size();
  std::vector<std::vector<mpq_class>> A(n, std::vector<mpq_class>(n));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) A[i][j] = B.coeff(rows[i], rows[j]);
  for (std::size_t k = 0; k < n; ++k) {
    if (sgn(A[k][k]) < 0) return false;
    for (std::size_t i = k + 1; i < n; ++i) {
      if (sgn(A[i][k]) == 0) continue;
      if (sgn(A[k][k]) == 0) return false;
      const mpq_class factor = A[i][k] / A[k][k];
      for (std::size_t j = k + 1; j < n; ++j) A[i][j] -= factor * A[k][j];
    }
  }
  return true;
}

}  // namespace

bool surely_semidefinite(const SpMat& B, Index exact_to) {
  for (const Rows& rows : components(B))
    if (!dominant(B, rows) && (static_cast<Index>(rows.size()) > exact_to || !exactly_semidefinite(B, rows)))
      return false;
  return true;
}

}  // namespace perp::ncp

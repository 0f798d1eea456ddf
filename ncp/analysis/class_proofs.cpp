// SPDX-License-Identifier: Apache-2.0
#include "ncp/analysis/class_proofs.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "lcp/dense_factors.hpp"
#include "ncp/interval/semidefinite.hpp"
#include "ncp/problem/words.hpp"

namespace perp::ncp {
namespace {

using Dense = ::Eigen::MatrixXd;
using IntervalMatrix = std::vector<std::vector<Interval>>;

Interval diagonal(const JacobianRange& range, Index i) {
  for (const JacobianRange::Entry& entry : range.rows[at(i)])
    if (entry.col == i) return entry.value;
  return 0;
}

/// J_ij + J_ji, i < j, where it is not 0.
std::map<std::pair<Index, Index>, Interval> off_diagonal(const JacobianRange& range) {
  std::map<std::pair<Index, Index>, Interval> sums;
  for (Index i = 0; i < range.size(); ++i)
    for (const auto& [j, value] : range.rows[at(i)])
      if (i != j) sums[std::minmax(i, j)] += value;
  std::erase_if(sums, [](const auto& sum) { return sum.second == Interval(0); });
  return sums;
}

/// Of the symmetric B: its least eigenvalue is at least this (Weyl, and the backward error of the tridiagonal QR).
double least_eigenvalue(const Dense& B) {
  const ::Eigen::SelfAdjointEigenSolver<Dense> eigen(B, ::Eigen::EigenvaluesOnly);
  if (eigen.info() != ::Eigen::Success) return -infinity;
  // Squares of small entries vanish: the norm is scaled. What rounds below the normal numbers, the last term covers.
  const double error = 20 * static_cast<double>(B.rows()) * std::numeric_limits<double>::epsilon() * B.stableNorm() +
                       10 * std::numeric_limits<double>::denorm_min();
  return eigen.eigenvalues().minCoeff() - error;
}

/// Of the symmetric B: the tests in floating point say so of B less 1e-7 of its diagonal, far beyond what they may err
/// by, which they call "to rounding": 1e-13 n on a diagonal near 1, n up to 50,000. No: one of their steps might
/// overflow or underflow.
bool semidefinite_by_a_margin(SpMat B) {
  constexpr double margin = 1e-7, tiny = 1e-100, huge = 1e100;
  const auto usual = [](double entry) { return entry == 0 || (std::abs(entry) > tiny && std::abs(entry) < huge); };
  if (!std::all_of(B.valuePtr(), B.valuePtr() + B.nonZeros(), usual)) return false;
  for (Index i = 0; i < B.rows(); ++i) B.coeffRef(i, i) *= 1 - margin;
  return lcp::positive_semidefinite(B).yes();
}

/// Tsatsomeros & Li: A is P iff a_11 > 0, A without the first row and column is P, and so is the Schur complement.
bool all_p(const IntervalMatrix& A) {
  const std::size_t n = A.size();
  if (n == 0) return true;
  if (!(A[0][0].lower > 0)) return false;
  IntervalMatrix rest(n - 1, std::vector<Interval>(n - 1)), schur = rest;
  for (std::size_t i = 1; i < n; ++i)
    for (std::size_t j = 1; j < n; ++j) {
      rest[i - 1][j - 1] = A[i][j];
      schur[i - 1][j - 1] = A[i][j] - A[i][0] * A[0][j] / A[0][0];
    }
  return all_p(rest) && all_p(schur);
}

/// C of class_proofs.hpp; nothing where an entry is unbounded.
bool comparison(const JacobianRange& range, Dense& C) {
  C = Dense::Zero(range.size(), range.size());
  for (Index i = 0; i < range.size(); ++i)
    for (const auto& [j, value] : range.rows[at(i)]) C(i, j) = i == j ? value.lower : -value.magnitude();
  return C.allFinite();
}

bool every_h_plus(const JacobianRange& range) {
  Dense C;
  if (!comparison(range, C) || !(C.diagonal().array() > 0).all()) return false;
  const Vec v = ::Eigen::PartialPivLU<Dense>(C).solve(Vec::Ones(range.size()));
  if (!v.allFinite() || !(v.array() > 0).all()) return false;
  for (Index i = 0; i < range.size(); ++i) {
    Interval sum = 0;
    for (Index j = 0; j < range.size(); ++j) sum += Interval(C(i, j)) * v[j];
    if (!(sum.lower > 0)) return false;
  }
  return true;
}

}  // namespace

JacobianRange jacobian_range(const Mcp& mcp, const Enclosure& enclosure) {
  const Box& box = mcp.box();
  std::vector<Interval> X(at(mcp.size()));
  std::vector<Index> place(at(mcp.size()), -1);
  JacobianRange range;
  for (Index i = 0; i < mcp.size(); ++i) {
    X[at(i)] = {box.lower[i], box.upper[i]};
    if (box.lower[i] == box.upper[i]) continue;
    place[at(i)] = static_cast<Index>(range.variables.size());
    range.variables.push_back(i);
  }
  const SpMat& pattern = mcp.jacobian_pattern();
  std::vector<Interval> J(at(pattern.nonZeros()));
  std::vector<char> known(at(mcp.size()), 0);
  enclosure.jacobian(X, J, known);
  range.rows.resize(range.variables.size());
  std::size_t k = 0;
  for (Index j = 0; j < pattern.cols(); ++j)
    for (SpMat::InnerIterator it(pattern, j); it; ++it, ++k) {
      const Index row = place[at(it.row())], col = place[at(j)];
      if (row >= 0 && col >= 0 && J[k] != Interval(0)) range.rows[at(row)].push_back({col, J[k]});
    }
  // The row of a fixed variable has no entries here, but where it has no value F has none.
  std::vector<Interval> F(at(mcp.size()));
  std::vector<char> defined(at(mcp.size()), 0);
  enclosure.values(X, F, defined);
  for (Index i = 0; i < mcp.size() && range.unknown.empty(); ++i) {
    const bool fixed = place[at(i)] < 0;
    if (fixed ? defined[at(i)] == 0 : known[at(i)] == 0)
      range.unknown = "equation " + mcp.equation_name(i) + " is not known to be " + (fixed ? "defined" : "smooth") +
                      " on all of the box";
  }
  return range;
}

Definiteness definiteness(const JacobianRange& range, Index dense_to) {
  Definiteness out;
  const Index n = range.size();
  std::vector<Interval> low(at(n));
  for (Index i = 0; i < n; ++i) low[at(i)] = 2 * Interval(diagonal(range, i).lower);
  std::vector<::Eigen::Triplet<double>> entries;
  for (const auto& [place, sum] : off_diagonal(range)) {
    const auto [i, j] = place;
    if (!sum.bounded()) {
      out.why_not = "the sum of J's entries (" + std::to_string(i + 1) + ", " + std::to_string(j + 1) +
                    ") and its mirror image has no bound on the box";
      return out;
    }
    const double middle = sum.lower + (sum.upper - sum.lower) / 2;
    const double radius = std::max((sum - middle).upper, (Interval(middle) - sum).upper);
    for (const Index k : {i, j}) low[at(k)] = low[at(k)] - radius;
    entries.emplace_back(static_cast<int>(i), static_cast<int>(j), middle);
    entries.emplace_back(static_cast<int>(j), static_cast<int>(i), middle);
  }
  for (Index i = 0; i < n; ++i) {
    const double d = low[at(i)].lower;
    if (!(d >= 0)) {
      out.why_not = "J_ii less what lies beside it may be as low as " + number(d / 2) +
                    " on the box, i = " + std::to_string(range.variables[at(i)] + 1);
      return out;
    }
    entries.emplace_back(static_cast<int>(i), static_cast<int>(i), d);
  }
  SpMat B(n, n);
  B.setFromTriplets(entries.begin(), entries.end());
  if (n <= dense_to)
    if (const double least = least_eigenvalue(Dense(B)); least > 0) out.modulus = least / 2;
  if (surely_semidefinite(B) || semidefinite_by_a_margin(B))
    out.semidefinite = "J + J' is positive semidefinite on the box";
  else
    out.why_not = "the ranges of J leave room for directions of negative curvature";
  return out;
}

std::string uniform_p(const JacobianRange& range, const FunctionClassOptions& options) {
  if (range.size() <= options.dense_to && every_h_plus(range))
    return "every J on the box is an H-matrix with positive diagonal";
  if (range.size() > options.minors_to) return "";
  IntervalMatrix A(at(range.size()), std::vector<Interval>(at(range.size())));
  for (Index i = 0; i < range.size(); ++i)
    for (const auto& [j, value] : range.rows[at(i)]) {
      if (!value.bounded()) return "";
      A[at(i)][at(j)] = value;
    }
  return all_p(A) ? "every J on the box is a P-matrix, by Schur complements of its ranges" : "";
}

bool dominant(const JacobianRange& range) {
  for (Index i = 0; i < range.size(); ++i) {
    Interval rest = diagonal(range, i).lower;
    for (const auto& [j, value] : range.rows[at(i)])
      if (i != j) rest = rest - value.magnitude();
    if (!(rest.lower >= 0)) return false;
  }
  return true;
}

}  // namespace perp::ncp

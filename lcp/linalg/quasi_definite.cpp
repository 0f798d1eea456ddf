// SPDX-License-Identifier: Apache-2.0
#include "lcp/linalg/quasi_definite.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>
#include <vector>

namespace perp::lcp {
namespace {

bool same_pattern(const SpMat& A, const SpMat& B) {
  return A.isCompressed() && B.isCompressed() && A.nonZeros() == B.nonZeros() &&
         std::equal(A.outerIndexPtr(), A.outerIndexPtr() + A.cols(), B.outerIndexPtr()) &&
         std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), B.innerIndexPtr());
}

/// take(i, M_ij, M_ji) for the entries of column j, i != j, until one answers false.
template <class Take>
bool both_ways(const SpMat& M, const SpMat& Mt, bool same, Index j, Take take) {
  if (same) {
    for (Index p = M.outerIndexPtr()[j]; p < M.outerIndexPtr()[j + 1]; ++p)
      if (const Index i = M.innerIndexPtr()[p]; i != j && !take(i, M.valuePtr()[p], Mt.valuePtr()[p])) return false;
    return true;
  }
  SpMat::InnerIterator it(M, j), back(Mt, j);
  while (it || back) {
    const Index i = !back || (it && it.row() < back.row()) ? it.row() : back.row();
    const double a = it && it.row() == i ? it.value() : 0;
    const double b = back && back.row() == i ? back.value() : 0;
    if (it && it.row() == i) ++it;
    if (back && back.row() == i) ++back;
    if (i != j && !take(i, a, b)) return false;
  }
  return true;
}

/// R_i != 0 with symmetric R M, found from row to row along the pairs off the diagonal that are not zero. equal(R_i
/// M_ij, R_j M_ji): a row that is met again fits. part: the connected component of each row.
template <class Equal>
std::optional<Vec> row_factors(const SpMat& M, const SpMat& Mt, bool same, std::vector<Index>& part, Equal equal) {
  const Index n = M.rows();
  Vec R = Vec::Zero(n);
  std::vector<Index> stack;
  part.assign(at(n), -1);
  for (Index first = 0; first < n; ++first) {
    if (R[first] != 0) continue;
    R[first] = 1;
    stack.push_back(first);
    while (!stack.empty()) {
      const Index j = stack.back();
      stack.pop_back();
      part[at(j)] = first;
      const bool fits = both_ways(M, Mt, same, j, [&](Index i, double a, double b) {
        if (a == 0 || b == 0) return true;
        if (R[i] == 0) stack.push_back(i), R[i] = a == b ? R[j] : a == -b ? -R[j] : R[j] * (b / a);
        return R[i] != 0 && std::isfinite(R[i]) && equal(R[i] * a, R[j] * b);
      });
      if (!fits) return std::nullopt;
    }
  }
  return R;
}

/// Returns whether entries without a mirror image lead from components that none leads to: then the factors without
/// them make two steps of refinement exact.
bool at_most_one_after_another(const SpMat& M, const SpMat& Mt, bool same, const std::vector<Index>& part) {
  enum : char { Unknown, From, To };
  std::vector<char> role(part.size(), Unknown);
  const auto is = [&](Index p, char wanted) {
    char& now = role[at(p)];
    if (now == Unknown) now = wanted;
    return now == wanted;
  };
  for (Index j = 0; j < M.cols(); ++j)
    if (!both_ways(M, Mt, same, j, [&](Index i, double a, double b) {
          const Index of_i = part[at(i)], of_j = part[at(j)];
          return a == 0 || b != 0 || (of_i != of_j && is(of_j, From) && is(of_i, To));
        }))
      return false;
  return true;
}

bool without_mirror_image(const SpMat& M, const SpMat& Mt, bool same) {
  for (Index j = 0; j < M.cols(); ++j)
    if (!both_ways(M, Mt, same, j, [](Index, double a, double b) { return (a == 0) == (b == 0); })) return true;
  return false;
}

/// Asymmetry that rounding and the walk from row to row may leave, relative; refinement makes it good.
constexpr double rounding = 1e-9;

}  // namespace

std::optional<Vec> signs_of(const SpMat& M) {
  const SpMat Mt = M.transpose();
  const bool same = same_pattern(M, Mt);
  std::vector<Index> part;
  if (without_mirror_image(M, Mt, same)) return std::nullopt;
  return row_factors(M, Mt, same, part, [](double a, double b) { return a == b; });
}

SpMat with_diagonal(const SpMat& M) {
  SpMat zeros(M.rows(), M.rows());
  zeros.setIdentity();
  zeros *= 0;
  SpMat out = M + zeros;
  out.makeCompressed();
  return out;
}

QuasiDefinite::QuasiDefinite() : cholesky_(CholeskyOrdering::Thorough) {}

bool QuasiDefinite::analyze(const SpMat& M) {
  const SpMat Mt = M.transpose();
  const bool same = same_pattern(M, Mt);
  std::vector<Index> part;
  const auto R =
      row_factors(M, Mt, same, part, [](double a, double b) { return std::abs(a - b) <= rounding * std::abs(a); });
  if (!R || !at_most_one_after_another(M, Mt, same, part)) return false;
  R_ = *R;
  lower_ = M.triangularView<Eigen::Lower>();
  lower_.makeCompressed();
  for (Index j = 0; j < M.cols(); ++j) {
    SpMat::InnerIterator back(Mt, j);
    for (SpMat::InnerIterator it(lower_, j); it; ++it) {
      while (back && back.row() < it.row()) ++back;
      const bool paired = back && back.row() == it.row() && back.value() != 0;
      it.valueRef() = paired ? R_[it.row()] * it.value() : 0;
    }
  }
  diagonal_ = lower_.diagonal();
  std::vector<signed char> signs(at(M.rows()));
  for (Index i = 0; i < M.rows(); ++i) signs[at(i)] = R_[i] > 0 ? 1 : -1;
  if (signs != signs_) cholesky_.set_signs(signs);
  signs_ = std::move(signs);
  const CholeskyStatus status = cholesky_.analyze(lower_);
  if (status == CholeskyStatus::OutOfMemory) throw std::bad_alloc();
  return status == CholeskyStatus::Ok;
}

bool QuasiDefinite::factor(In d) {
  for (Index j = 0; j < lower_.cols(); ++j) lower_.valuePtr()[lower_.outerIndexPtr()[j]] = diagonal_[j] + R_[j] * d[j];
  return cholesky_.try_factor(lower_);
}

void QuasiDefinite::solve(In b, Out x) const { cholesky_.solve(R_.cwiseProduct(b), x); }

}  // namespace perp::lcp

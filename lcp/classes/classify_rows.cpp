// SPDX-License-Identifier: Apache-2.0
/// What the rows and columns of a matrix say: magnitudes, dominance, Jacobi's radius.
#include <algorithm>
#include <cmath>

#include "lcp/classes/classify_parts.hpp"
#include "lcp/exact_sum.hpp"

namespace perp::lcp {

Exponents exponents(const SpMat& M) {
  double least = infinity;
  double most = 0;
  for (Index j = 0; j < M.cols(); ++j)
    for (SpMat::InnerIterator it(M, j); it; ++it) {
      if (it.value() == 0) continue;
      least = std::min(least, std::abs(it.value()));
      most = std::max(most, std::abs(it.value()));
    }
  return most == 0 ? Exponents{} : Exponents{std::ilogb(least), std::ilogb(most)};
}

int centring(const Exponents& e) { return std::min(-(e.most + e.least) / 4 * 2, 1020 - e.most); }

SpMat centred(const SpMat& M, const Exponents& e) {
  const int k = centring(e);
  SpMat A = M;
  for (Index j = 0; j < A.cols(); ++j)
    for (SpMat::InnerIterator it(A, j); it; ++it) it.valueRef() = std::ldexp(it.value(), k);
  return A;
}

Dominance dominance_of_columns(const SpMat& A, double tol) {
  Dominance d;
  d.strict_columns.assign(at(A.cols()), 0);
  for (Index j = 0; j < A.cols(); ++j) {
    double diagonal = 0;
    double others = 0;
    ExactSum excess;
    for (SpMat::InnerIterator it(A, j); it; ++it) {
      it.row() == j ? diagonal = it.value() : others += std::abs(it.value());
      excess.add(it.row() == j ? it.value() : -std::abs(it.value()));
    }
    d.overflow = d.overflow || !excess.exact();
    const double zero = tol * (std::abs(diagonal) + others);
    const bool weak = diagonal >= 0 && diagonal - others >= -zero;
    const bool strict = excess.sign() > 0;
    d.strict_columns[at(j)] = strict;
    if (!weak && d.violated < 0) d.violated = j;
    if (!strict && d.not_strict < 0) d.not_strict = j;
    d.weak = d.weak && weak;
    d.strict = d.strict && diagonal - others > zero;
    d.exactly_weak = d.exactly_weak && excess.sign() >= 0;
    d.exactly_strict = d.exactly_strict && strict;
  }
  if (d.overflow) d.weak = d.strict = d.exactly_weak = d.exactly_strict = false;
  return d;
}

bool chained(const Dominance& dominance, const SpMat& B) {
  std::vector<Index> queue;
  std::vector<char> reached = dominance.strict_columns;
  for (Index i = 0; i < B.rows(); ++i)
    if (reached[at(i)]) queue.push_back(i);
  for (std::size_t next = 0; next < queue.size(); ++next)
    for (SpMat::InnerIterator it(B, queue[next]); it; ++it)
      if (it.value() != 0 && !reached[at(it.row())]) {
        reached[at(it.row())] = 1;
        queue.push_back(it.row());
      }
  return static_cast<Index>(queue.size()) == B.rows();
}

JacobiRadius jacobi_radius(const SpMat& M, const std::vector<int>& component, int sweeps, double tol) {
  const Index n = M.rows();
  const auto parts = static_cast<std::size_t>(n > 0 ? *std::max_element(component.begin(), component.end()) + 1 : 0);
  const Vec diagonal = M.diagonal();
  JacobiRadius r{.x = Vec::Ones(n)};
  if (exponents(M).wide()) {  // the quotients would overflow
    r.lower.assign(parts, 0);
    r.upper.assign(parts, infinity);
    return r;
  }
  Vec y(n);
  for (int sweep = 0; sweep < std::max(1, sweeps); ++sweep) {
    y.setZero();
    for (Index j = 0; j < n; ++j)
      for (SpMat::InnerIterator it(M, j); it; ++it)
        if (it.row() != j && component[at(it.row())] == component[at(j)]) y[it.row()] += std::abs(it.value()) * r.x[j];
    r.lower.assign(parts, infinity);
    r.upper.assign(parts, 0);
    std::vector<double> largest(parts, 0);
    for (Index i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(component[at(i)]);
      y[i] /= diagonal[i];
      r.lower[k] = std::min(r.lower[k], y[i] / r.x[i]);
      r.upper[k] = std::max(r.upper[k], y[i] / r.x[i]);
      largest[k] = std::max(largest[k], r.x[i] + y[i]);
    }
    bool open = false;
    bool refuted = false;
    for (std::size_t k = 0; k < parts; ++k) {
      open = open || r.upper[k] >= 1 - tol;
      refuted = refuted || r.lower[k] > 1 + tol || r.lower[k] == 1;
    }
    if (!open || refuted || sweep + 1 >= sweeps) break;
    // (I + J) / 2, which is aperiodic; an x that has underflowed stays positive, and its bounds are then useless.
    for (Index i = 0; i < n; ++i)
      r.x[i] = std::max((r.x[i] + y[i]) / largest[static_cast<std::size_t>(component[at(i)])], 1e-300);
  }
  return r;
}

}  // namespace perp::lcp

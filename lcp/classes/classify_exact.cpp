// SPDX-License-Identifier: Apache-2.0
/// What is exactly zero, and what rounding has made zero.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

#include "lcp/classes/classify_parts.hpp"
#include "lcp/exact_sum.hpp"

namespace perp::lcp {
namespace {

using Dense = Eigen::MatrixXd;

/// Of the exact sum; nothing where products leave the range.
std::optional<int> sign(const ExactSum& sum) { return sum.exact() ? std::optional(sum.sign()) : std::nullopt; }

/// Of v'Mv.
std::optional<int> sign_of_form(const SpMat& M, const Vec& v) {
  ExactSum sum;
  for (Index j = 0; j < M.cols(); ++j) {
    if (v[j] == 0) continue;
    for (SpMat::InnerIterator it(M, j); it; ++it) {
      if (v[it.row()] == 0 || it.value() == 0) continue;
      const TwoParts product = two_product(v[it.row()], v[j]);
      if (!(std::abs(product.value) >= 0x1p-900)) return std::nullopt;
      sum.add_product(product.value, it.value());
      if (product.error != 0) sum.add_product(product.error, it.value());
    }
  }
  return sign(sum);
}

/// (M + M')v != 0, without doubt.
bool surely_not_in_kernel(const SpMat& M, const SpMat& Mt, const Vec& v) {
  for (Index i = 0; i < M.cols(); ++i) {
    ExactSum sum;
    for (SpMat::InnerIterator it(M, i); it; ++it) sum.add_product(it.value(), v[it.row()]);
    for (SpMat::InnerIterator it(Mt, i); it; ++it) sum.add_product(it.value(), v[it.row()]);
    if (sum.exact() && sum.sign() != 0) return true;
  }
  return false;
}

/// M_ii v_i <= sum |M_ij| v_j for all i. Pre: v >= 0.
bool surely_not_h(const SpMat& Mt, const Vec& v) {
  for (Index i = 0; i < Mt.cols(); ++i) {
    if (v[i] == 0) continue;
    ExactSum sum;
    for (SpMat::InnerIterator it(Mt, i); it; ++it)
      sum.add_product(it.row() == i ? it.value() : -std::abs(it.value()), v[it.row()]);
    if (!sum.exact() || sum.sign() > 0) return false;
  }
  return true;
}

/// The exponent of the last binary digit. Pre: a != 0, finite.
int last_digit(double a) {
  int e = 0;
  const auto digits = static_cast<std::int64_t>(std::ldexp(std::frexp(std::abs(a), &e), 53));
  return e - 53 + std::countr_zero(static_cast<std::uint64_t>(digits));
}

/// Integers without a common factor of two in a row or column, by factors of two.
void make_integer(Dense& A) {
  const auto reduce = [](auto line) {
    int least = 0;
    bool any = false;
    for (Index k = 0; k < line.size(); ++k) {
      if (line[k] == 0) continue;
      least = any ? std::min(least, last_digit(line[k])) : last_digit(line[k]);
      any = true;
    }
    for (Index k = 0; k < line.size(); ++k) line[k] = std::ldexp(line[k], -least);
  };
  for (Index i = 0; i < A.rows(); ++i) reduce(A.row(i));
  for (Index j = 0; j < A.cols(); ++j) reduce(A.col(j));
}

/// By elimination in integers (Bareiss, Math. Comp. 22 (1968) 565). False, too, where they have more than 52 digits.
bool surely_singular(Dense A) {
  make_integer(A);
  double last = 1;
  for (Index k = 0; k < A.rows(); ++k) {
    Index pivot = k;
    while (pivot < A.rows() && A(pivot, k) == 0) ++pivot;
    if (pivot == A.rows()) return true;
    A.row(k).swap(A.row(pivot));
    for (Index i = k + 1; i < A.rows(); ++i)
      for (Index j = k + 1; j < A.cols(); ++j) {
        const double one = A(i, j) * A(k, k);
        const double two = A(i, k) * A(k, j);
        if (!(std::max(std::abs(one), std::abs(two)) < 0x1p52)) return false;
        A(i, j) = (one - two) / last;
      }
    last = A(k, k);
  }
  return false;
}

/// The determinant of A, which is zero to rounding.
bool surely_not_positive(const Dense& A) {
  if (A.rows() != 2) return surely_singular(A);
  ExactSum minor;
  minor.add_product(A(0, 0), A(1, 1));
  minor.add_product(-A(0, 1), A(1, 0));
  return minor.exact() && minor.sign() <= 0;
}

Dense block(const SpMat& M, const std::vector<Index>& alpha) {
  const auto n = static_cast<Index>(alpha.size());
  return Dense::NullaryExpr(n, n, [&](Index i, Index j) { return M.coeff(alpha[at(i)], alpha[at(j)]); });
}

void take_back(Property& property, const char* reason) { property = {.reason = reason}; }

}  // namespace

bool exact_sum(const SpMat& M, const SpMat& Mt, const SpMat& S) {
  for (Index j = 0; j < S.cols(); ++j) {
    SpMat::InnerIterator m(M, j), mt(Mt, j);
    for (SpMat::InnerIterator s(S, j); s; ++s) {
      const double a = m && m.row() == s.row() ? m.value() : 0, b = mt && mt.row() == s.row() ? mt.value() : 0;
      if (m && m.row() == s.row()) ++m;
      if (mt && mt.row() == s.row()) ++mt;
      const double part = s.value() - a;
      if ((a - (s.value() - part)) + (b - part) != 0) return false;
    }
  }
  return true;
}

void take_back_rounded_zeros(const SpMat& M, double tol, Diagnosis& d) {
  const SpMat Mt = M.transpose();
  const SpMat S = M + Mt;
  const auto zero_form = [&](const Property& property) {
    return property.no() && property.vector.size() == M.rows() && !quadratic_form(S, property.vector, tol).negative();
  };
  for (Property* property : {&d.positive_definite, &d.strictly_copositive, &d.copositive_plus}) {
    if (!zero_form(*property)) continue;
    const std::optional<int> sign = sign_of_form(M, property->vector);
    const bool plus = property == &d.copositive_plus;
    const bool holds = plus ? sign == 0 && surely_not_in_kernel(M, Mt, property->vector) : sign && *sign <= 0;
    if (!holds)
      take_back(*property, plus ? "rounding hides whether v'Mv = 0 for a v >= 0" : "rounding hides the sign of v'Mv");
  }
  bool p = false;
  if (d.h_plus.no() && d.h_plus.vector.size() == M.rows() && !surely_not_h(Mt, d.h_plus.vector)) {
    take_back(d.h_plus, "the comparison matrix is singular to rounding");
    p = d.p.no() && d.p.vector.size() == M.rows();
  }
  // A negative minor refutes P0 as well.
  if (d.p.no() && !d.p0.no() && d.p.indices.size() > 1 && !surely_not_positive(block(M, d.p.indices))) p = true;
  if (!p) return;
  take_back(d.p, "rounding hides the sign of a principal minor");
  if (d.z.yes()) take_back(d.m, "rounding hides the sign of a principal minor");
}

}  // namespace perp::lcp

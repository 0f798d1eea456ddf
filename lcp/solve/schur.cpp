// SPDX-License-Identifier: Apache-2.0
#include "lcp/solve/schur.hpp"

#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>
#include <utility>
#include <vector>

#include "lcp/exact_sum.hpp"
#include "lcp/lu/lu_factors.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

/// rcond below which solutions are refined to twice the precision: above it they are right to 1e-9.
constexpr double refined_below = 1e-6;
/// Corrections at most, and the last one, relative to the solution.
constexpr int corrections = 20;
constexpr double last_correction = 1e-22;
/// A correction that is larger, and the last, leaves digits wrong.
constexpr double largest_last_correction = 1e-14;
constexpr double singular = 1e-15;

void check_sizes(const SpMat& K, const SpMat& B, Index f) {
  if (K.rows() != K.cols() || B.rows() != K.rows() || f != K.rows())
    refuse_input("schur: K is ", K.rows(), " x ", K.cols(), ", B ", B.rows(), " x ", B.cols(), ", f has ", f,
                 " entries");
}

/// D with the largest entries of the rows and columns of D K D near one, powers of two (Ruiz 2001).
Vec symmetric_scale(const SpMat& K) {
  constexpr int sweeps = 5;
  Vec D = Vec::Ones(K.rows());
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    Vec largest = Vec::Zero(K.rows());
    for (Index j = 0; j < K.cols(); ++j)
      for (SpMat::InnerIterator it(K, j); it; ++it) {
        const double a = std::abs(D[it.row()] * it.value() * D[j]);
        largest[it.row()] = std::max(largest[it.row()], a);
        largest[j] = std::max(largest[j], a);
      }
    for (Index i = 0; i < D.size(); ++i)
      if (largest[i] > 0 && std::isfinite(largest[i])) D[i] = std::ldexp(D[i], -std::ilogb(largest[i]) / 2);
  }
  return D;
}

/// Adds column j of S to `entries`: B' z, row by row of B where z is not zero.
void add_column(const SpMat& B_transposed, const SparseVector& z, int j, SparseVector& s,
                std::vector<Eigen::Triplet<double>>& entries) {
  s.clear();
  z.for_each([&](Index row, double value) {
    for (SpMat::InnerIterator it(B_transposed, row); it; ++it) s.add(it.row(), it.value() * value);
  });
  s.for_each([&](Index i, double value) {
    if (value != 0) entries.emplace_back(static_cast<int>(i), j, value);
  });
}

/// A vector value + rest, |rest| <= eps |value| entry by entry.
struct InTwoParts {
  Vec value;
  Vec rest;

  void add(Index i, double a) {
    const TwoParts low = two_sum(rest[i], a);
    const TwoParts sum = two_sum(value[i], low.value);
    value[i] = sum.value;
    rest[i] = sum.error + low.error;
  }
  void add_product(Index i, double a, double b) {
    const TwoParts product = two_product(a, b);
    add(i, product.value);
    add(i, product.error);
  }
};

InTwoParts in_two_parts(Vec value) {
  Vec rest = Vec::Zero(value.size());
  return {.value = std::move(value), .rest = std::move(rest)};
}

/// K^-1 b: each correction reduces the error by eps / rcond. False: it does not become small.
bool refined(const SparseLu& lu, const SpMat& K, const InTwoParts& b, InTwoParts& y,
             double largest_last = largest_last_correction) {
  y = in_two_parts(Vec(b.value.size()));
  lu.solve(b.value, y.value);
  double last = y.value.lpNorm<::Eigen::Infinity>();
  const auto small = [&y](double size, double share) { return size <= share * y.value.lpNorm<::Eigen::Infinity>(); };
  Vec correction(b.value.size());
  for (int k = 0; k < corrections; ++k) {
    InTwoParts left = b;
    for (Index j = 0; j < K.cols(); ++j)
      for (SpMat::InnerIterator it(K, j); it; ++it) {
        left.add_product(it.row(), -it.value(), y.value[j]);
        left.add_product(it.row(), -it.value(), y.rest[j]);
      }
    lu.solve(left.value, correction);
    const double size = correction.lpNorm<::Eigen::Infinity>();
    if (size == 0) return true;
    if (!(size < last)) return small(last, largest_last);
    for (Index i = 0; i < correction.size(); ++i) y.add(i, correction[i]);
    if (small(size, last_correction)) return true;
    last = size;
  }
  return small(last, largest_last);
}

/// s = s + B' y.
void add_transposed(const SpMat& B, const InTwoParts& y, InTwoParts& s) {
  for (Index i = 0; i < B.cols(); ++i)
    for (SpMat::InnerIterator it(B, i); it; ++it) {
      s.add_product(i, it.value(), y.value[it.row()]);
      s.add_product(i, it.value(), y.rest[it.row()]);
    }
}

/// B' K^-1 B column by column, each by refined(), until one does not converge.
bool add_refined_columns(const SparseLu& lu, const SpMat& K, const SpMat& B,
                         std::vector<Eigen::Triplet<double>>& entries) {
  for (Index j = 0; j < B.cols(); ++j) {
    InTwoParts y;
    if (!refined(lu, K, in_two_parts(B.col(j)), y)) return false;
    InTwoParts s = in_two_parts(Vec::Zero(B.cols()));
    add_transposed(B, y, s);
    for (Index i = 0; i < B.cols(); ++i)
      if (s.value[i] != 0) entries.emplace_back(static_cast<int>(i), static_cast<int>(j), s.value[i]);
  }
  return true;
}

/// The same by solves with sparse right-hand sides.
void add_columns(const SparseLu& lu, const SpMat& B, std::vector<Eigen::Triplet<double>>& entries) {
  LuFactors factors;
  if (!lu.factors(factors)) throw std::logic_error("the LU library gives no factors");
  LuSolver solver(std::move(factors));
  const SpMat transposed = B.transpose();
  SparseVector b(B.rows());
  SparseVector z(B.rows());
  SparseVector s(B.cols());
  for (Index j = 0; j < B.cols(); ++j) {
    b.clear();
    for (SpMat::InnerIterator it(B, j); it; ++it) b.add(it.row(), it.value());
    solver.solve(b, z);
    add_column(transposed, z, static_cast<int>(j), s, entries);
  }
}

}  // namespace

Schur schur(const SpMat& K, const SpMat& B, In f, double drop) { return schur(K, B, f, Vec::Zero(B.cols()), drop); }

bool Schur::regular() const { return status == LuStatus::Ok && !(rcond < singular) && converged; }

SchurProduct::SchurProduct(const SpMat& K, const SpMat& B) : lu_(LuBackend::General) {
  check_sizes(K, B, K.rows());
  const Vec D = symmetric_scale(K);
  K_ = D.asDiagonal() * K * D.asDiagonal();
  B_ = D.asDiagonal() * B;
  if (K.rows() > 0) status_ = lu_.factor(K_);
  if (status_ == LuStatus::OutOfMemory) throw std::bad_alloc();
}

Vec SchurProduct::operator()(In r, In w) const {
  InTwoParts b = in_two_parts(Vec::Zero(K_.rows()));
  for (Index j = 0; j < B_.cols(); ++j)
    for (SpMat::InnerIterator it(B_, j); it; ++it) b.add_product(it.row(), it.value(), r[j]);
  InTwoParts s = in_two_parts(w);
  InTwoParts y = in_two_parts(Vec());
  if (status_ != LuStatus::Ok || (K_.rows() > 0 && !refined(lu_, K_, b, y, last_correction)))
    return Vec::Constant(w.size(), std::numeric_limits<double>::quiet_NaN());
  if (K_.rows() > 0) add_transposed(B_, y, s);
  return s.value + s.rest;
}

Schur schur(const SpMat& K, const SpMat& B, In f, In w, double drop) {
  check_sizes(K, B, f.size());
  Schur out;
  const Index n = B.cols();
  out.S.resize(n, n);
  out.x = Vec::Zero(K.rows());
  out.image = w;
  if (K.rows() == 0) return out;
  const Vec D = out.scale = symmetric_scale(K);
  SparseLu lu(LuBackend::General);
  const SpMat scaled = D.asDiagonal() * K * D.asDiagonal();
  out.status = lu.factor(scaled);
  if (out.status != LuStatus::Ok) return out;
  out.rcond = lu.rcond();
  const bool refine = out.rcond < refined_below;
  const SpMat columns = D.asDiagonal() * B;
  std::vector<Eigen::Triplet<double>> entries;
  InTwoParts x = in_two_parts(Vec());
  out.converged = refined(lu, scaled, in_two_parts(D.cwiseProduct(f)), x);
  if (refine)
    out.converged = out.converged && add_refined_columns(lu, scaled, columns, entries);
  else
    add_columns(lu, columns, entries);
  out.x = D.cwiseProduct(x.value);
  InTwoParts image = in_two_parts(w);
  add_transposed(columns, x, image);
  out.image = image.value + image.rest;
  out.S.setFromTriplets(entries.begin(), entries.end());
  const Vec size = Vec(out.S.diagonal()).cwiseAbs().cwiseSqrt();
  out.S.prune([&](Index i, Index j, double value) { return !(std::abs(value) <= drop * size[i] * size[j]); });
  return out;
}

}  // namespace perp::lcp

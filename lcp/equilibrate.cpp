// SPDX-License-Identifier: Apache-2.0
#include "lcp/equilibrate.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

namespace perp::lcp {
namespace {

constexpr int most_sweeps = 10;
/// Largest entries this near to one, or to its inverse, need no further sweep: the rounding of the factors to powers of
/// two moves them by more.
constexpr double near_one = 1.125;

/// The nearest one, by its logarithm: of numbers in the usual range by their bits.
double power_of_two(double a) {
  constexpr int far = 500;
  if (a > 0x1p-499 && a < 0x1p499) {
    constexpr std::uint64_t fraction = (std::uint64_t{1} << 52U) - 1;
    constexpr std::uint64_t root_of_two = std::bit_cast<std::uint64_t>(1.41421356237309504) & fraction;
    const auto bits = std::bit_cast<std::uint64_t>(a);
    return std::bit_cast<double>((bits & ~fraction) + ((bits & fraction) < root_of_two ? 0 : fraction + 1));
  }
  int exponent = 0;
  const double half_to_one = std::frexp(a, &exponent);
  if (!(half_to_one > 0 && half_to_one < 1)) return a > 0 ? std::ldexp(1, far) : a == 0 ? std::ldexp(1, -far) : a;
  constexpr double middle = 0.70710678118654752;
  return std::ldexp(1, std::clamp(half_to_one < middle ? exponent - 1 : exponent, -far, far));
}

/// One step of Ruiz' iteration: rows and columns are divided by the root of their largest entry. False: another one is
/// not needed.
bool sweep(const SpMat& M, Scaling& scaling, Vec& row_max, Vec& column_max) {
  row_max.setZero();
  const double* of_row = scaling.rows.data();
  double* largest_of_row = row_max.data();
  for (Index j = 0; j < M.cols(); ++j) {
    const double of_column = scaling.columns[j];
    double largest = 0;
    for (SpMat::InnerIterator it(M, j); it; ++it) {
      const Index i = it.row();
      const double a = std::abs(it.value()) * of_row[i] * of_column;
      largest_of_row[i] = std::max(largest_of_row[i], a);
      largest = std::max(largest, a);
    }
    column_max[j] = largest;
  }
  bool far = false;
  const auto divide_by_root = [&far](Vec& factors, Vec& largest) {
    for (double& a : largest) {
      if (!(a > 0)) a = 1;
      far = far || a > near_one || a * near_one < 1;
    }
    factors.array() *= largest.array().sqrt().inverse();  // two at a time
  };
  divide_by_root(scaling.rows, row_max);
  divide_by_root(scaling.columns, column_max);
  return far;
}

/// Whether every bound is as finite after the scaling as before, and every interval still one.
bool keeps_bounds(const Box& box, const Box& scaled) {
  for (Index i = 0; i < box.size(); ++i)
    if (std::isfinite(box.lower[i]) != std::isfinite(scaled.lower[i]) ||
        std::isfinite(box.upper[i]) != std::isfinite(scaled.upper[i]) ||
        (box.lower[i] == box.upper[i]) != (scaled.lower[i] == scaled.upper[i]))
      return false;
  return true;
}

Scaling ones(Index n) { return {Vec::Ones(n), Vec::Ones(n)}; }

}  // namespace

AffineMcp Scaling::apply(const AffineMcp& problem) const {
  AffineMcp scaled{problem.M,
                   rows.cwiseProduct(problem.q),
                   {problem.box.lower.cwiseQuotient(columns), problem.box.upper.cwiseQuotient(columns)}};
  for (Index j = 0; j < scaled.M.cols(); ++j)
    for (SpMat::InnerIterator it(scaled.M, j); it; ++it) it.valueRef() = rows[it.row()] * it.value() * columns[j];
  return scaled;
}

bool Scaling::loses_nothing(const AffineMcp& problem) const {
  const AffineMcp scaled = apply(problem);
  for (Index j = 0; j < problem.size(); ++j) {
    if (scaled.q[j] / rows[j] != problem.q[j] || scaled.box.lower[j] * columns[j] != problem.box.lower[j] ||
        scaled.box.upper[j] * columns[j] != problem.box.upper[j])
      return false;
    SpMat::InnerIterator it(problem.M, j);
    for (SpMat::InnerIterator scaled_it(scaled.M, j); it && scaled_it; ++it, ++scaled_it)
      if (scaled_it.value() / columns[j] / rows[it.row()] != it.value()) return false;
  }
  return true;
}

Vec Scaling::to_scaled(const Box& box, In x) const {
  Vec scaled(x.size());
  for (Index i = 0; i < x.size(); ++i) {
    const double z = project(box, i, x[i]);
    scaled[i] = z / columns[i] + rows[i] * (x[i] - z);
  }
  return scaled;
}

Vec Scaling::to_original(const Box& scaled_box, In x) const {
  Vec original = x;
  make_original(scaled_box, original);
  return original;
}

void Scaling::make_original(const Box& scaled_box, Vec& x) const {
  for (Index i = 0; i < x.size(); ++i) {
    const double z = std::min(std::max(x[i], scaled_box.lower[i]), scaled_box.upper[i]);
    x[i] = columns[i] * z + (x[i] - z) / rows[i];
  }
}

Scaling equilibrate(const AffineMcp& problem) { return equilibrated(problem).scaling; }

Equilibrated equilibrated(const AffineMcp& problem) {
  const Index n = problem.size();
  Scaling scaling = ones(n);
  Vec row_max(n);
  Vec column_max(n);
  int k = 0;
  while (k < most_sweeps && sweep(problem.M, scaling, row_max, column_max)) ++k;
  const double q = n > 0 ? scaling.rows.cwiseProduct(problem.q).lpNorm<::Eigen::Infinity>() : 0;
  if (q > 0 && std::isfinite(q)) {
    scaling.rows /= q;
    scaling.columns *= q;
  }
  for (Vec* factors : {&scaling.rows, &scaling.columns}) *factors = factors->unaryExpr(&power_of_two);
  AffineMcp scaled = scaling.apply(problem);
  if (keeps_bounds(problem.box, scaled.box) && !scaled.invalid()) return {std::move(scaling), std::move(scaled)};
  return {ones(n), problem};
}

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#include "ncp/interval/exact_multipliers.hpp"

#include <cfloat>  // which gmpxx.h uses

#include <gmpxx.h>

#include <cmath>
#include <utility>
#include <vector>

namespace perp::ncp {
namespace {

using lcp::at;
using lcp::Index;
using lcp::SpMat;
using lcp::Vec;

/// Multipliers and sums within this x the largest, or their terms, are rounding.
constexpr double nearly = 1e-9;
/// The elimination is O(most_rows^3) in rational numbers: below a second.
constexpr std::size_t most_rows = 200;
constexpr int free_digits = 24;

using Rationals = std::vector<mpq_class>;

/// Gauss-Jordan on rows of |S| entries; returns the pivot's column of each row that is left.
std::vector<std::size_t> eliminate(std::vector<Rationals>& rows, std::size_t columns) {
  std::vector<std::size_t> pivots;
  for (std::size_t c = 0; c < columns && pivots.size() < rows.size(); ++c) {
    const std::size_t r = pivots.size();
    std::size_t k = r;
    while (k < rows.size() && rows[k][c] == 0) ++k;
    if (k == rows.size()) continue;
    std::swap(rows[r], rows[k]);
    const mpq_class pivot = rows[r][c];
    for (mpq_class& entry : rows[r]) entry /= pivot;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (i == r || rows[i][c] == 0) continue;
      const mpq_class factor = rows[i][c];
      for (std::size_t j = c; j < columns; ++j)
        if (rows[r][j] != 0) rows[i][j] -= factor * rows[r][j];
    }
    pivots.push_back(c);
  }
  rows.resize(pivots.size());
  return pivots;
}

/// value = high + low, times 2^-shift; false: it has more digits.
bool in_two_parts(const mpz_class& value, int shift, double& high, double& low) {
  high = value.get_d();
  const mpz_class rest = value - mpz_class(high);
  low = rest.get_d();
  if (mpz_class(low) != rest) return false;
  high = std::ldexp(high, -shift);
  low = std::ldexp(low, -shift);
  return true;
}

}  // namespace

std::optional<lcp::TwoPartVector> exact_multipliers(const lcp::AffineMcp& problem, lcp::In y) {
  const double largest = y.lpNorm<Eigen::Infinity>();
  std::vector<Index> S;
  std::vector<std::size_t> place(at(y.size()), most_rows);
  for (Index i = 0; i < y.size(); ++i)
    if (std::abs(y[i]) > nearly * largest) {
      place[at(i)] = S.size();
      S.push_back(i);
    }
  if (S.empty() || S.size() > most_rows) return std::nullopt;
  std::vector<Rationals> E;
  for (Index j = 0; j < problem.size(); ++j) {
    if (std::isfinite(problem.box.lower[j]) && std::isfinite(problem.box.upper[j])) continue;
    Rationals column(S.size());
    double sum = 0, terms = 0;
    for (SpMat::InnerIterator it(problem.M, j); it; ++it) {
      if (place[at(it.row())] == most_rows) continue;
      column[place[at(it.row())]] = it.value();
      sum += it.value() * y[it.row()];
      terms += std::abs(it.value() * y[it.row()]);
    }
    if (terms > 0 && std::abs(sum) <= nearly * terms) E.push_back(std::move(column));
  }
  if (E.size() > most_rows) return std::nullopt;
  const std::vector<std::size_t> pivots = eliminate(E, S.size());
  if (pivots.size() == S.size()) return std::nullopt;
  Rationals exact(S.size());
  std::vector<char> follows(S.size(), 0);
  for (const std::size_t c : pivots) follows[c] = 1;
  // One alone only sets the length.
  const bool one = pivots.size() + 1 == S.size();
  for (std::size_t c = 0; c < S.size(); ++c) {
    if (follows[c] != 0) continue;
    int exponent = 0;
    const double fraction = std::frexp(y[S[c]] / largest, &exponent);
    exact[c] = one ? std::copysign(1.0, fraction) : std::ldexp(std::round(std::ldexp(fraction, free_digits)), exponent);
  }
  for (std::size_t r = 0; r < pivots.size(); ++r)
    for (std::size_t c = 0; c < S.size(); ++c)
      if (follows[c] == 0) exact[pivots[r]] -= E[r][c] * exact[c];
  mpz_class denominator = 1;
  for (const mpq_class& value : exact) denominator = lcm(denominator, value.get_den());
  int digits = 0;
  for (mpq_class& value : exact) {
    value *= denominator;
    digits = std::max(digits, static_cast<int>(mpz_sizeinbase(value.get_num_mpz_t(), 2)));
  }
  if (digits > 900) return std::nullopt;
  lcp::TwoPartVector out{Vec(Vec::Zero(y.size()))};
  for (std::size_t c = 0; c < S.size(); ++c)
    if (!in_two_parts(exact[c].get_num(), digits, out.value[S[c]], out.rest[S[c]])) return std::nullopt;
  return out;
}

}  // namespace perp::ncp

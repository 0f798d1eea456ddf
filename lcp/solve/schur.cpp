// SPDX-License-Identifier: Apache-2.0
#include "lcp/solve/schur.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "lcp/lu/lu_factors.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

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

}  // namespace

Schur schur(const SpMat& K, const SpMat& B, In f, double drop) {
  if (K.rows() != K.cols() || B.rows() != K.rows() || f.size() != K.rows()) {
    refuse_input("schur: K is ", K.rows(), " x ", K.cols(), ", B ", B.rows(), " x ", B.cols(), ", f has ", f.size(),
                 " entries");
  }
  Schur out;
  const Index n = B.cols();
  out.S.resize(n, n);
  out.x = Vec::Zero(K.rows());
  if (K.rows() == 0) return out;
  const Vec D = out.scale = symmetric_scale(K);
  SparseLu lu(LuBackend::General);
  LuFactors factors;
  out.status = lu.factor(D.asDiagonal() * K * D.asDiagonal());
  if (out.status != LuStatus::Ok) return out;
  out.rcond = lu.rcond();
  Vec y(K.rows());
  lu.solve_refined(D.cwiseProduct(f), y);
  out.x = D.cwiseProduct(y);
  if (!lu.factors(factors)) throw std::logic_error("the LU library gives no factors");
  LuSolver solver(std::move(factors));

  const SpMat scaled = D.asDiagonal() * B;
  const SpMat transposed = scaled.transpose();
  SparseVector b(K.rows());
  SparseVector z(K.rows());
  SparseVector s(n);
  std::vector<Eigen::Triplet<double>> entries;
  for (Index j = 0; j < n; ++j) {
    b.clear();
    for (SpMat::InnerIterator it(scaled, j); it; ++it) b.add(it.row(), it.value());
    solver.solve(b, z);
    add_column(transposed, z, static_cast<int>(j), s, entries);
  }
  out.S.setFromTriplets(entries.begin(), entries.end());
  const Vec size = Vec(out.S.diagonal()).cwiseAbs().cwiseSqrt();
  out.S.prune([&](Index i, Index j, double value) { return !(std::abs(value) <= drop * size[i] * size[j]); });
  return out;
}

}  // namespace perp::lcp

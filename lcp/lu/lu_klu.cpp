// SPDX-License-Identifier: Apache-2.0
#include "lcp/lu/lu_klu.hpp"

#include <algorithm>
#include <functional>
#include <new>
#include <stdexcept>
#include <utility>
#include <vector>

namespace perp::lcp {
namespace {

constexpr double entry_bytes = sizeof(double) + sizeof(int);

}  // namespace

Klu::Klu() {
  klu_defaults(&common_);
  common_.tol = 0.1;  // KLU's own 0.001 loses six digits on random matrices
}
Klu::~Klu() {
  klu_free_numeric(&numeric_, &common_);
  klu_free_symbolic(&symbolic_, &common_);
}

LuStatus Klu::status() const {
  if (common_.status == KLU_SINGULAR) return LuStatus::Singular;
  throw std::bad_alloc();
}

LuStatus Klu::analyze(const SpMat& A) {
  factored_ = false;
  klu_free_numeric(&numeric_, &common_);  // belongs to the old analysis
  klu_free_symbolic(&symbolic_, &common_);
  pattern_ = A;  // KLU takes pointers to non-const
  symbolic_ = klu_analyze(static_cast<int>(A.rows()), pattern_.outerIndexPtr(), pattern_.innerIndexPtr(), &common_);
  return symbolic_ ? LuStatus::Ok : status();
}

FactorCost Klu::cost() const {
  return {.flops = std::max(0.0, symbolic_->est_flops),
          .bytes = entry_bytes * std::max(0.0, symbolic_->lnz + symbolic_->unz)};
}

FactorCost Klu::spent() const {
  klu_common common = common_;
  klu_flops(symbolic_, numeric_, &common);
  return {.flops = common.flops, .bytes = entry_bytes * static_cast<double>(numeric_->lnz + numeric_->unz)};
}

bool Klu::refactor(const SpMat& A) {
  std::copy_n(A.valuePtr(), A.nonZeros(), pattern_.valuePtr());
  return klu_refactor(pattern_.outerIndexPtr(), pattern_.innerIndexPtr(), pattern_.valuePtr(), symbolic_, numeric_,
                      &common_) != 0 &&
         common_.status == KLU_OK && klu_rcond(symbolic_, numeric_, &common_) != 0 && common_.rcond > 0;
}

/// The last factors' pivots; false if these do not do.
bool Klu::factor_again() {
  int* const start = pattern_.outerIndexPtr();
  int* const row = pattern_.innerIndexPtr();
  return klu_refactor(start, row, pattern_.valuePtr(), symbolic_, numeric_, &common_) && common_.status == KLU_OK &&
         klu_rgrowth(start, row, pattern_.valuePtr(), symbolic_, numeric_, &common_) &&
         common_.rgrowth * most_growth_again >= 1 && klu_rcond(symbolic_, numeric_, &common_) && common_.rcond > 0;
}

LuStatus Klu::factor(const SpMat& A) {
  std::copy_n(A.valuePtr(), A.nonZeros(), pattern_.valuePtr());
  const bool known = std::exchange(factored_, false);
  factored_ = reuse_ && known && factor_again();
  if (factored_) return LuStatus::Ok;
  klu_free_numeric(&numeric_, &common_);
  numeric_ = klu_factor(pattern_.outerIndexPtr(), pattern_.innerIndexPtr(), pattern_.valuePtr(), symbolic_, &common_);
  if (!numeric_) return status();
  if (common_.status == KLU_SINGULAR) return LuStatus::Singular;
  // a pivot that underflowed or overflowed: min |U_ii| / max |U_ii|
  factored_ = klu_rcond(symbolic_, numeric_, &common_) && common_.rcond > 0;
  return factored_ ? LuStatus::Ok : LuStatus::Singular;
}

void Klu::solve(const SpMat& A, In b, Out x, bool transposed) const {
  x = b;
  const int n = static_cast<int>(A.rows());
  // Solves may run in two threads: each has its own status, and its own copy of the head of the factors with a
  // workspace of its own - KLU's is one per factorization.
  klu_common common = common_;
  klu_numeric numeric = *numeric_;
  Vec workspace(4 * A.rows());
  numeric.Xwork = workspace.data();
  if (transposed)
    klu_tsolve(symbolic_, &numeric, n, 1, x.data(), &common);
  else
    klu_solve(symbolic_, &numeric, n, 1, x.data(), &common);
}

/// L and U of the diagonal blocks, U with the entries of (R A)(P, Q) above the blocks, too; where the blocks begin, and
/// the order at the end.
std::vector<int> Klu::extract_blocks(LuFactors& out) const {
  if (!factored_) throw std::logic_error("KLU has no factors");
  const auto n = at(numeric_->n);
  struct Columns {
    Columns(std::size_t columns, int entries) : start(columns + 1), row(at(entries)), value(at(entries)) {}
    std::vector<int> start, row;
    std::vector<double> value;
    /// Those of column j but for the diagonal's.
    void append(std::size_t j, Triangle& to) const {
      for (auto k = at(start[j]); k < at(start[j + 1]); ++k)
        if (row[k] != static_cast<int>(j)) to.push(row[k], value[k]);
    }
  };
  Columns l(n, numeric_->lnz);
  Columns u(n, numeric_->unz);
  Columns above(n, numeric_->nzoff);
  out.P.resize(n);
  out.Q.resize(n);
  std::vector<int> blocks(at(symbolic_->nblocks) + 1);
  Vec scale(numeric_->n);
  klu_common common = common_;
  if (!klu_extract(numeric_, symbolic_, l.start.data(), l.row.data(), l.value.data(), u.start.data(), u.row.data(),
                   u.value.data(), above.start.data(), above.row.data(), above.value.data(), out.P.data(), out.Q.data(),
                   scale.data(), blocks.data(), &common))
    throw std::bad_alloc();
  out.R.resize(numeric_->n);
  for (std::size_t k = 0; k < n; ++k) out.R[out.P[k]] = 1 / scale[static_cast<Index>(k)];  // scale is by pivots
  out.diagonal = Eigen::Map<const Vec>(static_cast<const double*>(numeric_->Udiag), numeric_->n);
  out.L = out.U = out.L_transposed = out.U_transposed = Triangle{};
  for (auto* triangle : {&out.L, &out.U}) {
    const std::size_t most = triangle == &out.L ? l.row.size() : u.row.size() + above.row.size();
    triangle->start.reserve(n + 1);
    triangle->row.reserve(most);
    triangle->value.reserve(most);
  }
  for (std::size_t j = 0; j < n; ++j) {
    l.append(j, out.L);
    out.L.end_column();
    u.append(j, out.U);
    above.append(j, out.U);
    out.U.end_column();
  }
  out.finish();
  return blocks;
}

/// With L, U of the diagonal blocks and F above them, (R A)(P, Q) = L U + F = L (U + L^-1 F): what a factorization
/// without blocks and with the same pivots would have come to.
void Klu::extract(LuFactors& out) const {
  const std::vector<int> blocks = extract_blocks(out);
  const Triangle by_blocks = std::exchange(out.U, Triangle{});
  Vec x = Vec::Zero(out.size());  // zero wherever no row is waiting
  std::vector<char> seen(at(out.size()), 0);
  std::vector<int> waiting;  // a heap: L leads downwards only
  const auto wait = [&](int i) {
    if (std::exchange(seen[at(i)], 1)) return;
    waiting.push_back(i);
    std::ranges::push_heap(waiting, std::greater<>{});
  };
  for (std::size_t block = 0; block + 1 < blocks.size(); ++block)
    for (int j = blocks[block]; j < blocks[block + 1]; ++j) {
      for (auto k = at(by_blocks.start[at(j)]); k < at(by_blocks.start[at(j + 1)]); ++k) {
        const int i = by_blocks.row[k];
        if (i >= blocks[block]) {
          out.U.push(i, by_blocks.value[k]);
          continue;
        }
        x[i] = by_blocks.value[k];
        wait(i);
      }
      while (!waiting.empty()) {
        std::ranges::pop_heap(waiting, std::greater<>{});
        const int i = waiting.back();
        waiting.pop_back();
        seen[at(i)] = 0;
        const double value = std::exchange(x[i], 0.0);
        if (value == 0) continue;
        out.U.push(i, value);
        for (int k = out.L.start[at(i)]; k < out.L.start[at(i + 1)]; ++k) {
          x[out.L.row[at(k)]] -= out.L.value[at(k)] * value;
          wait(out.L.row[at(k)]);
        }
      }
      out.U.end_column();
    }
  out.L_transposed = out.L.transpose();
}

std::unique_ptr<LuLibrary> make_klu() { return std::make_unique<Klu>(); }

}  // namespace perp::lcp

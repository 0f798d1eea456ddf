#include "lcp/basis_factor.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace perp::lcp {
namespace {

void require_size(const char* what, Index size, Index rows) {
  if (size == rows) return;
  std::ostringstream message;
  message << "BasisFactor: " << what << " has " << size << " entries, not one for each of " << rows << " rows";
  throw std::invalid_argument(message.str());
}

void require_below(const char* what, Index i, Index limit) {
  if (i >= 0 && i < limit) return;
  std::ostringstream message;
  message << "BasisFactor: " << what << ' ' << i << " is none of the " << limit << " there are";
  throw std::invalid_argument(message.str());
}

}  // namespace

BasisFactor::BasisFactor(const SpMat& A, BasisOptions options) : A_(&A), options_(options), lu_(options.lu) {
  if (A.cols() < A.rows()) throw std::invalid_argument("BasisFactor: fewer columns than rows");
}

LuStatus BasisFactor::factor(std::span<const Index> basis) {
  const Index n = A_->rows();
  require_size("the basis", static_cast<Index>(basis.size()), n);
  for (const Index j : basis) require_below("column", j, A_->cols());
  basis_.assign(basis.begin(), basis.end());
  etas_.clear();
  eta_entries_ = 0;
  B_.resize(n, n);
  Index nonzeros = 0;
  for (const Index j : basis_) nonzeros += A_->col(j).nonZeros();
  B_.reserve(nonzeros);
  for (Index p = 0; p < n; ++p) {
    B_.startVec(p);
    for (SpMat::InnerIterator it(*A_, basis_[static_cast<std::size_t>(p)]); it; ++it)
      B_.insertBack(it.row(), p) = it.value();
  }
  B_.finalize();
  ++factorizations_;
  return lu_.factor(B_);
}

void BasisFactor::ftran(In b, Out x) const {
  lu_.solve(b, x);
  for (const Eta& eta : etas_) {
    const double xp = x[eta.p] / eta.pivot;
    x[eta.p] = xp;
    if (xp == 0) continue;
    for (std::size_t k = 0; k < eta.rows.size(); ++k) x[eta.rows[k]] -= eta.values[k] * xp;
  }
}

void BasisFactor::btran(In b, Out x) const {
  require_size("b", b.size(), A_->rows());
  Vec y = b;
  for (auto eta = etas_.rbegin(); eta != etas_.rend(); ++eta) {
    double sum = y[eta->p];
    for (std::size_t k = 0; k < eta->rows.size(); ++k) sum -= eta->values[k] * y[eta->rows[k]];
    y[eta->p] = sum / eta->pivot;
  }
  lu_.solve_transposed(y, x);
}

BasisFactor::Update BasisFactor::replace(Index p, Index q, In ftran_of_q) {
  require_below("position", p, A_->rows());
  require_below("column", q, A_->cols());
  require_size("ftran_of_q", ftran_of_q.size(), A_->rows());
  if (!ftran_of_q.allFinite()) return Update::Singular;  // the norm below may pass over a NaN
  const double largest = ftran_of_q.lpNorm<::Eigen::Infinity>();
  const double pivot = ftran_of_q[p];
  if (!(std::abs(pivot) > options_.singular_tol * largest)) return Update::Singular;
  Eta eta{.p = p, .pivot = pivot, .rows = {}, .values = {}};
  for (Index i = 0; i < ftran_of_q.size(); ++i)
    if (i != p && ftran_of_q[i] != 0) {
      eta.rows.push_back(static_cast<int>(i));
      eta.values.push_back(ftran_of_q[i]);
    }
  eta_entries_ += eta.rows.size() + 1;
  etas_.push_back(std::move(eta));
  basis_[static_cast<std::size_t>(p)] = q;
  return std::abs(pivot) < options_.unstable_tol * largest ? Update::Unstable : Update::Ok;
}

bool BasisFactor::stale() const {
  const auto allowed = options_.fill_limit * static_cast<double>(B_.nonZeros() + B_.rows());
  return updates() >= options_.refactor_every || static_cast<double>(eta_entries_) > allowed;
}

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#include "lcp/solve/refined_lu.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>
#include <utility>

#include "lcp/cholesky/symmetric.hpp"
#include "lcp/linalg/joined.hpp"
#include "lcp/lu/lu_factors.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

constexpr double singular = 1e-15;
/// rcond below which columns are refined to twice the precision: above it they are right to 1e-9.
constexpr double refined_below = 1e-6;
/// A correction that is larger, and the last, leaves digits of such columns wrong.
constexpr double largest_last_of_columns = 1e-14;
constexpr int corrections = 20;
/// Of twice the precision, generously.
constexpr double roundings = 64;

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

/// The largest |x_i| of each part.
Vec largest_of_parts(const Vec& x, const std::vector<int>& part_of) {
  Vec largest = Vec::Zero(x.size());  // as many as there may be parts
  for (Index i = 0; i < x.size(); ++i) {
    double& of = largest[part_of[at(i)]];
    if (!std::isnan(of) && !(std::abs(x[i]) <= of)) of = std::abs(x[i]);  // NaN stays
  }
  return largest;
}

/// Which parts of a solution are still being refined.
class Refining {
 public:
  Refining(const Vec& y, const std::vector<int>& part_of, double enough, double largest_last)
      : part_of_(part_of),
        enough_(enough),
        largest_last_(largest_last),
        last_(largest_of_parts(y, part_of)),
        done_(at(y.size()), 0),
        left_(y.size()) {
    for (double& last : last_)
      if (last == 0) last = infinity;  // the rest of b may not be
  }

  bool done(Index i) const { return done_[at(part_of_[at(i)])] != 0; }
  bool all_done() const { return left_ == 0; }
  bool failed() const { return failed_; }

  /// Before corrections of this size are made to y: what does not fall any more is done.
  void before(const Vec& correction, const Vec& y) {
    size_ = largest_of_parts(correction, part_of_);
    const Vec of_y = largest_of_parts(y, part_of_);
    for (Index b = 0; b < size_.size(); ++b) {
      if (done_[at(b)] != 0) continue;
      if (size_[b] == 0)
        end(b);
      else if (!(size_[b] < last_[b]))
        end(b, last_[b] <= largest_last_ * of_y[b]);
    }
  }
  /// After them: what is small enough is done.
  void after(const Vec& y) {
    const Vec of_y = largest_of_parts(y, part_of_);
    for (Index b = 0; b < size_.size(); ++b) {
      if (done_[at(b)] == 0 && size_[b] <= enough_ * of_y[b]) end(b);
      last_[b] = size_[b];
    }
  }
  /// When there is no more patience.
  void stop(const Vec& y) {
    const Vec of_y = largest_of_parts(y, part_of_);
    for (Index b = 0; b < last_.size(); ++b)
      if (done_[at(b)] == 0) end(b, last_[b] <= largest_last_ * of_y[b]);
  }

 private:
  void end(Index b, bool good = true) {
    done_[at(b)] = 1;
    --left_;
    failed_ = failed_ || !good;
  }

  const std::vector<int>& part_of_;
  double enough_;
  double largest_last_;
  Vec last_;
  Vec size_;
  std::vector<char> done_;
  Index left_;
  bool failed_ = false;
};

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

RefinedLu::RefinedLu(SpMat K) : K_(std::move(K)), lu_(LuBackend::General) {
  if (K_.rows() != K_.cols()) refuse_input("schur: K is ", K_.rows(), " x ", K_.cols());
  D_ = symmetric_scale(K_);
  K_ = SpMat(D_.asDiagonal() * K_ * D_.asDiagonal());
  symmetric_ = lcp::symmetric(K_, 0);
  part_of_ = coupled_by(K_);
  if (size() == 0) return;
  status_ = lu_.factor(K_);
  rcond_ = lu_.rcond();
}

bool RefinedLu::regular() const { return status_ == LuStatus::Ok && !(rcond_ < singular); }

Vec RefinedLu::solve(In b) const {
  Vec y(size());
  if (size() == 0) return y;
  lu_.solve(D_.cwiseProduct(b), y);
  return D_.cwiseProduct(y);
}

std::optional<TwoPartVector> RefinedLu::refined(const TwoPartVector& b, double largest_last) const {
  TwoPartVector y(Vec::Zero(size()));
  if (size() == 0) return y;
  TwoPartVector right = b;
  right.value = D_.cwiseProduct(b.value);
  right.rest = D_.cwiseProduct(b.rest);
  lu_.solve(right.value, y.value);
  const double enough = share_in_doubt();
  Refining parts(y.value, part_of_, enough, std::max(enough, largest_last));
  Vec correction(size());
  for (int k = 0; k < corrections && !parts.all_done(); ++k) {
    TwoPartVector product(Vec::Zero(size()));
    product.add_product(K_, y);
    TwoPartVector left = right;
    for (Index i = 0; i < size(); ++i) {
      left.add(i, -product.value[i]);
      left.add(i, -product.rest[i]);
    }
    lu_.solve(left.value, correction);
    parts.before(correction, y.value);
    for (Index i = 0; i < size(); ++i)
      if (!parts.done(i)) y.add(i, correction[i]);
    parts.after(y.value);
  }
  parts.stop(y.value);
  if (parts.failed()) return std::nullopt;
  y.value = D_.cwiseProduct(y.value);
  y.rest = D_.cwiseProduct(y.rest);
  return y;
}

double RefinedLu::share_in_doubt() const {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  return roundings * eps * eps / rcond_;
}

Vec RefinedLu::doubt(const TwoPartVector& y, In terms) const {
  const Vec of_y = largest_of_parts(y.value.cwiseQuotient(D_), part_of_);
  const Vec of_b = largest_of_parts(terms.cwiseProduct(D_), part_of_);
  const double share = share_in_doubt();
  return Vec::NullaryExpr(size(), [&](Index i) {
    const int part = part_of_[at(i)];
    return share * D_[i] * (of_y[part] + of_b[part]);
  });
}

double RefinedLu::entries_of_factors() const {
  LuFactors factors;
  return size() > 0 && lu_.factors(factors) ? static_cast<double>(factors.nonzeros()) : 0;
}

void RefinedLu::for_each_column(const SpMat& B, const std::function<bool(Index j, const SparseVector& z)>& take) const {
  LuFactors factors;
  if (size() == 0) return;
  if (!lu_.factors(factors)) throw std::logic_error("the LU library gives no factors");
  LuSolver solver(std::move(factors));
  SparseVector b(size());
  SparseVector z(size());
  SparseVector unscaled(size());
  for (Index j = 0; j < B.cols(); ++j) {
    b.clear();
    for (SpMat::InnerIterator it(B, j); it; ++it) b.add(it.row(), D_[it.row()] * it.value());
    solver.solve(b, z);
    unscaled.clear();
    z.for_each([&](Index i, double value) { unscaled.set(i, D_[i] * value); });
    if (!take(j, unscaled)) return;
  }
}

/// Column by column, until one does not converge.
bool RefinedLu::add_refined_columns(const SpMat& B, std::vector<Eigen::Triplet<double>>& entries) const {
  for (Index j = 0; j < B.cols(); ++j) {
    const std::optional<TwoPartVector> y = refined(TwoPartVector(Vec(B.col(j))), largest_last_of_columns);
    if (!y) return false;
    TwoPartVector s(Vec::Zero(B.cols()));
    s.add_transposed_product(B, *y);
    for (Index i = 0; i < B.cols(); ++i)
      if (s.value[i] != 0) entries.emplace_back(static_cast<int>(i), static_cast<int>(j), s.value[i]);
  }
  return true;
}

std::optional<SpMat> RefinedLu::schur(const SpMat& B, double drop) const {
  SpMat S(B.cols(), B.cols());
  if (size() == 0) return S;
  std::vector<Eigen::Triplet<double>> entries;
  if (rcond_ < refined_below) {
    if (!add_refined_columns(B, entries)) return std::nullopt;
  } else {
    const SpMat transposed = B.transpose();
    SparseVector s(B.cols());
    for_each_column(B, [&](Index j, const SparseVector& z) {
      add_column(transposed, z, static_cast<int>(j), s, entries);
      return true;
    });
  }
  S.setFromTriplets(entries.begin(), entries.end());
  const Vec diagonal = Vec(S.diagonal()).cwiseAbs().cwiseSqrt();
  S.prune([&](Index i, Index j, double value) { return !(std::abs(value) <= drop * diagonal[i] * diagonal[j]); });
  return S;
}

}  // namespace perp::lcp

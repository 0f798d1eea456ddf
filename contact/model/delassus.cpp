// SPDX-License-Identifier: Apache-2.0
#include "contact/model/delassus.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numeric>
#include <utility>

#include "lcp/cholesky/symmetric.hpp"
#include "lcp/lu/condition.hpp"

namespace perp::contact {
namespace {

/// Bodies of more velocities are factored together, by sparse factors.
constexpr std::size_t largest_body = 24;
/// Entries below this part of sqrt(W_ii W_jj) are zero by structure.
constexpr double rounding_of_zero = 1e-15;

/// Things that are joined two by two, and the sets they come to.
class Joined {
 public:
  explicit Joined(Index things) : parent_(at(things)) { std::iota(parent_.begin(), parent_.end(), 0); }

  void join(Index a, Index b) {
    const int of_a = root(static_cast<int>(a));
    const int of_b = root(static_cast<int>(b));
    parent_[at(std::max(of_a, of_b))] = std::min(of_a, of_b);
  }
  /// A number for each, that of its set, from 0 in the order of their first members.
  std::vector<int> numbers() {
    std::vector<int> number(parent_.size(), -1);
    int count = 0;
    for (std::size_t i = 0; i < parent_.size(); ++i) {
      const int r = root(static_cast<int>(i));
      if (number[at(r)] < 0) number[at(r)] = count++;
      number[i] = number[at(r)];
    }
    return number;
  }

 private:
  int root(int i) {
    while (parent_[at(i)] != i) i = parent_[at(i)] = parent_[at(parent_[at(i)])];
    return i;
  }
  std::vector<int> parent_;
};

bool same_matrix(const SpMat& a, const SpMat& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a.nonZeros() == b.nonZeros() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.outerSize() + 1, b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr()) &&
         std::equal(a.valuePtr(), a.valuePtr() + a.nonZeros(), b.valuePtr());
}

}  // namespace

std::vector<int> coupled_by(const SpMat& A) {
  Joined unknowns(A.rows());
  for (Index j = 0; j < A.cols(); ++j)
    for (SpMat::InnerIterator it(A, j); it; ++it) unknowns.join(it.row(), j);
  return unknowns.numbers();
}

SpMat normal_columns(const SpMat& A, int d) {
  SpMat out(A.rows(), A.cols() / d);
  for (Index a = 0; a < out.cols(); ++a) {
    out.startVec(a);
    for (SpMat::InnerIterator it(A, d * a); it; ++it) out.insertBack(it.row(), a) = it.value();
  }
  out.finalize();
  return out;
}

std::shared_ptr<const Inertia> Inertia::of(SpMat M) {
  M.makeCompressed();
  if (!lcp::symmetric(M, 0)) return nullptr;
  std::shared_ptr<Inertia> inertia(new Inertia);
  inertia->M_ = std::move(M);
  if (!inertia->factor()) return nullptr;
  return inertia;
}

bool Inertia::factor() {
  body_of_ = coupled_by(M_);
  place_.resize(body_of_.size());
  for (std::size_t i = 0; i < body_of_.size(); ++i) {
    const auto body = at(body_of_[i]);
    if (body >= rows_.size()) rows_.resize(body + 1);
    place_[i] = static_cast<int>(rows_[body].size());
    rows_[body].push_back(static_cast<int>(i));
  }
  if (std::ranges::any_of(rows_, [](const std::vector<int>& rows) { return rows.size() > largest_body; })) {
    cholesky_ = std::make_unique<lcp::Cholesky>();
    if (cholesky_->factor(M_) != lcp::CholeskyStatus::Ok) return false;
    rcond_ = whole_rcond();
    return true;
  }
  for (const std::vector<int>& rows : rows_) {
    const auto size = static_cast<Index>(rows.size());
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(size, size);
    for (Index j = 0; j < size; ++j)
      for (SpMat::InnerIterator it(M_, rows[at(j)]); it; ++it) block(place_[at(it.row())], j) = it.value();
    const Eigen::LLT<Eigen::MatrixXd> llt(block);
    if (llt.info() != Eigen::Success) return false;
    L_.emplace_back(llt.matrixL());
    if (!L_.back().allFinite()) return false;
    const Vec D = block.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd unit = D.asDiagonal() * block * D.asDiagonal();
    rcond_ = std::min(rcond_, unit.llt().rcond());
  }
  return true;
}

/// Of D M D, by solves: the pivots of Cholesky's factors would only tell what it is not below.
double Inertia::whole_rcond() const {
  const Vec D = M_.diagonal().cwiseSqrt().cwiseInverse();
  const auto solve = [&](In b, lcp::Out x) {
    cholesky_->solve(D.cwiseInverse().cwiseProduct(b), x);
    x = D.cwiseInverse().cwiseProduct(x);
  };
  return lcp::reciprocal_condition(lcp::norm1(D.asDiagonal() * M_ * D.asDiagonal()), M_.rows(), solve, solve);
}

double Inertia::entries_of_factor() const {
  if (cholesky_) return cholesky_->nonzeros();
  double entries = 0;
  for (const Eigen::MatrixXd& L : L_) entries += 0.5 * static_cast<double>(L.rows() * (L.rows() + 1));
  return entries;
}

Vec Inertia::inverse(In p) const {
  Vec v(p.size());
  if (cholesky_) {
    cholesky_->solve(p, v);
    return v;
  }
  Vec part;
  for (std::size_t b = 0; b < rows_.size(); ++b) {
    const std::vector<int>& rows = rows_[b];
    part.resize(static_cast<Index>(rows.size()));
    for (std::size_t k = 0; k < rows.size(); ++k) part[static_cast<Index>(k)] = p[rows[k]];
    L_[b].triangularView<Eigen::Lower>().solveInPlace(part);
    L_[b].triangularView<Eigen::Lower>().transpose().solveInPlace(part);
    for (std::size_t k = 0; k < rows.size(); ++k) v[rows[k]] = part[static_cast<Index>(k)];
  }
  return v;
}

std::unique_ptr<const SpMat> Inertia::root(const SpMat& H) const {
  if (cholesky_) return nullptr;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(at(H.nonZeros()));
  std::vector<int> met;
  Vec column = Vec::Zero(H.rows());
  Vec part;
  for (Index j = 0; j < H.cols(); ++j) {
    met.clear();
    for (SpMat::InnerIterator it(H, j); it; ++it) {
      column[it.row()] = it.value();
      if (std::ranges::find(met, body_of_[at(it.row())]) == met.end()) met.push_back(body_of_[at(it.row())]);
    }
    for (const int body : met) {
      const std::vector<int>& rows = rows_[at(body)];
      part.resize(static_cast<Index>(rows.size()));
      for (std::size_t k = 0; k < rows.size(); ++k) part[static_cast<Index>(k)] = std::exchange(column[rows[k]], 0);
      L_[at(body)].triangularView<Eigen::Lower>().solveInPlace(part);
      for (std::size_t k = 0; k < rows.size(); ++k)
        if (const double value = part[static_cast<Index>(k)]; value != 0)
          entries.emplace_back(rows[k], static_cast<int>(j), value);
    }
  }
  auto Z = std::make_unique<SpMat>(H.rows(), H.cols());
  Z->setFromTriplets(entries.begin(), entries.end());
  return Z;
}

DelassusParts::DelassusParts(std::shared_ptr<const Inertia> inertia, double s, SpMat H)
    : inertia_(std::move(inertia)), s_(s), M_(s * inertia_->M()), H_(std::move(H)) {
  M_.makeCompressed();
  H_.makeCompressed();
  if (auto Z = inertia_->root(H_)) root_ = std::make_unique<const SpMat>(*Z / std::sqrt(s_));
  find_near_and_shares();
}

void DelassusParts::find_near_and_shares() {
  const Index n = H_.cols();
  const std::vector<int>& body_of = inertia_->body_of();
  near_.assign(at(n), {});
  shares_ = SpMat(inertia_->bodies(), n);
  std::vector<std::pair<int, double>> squares;  // of the column at hand: N_bj^2 and b
  const auto add_square = [&](Index row, double square) {
    const int body = body_of[at(row)];
    const auto found = std::ranges::find(squares, body, &std::pair<int, double>::first);
    if (found == squares.end())
      squares.emplace_back(body, square);
    else
      found->second += square;
  };
  Vec v;
  for (Index j = 0; j < n; ++j) {
    squares.clear();
    if (root_) {
      for (Index i = std::max<Index>(0, j - 2); i <= j; ++i) near_[at(i)][at(j - i)] = root_->col(i).dot(root_->col(j));
      for (SpMat::InnerIterator it(*root_, j); it; ++it) add_square(it.row(), it.value() * it.value());
    } else {
      v = inverse(Vec(H_.col(j)));
      for (Index i = std::max<Index>(0, j - 2); i <= j; ++i) near_[at(i)][at(j - i)] = H_.col(i).dot(v);
      for (SpMat::InnerIterator it(H_, j); it; ++it) add_square(it.row(), it.value() * v[it.row()]);
    }
    std::ranges::sort(squares);
    shares_.startVec(j);
    for (const auto& [body, square] : squares) shares_.insertBack(body, j) = std::sqrt(std::max(square, 0.0));
  }
  shares_.finalize();
}

Vec DelassusParts::product(In r) const {
  if (root_) return root_->transpose() * Vec(*root_ * r);
  return H_.transpose() * inverse(Vec(H_ * r));
}

SpMat DelassusParts::form() const {
  SpMat W = root_ ? SpMat(SpMat(root_->transpose()) * *root_) : form_by_columns();
  W.prune([this](Index i, Index j, double value) {
    return !(std::abs(value) <= rounding_of_zero * std::sqrt(near(i, i) * near(j, j)));
  });
  return W;
}

SpMat DelassusParts::form_by_columns() const {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index j = 0; j < H_.cols(); ++j) {
    const Vec column = H_.transpose() * inverse(Vec(H_.col(j)));
    for (Index i = 0; i < column.size(); ++i)
      if (column[i] != 0) entries.emplace_back(static_cast<int>(i), static_cast<int>(j), column[i]);
  }
  SpMat W(H_.cols(), H_.cols());
  W.setFromTriplets(entries.begin(), entries.end());
  return 0.5 * (W + SpMat(W.transpose()));
}

struct Delassus::Entries {
  std::once_flag once;
  std::atomic<bool> formed = false;
  std::function<SpMat()> form;
  SpMat W;
};

Delassus::Delassus(SpMat W) : entries_(std::make_shared<Entries>()) {
  entries_->W = std::move(W);
  entries_->formed = true;
}

Delassus::Delassus(SpMat W, std::shared_ptr<const lcp::SchurProduct> exact) : Delassus(std::move(W)) {
  condensed_ = std::move(exact);
}

Delassus::Delassus(std::shared_ptr<const DelassusParts> parts, std::function<SpMat()> form)
    : entries_(std::make_shared<Entries>()), parts_(std::move(parts)) {
  entries_->form = form ? std::move(form) : [of = parts_] { return of->form(); };
}

Index Delassus::rows() const { return parts_ ? parts_->H().cols() : entries_->W.rows(); }
Index Delassus::cols() const { return parts_ ? parts_->H().cols() : entries_->W.cols(); }
bool Delassus::formed() const { return entries_->formed; }

bool Delassus::same_as(const Delassus& other) const {
  if (shift_ != other.shift_) return false;
  if (entries_ == other.entries_) return true;
  if (!parts_ || !other.parts_) return !parts_ && !other.parts_ && same_matrix(entries_->W, other.entries_->W);
  return same_matrix(parts_->M(), other.parts_->M()) && same_matrix(parts_->H(), other.parts_->H());
}

const SpMat& Delassus::matrix() const {
  if (parts_)
    std::call_once(entries_->once, [this] {
      entries_->W = entries_->form();
      entries_->formed = true;
    });
  return entries_->W;
}

SpMat& Delassus::given() {
  condensed_.reset();
  if (parts_ || entries_.use_count() > 1) *this = Delassus(SpMat(matrix()));
  return entries_->W;
}

Vec Delassus::diagonal() const {
  if (!parts_) return entries_->W.diagonal();
  return Vec::NullaryExpr(rows(), [this](Index i) { return near(i, i); });
}

double Delassus::near(Index i, Index j) const {
  if (!parts_) return entries_->W.coeff(i, j);
  return parts_->near(i, j) + (i == j ? shift_ : 0);
}

Delassus Delassus::plus(double alpha) const {
  if (alpha == 0) return *this;
  const auto add_to = [alpha](SpMat W) {
    for (Index i = 0; i < W.rows(); ++i) W.coeffRef(i, i) += alpha;
    return W;
  };
  if (!parts_) return add_to(entries_->W);
  Delassus sum(parts_, [of = *this, add_to] { return add_to(of.matrix()); });
  sum.shift_ = shift_ + alpha;
  return sum;
}

std::vector<std::vector<Index>> Delassus::groups(int d) const {
  const Index n = rows() / d;
  const SpMat& coupling = parts_ ? parts_->shares() : entries_->W;
  Joined joined(n + (parts_ ? coupling.rows() : 0));  // contacts, then bodies
  for (Index j = 0; j < coupling.cols(); ++j)
    for (SpMat::InnerIterator it(coupling, j); it; ++it)
      if (it.value() != 0) joined.join(j / d, parts_ ? n + it.row() : it.row() / d);
  const std::vector<int> number = joined.numbers();
  std::vector<std::vector<Index>> groups;
  for (Index a = 0; a < n; ++a) {
    const std::size_t group = at(number[at(a)]);
    if (group >= groups.size()) groups.resize(group + 1);
    groups[group].push_back(a);
  }
  return groups;
}

Eigen::MatrixXd Delassus::columns(const Eigen::MatrixXd& R) const {
  Eigen::MatrixXd products(rows(), R.cols());
  for (Index j = 0; j < R.cols(); ++j) products.col(j) = product(R.col(j));
  return products;
}

Vec Delassus::product(In r) const {
  if (!parts_) return entries_->W * r;
  Vec out = parts_->product(r);
  if (shift_ != 0) out += shift_ * r;
  return out;
}

}  // namespace perp::contact

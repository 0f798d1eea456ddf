// SPDX-License-Identifier: Apache-2.0
#include "contact/model/delassus.hpp"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <limits>
#include <mutex>
#include <utility>

#include "lcp/cholesky/symmetric.hpp"
#include "lcp/dense_factors.hpp"
#include "lcp/linalg/joined.hpp"
#include "lcp/lu/condition.hpp"

namespace perp::contact {
namespace {

/// Bodies of more velocities are factored together, by sparse factors.
constexpr std::size_t largest_body = 24;
/// Of what a contact velocity would be without constraints: below, its share is found from refined solutions.
constexpr double held = 1e-6;
constexpr double unsure_by_lu = 1e3;
/// Below, it is zero.
constexpr double held_altogether = 1e-20;

bool same_matrix(const SpMat& a, const SpMat& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a.nonZeros() == b.nonZeros() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.outerSize() + 1, b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr()) &&
         std::equal(a.valuePtr(), a.valuePtr() + a.nonZeros(), b.valuePtr());
}

}  // namespace

SpMat columns_of(const SpMat& A, const std::vector<Index>& columns, In weights) {
  SpMat out(A.rows(), weights.size());
  out.reserve(A.nonZeros());
  for (Index k = 0; k < weights.size(); ++k) {
    out.startVec(k);
    for (SpMat::InnerIterator it(A, columns[at(k)]); it; ++it) out.insertBack(it.row(), k) = weights[k] * it.value();
  }
  out.finalize();
  return out;
}

SpMat normal_columns(const SpMat& A, int d) {
  std::vector<Index> normals;
  for (Index j = 0; j < A.cols(); j += d) normals.push_back(j);
  return columns_of(A, normals, Vec::Ones(static_cast<Index>(normals.size())));
}

std::vector<int> touched_velocities(const Inertia& inertia, const SpMat& H) {
  std::vector<char> touched(at(inertia.bodies()), 0);
  for (Index j = 0; j < H.cols(); ++j)
    for (SpMat::InnerIterator it(H, j); it; ++it) touched[at(inertia.body_of()[at(it.row())])] = 1;
  std::vector<int> place;
  int count = 0;
  for (const int body : inertia.body_of()) place.push_back(touched[at(body)] != 0 ? count++ : -1);
  return place;
}

Vec free_squares(const Inertia& inertia, const SpMat& H) {
  const Vec M = inertia.M().diagonal();
  Vec out = Vec::Zero(H.cols());
  for (Index j = 0; j < H.cols(); ++j)
    for (SpMat::InnerIterator it(H, j); it; ++it)
      if (it.row() < inertia.velocities()) out[j] += it.value() * it.value() / M[it.row()];
  return out;
}

std::shared_ptr<const Inertia> Inertia::of(SpMat M) {
  M.prune([](Index /*i*/, Index /*j*/, double value) { return value != 0; });
  M.makeCompressed();
  if (!lcp::symmetric(M, 0)) return nullptr;
  std::shared_ptr<Inertia> inertia(new Inertia);
  inertia->M_ = std::move(M);
  inertia->velocities_ = inertia->M_.rows();
  if (!inertia->factor()) return nullptr;
  return inertia;
}

std::shared_ptr<const Inertia> Inertia::of(const SpMat& M, SpMat K, std::shared_ptr<const lcp::RefinedLu> factors) {
  if (!factors->regular() || !lcp::symmetric(M, rounding_of_input)) return nullptr;
  const SpMat transposed = M.transpose();
  if (!of(SpMat(0.5 * (M + transposed)))) return nullptr;
  std::shared_ptr<Inertia> inertia(new Inertia);
  inertia->symmetric_ = lcp::symmetric(M, 0);
  inertia->velocities_ = M.rows();
  inertia->M_ = std::move(K);
  inertia->body_of_ = factors->part_of();
  const auto& body_of = inertia->body_of_;
  inertia->M_.prune([&](Index i, Index j, double value) { return value != 0 && body_of[at(i)] == body_of[at(j)]; });
  inertia->find_bodies();
  inertia->rcond_ = factors->rcond();
  inertia->entries_of_lu_ = factors->entries_of_factors();
  inertia->lu_ = std::move(factors);
  return inertia;
}

/// The rows of each body, and the place of each among them.
void Inertia::find_bodies() {
  place_.resize(body_of_.size());
  for (std::size_t i = 0; i < body_of_.size(); ++i) {
    const auto body = at(body_of_[i]);
    if (body >= rows_.size()) rows_.resize(body + 1);
    place_[i] = static_cast<int>(rows_[body].size());
    rows_[body].push_back(static_cast<int>(i));
  }
}

bool Inertia::factor() {
  body_of_ = lcp::coupled_by(M_);
  find_bodies();
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
  if (lu_) return entries_of_lu_ / 2;
  if (cholesky_) return cholesky_->nonzeros();
  double entries = 0;
  for (const Eigen::MatrixXd& L : L_) entries += 0.5 * static_cast<double>(L.rows() * (L.rows() + 1));
  return entries;
}

Vec Inertia::inverse(In p) const {
  if (lu_) return lu_->solve(p);
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
  if (cholesky_ || lu_) return nullptr;
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

DelassusParts::DelassusParts(std::shared_ptr<const Inertia> inertia, SpMat H)
    : inertia_(std::move(inertia)), M_(inertia_->M()), H_(std::move(H)) {
  H_.makeCompressed();
  if (auto Z = inertia_->root(H_)) root_ = std::move(Z);
  find_near_and_shares();
}

DelassusParts::DelassusParts(const DelassusParts& of, double s, const std::vector<Index>& rows,
                             const std::vector<double>& weights)
    : inertia_(of.inertia_), s_(s * of.s_), M_(s * of.M_) {
  const Eigen::Map<const Vec> all(weights.data(), static_cast<Index>(weights.size()));
  H_ = columns_of(of.H_, rows, all);
  shares_ = columns_of(of.shares_, rows, all) / std::sqrt(s);
  if (of.root_) root_ = std::make_unique<const SpMat>(columns_of(*of.root_, rows, all) / std::sqrt(s));
  near_.assign(rows.size(), {});
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = i; j < std::min(i + 3, rows.size()); ++j)
      if (const Index apart = std::abs(rows[j] - rows[i]); apart <= 2)
        near_[i][j - i] = weights[i] * weights[j] * of.near(rows[i], rows[j]) / s;
}

/// Of column j, with v = M^-1 H_j.
void DelassusParts::take_near_and_shares(Index j, In v) {
  const std::vector<int>& body_of = inertia_->body_of();
  std::vector<std::pair<int, double>> squares;  // b and N_bj^2
  const auto add_square = [&](Index row, double square) {
    const int body = body_of[at(row)];
    const auto found = std::ranges::find(squares, body, &std::pair<int, double>::first);
    if (found == squares.end())
      squares.emplace_back(body, square);
    else
      found->second += square;
  };
  for (Index i = std::max<Index>(0, j - 2); i <= j; ++i)
    near_[at(i)][at(j - i)] = root_ ? root_->col(i).dot(root_->col(j)) : H_.col(i).dot(v);
  if (root_)
    for (SpMat::InnerIterator it(*root_, j); it; ++it) add_square(it.row(), it.value() * it.value());
  else
    for (SpMat::InnerIterator it(H_, j); it; ++it) add_square(it.row(), it.value() * v[it.row()]);
  std::ranges::sort(squares);
  shares_.startVec(j);
  for (const auto& [body, square] : squares) shares_.insertBack(body, j) = std::sqrt(std::max(square, 0.0));
}

void DelassusParts::find_near_and_shares() {
  near_.assign(at(H_.cols()), {});
  shares_ = SpMat(inertia_->bodies(), H_.cols());
  if (inertia_->by_lu()) {
    find_constrained();
  } else {
    for (Index j = 0; j < H_.cols(); ++j) take_near_and_shares(j, root_ ? Vec() : inverse(Vec(H_.col(j))));
  }
  shares_.finalize();
}

/// Where constraints hold almost all of a velocity, what is left of a solution is its rounding, and where they hold all
/// of it, what is left of a refined one.
void DelassusParts::find_constrained() {
  const lcp::RefinedLu& K = inertia_->lu();
  const double unsure = std::max(held, unsure_by_lu * std::numeric_limits<double>::epsilon() / K.rcond());
  const Vec free = free_squares(*inertia_, H_);
  const Vec nothing = Vec::Zero(H_.rows());
  K.for_each_column(H_, [&](Index j, const lcp::SparseVector& v) {
    const auto moved = [&](const Vec& by) { return H_.col(j).dot(by); };
    if (moved(v.values()) > unsure * free[j]) {
      take_near_and_shares(j, v.values());
      return true;
    }
    const std::optional<lcp::TwoPartVector> refined = K.refined(lcp::TwoPartVector(Vec(H_.col(j))));
    const bool moves = refined && moved(refined->value) > held_altogether * free[j];
    take_near_and_shares(j, moves ? refined->value : nothing);
    return true;
  });
}

Vec DelassusParts::product(In r) const {
  if (root_) return root_->transpose() * Vec(*root_ * r);
  return H_.transpose() * inverse(Vec(H_ * r));
}

lcp::SchurImage DelassusParts::refined_product(In r, double shift, In w) const {
  assert(s_ == 1);
  lcp::TwoPartSums p(Vec::Zero(H_.rows()));
  p.add_product(H_, r);
  lcp::TwoPartSums rest{Vec(w)};
  if (shift != 0)
    for (Index i = 0; i < r.size(); ++i) {
      rest.sum.add_product(i, shift, r[i]);
      rest.terms[i] += std::abs(shift * r[i]);
    }
  return lcp::schur_image(inertia_->lu(), H_, p, rest);
}

SpMat DelassusParts::form() const {
  SpMat W = root_ ? SpMat(SpMat(root_->transpose()) * *root_) : form_by_columns();
  W.prune([this](Index i, Index j, double value) {
    if (std::abs(value) <= rounding_of_zero * std::sqrt(near(i, i) * near(j, j))) return false;
    return !inertia_->by_lu() || shares_.col(i).dot(shares_.col(j)) > 0;  // what is held acts on nothing
  });
  return W;
}

SpMat DelassusParts::form_by_columns() const {
  if (inertia_->by_lu()) {
    if (std::optional<SpMat> W = inertia_->lu().schur(H_, 0)) {
      *W /= s_;
      return inertia_->symmetric() ? SpMat(0.5 * (*W + SpMat(W->transpose()))) : *W;
    }
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (Index j = 0; j < H_.cols(); ++j) {
    const Vec column = H_.transpose() * inverse(Vec(H_.col(j)));
    for (Index i = 0; i < column.size(); ++i)
      if (column[i] != 0) entries.emplace_back(static_cast<int>(i), static_cast<int>(j), column[i]);
  }
  SpMat W(H_.cols(), H_.cols());
  W.setFromTriplets(entries.begin(), entries.end());
  return inertia_->symmetric() ? SpMat(0.5 * (W + SpMat(W.transpose()))) : W;
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
  lcp::Joined joined(n + (parts_ ? coupling.rows() : 0));  // contacts, then bodies
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

Delassus Delassus::part(const std::vector<Index>& rows) const {
  if (whole_parts() != nullptr)
    return Delassus(std::make_shared<const DelassusParts>(*parts_, 1, rows, std::vector<double>(rows.size(), 1)));
  std::vector<int> place(at(this->rows()), -1);
  for (std::size_t k = 0; k < rows.size(); ++k) place[at(rows[k])] = static_cast<int>(k);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t j = 0; j < rows.size(); ++j)
    for (SpMat::InnerIterator it(matrix(), rows[j]); it; ++it)
      if (const int row = place[at(it.row())]; row >= 0 && it.value() != 0)
        entries.emplace_back(row, static_cast<int>(j), it.value());
  const auto size = static_cast<Index>(rows.size());
  SpMat out(size, size);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
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

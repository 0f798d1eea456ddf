// SPDX-License-Identifier: Apache-2.0
#include "contact/model/contact_system.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "lcp/cholesky/symmetric.hpp"
#include "lcp/linalg/gmres.hpp"

namespace perp::contact {
namespace {

/// KLU up to so many rows and entries in each, the general LU beyond: factors of large piles are dense, KLU's loops are
/// for sparse ones.
constexpr Index system_klu_rows = 2000;
constexpr Index system_klu_entries = 60;
constexpr double system_diagonal_term = 1e-14;
/// Refinement while the residual is above this, relative.
constexpr double refined = 1e-13;
constexpr double symmetric_tol = 1e-13;
/// GMRES: residual and products. More contacts than `most_coupled` are not tried: LU takes less.
constexpr double coupling_tol = 1e-11;
constexpr int most_products = 80;
constexpr Index most_reduced = 256;  // by LU
constexpr Index reduced_columns = 32;
constexpr double coupled_refined = 1e-9;
constexpr double most_coupled = 0.5;

/// Of a block whose rows may differ by many powers of ten.
template <int Size>
ContactMatrix<Size> inverse_of(const ContactMatrix<Size>& A, int size) {
  using Block = ContactMatrix<Size>;
  Block whole = Block::Identity();
  whole.topLeftCorner(size, size) = A.topLeftCorner(size, size);
  ContactVector<Size> scale = whole.cwiseAbs().rowwise().maxCoeff();
  Block inverse = (scale.cwiseInverse().asDiagonal() * whole).partialPivLu().inverse();
  return inverse * scale.cwiseInverse().asDiagonal();
}

bool nearly_symmetric(const Eigen::Ref<const Eigen::MatrixXd>& A) {
  return (A - A.transpose()).cwiseAbs().maxCoeff() <= symmetric_tol * A.diagonal().cwiseAbs().maxCoeff();
}

/// Whether A + B W may be positive definite as far as this contact tells.
template <int Size>
bool definite(const RowsOfSize<Size>& rows, int size) {
  return rows.B.topLeftCorner(size, size).isIdentity(0) && nearly_symmetric(rows.A.topLeftCorner(size, size));
}

/// Parts are symmetric to rounding at least.
bool symmetric(const Delassus& W, double tol) {
  if (W.parts() == nullptr) return lcp::symmetric(W.matrix(), tol);
  return tol > 0 || W.parts()->inertia().symmetric();
}

}  // namespace

template <int Size>
Vec product(const Scaled& problem, const std::vector<RowsOfSize<Size>>& rows, In x) {
  const Vec Wx = problem.W * x;
  Vec out(x.size());
  for (std::size_t a = 0; a < rows.size(); ++a) {
    const Scaled::Block& block = problem.blocks[a];
    out.segment(block.first, block.size) =
        (rows[a].A * block.of<Size>(x) + rows[a].B * block.of<Size>(Wx)).head(block.size);
  }
  return out;
}

/// W has whole blocks only on the diagonal: elsewhere the rows of a contact may be in a column in part, which couples
/// through B's off-diagonal entries.
template <int Size>
void contact_matrix(const Scaled& problem, const std::vector<RowsOfSize<Size>>& rows, double alpha, SpMat& K) {
  std::vector<int> owner;
  for (std::size_t a = 0; a < problem.blocks.size(); ++a)
    owner.insert(owner.end(), at(problem.blocks[a].size), static_cast<int>(a));
  const SpMat& W = problem.W.matrix();
  for (Index j = 0; j < K.cols(); ++j) {
    SpMat::InnerIterator w(W, j);
    SpMat::InnerIterator k(K, j);
    while (w) {
      const int a = owner[at(w.row())];
      const Scaled::Block& block = problem.blocks[at(a)];
      ContactVector<Size> column = ContactVector<Size>::Zero();
      for (; w && owner[at(w.row())] == a; ++w) column[w.row() - block.first] = w.value();
      const bool own = owner[at(j)] == a;
      if (own) column[j - block.first] += alpha;
      ContactVector<Size> value = rows[at(a)].B * column;
      if (own) value += rows[at(a)].A.col(j - block.first);
      for (; k && owner[at(k.row())] == a; ++k) k.valueRef() = value[k.row() - block.first];
    }
  }
}

template Vec product<3>(const Scaled&, const std::vector<RowsOfSize<3>>&, In);
template Vec product<5>(const Scaled&, const std::vector<RowsOfSize<5>>&, In);
template void contact_matrix<3>(const Scaled&, const std::vector<RowsOfSize<3>>&, double, SpMat&);
template void contact_matrix<5>(const Scaled&, const std::vector<RowsOfSize<5>>&, double, SpMat&);

template <int Size>
ContactSystemOf<Size>::ContactSystemOf(const Scaled& problem, lcp::LuBackend lu)
    : problem_(problem),
      cholesky_(std::make_shared<lcp::Cholesky>(lcp::CholeskyOrdering::Thorough)),
      backend_(lu),
      exactly_symmetric_W_(symmetric(problem.W, 0)),
      symmetric_W_(exactly_symmetric_W_ || symmetric(problem.W, rounding_of_input)),
      W_(problem.W.plus(-problem.W.shift())) {}

template <int Size>
ContactSystemOf<Size>::ContactSystemOf(const Scaled& problem, const ContactSystemOf& shared)
    : problem_(problem),
      backend_(shared.backend_),
      exactly_symmetric_W_(symmetric(problem.W, 0)),
      symmetric_W_(exactly_symmetric_W_ || symmetric(problem.W, rounding_of_input)),
      chosen_(true),
      W_(problem.W.plus(-problem.W.shift())) {
  if (problem.W.parts() != nullptr)
    bodies_ = shared.bodies_ ? shared.bodies_ : std::make_shared<BodiesMatrixOf<Size>>(problem);
  else
    K_ = problem.W.matrix();
  if ((bodies_ != nullptr) == (shared.bodies_ != nullptr)) {
    lu_ = shared.lu_;
    cholesky_ = shared.cholesky_;
  }
  if (!lu_) make_lu();
  if (!cholesky_) cholesky_ = std::make_shared<lcp::Cholesky>();
}

template <int Size>
ContactSystemOf<Size>::~ContactSystemOf() = default;

template <int Size>
typename ContactSystemOf<Size>::Form ContactSystemOf<Size>::form() {
  choose();
  return bodies_ ? Form::Bodies : Form::Contacts;
}

template <int Size>
void ContactSystemOf<Size>::choose() {
  if (std::exchange(chosen_, true)) return;
  if (problem_.W.parts() != nullptr) bodies_ = std::make_shared<BodiesMatrixOf<Size>>(problem_);
  if (!bodies_) K_ = problem_.W.matrix();
  make_lu();
}

template <int Size>
void ContactSystemOf<Size>::make_lu() {
  const SpMat& K = bodies_ ? bodies_->matrix() : K_;
  lcp::LuBackend backend = backend_;
  if (backend == lcp::LuBackend::Auto)
    backend = K.rows() <= system_klu_rows && K.nonZeros() <= system_klu_entries * K.rows() ? lcp::LuBackend::Klu
                                                                                           : lcp::LuBackend::General;
  lu_ = std::make_shared<lcp::SparseLu>(backend);
  if (!bodies_) lu_->reuse_pivots();  // by bodies E takes the digits that older pivots leave
}

template <int Size>
bool ContactSystemOf<Size>::take_contacts(bool definite) {
  ++factorizations_;
  contact_matrix(problem_, rows_, system_diagonal_term, K_);
  by_cholesky_ = definite && cholesky_->try_factor(K_);
  return by_cholesky_ || lu_->factor(K_) == lcp::LuStatus::Ok;
}

/// `definite`: all E are symmetric.
template <int Size>
bool ContactSystemOf<Size>::take_bodies(bool definite) {
  ++factorizations_;
  if (definite) bodies_->assemble_lower(E_);
  by_cholesky_ = definite && cholesky_->try_factor(bodies_->matrix());
  if (by_cholesky_) return true;
  bodies_->assemble(E_);
  return lu_->factor(bodies_->with_unit_diagonal(scale_)) == lcp::LuStatus::Ok;
}

/// E = A^-1 B of one contact; whether it is symmetric.
template <int Size>
bool ContactSystemOf<Size>::invert(std::size_t a) {
  const int size = problem_.blocks[a].size;
  A_inverse_[a] = inverse_of<Size>(rows_[a].A, size);
  E_[a] = A_inverse_[a].topLeftCorner(Size, size) * rows_[a].B.topLeftCorner(size, Size);
  return nearly_symmetric(E_[a]);
}

/// By bodies: whether all E are symmetric without what friction takes from the normal impulse, A's first column.
template <int Size>
bool ContactSystemOf<Size>::part_by_bodies() {
  A_inverse_.resize(rows_.size());
  E_.resize(rows_.size());
  bool symmetric = true;
  for (std::size_t a = 0; a < rows_.size() && symmetric; ++a) {
    if (invert(a)) continue;
    ContactVector<Size> p = rows_[a].A.col(0);
    p[0] = 0;
    rows_[a].A.col(0).template tail<Size - 1>().setZero();
    couplings_.push_back({.contact = a, .p = p, .q = ContactVector<Size>::UnitX()});
    symmetric = invert(a);
  }
  return symmetric && static_cast<double>(couplings_.size()) <= most_coupled * static_cast<double>(rows_.size());
}

/// All in one matrix, by LU.
template <int Size>
bool ContactSystemOf<Size>::factor_whole() {
  for (const Coupling& c : std::exchange(couplings_, {})) rows_[c.contact].A += c.p * c.q.transpose();
  if (bodies_) {
    A_inverse_.resize(rows_.size());
    E_.resize(rows_.size());
    for (std::size_t a = 0; a < rows_.size(); ++a) invert(a);
    return take_bodies(false);
  }
  return take_contacts(false);
}

template <int Size>
bool ContactSystemOf<Size>::factor(const std::vector<Rows>& rows) {
  choose();
  reduced_.reset();
  rows_ = rows;
  if (const double shift = problem_.W.shift(); shift != 0)
    for (Rows& of : rows_) of.A += shift * of.B;
  couplings_.clear();
  bool all_definite = !bodies_ && symmetric_W_;
  for (std::size_t a = 0; a < rows_.size() && all_definite; ++a)
    all_definite = definite<Size>(rows_[a], problem_.blocks[a].size);
  if (all_definite) return take_contacts(true);
  return bodies_ && !bodies_->by_lu() && part_by_bodies() ? take_bodies(true) : factor_whole();
}

template <int Size>
bool ContactSystemOf<Size>::factor(const std::vector<Block>& A, const std::vector<Block>& inverse,
                                   std::vector<Coupling> couplings) {
  assert(problem_.W.shift() == 0);
  choose();
  reduced_.reset();
  rows_.resize(A.size());
  for (std::size_t a = 0; a < A.size(); ++a) rows_[a] = {.A = A[a], .B = Block::Identity()};
  couplings_ = std::move(couplings);
  A_inverse_ = inverse;
  E_ = inverse;
  if (bodies_ && bodies_->by_lu()) {
    couple_inverses();
    return take_bodies(false);
  }
  if (!symmetric_W_ || static_cast<double>(couplings_.size()) > most_coupled * static_cast<double>(A.size()))
    return factor_whole();
  return bodies_ ? take_bodies(true) : take_contacts(true);
}

/// Takes the couplings into A, and into its inverses by Sherman and Morrison's formula, which keeps their digits.
template <int Size>
void ContactSystemOf<Size>::couple_inverses() {
  for (const Coupling& c : std::exchange(couplings_, {})) {
    Block& inverse = A_inverse_[c.contact];
    const ContactVector<Size> p = inverse * c.p;
    const Eigen::Matrix<double, 1, Size> q = c.q.transpose() * inverse;
    inverse -= p * q / (1 + c.q.dot(p));
    E_[c.contact] = inverse;
    rows_[c.contact].A += c.p * c.q.transpose();
  }
}

template <int Size>
void ContactSystemOf<Size>::back_solve(const Vec& b, Vec& x) const {
  x.resize(b.size());
  if (by_cholesky_) return cholesky_->solve(b, x);
  if (!bodies_) return lu_->solve(b, x);
  lu_->solve(scale_.cwiseProduct(b), x);
  x = scale_.cwiseProduct(x).eval();
}

template <int Size>
void ContactSystemOf<Size>::back_solve(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) const {
  X = B;
  if (by_cholesky_) return cholesky_->solve_columns(X);
  Vec x;
  for (Index k = 0; k < X.cols(); ++k) {
    back_solve(Vec(X.col(k)), x);
    X.col(k) = x;
  }
}

/// out_a += blocks_a in_a.
template <int Size>
template <class Blocks, class X>
void ContactSystemOf<Size>::add_product(const Blocks& block, const X& in, X& out) const {
  for (std::size_t a = 0; a < problem_.blocks.size(); ++a) {
    const Scaled::Block& b = problem_.blocks[a];
    if (b.size == Size)
      out.template middleRows<Size>(b.first).noalias() += block(a) * in.template middleRows<Size>(b.first);
    else
      out.middleRows(b.first, b.size) += block(a).topLeftCorner(b.size, b.size) * in.middleRows(b.first, b.size);
  }
}

/// x = A^-1 (c - B H' v), of columns.
template <int Size>
template <class X>
void ContactSystemOf<Size>::solve_by_bodies(const X& c, X& x) const {
  const SpMat& H = problem_.W.parts()->H();
  const auto A_inverse = [this](std::size_t a) -> const Block& { return A_inverse_[a]; };
  const auto minus_B = [this](std::size_t a) -> Block { return -rows_[a].B; };
  X y = X::Zero(c.rows(), c.cols());
  add_product(A_inverse, c, y);
  X v;
  back_solve(X(H * y), v);
  X rest = c;
  add_product(minus_B, X(H.transpose() * v), rest);
  x = X::Zero(c.rows(), c.cols());
  add_product(A_inverse, rest, x);
}

/// (A + B W) x.
template <int Size>
template <class X>
X ContactSystemOf<Size>::product(const X& x) const {
  const auto A = [this](std::size_t a) -> const Block& { return rows_[a].A; };
  const auto B = [this](std::size_t a) -> const Block& { return rows_[a].B; };
  X out = X::Zero(x.rows(), x.cols());
  add_product(A, x, out);
  add_product(B, X(W_.columns(x)), out);
  return out;
}

template <int Size>
void ContactSystemOf<Size>::solve_definite(In c, Vec& x) const {
  solve_definite_once(Vec(c), x);
  if (!bodies_ && (exactly_symmetric_W_ || !by_cholesky_)) return;
  const auto again = [this](const Vec& rest, Vec& dx) { solve_definite_once(rest, dx); };
  refine(
      c, refined * c.lpNorm<Eigen::Infinity>(), [this](const Vec& at) { return product(at); }, again, x);
}

/// Of columns.
template <int Size>
template <class X>
void ContactSystemOf<Size>::solve_definite_once(const X& c, X& x) const {
  bodies_ ? solve_by_bodies(c, x) : back_solve(c, x);
}

template <int Size>
void ContactSystemOf<Size>::solve_once(In c, Vec& x) {
  const Vec right = c;
  solve_definite_once(right, x);
  if (couplings_.empty()) return;
  if (const std::optional<Vec> z = solve_reduced(couple(x)))
    solve_definite_once(Vec(right - spread(*z)), x);
  else if (factor_whole())
    solve_definite_once(right, x);
  else
    x.setConstant(std::numeric_limits<double>::quiet_NaN());
}

/// Q' x.
template <int Size>
Vec ContactSystemOf<Size>::couple(const Vec& x) const {
  Vec z(static_cast<Index>(couplings_.size()));
  for (Index k = 0; k < z.size(); ++k) {
    const Coupling& of = couplings_[at(k)];
    z[k] = of.q.dot(problem_.blocks[of.contact].template of<Size>(x));
  }
  return z;
}

/// P z.
template <int Size>
Vec ContactSystemOf<Size>::spread(const Vec& z) const {
  Vec out = Vec::Zero(problem_.size());
  for (Index k = 0; k < z.size(); ++k) {
    const Coupling& of = couplings_[at(k)];
    const Scaled::Block& block = problem_.blocks[of.contact];
    out.segment(block.first, block.size) += z[k] * of.p.head(block.size);
  }
  return out;
}

/// 1 + Q' K^-1 P, some columns at a time, without refinement: that is for the solutions.
template <int Size>
void ContactSystemOf<Size>::reduce() {
  const auto count = static_cast<Index>(couplings_.size());
  Eigen::MatrixXd whole = Eigen::MatrixXd::Identity(count, count);
  for (Index from = 0; from < count; from += reduced_columns) {
    const Index width = std::min(reduced_columns, count - from);
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(problem_.size(), width);
    for (Index k = 0; k < width; ++k) {
      const Coupling& of = couplings_[at(from + k)];
      const Scaled::Block& block = problem_.blocks[of.contact];
      right.block(block.first, k, block.size, 1) = of.p.head(block.size);
    }
    Eigen::MatrixXd x;
    solve_definite_once(right, x);
    for (Index k = 0; k < width; ++k) whole.col(from + k) += couple(x.col(k));
  }
  reduced_.emplace(whole);
}

/// Nothing: GMRES does not converge.
template <int Size>
std::optional<Vec> ContactSystemOf<Size>::solve_reduced(const Vec& right) {
  if (right.size() <= most_reduced) {
    if (!reduced_) reduce();
    return Vec(reduced_->solve(right));
  }
  Vec Kx;
  const auto reduced = [&](const Vec& z) {
    solve_definite(spread(z), Kx);
    return Vec(z + couple(Kx));
  };
  return lcp::gmres(reduced, right, coupling_tol, most_products);
}

/// False: the reduced system is not solved.
template <int Size>
bool ContactSystemOf<Size>::solve_coupled(In c, Vec& x) {
  solve_definite(c, x);
  const std::optional<Vec> z = solve_reduced(couple(x));
  if (z) solve_definite(c - spread(*z), x);
  return z && x.allFinite();
}

template <int Size>
void ContactSystemOf<Size>::solve(In c, Vec& x) {
  if (couplings_.empty()) return solve_definite(c, x);
  if (solve_coupled(c, x)) {
    const auto whole = [this](const Vec& at) { return Vec(product(at) + spread(couple(at))); };
    const auto again = [this](const Vec& rest, Vec& dx) {
      if (!solve_coupled(rest, dx)) dx.setZero();
    };
    refine(c, coupled_refined * c.lpNorm<Eigen::Infinity>(), whole, again, x);
  } else if (factor_whole()) {
    solve_definite(c, x);
  } else {
    x.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
}

template class ContactSystemOf<3>;
template class ContactSystemOf<5>;

}  // namespace perp::contact

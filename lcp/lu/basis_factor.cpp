// SPDX-License-Identifier: Apache-2.0
#include "lcp/lu/basis_factor.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "lcp/lu/condition.hpp"
#include "lcp/lu/eta_file.hpp"
#include "lcp/lu/lu_factors.hpp"
#include "lcp/lu/past_zeros.hpp"
#include "lcp/words.hpp"

namespace perp::lcp {
namespace {

constexpr int none = -1;

/// UMFPACK takes ten times as long as the arithmetic of a matrix of so many rows.
constexpr Index few_rows = 300;

void require_size(const char* what, Index size, Index rows) {
  if (size == rows) return;
  throw std::invalid_argument(
      text_of("BasisFactor: ", what, " has ", size, " entries, not one for each of ", rows, " rows"));
}

void require_below(const char* what, Index i, Index limit) {
  if (i >= 0 && i < limit) return;
  throw std::invalid_argument(text_of("BasisFactor: ", what, ' ', i, " is none of the ", limit, " there are"));
}

}  // namespace

struct BasisFactor::Impl {
  Impl(const SpMat& matrix, BasisOptions o)
      : A(&matrix),
        options(o),
        own{SparseLu(o.lu)},
        shared(o.shared ? o.shared : &own),
        rhs(matrix.rows()),
        b_(matrix.rows()),
        given_(matrix.rows()),
        found_(matrix.rows()) {}

  const SpMat* A;
  BasisOptions options;
  SharedLu own;
  SharedLu* shared;
  LuStatus status = LuStatus::Singular;
  std::vector<Index> basis;
  int factorizations = 0;

  // The partition of the last factor(): positions and rows of slacks, the rest numbered as in C.
  std::vector<int> slack_of_row;     // position of the slack in this row, or none
  std::vector<int> row_of_position;  // row of the slack at this position, or none
  std::vector<int> active_row;       // rows of C
  std::vector<int> active_position;  // columns of C
  std::vector<int> block_of_row;     // their inverses
  std::vector<int> block_of_position;
  Vec slack;             // D by rows
  SpMat S;               // n x active, entries in rows of slacks only
  mutable SpMat S_rows;  // its transpose, from the first btran on
  mutable bool has_S_rows = false;
  SpMat C;
  Index B_nonzeros = 0;

  EtaFile etas;
  double growth = 1;
  double drift = 0;
  mutable std::size_t eta_work = 0;  // entries of the file that solves passed through
  Index factor_entries = 0;          // of L + U, or a guess

  mutable std::optional<LuSolver> solver;  // where the library gives its factors
  mutable SparseVector block_b, block_x;   // of the order of C
  mutable Vec block_;                      // the same
  mutable SparseVector rhs;                // by rows
  mutable SparseVector b_;                 // by positions
  mutable SparseVector given_, found_;     // of the solves with dense right-hand sides
  mutable Vec rows_;                       // what is left of them in the rows of slacks

  Index rows() const { return A->rows(); }
  template <class F>
  void for_column(Index j, F f) const {  // f(row, value)
    if (j >= A->cols()) {
      f(j - A->cols(), 1.0);
      return;
    }
    for (SpMat::InnerIterator it(*A, j); it; ++it) f(it.row(), it.value());
  }
  void partition();
  LuStatus factor(std::span<const Index> columns);
  /// Whether the last factor() was of these columns, and none has been replaced since.
  bool factored(std::span<const Index> columns) const {
    return factorizations > 0 && etas.size() == 0 && std::ranges::equal(basis, columns);
  }
  std::vector<Dependency> dependencies(double tol) const;
  void ftran(const SparseVector& b, SparseVector& x) const;
  void btran(const SparseVector& b, SparseVector& x) const;
  void solve_block(bool transposed) const;
  void fill(const SparseVector& b, const Vec& block, SparseVector& x) const;
  double drift_of(Index q, const SparseVector& d) const;
  double norm1() const;
};

/// Sets the columns with one entry aside, one a row.
void BasisFactor::Impl::partition() {
  const Index n = rows();
  slack_of_row.assign(at(n), none);
  row_of_position.assign(at(n), none);
  slack = Vec::Zero(n);
  for (Index p = 0; p < n; ++p) {
    int entries = 0;
    Index row = 0;
    double pivot = 0;
    for_column(basis[at(p)], [&](Index i, double v) {
      if (v == 0) return;
      ++entries;
      row = i;
      pivot = v;
    });
    if (entries != 1 || !std::isfinite(pivot) || slack_of_row[at(row)] != none) continue;
    slack_of_row[at(row)] = static_cast<int>(p);
    row_of_position[at(p)] = static_cast<int>(row);
    slack[row] = pivot;
  }
  const auto number = [n](const std::vector<int>& taken, std::vector<int>& members, std::vector<int>& inverse) {
    members.clear();
    members.reserve(at(n));
    inverse.assign(at(n), none);
    for (Index i = 0; i < n; ++i) {
      if (taken[at(i)] != none) continue;
      inverse[at(i)] = static_cast<int>(members.size());
      members.push_back(static_cast<int>(i));
    }
  };
  number(slack_of_row, active_row, block_of_row);
  number(row_of_position, active_position, block_of_position);
}

LuStatus BasisFactor::Impl::factor(std::span<const Index> columns) {
  basis.assign(columns.begin(), columns.end());
  etas.clear();
  growth = 1;
  drift = 0;
  eta_work = 0;
  ++factorizations;
  status = LuStatus::Singular;
  partition();
  const auto order = static_cast<Index>(active_position.size());
  Index in_S = 0;
  Index in_C = 0;
  for (const int p : active_position)
    for_column(basis[at(p)], [&](Index i, double) { ++(block_of_row[at(i)] == none ? in_S : in_C); });
  B_nonzeros = rows() - order + in_S + in_C;
  S.resize(rows(), order);
  C.resize(order, order);
  S.resizeNonZeros(in_S);
  C.resizeNonZeros(in_C);
  in_S = in_C = 0;
  const auto append = [](SpMat& T, Index& entries, Index row, double v) {
    T.innerIndexPtr()[entries] = static_cast<int>(row);
    T.valuePtr()[entries++] = v;
  };
  for (Index k = 0; k < order; ++k) {
    for_column(basis[at(active_position[at(k)])], [&](Index i, double v) {
      if (const int block_row = block_of_row[at(i)]; block_row == none)
        append(S, in_S, i, v);
      else
        append(C, in_C, block_row, v);
    });
    S.outerIndexPtr()[k + 1] = static_cast<int>(in_S);
    C.outerIndexPtr()[k + 1] = static_cast<int>(in_C);
  }
  has_S_rows = false;
  shared->user = this;
  const LuStatus answer = shared->lu.factor(C);
  solver.reset();
  if (answer != LuStatus::Ok) return status = answer;
  if (order > 0 && shared->lu.gives_factors()) {
    LuFactors factors;
    if (shared->lu.factors(factors)) solver.emplace(std::move(factors));
  }
  factor_entries = solver ? solver->factors().nonzeros() : 4 * C.nonZeros();
  if (block_b.size() != order) {
    block_b = SparseVector(order);
    block_x = SparseVector(order);
  }
  return status = answer;  // at last: there may have been no memory for a copy of the factors
}

/// The columns of the present basis that depend on others, each with a row that none of the others can pivot on. In a
/// small basis they depend on those before them. The last columns are mostly multipliers, and most paths have fewer
/// pivots if these wait rather than variables.
std::vector<BasisFactor::Dependency> BasisFactor::Impl::dependencies(double tol) const {
  if (C.rows() <= few_rows) {
    std::vector<int> order(at(C.cols()));
    std::iota(order.begin(), order.end(), 0);
    const PastZeros factors(C, order, tol);
    const std::vector<int> rows_left = factors.rows_left();
    std::vector<Dependency> found;
    for (std::size_t k = 0; k < rows_left.size(); ++k) {
      const Index p = active_position[at(factors.dependent()[k])];
      found.push_back({.position = p, .column = basis[at(p)], .row = active_row[at(rows_left[k])]});
    }
    return found;
  }
  // The library goes on past zero pivots, and shows its factors. UMFPACK wants no row or column without an entry.
  SpMat zeros(C.rows(), C.cols());
  zeros.setIdentity();
  zeros *= 0;
  SparseLu revealing(LuBackend::General);
  (void)revealing.factor(C + zeros);
  LuFactors f;
  std::vector<Dependency> found;
  if (!revealing.factors(f)) return found;
  for (Index k = 0; k < f.size(); ++k) {
    double largest = 0;
    for (auto e = at(f.U.start[at(k)]); e < at(f.U.start[at(k + 1)]); ++e)
      largest = std::max(largest, std::abs(f.U.value[e]));
    const Index column = f.Q[at(k)];
    for (SpMat::InnerIterator it(C, column); it; ++it)
      largest = std::max(largest, std::abs(it.value() * f.R[it.row()]));
    const double pivot = std::abs(f.diagonal[k]);
    if (pivot > tol * largest && std::isfinite(pivot)) continue;
    const Index p = active_position[at(column)];
    found.push_back({.position = p, .column = basis[at(p)], .row = active_row[at(f.P[at(k)])]});
  }
  return found;
}

/// block_x <- C^-1 block_b, or with C'.
void BasisFactor::Impl::solve_block(bool transposed) const {
  if (block_b.size() == 0) return;
  if (solver) {
    if (transposed)
      solver->solve_transposed(block_b, block_x);
    else
      solver->solve(block_b, block_x);
    return;
  }
  if (std::exchange(shared->user, this) != this) (void)shared->lu.factor(C);
  block_.resize(block_b.size());
  if (transposed)
    shared->lu.solve_transposed(block_b.values(), block_);
  else
    shared->lu.solve(block_b.values(), block_);
  block_x.assign(block_);
}

/// x, of which most is nonzero, from its part in C: the sums of ftran() without lists of places.
void BasisFactor::Impl::fill(const SparseVector& b, const Vec& block, SparseVector& x) const {
  x.clear();
  x.set_full();
  double* to = x.data();
  rows_ = b.values();
  for (Index k = 0; k < block.size(); ++k) {
    const double v = block[k];
    if (v == 0) continue;
    to[active_position[at(k)]] = v;
    for (SpMat::InnerIterator it(S, k); it; ++it) rows_[it.row()] -= it.value() * v;
  }
  for (Index i = 0; i < rows(); ++i)
    if (const int p = slack_of_row[at(i)]; p != none && rows_[i] != 0) to[p] = rows_[i] / slack[i];
}

void BasisFactor::Impl::ftran(const SparseVector& b, SparseVector& x) const {
  block_b.clear();
  rhs.clear();
  b.for_each([&](Index i, double v) {
    if (const int k = block_of_row[at(i)]; k == none)
      rhs.set(i, v);
    else
      block_b.set(k, v);
  });
  solve_block(false);
  if (block_x.full() && 5 * (block_x.values().array() != 0).count() > rows()) {
    fill(b, block_x.values(), x);
  } else {
    x.clear();
    block_x.for_each([&](Index k, double v) {
      x.set(active_position[at(k)], v);
      for (SpMat::InnerIterator it(S, k); it; ++it) rhs.add(it.row(), -it.value() * v);
    });
    rhs.for_each([&](Index i, double v) { x.set(slack_of_row[at(i)], v / slack[i]); });
  }
  eta_work += etas.apply(x);
}

void BasisFactor::Impl::btran(const SparseVector& b, SparseVector& x) const {
  if (!has_S_rows) S_rows = S.transpose();
  has_S_rows = true;
  b_.clear();
  b.for_each([&](Index p, double v) { b_.set(p, v); });
  etas.apply_transposed(b_);
  eta_work += etas.entries();
  block_b.clear();
  x.clear();
  b_.for_each([&](Index p, double v) {
    const int row = row_of_position[at(p)];
    if (row == none) {
      block_b.add(block_of_position[at(p)], v);
      return;
    }
    const double y = v / slack[row];
    x.set(row, y);
    for (SpMat::InnerIterator it(S_rows, row); it; ++it) block_b.add(it.row(), -it.value() * y);
  });
  solve_block(true);
  block_x.for_each([&](Index k, double v) { x.set(active_row[at(k)], v); });
}

/// || a_q - B d ||_inf relative to its terms.
double BasisFactor::Impl::drift_of(Index q, const SparseVector& d) const {
  rhs.clear();
  double size = 0;
  double terms = 0;
  for_column(q, [&](Index i, double v) {
    rhs.add(i, v);
    size = std::max(size, std::abs(v));
  });
  d.for_each([&](Index p, double v) {
    for_column(basis[at(p)], [&](Index i, double a) {
      rhs.add(i, -a * v);
      terms = std::max(terms, std::abs(a * v));
    });
  });
  double worst = 0;
  rhs.for_each([&](Index, double v) { worst = std::max(worst, std::abs(v)); });
  return size + terms > 0 ? worst / (size + terms) : 0;
}

double BasisFactor::Impl::norm1() const {
  double worst = 0;
  for (const Index j : basis) {
    double sum = 0;
    for_column(j, [&](Index, double v) { sum += std::abs(v); });
    worst = std::max(worst, sum);
  }
  return worst;
}

BasisFactor::BasisFactor(const SpMat& A, BasisOptions options) {
  if (A.cols() < A.rows()) throw std::invalid_argument("BasisFactor: fewer columns than rows");
  impl_ = std::make_unique<Impl>(A, options);
}
BasisFactor::~BasisFactor() = default;
BasisFactor::BasisFactor(BasisFactor&&) noexcept = default;
BasisFactor& BasisFactor::operator=(BasisFactor&&) noexcept = default;

LuStatus BasisFactor::factor(std::span<const Index> basis) {
  const Index n = impl_->rows();
  require_size("the basis", static_cast<Index>(basis.size()), n);
  for (const Index j : basis) require_below("column", j, impl_->A->cols() + n);
  return impl_->factor(basis);
}

LuStatus BasisFactor::factor_repaired(std::span<const Index> basis, std::vector<Dependency>& replaced) {
  replaced.clear();
  std::vector<Index> columns(basis.begin(), basis.end());
  LuStatus status = impl_->factored(columns) ? impl_->status : factor(columns);
  double tol = impl_->options.dependent_tol;
  // The pivots need not reveal every dependency at once.
  for (int round = 0; round < 4; ++round, tol *= 100) {
    if (status != LuStatus::Ok && status != LuStatus::Singular) return status;
    const std::vector<Dependency> found = impl_->dependencies(tol);
    if (found.empty() && status == LuStatus::Ok) return status;
    for (const Dependency& d : found) {
      columns[at(d.position)] = impl_->A->cols() + d.row;
      const auto before =
          std::ranges::find_if(replaced, [&d](const Dependency& other) { return other.position == d.position; });
      if (before == replaced.end())
        replaced.push_back(d);
      else
        before->row = d.row;
    }
    status = factor(columns);
    if (status == LuStatus::Ok) return status;
  }
  return status;
}

void BasisFactor::ftran(In b, Out x) const {
  require_size("b", b.size(), impl_->rows());
  require_size("x", x.size(), impl_->rows());
  impl_->given_.assign(b);
  ftran(impl_->given_, impl_->found_);
  x = impl_->found_.values();
}

void BasisFactor::ftran(const SparseVector& b, SparseVector& x) const {
  if (impl_->status != LuStatus::Ok) throw std::logic_error("BasisFactor: solve without a successful factor()");
  require_size("b", b.size(), impl_->rows());
  require_size("x", x.size(), impl_->rows());
  impl_->ftran(b, x);
}

void BasisFactor::ftran_column(Index q, SparseVector& x) const {
  require_below("column", q, impl_->A->cols() + impl_->rows());
  impl_->b_.clear();
  impl_->for_column(q, [&](Index i, double v) { impl_->b_.add(i, v); });
  ftran(impl_->b_, x);
}

void BasisFactor::btran(In b, Out x) const {
  require_size("b", b.size(), impl_->rows());
  require_size("x", x.size(), impl_->rows());
  impl_->given_.assign(b);
  btran(impl_->given_, impl_->found_);
  x = impl_->found_.values();
}

void BasisFactor::btran(const SparseVector& b, SparseVector& x) const {
  if (impl_->status != LuStatus::Ok) throw std::logic_error("BasisFactor: solve without a successful factor()");
  require_size("b", b.size(), impl_->rows());
  require_size("x", x.size(), impl_->rows());
  impl_->btran(b, x);
}

Vec BasisFactor::residual(In b, In x) const {
  Vec r = b;
  for (Index p = 0; p < x.size(); ++p)
    if (x[p] != 0) impl_->for_column(impl_->basis[at(p)], [&](Index i, double v) { r[i] -= v * x[p]; });
  return r;
}

BasisFactor::Update BasisFactor::replace(Index p, Index q, In ftran_of_q) {
  require_size("ftran_of_q", ftran_of_q.size(), impl_->rows());
  SparseVector d(ftran_of_q.size());
  d.assign(ftran_of_q);
  return replace(p, q, d);
}

BasisFactor::Update BasisFactor::replace(Index p, Index q, const SparseVector& d) {
  Impl& s = *impl_;
  require_below("position", p, s.rows());
  require_below("column", q, s.A->cols() + s.rows());
  require_size("ftran_of_q", d.size(), s.rows());
  const double largest = d.largest();
  const double pivot = std::abs(d[p]);
  if (!std::isfinite(largest) || !(pivot > s.options.singular_tol * largest)) return Update::Singular;
  constexpr std::size_t check_every = 8;
  if (s.etas.size() % check_every == check_every - 1) s.drift = std::max(s.drift, s.drift_of(q, d));
  s.growth = std::max(s.growth, largest / pivot);
  s.etas.push(p, d);
  s.basis[at(p)] = q;
  return pivot < s.options.unstable_tol * largest ? Update::Unstable : Update::Ok;
}

double BasisFactor::rcond() const {
  if (impl_->status != LuStatus::Ok) return 0;
  return reciprocal_condition(
      impl_->norm1(), impl_->rows(), [this](In b, Out x) { ftran(b, x); }, [this](In b, Out x) { btran(b, x); });
}

bool BasisFactor::surely_regular() const {
  constexpr double surely = 1e-8;
  const Impl& s = *impl_;
  if (s.status != LuStatus::Ok || s.shared->user != &s) return false;
  double least = infinity;
  for (Index i = 0; i < s.rows(); ++i)
    if (s.slack_of_row[at(i)] != none) least = std::min(least, std::abs(s.slack[i]));
  if (active() > 0) {
    const Eigen::Map<const Vec> entries(s.C.valuePtr(), s.C.nonZeros());
    least = std::min(least, s.shared->lu.pivot_ratio() * entries.lpNorm<::Eigen::Infinity>());
  }
  return least >= surely * s.norm1();
}

int BasisFactor::updates() const { return static_cast<int>(impl_->etas.size()); }
int BasisFactor::factorizations() const { return impl_->factorizations; }
const std::vector<Index>& BasisFactor::basis() const { return impl_->basis; }
Index BasisFactor::active() const { return static_cast<Index>(impl_->active_position.size()); }

bool BasisFactor::stale() const {
  const Impl& s = *impl_;
  const auto allowed = s.options.fill_limit * static_cast<double>(s.B_nonzeros + s.rows());
  const double work = s.options.work_limit * static_cast<double>(s.factor_entries + s.rows());
  return updates() >= s.options.refactor_every || static_cast<double>(s.eta_work) > work ||
         static_cast<double>(s.etas.entries()) > allowed || s.growth > s.options.growth_limit ||
         s.drift > s.options.drift_limit;
}

}  // namespace perp::lcp

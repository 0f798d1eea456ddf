// SPDX-License-Identifier: Apache-2.0
#include "lcp/vi/face_pivoting.hpp"

#include <cmath>

namespace perp::lcp {
namespace {

/// Violations within this x their terms are rounding.
constexpr double negligible = 1e-13;
/// A normal is a combination of others if what is left of its square is within this x it.
constexpr double dependent = 1e-11;
/// A combination of rows that misses its side by no more than this x its terms contradicts nothing.
constexpr double doubtful = 1e-10;

}  // namespace

FacePivoting::End FacePivoting::run(In q, const Box& rows, const Box& box, Face& face, const Limits& limits) {
  if (!begin(q, rows, box, face)) return End::Stopped;
  bool fresh = true;
  const Index limit = 1000 + 20 * (n_ + m_);
  while (pivots_ < limit && !limits.reached()) {
    const Index r = most_violated();
    if (r < 0 && fresh) {
      write(face);
      return End::Found;
    }
    if (r < 0) {  // y is computed anew from W
      if (!refined() && !rebuild()) return End::Stopped;
    } else if (!enter(r)) {
      return certificate_.size() > 0 ? End::Empty : End::Stopped;
    }
    fresh = r < 0;
  }
  return End::Stopped;
}

void FacePivoting::prepare(const Eigen::MatrixXd* M, const Rows& A) {
  M_ = M;
  A_ = &A;
  n_ = A.cols();
  m_ = A.rows();
  if (M != nullptr) lu_.compute(*M);
  norms_.resize(m_ + n_);
  norms_ << A.rowwise().norm(), Vec::Ones(n_);
  T_.resize(m_ + n_, m_ + n_);
  has_.assign(at(m_ + n_), 0);
}

bool FacePivoting::begin(In q, const Box& rows, const Box& box, const Face& face) {
  const Index all = m_ + n_;
  pivots_ = 0;
  freely_ = 3 * all / 2;
  certificate_.resize(0);
  lower_.resize(all);
  lower_ << rows.lower, box.lower;
  upper_.resize(all);
  upper_ << rows.upper, box.upper;
  y0_.resize(all);
  y0_.tail(n_) = M_ != nullptr ? Vec(-lu_.solve(q)) : Vec(-q);
  y0_.head(m_).noalias() = *A_ * y0_.tail(n_);
  lambda_.resize(n_ + 1);
  columns_.resize(all, n_ + 1);
  inverse_.resize(n_ + 1, n_ + 1);
  active_.clear();
  sign_.clear();
  in_.assign(at(all), 0);
  const auto take = [&](Index r, Cell cell) {
    const auto k = static_cast<Index>(active_.size());
    if (cell == Cell::Inside || k >= n_ || in_[at(r)] != 0) return;
    const int sign = cell == Cell::Above ? -1 : 1;
    if (!std::isfinite(sign > 0 ? lower_[r] : upper_[r])) return;
    columns_.col(k) = Eigen::Map<const Vec>(column_of(r), all);
    active_.push_back(r);
    sign_.push_back(sign);
    in_[at(r)] = 1;
  };
  for (Index r = m_; r < all; ++r)
    if (fixed(r)) take(r, Cell::Fixed);
  const std::size_t held = active_.size();
  for (std::size_t i = 0; i < face.rows.size(); ++i) take(static_cast<Index>(i), face.rows[i]);
  for (std::size_t j = 0; j < face.bounds.size(); ++j) take(m_ + static_cast<Index>(j), face.bounds[j]);
  if (!rebuild()) {  // dependent normals
    for (; active_.size() > held; active_.pop_back()) in_[at(active_.back())] = 0;
    sign_.resize(held);
    return rebuild();
  }
  for (bool gone = true; gone;) {  // multipliers of the wrong sign go, all at once
    gone = false;
    for (auto k = static_cast<Index>(active_.size()); k-- > 0;)
      if (!fixed(active_[at(k)]) && sign_[at(k)] * lambda_[k] < 0) {
        drop(k);
        gone = true;
      }
    if (gone && !rebuild()) return false;
  }
  return true;
}

/// y of W and lambda, and a step of refinement; false if S^-1 has lost too many digits on the way for it.
bool FacePivoting::refined() {
  const auto k = static_cast<Index>(active_.size());
  const auto off = [&] {
    Vec b(k);
    for (Index i = 0; i < k; ++i) b[i] = side(i) - y_[active_[at(i)]];
    return b;
  };
  y_ = y0_;
  y_.noalias() += columns_.leftCols(k) * lambda_.head(k);
  const Vec d = inverse_.topLeftCorner(k, k) * off();
  lambda_.head(k) += d;
  y_.noalias() += columns_.leftCols(k) * d;
  x_ = y_.tail(n_);
  return x_.allFinite() &&
         off().cwiseAbs().sum() <= negligible * (y_.cwiseAbs().maxCoeff() + y0_.cwiseAbs().maxCoeff());
}

/// S^-1, lambda and y of W, with a step of refinement; false if S is singular.
bool FacePivoting::rebuild() {
  const auto k = static_cast<Index>(active_.size());
  y_ = y0_;
  if (k > 0) {
    Eigen::MatrixXd S(k, k);
    Vec b(k);
    for (Index i = 0; i < k; ++i) {
      S.row(i) = columns_.row(active_[at(i)]).head(k);
      b[i] = side(i) - y0_[active_[at(i)]];
    }
    const Eigen::PartialPivLU<Eigen::MatrixXd> lu(S);
    const auto pivots = lu.matrixLU().diagonal().cwiseAbs();
    if (!(pivots.minCoeff() > dependent * pivots.maxCoeff())) return false;
    auto inverse = inverse_.topLeftCorner(k, k);
    inverse = lu.inverse();
    lambda_.head(k).noalias() = inverse * b;
    y_.noalias() += columns_.leftCols(k) * lambda_.head(k);
    for (Index i = 0; i < k; ++i) b[i] = side(i) - y_[active_[at(i)]];
    const Vec d = inverse * b;
    lambda_.head(k) += d;
    y_.noalias() += columns_.leftCols(k) * d;
  }
  x_ = y_.tail(n_);
  return x_.allFinite();
}

/// The row that is violated most beside its length, equations first; -1: none.
Index FacePivoting::most_violated() const {
  Index worst = -1;
  double largest = 0;
  bool equation = false;
  const double size = std::sqrt(static_cast<double>(n_)) * y_.tail(n_).lpNorm<Eigen::Infinity>();
  for (Index r = 0; r < m_ + n_; ++r) {
    const double beyond = std::abs(violation(r));
    if (beyond == 0 || in_[at(r)] != 0) continue;
    if (beyond <= negligible * (std::abs(y_[r]) + norms_[r] * size)) continue;
    const double relative = norms_[r] > 0 ? beyond / norms_[r] : infinity;
    if ((fixed(r) && !equation) || (relative > largest && fixed(r) == equation)) {
      worst = r;
      largest = relative;
      equation = fixed(r);
    }
  }
  return worst;
}

/// Takes row r into W. False if it cannot: with a certificate, because C is empty.
bool FacePivoting::enter(Index r) {
  const int sign = violation(r) < 0 ? 1 : -1;
  const Eigen::Map<const Vec> column(column_of(r), m_ + n_);
  const double square = column[r];
  if (!(square > 0) && norms_[r] > 0) return false;
  double lambda_r = 0;
  for (;;) {
    ++pivots_;
    const auto k = static_cast<Index>(active_.size());
    row_.resize(k);
    for (Index i = 0; i < k; ++i) row_[i] = -sign * column[active_[at(i)]];
    direction_.noalias() = inverse_.topLeftCorner(k, k) * row_;
    rates_ = sign * column;
    rates_.noalias() += columns_.leftCols(k) * direction_;
    const double slope = sign * rates_[r];
    const bool moves = slope > dependent * square && k < n_;
    double step = moves ? std::abs(violation(r)) / slope : infinity;
    Index blocking = -1;
    for (Index i = 0; i < k; ++i) {
      const double rate = sign_[at(i)] * direction_[i];
      if (!(rate < 0) || fixed(active_[at(i)])) continue;
      const double length = std::max(0.0, -sign_[at(i)] * lambda_[i] / rate);
      if (length < step) {
        step = length;
        blocking = i;
      }
    }
    if (step == infinity) {  // sign a_r = -A_W'direction
      const double terms = std::abs(y_[r]) + norms_[r] * y_.tail(n_).norm();
      if (std::abs(violation(r)) <= doubtful * terms) {
        in_[at(r)] = 1;  // it holds, as well as doubles tell, wherever W does
        return true;
      }
      certificate_ = Vec::Zero(m_);
      if (r < m_) certificate_[r] = sign;
      for (Index i = 0; i < k; ++i)
        if (active_[at(i)] < m_) certificate_[active_[at(i)]] = direction_[i];
      return false;
    }
    const Index meets = moves && pivots_ > freely_ ? met(r, step) : -1;
    lambda_.head(k) += step * direction_;
    lambda_r += step;
    if (moves) y_ += step * rates_;
    if (meets >= 0) {
      add(meets, rates_[meets] < 0 ? 1 : -1, 0);
    } else if (blocking >= 0) {
      drop(blocking);
    } else {
      add(r, sign, sign * lambda_r);
      return true;
    }
  }
}

/// The row that holds and is met before `step`, which becomes shorter; -1: none.
Index FacePivoting::met(Index r, double& step) const {
  Index first = -1;
  const double length = rates_.tail(n_).norm();
  for (Index s = 0; s < m_ + n_; ++s) {
    const double rate = rates_[s];
    if (in_[at(s)] != 0 || s == r || std::abs(rate) <= negligible * norms_[s] * length) continue;
    const double zero = negligible * (std::abs(y_[s]) + norms_[s]);
    double until = infinity;
    if (rate > 0 && y_[s] <= upper_[s] + zero) until = std::max(0.0, (upper_[s] - y_[s]) / rate);
    if (rate < 0 && y_[s] >= lower_[s] - zero) until = std::max(0.0, (lower_[s] - y_[s]) / rate);
    if (until < step) {
      step = until;
      first = s;
    }
  }
  return first;
}

const double* FacePivoting::column_of(Index r) {
  auto column = T_.col(r);
  if (has_[at(r)] == 0) {
    has_[at(r)] = 1;
    auto x = column.tail(n_);
    if (r < m_)
      x = A_->row(r).transpose();
    else
      x = Vec::Unit(n_, r - m_);
    if (M_ != nullptr) x = lu_.solve(x).eval();
    column.head(m_).noalias() = *A_ * x;
  }
  return column.data();
}

/// W and r: S^-1 by bordering.
void FacePivoting::add(Index r, int sign, double lambda) {
  const auto k = static_cast<Index>(active_.size());
  columns_.col(k) = Eigen::Map<const Vec>(column_of(r), m_ + n_);
  auto inverse = inverse_.topLeftCorner(k, k);
  Vec right(k);
  for (Index i = 0; i < k; ++i) right[i] = columns_(active_[at(i)], k);
  const Vec left = columns_.row(r).head(k).transpose();
  const Vec u = inverse * right;
  const Vec w = inverse.transpose() * left;
  const double pivot = columns_(r, k) - left.dot(u);
  inverse.noalias() += (u / pivot) * w.transpose();
  inverse_.col(k).head(k) = -u / pivot;
  inverse_.row(k).head(k) = -w.transpose() / pivot;
  inverse_(k, k) = 1 / pivot;
  lambda_[k] = lambda;
  active_.push_back(r);
  sign_.push_back(sign);
  in_[at(r)] = 1;
}

/// W without its k-th member: the last one takes its place.
void FacePivoting::drop(Index k) {
  const auto last = static_cast<Index>(active_.size()) - 1;
  in_[at(active_[at(k)])] = 0;
  if (k != last) {
    inverse_.row(k).head(last + 1).swap(inverse_.row(last).head(last + 1));
    inverse_.col(k).head(last + 1).swap(inverse_.col(last).head(last + 1));
    columns_.col(k) = columns_.col(last);
    lambda_[k] = lambda_[last];
    active_[at(k)] = active_[at(last)];
    sign_[at(k)] = sign_[at(last)];
  }
  active_.pop_back();
  sign_.pop_back();
  const Vec column = inverse_.col(last).head(last) / inverse_(last, last);
  inverse_.topLeftCorner(last, last).noalias() -= column * inverse_.row(last).head(last);
}

void FacePivoting::write(Face& face) const {
  face.rows.assign(at(m_), Cell::Inside);
  face.bounds.assign(at(n_), Cell::Inside);
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const Index r = active_[k];
    (r < m_ ? face.rows[at(r)] : face.bounds[at(r - m_)]) = fixed(r)       ? Cell::Fixed
                                                            : sign_[k] > 0 ? Cell::Below
                                                                           : Cell::Above;
  }
}

}  // namespace perp::lcp

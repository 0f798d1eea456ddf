// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The Delassus operator W of a contact problem, d n x d n [1/kg]: given by its entries, or by the parts of
///     W = H' M^-1 H,
/// where it is a product with vectors. Its entries are then formed where somebody asks for them, once: with many
/// contacts on a body, or bodies that are no rigid ones, they are the largest thing of all. Copies share them.
/// Bilateral constraints G' v + b = 0 are among the parts: with K = [M G; G' 0] for M and [H; 0] for H, W is of the
/// same form. Entries that were condensed come with what they were condensed from, for whom they are not exact enough.
#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "lcp/cholesky/cholesky.hpp"
#include "lcp/solve/schur.hpp"
#include "lcp/types.hpp"

namespace perp::contact {

using lcp::at;
using lcp::In;
using lcp::Index;
using lcp::SpMat;
using lcp::Vec;

/// Relative asymmetry of M or W that is allowed: the rounding of whoever assembled it.
inline constexpr double rounding_of_input = 1e-11;

/// Entries below this part of sqrt(W_ii W_jj) are zero by structure.
inline constexpr double rounding_of_zero = 1e-15;

/// These columns of A, each times its weight.
SpMat columns_of(const SpMat& A, const std::vector<Index>& columns, In weights);
/// Columns 0, d, 2 d, .. of A, those of the contacts' normals.
SpMat normal_columns(const SpMat& A, int d);

/// Factors of an inertia M, symmetric bit by bit and positive definite: body by body where M has small blocks, else
/// Cholesky's of all. Or LU's of an inertia that is symmetric to rounding, with bilateral constraints: M stands for
/// K = [M G; G' 0] everywhere then, and multipliers for velocities, too.
class Inertia {
 public:
  /// Nothing: M is not symmetric, not positive definite, or the factors do not fit.
  static std::shared_ptr<const Inertia> of(SpMat M);
  /// By the factors of a regular K. Entries between bodies are dropped: zeros that are stored, or vanish where rows
  /// have their units. Nothing: M is not symmetric to 1e-11, or not positive definite.
  static std::shared_ptr<const Inertia> of(const SpMat& M, SpMat K, std::shared_ptr<const lcp::RefinedLu> factors);

  const SpMat& M() const { return M_; }
  bool by_lu() const { return lu_ != nullptr; }
  bool symmetric() const { return symmetric_; }      ///< bit by bit
  Index velocities() const { return velocities_; }   ///< rows of M; those of multipliers follow
  const lcp::RefinedLu& lu() const { return *lu_; }  ///< pre: by_lu()
  Vec inverse(In p) const;                           ///< M^-1 p
  /// Velocities that M couples, however indirectly, have the same number, from 0.
  const std::vector<int>& body_of() const { return body_of_; }
  int bodies() const { return static_cast<int>(rows_.size()); }
  /// L^-1 H, M = L L', which has the entries of H and those of their bodies; nothing where M is factored as a whole.
  std::unique_ptr<const SpMat> root(const SpMat& H) const;
  /// Reciprocal condition number, of D M D with unit diagonal: the least of the bodies'. Estimated in the 1-norm,
  /// rarely three times too large.
  double rcond() const { return rcond_; }
  /// Of the triangle that inverse() solves with, twice: of LU's factors half of all.
  double entries_of_factor() const;

 private:
  Inertia() = default;
  void find_bodies();
  bool factor();
  double whole_rcond() const;

  SpMat M_;
  std::vector<int> body_of_;
  std::vector<std::vector<int>> rows_;  // of each body
  std::vector<int> place_;              // of a velocity among those of its body
  std::vector<Eigen::MatrixXd> L_;      // of each body; none: by cholesky_
  std::unique_ptr<lcp::Cholesky> cholesky_;
  std::shared_ptr<const lcp::RefinedLu> lu_;
  double entries_of_lu_ = 0;
  Index velocities_ = 0;
  bool symmetric_ = true;
  double rcond_ = 1;
};

/// Places of the velocities among those of the bodies that H has entries of, or -1.
std::vector<int> touched_velocities(const Inertia& inertia, const SpMat& H);

/// What contact velocities would be of, without constraints and couplings, as squares of N: sum_i H_ij^2 / M_ii.
Vec free_squares(const Inertia& inertia, const SpMat& H);

/// W = H' (s M)^-1 H.
class DelassusParts {
 public:
  /// H has a row for each of the inertia's.
  DelassusParts(std::shared_ptr<const Inertia> inertia, SpMat H);
  /// diag(weights) W diag(weights) / s in these of its rows and columns.
  DelassusParts(const DelassusParts& of, double s, const std::vector<Index>& rows, const std::vector<double>& weights);

  const Inertia& inertia() const { return *inertia_; }
  const SpMat& M() const { return M_; }  ///< s M
  const SpMat& H() const { return H_; }
  /// Z with W = Z'Z, as sparse as H; null where M has no small blocks.
  const SpMat* root() const { return root_.get(); }
  Vec inverse(In p) const { return inertia_->inverse(p) / s_; }  ///< (s M)^-1 p
  Vec product(In r) const;                                       ///< W r
  /// W r + shift r + w, K^-1 H r refined to twice the precision; pre: inertia().by_lu(), s = 1.
  lcp::SchurImage refined_product(In r, double shift, In w) const;
  /// W_ij of one contact, |i - j| <= 2: what it does to itself.
  double near(Index i, Index j) const { return near_[at(std::min(i, j))][at(std::abs(i - j))]; }
  /// N, bodies x d n: N_bi = |H_i|_b in the norm of body b's M^-1, the size of the velocity that contact velocity i
  /// gets through b, a body being all that constraints hold together. |W_ij| <= (N'N)_ij, but for rounding.
  const SpMat& shares() const { return shares_; }
  /// H' (s M)^-1 H by its entries, all of them.
  SpMat form() const;

 private:
  void find_near_and_shares();
  void take_near_and_shares(Index j, In v);
  void find_constrained();
  SpMat form_by_columns() const;

  std::shared_ptr<const Inertia> inertia_;
  double s_ = 1;
  SpMat M_;
  SpMat H_;
  std::unique_ptr<const SpMat> root_;
  std::vector<std::array<double, 3>> near_;  // W(i, i), W(i, i + 1), W(i, i + 2)
  SpMat shares_;
};

class Delassus {
 public:
  Delassus() : Delassus(SpMat()) {}
  Delassus(SpMat W);  // NOLINT(google-explicit-constructor)
  /// `exact` has the same product to more digits.
  Delassus(SpMat W, std::shared_ptr<const lcp::SchurProduct> exact);
  template <class Derived>
  Delassus(const Eigen::SparseMatrixBase<Derived>& W) : Delassus(SpMat(W)) {}  // NOLINT(google-explicit-constructor)
  /// By its parts; `form` makes the entries, parts->form() if nothing else does.
  explicit Delassus(std::shared_ptr<const DelassusParts> parts, std::function<SpMat()> form = {});

  Index rows() const;
  Index cols() const;
  /// The parts; null where W is given by its entries.
  const DelassusParts* parts() const { return parts_.get(); }
  /// The parts where they are all of W; null where it has a shift().
  const DelassusParts* whole_parts() const { return shift_ == 0 ? parts_.get() : nullptr; }
  /// What the entries were condensed from; null where they are given.
  const lcp::SchurProduct* condensed() const { return condensed_.get(); }
  /// Whether the entries are there.
  bool formed() const;
  /// Whether both have the same entries, or the same M and H, bit by bit.
  bool same_as(const Delassus& other) const;
  /// The entries, which are formed if they are not there.
  const SpMat& matrix() const;
  /// The entries, to be changed. W is given by them from now on.
  SpMat& given();

  Vec diagonal() const;
  /// W_ij of one contact, |i - j| <= 2, without forming anything.
  double near(Index i, Index j) const;
  /// W + alpha I. Of parts the diagonal is kept apart, as shift().
  Delassus plus(double alpha) const;
  double shift() const { return shift_; }
  friend Vec operator*(const Delassus& W, In r) { return W.product(r); }
  /// The contacts, of d rows each, in groups that do not act on each other, however indirectly: coupled by an entry
  /// that is not 0; of parts, by a body. By their first contacts, which ascend in each.
  std::vector<std::vector<Index>> groups(int d) const;
  /// Gives these rows and columns, by its parts with the inertia of all bodies, factored once.
  Delassus part(const std::vector<Index>& rows) const;
  /// W R, column by column.
  Eigen::MatrixXd columns(const Eigen::MatrixXd& R) const;

 private:
  Vec product(In r) const;
  struct Entries;
  std::shared_ptr<Entries> entries_;
  std::shared_ptr<const DelassusParts> parts_;
  std::shared_ptr<const lcp::SchurProduct> condensed_;
  double shift_ = 0;
};

}  // namespace perp::contact

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The systems that Newton steps of contact problems come to,
///     (A + B W) x = c,   A = diag(A_a), B = diag(B_a): two blocks a contact, of its size,
/// in the coordinates of contact/model/scaling.hpp; B = 1 where a homotopy has eliminated its multipliers. They are
/// solved in one of two forms.
///  * *Contacts*: the matrix as it stands, on the pattern of W.
///  * *Bodies*, where W = H' M^-1 H is known by its parts (delassus.hpp): x = A^-1 (c - B H' v), with
///        (M + H E H') v = H A^-1 c,   E = A^-1 B,
///    of the size of M, where bodies that touch are neighbours. A wall has 10 contacts a brick, a pile 3 a sphere.
///    Its entries are not formed.
/// Where B = 1 and A is symmetric and positive definite, and with bodies wherever E is symmetric, the factor is
/// Cholesky's, which takes half of what LU does; LU otherwise, where Cholesky's fails, and with bilateral constraints.
///
/// Coulomb's law is unsymmetric only where contacts slip, by one product p q' each: its friction follows its normal
/// impulse, or its opening its slip. These are kept apart from A. With K = A + B W, P = diag(p_a) and Q = diag(q_a),
///     (K + P Q') x = c:   x = K^-1 (c - P z),   (1 + Q' K^-1 P) z = Q' K^-1 c,
/// one number z_a = q_a.x_a for each of them: by LU where they are few, by GMRES beyond; each of its products is a
/// solve with Cholesky's factor.
///
/// Solutions by bodies are refined with residuals of the system itself: E is as large as 1e10 where contacts stick.
/// Private to contact/.
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "contact/model/bodies_matrix.hpp"
#include "contact/model/scaling.hpp"
#include "lcp/cholesky/cholesky.hpp"
#include "lcp/dense_factors.hpp"
#include "lcp/lu/sparse_lu.hpp"

namespace perp::contact {

/// Of one contact: rows A dr + B du, of which its size counts.
template <int Size>
struct RowsOfSize {
  ContactMatrix<Size> A = ContactMatrix<Size>::Zero();
  ContactMatrix<Size> B = ContactMatrix<Size>::Zero();
};
using ContactRows = RowsOfSize<3>;

/// Rows p (q.dr) of one contact besides.
template <int Size>
struct CouplingOfSize {
  std::size_t contact = 0;
  ContactVector<Size> p = ContactVector<Size>::Zero();
  ContactVector<Size> q = ContactVector<Size>::Zero();
};
using ContactCoupling = CouplingOfSize<3>;

/// (A + B W) x.
template <int Size>
Vec product(const Scaled& problem, const std::vector<RowsOfSize<Size>>& rows, In x);
/// K = A + B (W + alpha I), whose pattern is that of W.
template <int Size>
void contact_matrix(const Scaled& problem, const std::vector<RowsOfSize<Size>>& rows, double alpha, SpMat& K);

/// x += solve(c - product(x)), at most four times, while the largest entry of the residual is above `target` and falls
/// to a quarter. Returns that entry.
template <class Product, class Solve>
double refine(const Vec& c, double target, const Product& product, const Solve& solve, Vec& x) {
  Vec rest = c - product(x);
  double size = rest.lpNorm<Eigen::Infinity>();
  double before = lcp::infinity;
  Vec dx;
  for (int k = 0; k < 4 && size > target && size <= 0.25 * before; ++k) {
    solve(rest, dx);
    const Vec better = x + dx;
    rest = c - product(better);
    const double now = rest.lpNorm<Eigen::Infinity>();
    if (!(now < size)) break;
    x = better;
    before = std::exchange(size, now);
  }
  return size;
}

/// Contacts with one disk have Size = 3, with two Size = 5; those have no form by bodies (scaling.hpp).
template <int Size>
class ContactSystemOf {
 public:
  using Rows = RowsOfSize<Size>;
  using Coupling = CouplingOfSize<Size>;
  using Block = ContactMatrix<Size>;
  enum class Form { Contacts, Bodies };

  /// `problem` outlives *this.
  explicit ContactSystemOf(const Scaled& problem, lcp::LuBackend lu = lcp::LuBackend::Auto);
  /// For another W of the same pattern, or the same parts with a shift(), with the analysis and memory of `shared`.
  ContactSystemOf(const Scaled& problem, const ContactSystemOf& shared);
  ~ContactSystemOf();
  ContactSystemOf(const ContactSystemOf&) = delete;
  ContactSystemOf& operator=(const ContactSystemOf&) = delete;

  // One block or pair of them a contact. False: there are no factors, the matrix is singular or not finite.
  bool factor(const std::vector<Rows>& rows);
  /// A + W with A symmetric positive definite, and these couplings; A's inverse is needed to more digits than A has.
  /// Pre: W has no shift().
  bool factor(const std::vector<Block>& A, const std::vector<Block>& inverse, std::vector<Coupling> couplings = {});
  /// With the last factors; where the reduced system is not solved with those, with factors of the whole matrix, and x
  /// is NaN where that is singular. Pre: there are factors.
  void solve(In c, Vec& x);
  /// The same without refinement, for those who refine with a residual of their own. Pre: there are factors.
  void solve_once(In c, Vec& x);

  Form form();                                            ///< chosen when it is first needed
  bool by_cholesky() const { return by_cholesky_; }       ///< are the last factors Cholesky's?
  int factorizations() const { return factorizations_; }  ///< since it was made

 private:
  void choose();
  void make_lu();
  bool take_contacts(bool definite);
  bool take_bodies(bool definite);
  bool factor_whole();
  bool part_by_bodies();
  bool invert(std::size_t a);
  void couple_inverses();
  void solve_definite(In c, Vec& x) const;
  template <class X>
  void solve_definite_once(const X& c, X& x) const;
  bool solve_coupled(In c, Vec& x);
  std::optional<Vec> solve_reduced(const Vec& right);
  void reduce();
  template <class X>
  X product(const X& x) const;
  Vec couple(const Vec& x) const;
  Vec spread(const Vec& z) const;
  void back_solve(const Vec& b, Vec& x) const;
  void back_solve(const Eigen::MatrixXd& B, Eigen::MatrixXd& X) const;
  template <class X>
  void solve_by_bodies(const X& c, X& x) const;
  template <class Blocks, class X>
  void add_product(const Blocks& block, const X& in, X& out) const;

  const Scaled& problem_;
  std::shared_ptr<lcp::SparseLu> lu_;
  std::shared_ptr<lcp::Cholesky> cholesky_;
  lcp::LuBackend backend_;
  bool exactly_symmetric_W_ = false;
  bool symmetric_W_ = false;  // to rounding at least
  bool chosen_ = false;
  bool by_cholesky_ = false;
  SpMat K_;                                       // by contacts
  std::shared_ptr<BodiesMatrixOf<Size>> bodies_;  // none: by contacts
  Vec scale_;                                     // of the rows and columns of LU's factors by bodies
  Delassus W_;                                    // without its shift, which is in rows_
  // Of the last factors.
  std::vector<Rows> rows_;
  std::vector<Coupling> couplings_;                              // none in a matrix factored whole
  std::optional<Eigen::PartialPivLU<Eigen::MatrixXd>> reduced_;  // 1 + Q' K^-1 P, once it is needed
  std::vector<Block> A_inverse_;
  std::vector<Block> E_;
  int factorizations_ = 0;
};
using ContactSystem = ContactSystemOf<3>;

}  // namespace perp::contact

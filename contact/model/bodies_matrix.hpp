// SPDX-License-Identifier: Apache-2.0
#pragma once
/// M + H E H' of contact systems that are solved by bodies (contact/model/contact_system.hpp), E one block a contact,
/// of Size rows at most, on a pattern that is made once. With bilateral constraints M is [M G; G' 0], and the matrix is
/// indefinite. Private to contact/.
#include <vector>

#include "contact/model/scaling.hpp"
#include "lcp/dense_factors.hpp"

namespace perp::contact {

template <int Size>
class BodiesMatrixOf {
 public:
  /// Of a W by its parts, which outlive *this.
  explicit BodiesMatrixOf(const Scaled& problem);

  bool by_lu() const { return by_lu_; }  ///< Inertia::by_lu(): no Cholesky of this either
  /// Of symmetric E: on and below the diagonal alone, what Cholesky reads.
  void assemble_lower(const std::vector<ContactMatrix<Size>>& E) { assemble(E, true); }
  void assemble(const std::vector<ContactMatrix<Size>>& E) { assemble(E, false); }
  const SpMat& matrix() const { return K_; }
  /// diag(scale) K diag(scale), and scale, in the units of K's diagonal, which may have E's 1e10 beside M's 1: LU looks
  /// for fewer pivots elsewhere, and fills up less. A diagonal far below its column may be rounding alone. Columns of
  /// multipliers have none: their largest entry becomes one.
  SpMat with_unit_diagonal(Vec& scale) const;

 private:
  using Row = Eigen::Matrix<double, 1, Size>;
  using Rows = std::vector<Row>;
  /// The rows of H that a contact has entries in, and their k x k entries among K's values: column by column those on
  /// and below the diagonal, and those above it.
  struct Part {
    Rows H;  // zero beyond the contact's columns
    std::vector<Index> lower;
    std::vector<Index> upper;
  };
  void assemble(const std::vector<ContactMatrix<Size>>& E, bool lower_alone);

  Index velocities_;  // rows of M that are none of multipliers
  bool by_lu_;
  std::vector<Part> parts_;
  SpMat K_;
  std::vector<double> inertia_;  // M on the pattern of K
};

}  // namespace perp::contact

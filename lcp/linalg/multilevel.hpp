// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Algebraic multigrid for symmetric positive definite matrices with mostly negative entries off the diagonal, and its
/// V-cycle on a face: on the unknowns that an active set leaves free. Private to lcp/.
///
/// The unknowns of a level are split into C and F by the strength of their connections (j is strong for i if -a_ij >=
/// theta max_k -a_ik); an F unknown is interpolated from its strong C neighbours,
///     e_i = sum_j w_ij e_j,   w_ij = -alpha_i a_ij / a_ii,   alpha_i = sum_k a_ik / sum_{j in C_i} a_ij   (negative
///     a),
/// with positive a_ik added to a_ii (direct interpolation: Stueben 2001, section A.7.2.1; the split is the first pass
/// of Ruge & Stueben 1987). Coarse matrices are A_c = P'A P, so that coarse unknowns are fine ones and inherit their
/// bounds.
///
/// On a face the rows of P of unknowns that are not free are zero and coarse unknowns that are not free are dropped
/// (truncation: Kornhuber, Numer. Math. 69 (1994) 167; Graeser & Kornhuber, J. Comput. Math. 27 (2009) 1).
/// References: Ruge & Stueben in McCormick (ed.), Multigrid Methods, SIAM 1987; Stueben in Trottenberg, Oosterlee &
/// Schueller, Multigrid, 2001, appendix A.
#include <vector>

#include "lcp/cholesky/cholesky.hpp"
#include "lcp/linalg/face_preconditioner.hpp"

namespace perp::lcp {

struct Grid {
  SparseRows A;               ///< symmetric, columns ascending
  Vec diagonal;               ///< of A
  SparseRows P;               ///< interpolation from the next grid; no rows on the coarsest
  SparseRows R;               ///< P'
  std::vector<int> c_points;  ///< the unknowns that are the next grid's
};

struct Hierarchy {
  std::vector<Grid> grids;  ///< from the finest
  /// Coarsens while a grid has more than `coarsest` unknowns and the next is smaller by a tenth at least.
  Hierarchy(SparseRows A, double theta, int coarsest);
};

/// One V-cycle with one forward Gauss-Seidel sweep before and one backward sweep after the coarse correction, over C
/// and then F unknowns (of whom few are neighbours, so that a row need not wait for the one before): a
/// symmetric positive definite approximation of the inverse of A's free block, whatever the interpolation.
class VCycle final : public FacePreconditioner {
 public:
  /// Starts at grids[finest]; the hierarchy must live as long. Coarsest grid: Cholesky up to `direct` unknowns.
  VCycle(const Hierarchy& hierarchy, std::size_t finest, int direct);
  FaceStatus set_free(const Mask& free) override;
  void apply(const Vec& r, Vec& x) override;

 private:
  struct Level {
    const SparseRows* A = nullptr;  ///< the grid's, on the finest level, else truncated
    SparseRows truncated;
    std::vector<int> order;     ///< of the forward sweep: the next grid's unknowns first
    std::vector<int> position;  ///< in that order
    SparseRows lower;           ///< of A in that order, strictly: all that the sweeps read
    Mask free;
    Vec inverse;  ///< of the diagonal; zero where not free
    Vec b;
    Vec x;
    Vec behind;  ///< -sum_{j > i} a_ij x_j
  };
  void all_free();
  void restrict_to(std::size_t k, const Mask& changed, Mask& changed_coarse);
  void cycle(std::size_t depth, const Vec& b, Vec& x);
  void factor_coarsest();

  const Hierarchy& hierarchy_;
  std::size_t finest_;
  int direct_;
  std::vector<Level> levels_;
  Cholesky coarsest_;
  bool factored_ = false;
};

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Symmetric matrices by rows, and what conjugate gradients on a face of the box are preconditioned with. Private to
/// lcp/.
#include <vector>

#include "lcp/cholesky/cholesky.hpp"
#include "lcp/types.hpp"

namespace perp::lcp {

/// A sparse matrix by rows.
struct SparseRows {
  std::vector<int> start{0};
  std::vector<int> column;
  std::vector<double> value;

  int rows() const { return static_cast<int>(start.size()) - 1; }
  void push(int j, double a) {
    column.push_back(j);
    value.push_back(a);
  }
  void end_row() { start.push_back(static_cast<int>(column.size())); }
  SparseRows transposed(int columns) const;
  void multiply(const Vec& x, Vec& y) const;  ///< y = A x
};

/// The rows of a symmetric matrix.
SparseRows rows_of(const SpMat& M);

using Mask = std::vector<char>;

enum class FaceStatus { Ok, NegativeCurvature, OutOfMemory };

/// B: approximates the inverse of A's block of free unknowns, symmetric and positive definite.
class FacePreconditioner {
 public:
  FacePreconditioner() = default;
  virtual ~FacePreconditioner() = default;
  FacePreconditioner(const FacePreconditioner&) = delete;
  FacePreconditioner& operator=(const FacePreconditioner&) = delete;
  virtual FaceStatus set_free(const Mask& free) = 0;
  virtual void apply(const Vec& r, Vec& x) = 0;  ///< x = B r; zero where not free
  int factorizations = 0;
  Vec direction;  ///< after NegativeCurvature: d'A d < 0
};

/// d'A d, and the same of absolute values, in extended precision.
struct Curvature {
  double value = 0;
  double size = 0;
  bool negative() const { return value < -1e-13 * size; }  ///< beyond the rounding of d and A
};
Curvature curvature(const SparseRows& A, const Vec& d);

/// B = (A_FF + sigma D_FF)^-1 by Cholesky, D the diagonal of A, with sigma = 0 or, where that block is singular up to
/// rounding, the smallest of 1e-12, 1e-10, 1e-8, 1e-6 that makes it positive definite.
class CholeskyFace final : public FacePreconditioner {
 public:
  /// A must live as long. A factor with more than `entries` entries is OutOfMemory.
  CholeskyFace(const SparseRows& A, double entries) : A_(A), entries_(entries) {}
  FaceStatus set_free(const Mask& free) override;
  void apply(const Vec& r, Vec& x) override;

 private:
  const SparseRows& A_;
  double entries_;
  Cholesky block_;
  std::vector<int> unknowns_;  ///< those free
  Vec right_;
  Vec solution_;
};

}  // namespace perp::lcp

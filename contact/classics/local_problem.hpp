// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The problem of one contact in the coordinates of contact/model/scaling.hpp (mu = 1), W = W_aa of 1 to 3 rows, or
/// to 5 where there are two disks:
///     u = W r + b,   K* > u + |u_T| e_N  _|_  r in K
/// and three ways to solve it (lecture, after (71); Siconos' one-contact solvers).
#include "contact/model/scaling.hpp"

namespace perp::contact {

enum class LocalSolver {
  Newton,      ///< open and sticking by cases, else Newton's method on Alart & Curnier's equation; Cases where it fails
  Projection,  ///< some of De Saxce & Feng's steps r = P_K(r - rho (u + |u_T| e_N)), rho = 1 / |W|
  Cases        ///< open, sticking, sliding; sliding is the root of one scalar equation
};

template <int Size>
class LocalProblem {
 public:
  using Vector = ContactVector<Size>;
  using Matrix = ContactMatrix<Size>;

  /// `W` in the first block.size rows and columns, zero elsewhere.
  LocalProblem(const Scaled::Block& block, const Matrix& W);
  const Matrix& W() const { return W_; }
  /// The impulse; `from` where W_NN is not positive, or the projections' start.
  Vector solve(LocalSolver solver, const Vector& b, const Vector& from) const;

 private:
  bool sticks(const Vector& r) const;
  bool newton(const Vector& b, Vector& r) const;
  Vector project(const Vector& b, Vector r) const;
  Vector sliding(const Vector& b, const Vector& from) const;
  Vector in_disks(double normal, const Vector& b, Vector r) const;  // of two

  int size_;
  int width_;
  Matrix W_;
  Matrix inverse_ = Matrix::Zero();  // of singular W: none
  double norm_ = 0;
};

}  // namespace perp::contact

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The problem of one contact in the coordinates of contact/model/scaling.hpp (mu = 1), W = W_aa of 1 to 3 rows:
///     u = W r + b,   K* > u + |u_T| e_N  _|_  r in K
/// and three ways to solve it (lecture, after (71); Siconos' one-contact solvers).
#include <Eigen/Core>

namespace perp::contact {

enum class LocalSolver {
  Newton,      ///< open and sticking by cases, else Newton's method on Alart & Curnier's equation; Cases where it fails
  Projection,  ///< some of De Saxce & Feng's steps r = P_K(r - rho (u + |u_T| e_N)), rho = 1 / |W|
  Cases        ///< open, sticking, sliding; sliding is the root of one scalar equation
};

class LocalProblem {
 public:
  /// `W` in the first `size` rows and columns, zero elsewhere.
  LocalProblem(int size, const Eigen::Matrix3d& W);
  int size() const { return size_; }
  const Eigen::Matrix3d& W() const { return W_; }
  /// The impulse; `from` where W_NN is not positive, or the projections' start.
  Eigen::Vector3d solve(LocalSolver solver, const Eigen::Vector3d& b, const Eigen::Vector3d& from) const;

 private:
  bool newton(const Eigen::Vector3d& b, Eigen::Vector3d& r) const;
  Eigen::Vector3d project(const Eigen::Vector3d& b, Eigen::Vector3d r) const;
  Eigen::Vector3d sliding(const Eigen::Vector3d& b, const Eigen::Vector3d& from) const;

  int size_;
  Eigen::Matrix3d W_;
  Eigen::Matrix3d inverse_ = Eigen::Matrix3d::Zero();  // of singular W: none
  double norm_ = 0;
};

}  // namespace perp::contact

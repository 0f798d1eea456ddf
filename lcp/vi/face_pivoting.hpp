// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A dense active-set method for affine variational inequalities over polyhedra (polyhedron.hpp) with positive definite
/// M, symmetric or not. With W the active rows and bounds, A_W their normals and b_W their sides,
///     x = M^-1 (A_W'lambda - q),   S lambda = b_W + A_W M^-1 q,   S = A_W M^-1 A_W',
/// the method begins with the fixed variables in W, keeps the signs of lambda right, and takes in violated rows one at
/// a time. For row r the multiplier lambda_r grows from 0, and x and lambda_W move such that A_W x = b_W,
///     dlambda = -S^-1 A_W M^-1 a_r,   dx = M^-1 (a_r + A_W'dlambda),   a_r'dx = dx'M dx >= 0,
/// until the row holds, and enters W, or the sign of a lambda_s would turn, and s leaves W. A row with dx = 0 that no
/// lambda_s stops is a combination of rows that contradicts them: C is empty (Farkas). Only one column of M^-1 A' is
/// computed a step. For M symmetric this is the dual method of Goldfarb and Idnani, Math. Programming 27 (1983) 1;
/// for others it may cycle, because rows that hold may become violated again. After 3/2 (m + n) pivots such rows
/// therefore enter W when they are met, so that ever fewer are violated: the principal pivoting method of Cottle and
/// Dantzig on the LCP of A M^-1 A', which is finite but takes more pivots (Cottle, Pang & Stone, The Linear
/// Complementarity Problem, 1992, section 4.2).
#include <algorithm>
#include <vector>

#include "lcp/dense_factors.hpp"
#include "lcp/judge/result.hpp"
#include "lcp/vi/polyhedron.hpp"

namespace perp::lcp {

class FacePivoting {
 public:
  enum class End { Found, Empty, Stopped };

  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// Factors M, nullptr the identity, for runs with rows A; both outlive them. What runs compute of M and A is kept.
  void prepare(const Eigen::MatrixXd* M, const Rows& A);
  /// From the face given, as far as its normals are independent and its signs right, to the solution's, on which all
  /// fixed variables are Fixed.
  End run(In q, const Box& rows, const Box& box, Face& face, const Limits& limits = {});

  const Vec& x() const { return x_; }
  /// End::Empty: y with y'A = 0 but for bounds, of the rows; its entries have the signs of multipliers.
  const Vec& certificate() const { return certificate_; }
  int pivots() const { return pivots_; }

 private:
  bool begin(In q, const Box& rows, const Box& box, const Face& face);
  bool rebuild();
  bool refined();
  Index most_violated() const;
  bool enter(Index r);
  Index met(Index r, double& step) const;
  const double* column_of(Index r);
  void add(Index r, int sign, double lambda);
  void drop(Index k);
  void write(Face& face) const;
  bool fixed(Index r) const { return lower_[r] == upper_[r]; }
  double side(Index k) const { return sign_[at(k)] > 0 ? lower_[active_[at(k)]] : upper_[active_[at(k)]]; }
  /// Negative below the lower side, positive above the upper one, else 0.
  double violation(Index r) const { return std::min(y_[r] - lower_[r], 0.0) + std::max(y_[r] - upper_[r], 0.0); }

  // Rows have the numbers 0 to m - 1, bounds m + j. With B = (A; I): y = B x, and T = B M^-1 B' by columns.
  const Eigen::MatrixXd* M_ = nullptr;
  const Rows* A_ = nullptr;
  Index n_ = 0, m_ = 0;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
  Vec lower_, upper_, norms_;
  Vec x_, y_, y0_;  ///< y0 = -B M^-1 q
  Vec direction_, rates_, row_;
  std::vector<Index> active_;  ///< W
  std::vector<int> sign_;      ///< 1: in W at the lower side, -1: at the upper one
  std::vector<char> in_;       ///< 1: the row or bound is in W
  Vec lambda_;                 ///< its first |W| entries
  Eigen::MatrixXd T_;          ///< the columns computed so far
  std::vector<char> has_;      ///< which those are
  Eigen::MatrixXd columns_;    ///< those of W
  Eigen::MatrixXd inverse_;    ///< S^-1
  Vec certificate_;
  int pivots_ = 0;
  Index freely_ = 0;  ///< pivots until rows that hold are kept
};

}  // namespace perp::lcp

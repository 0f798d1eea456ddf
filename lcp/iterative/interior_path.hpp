// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The skeleton of the primal-dual interior points of lcp and ncp. Each finite bound b of a variable z_i that is not
/// fixed has a slack s = sign (z_i - b) > 0, sign = 1 at lower and -1 at upper bounds, and a multiplier w > 0:
///     r = F(z)_i - sum of sign w = 0,   rho = sign (z_i - b) - s = 0,   s w = mu,   mu -> 0.
/// Newton's direction that changes the products s w by c is, with J = F'(z),
///     (J + diag(w / s) + delta I) dz = -r + sign (c - w rho) / s,   ds = sign dz + rho,   dw = (c - w ds) / s:
/// one factorization of one pattern an iteration (lcp/iterative/shifted_system.hpp), and some solves. The predictor has
/// c = -s w; sigma = (mu_aff / mu)^3; the corrector c = sigma mu - s w - ds_aff dw_aff (Mehrotra 1992); then Gondzio's
/// multiple correctors, while they lengthen the step. The delta term is proximal, towards the last iterate. Private to
/// lcp/iterative/ and ncp/methods/.
///
/// References: Mehrotra, SIAM J. Optim. 2 (1992) 575. Gondzio, Comput. Optim. Appl. 6 (1996) 137. Wright, Primal-Dual
/// Interior-Point Methods, SIAM 1997.
#include <array>
#include <vector>

#include "lcp/box.hpp"
#include "lcp/iterative/shifted_system.hpp"

namespace perp::lcp {

class InteriorPath {
 public:
  /// A finite bound of variable i: s = sign (z_i - at) with sign 1 at a lower bound, -1 at an upper one.
  struct Bound {
    Index i;
    double sign;
    double at;
  };
  /// z, and the slack s and multiplier w of each bound; or a direction in them.
  struct Iterate {
    Vec z, s, w;
  };
  /// Step lengths of the two groups of variables that programs have; equal for other problems.
  using Lengths = std::array<double, 2>;
  static double least(const Lengths& alpha) { return std::min(alpha[0], alpha[1]); }

  /// J has its diagonal in its pattern, and outlives *this. `affine`: J does not change, and may be a program's.
  InteriorPath(const SpMat& J, const Box& box, bool affine, double to_boundary, double proximal, LuBackend lu);

  /// The least squares solution of the equations that F = F(z) and J at z make, as near to z as they allow.
  Vec nearest(const Vec& z, const Vec& F);
  /// Mehrotra's start (1992, section 7): s and w of F = F(z), moved inside, z as it is: rho is not zero.
  void open(const Vec& z, const Vec& F);
  /// A start with s w = mu where one bound alone is finite, and s - w = t: z strictly inside, rho = 0.
  void open_centrally(const Vec& z, const Vec& t, double mu);
  /// A start with z moved inside by `margin`, or to the middle, rho = 0, and any w.
  void open_inside(const Vec& z, double margin);
  /// The t of F = F(z): what s and w leave of each other, s = max(t, 0) and w = max(-t, 0) at a solution.
  Vec halves(const Vec& z, const Vec& F) const;
  /// Newton's step of the free variables for their equations, the others held. False: there is none.
  bool step_of_free(const Vec& F, Vec& dz);

  /// J + diag(w / s) + delta I, or with a larger delta where that is singular, and the residuals, at x with F = F(z). J
  /// is as it was, or update() was called.
  LuStatus factor(const Vec& F);
  void update() { system_.update(); }
  /// Predictor and correctors, towards products of `least_target` at least, and no more than 10 times what they are.
  Iterate newton(double least_target = 0);
  /// Newton's direction that changes s w by c, to first order.
  Iterate direction(const Vec& c);
  /// The longest steps to the boundary, at most one; and the share of them that is taken.
  Lengths reach(const Iterate& d) const;
  Lengths length(const Iterate& d) const;
  Iterate moved(const Iterate& d, const Lengths& alpha) const;
  /// Makes delta larger after short steps, smaller where it keeps the residual from falling.
  void adapt_proximal(double alpha, double before, double now);

  Index size() const { return J_.rows(); }
  Index pairs() const { return static_cast<Index>(bounds_.size()); }
  const std::vector<Bound>& bounds() const { return bounds_; }
  bool linear() const { return linear_; }
  std::size_t group(Index i) const { return group_[at(i)]; }  ///< 0 but for programs
  /// The mean of s w.
  double gap(const Iterate& of) const { return pairs() > 0 ? of.s.dot(of.w) / static_cast<double>(pairs()) : 0; }
  double gap_after(const Iterate& d, const Lengths& alpha) const;
  Vec residual(const Iterate& of, const Vec& F) const;  ///< r
  /// Returns the bound of each variable that s < w calls active, or -1.
  std::vector<Index> active() const;
  ShiftedSystem& system() { return system_; }
  const ShiftedSystem& system() const { return system_; }

  Iterate x;

 private:
  std::size_t group_of(Index p) const { return group(bounds_[at(p)].i); }
  void find_groups();
  void move_inside(const Bound& b, double least);
  void follow_z();
  template <class F>
  void each_value(F f);
  void correct(Vec& c, Iterate& d, double target);

  const SpMat& J_;
  const Box& box_;
  double to_boundary_, proximal_;
  ShiftedSystem system_;
  double delta_;
  std::vector<Bound> bounds_;
  std::vector<std::size_t> group_;  ///< of each variable
  bool program_ = false, linear_ = false;
  Vec r_, rho_;               ///< at x
  std::vector<Index> stiff_;  ///< of each variable: its bound with the largest w / s, or -1 where that is below one
};

}  // namespace perp::lcp

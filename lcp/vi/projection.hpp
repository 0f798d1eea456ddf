// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The projection on a polyhedron C (polyhedron.hpp), p* = argmin over C of ||y - t||^2 / 2, with a bound on its error:
/// what the natural map x - p*(x - F(x)) of a variational inequality is judged by.
///
/// On a face with active rows W and variables N at their bounds, F the others,
///     p_N = bounds,  p_F = t_F + A_WF'mu,  A_WF A_WF'mu = b_W - A_WN p_N - A_WF t_F,
/// refined to about twice the digits of doubles with exact residuals. Whichever method named the face, p is judged by
/// itself: let signs of mu and of nu = p - t - A'mu be right but for what moves t by eps, kappa = sum_W |mu_i| |a_i p -
/// b_i|, and let some point of C be within eta of p. Then
///     ||p - p*||  <=  eps + sqrt(kappa + (||p - t|| + eta) eta)
/// by adding the variational inequalities of p and p*. kappa and eta are of the size 1e-31, so the root is harmless.
/// That a point of C is near follows in one of three ways: p in doubles is in C exactly; or the rows in W, and others
/// that hold only just, have independent normals, as Cholesky's factorization of their Gram matrix, shifted, shows
/// (Rump, BIT 46 (2006) 433); or from p a point inside C by a margin is seen. Where C is flat without saying so by
/// equations, none may be found: the bound is then infinite.
#include <cmath>
#include <optional>
#include <vector>

#include "lcp/judge/two_part_vector.hpp"
#include "lcp/vi/face_pivoting.hpp"

namespace perp::lcp {

struct Projection {
  Vec p;
  double error = infinity;  ///< ||p - p*||_2 <= error
  /// The length by which wrong signs move t, and by which p is off C's rows and bounds. Small does not say that C is
  /// near.
  double misses = infinity;
  Vec multipliers;  ///< mu
  Vec reduced;      ///< nu
  Face face;
  bool empty = false;  ///< the rows contradict each other, as `certificate` says in doubles
  Vec certificate;     ///< multipliers of the rows: proof_of_empty() makes a proof of them
};

/// Keeps C and its memory.
class Projector {
 public:
  /// Throws std::invalid_argument if C is malformed.
  explicit Projector(Polyhedron C);

  /// Begins with the face given. Ends with an error of at most `wanted`, if it can.
  const Projection& project(const TwoPartVector& t, Face face, double wanted, const Limits& limits = {});
  const Polyhedron& polyhedron() const { return C_; }
  const FacePivoting::Rows& dense();  ///< A, made when it is first needed
  /// Other sides of the same A. Throws std::invalid_argument if they are none.
  void set_sides(Box rows, Box box);

 private:
  using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  bool find_face(const TwoPartVector& t, Face& face, const Limits& limits);
  void keep_fixed(Face& face) const;
  FacePivoting& pivoting();
  /// A point of a face.
  struct Point {
    TwoPartVector p{}, mu{};
    std::vector<Index> active{};  ///< W
    Vec misses{};                 ///< by how much p misses them
  };
  std::optional<Point> solve_face(const Face& face, const TwoPartVector& t) const;
  double error_bound(const TwoPartVector& t, const Limits& limits);
  double violation() const;
  double distance(const Limits& limits);
  double through_equations(const std::vector<Index>& tight, const std::vector<char>& held, const TwoPartVector& y,
                           bool moved) const;
  bool same_row(Index i, Index j, double s) const;
  double step_onto(const std::vector<Index>& E, const std::vector<char>& held, const Vec& misses) const;
  double through_inside(const Limits& limits);
  struct Slack {
    double value, error;
    double size() const { return std::abs(value) * (1 + 4e-16) + error; }
  };
  Slack slack(Index i, double side, const TwoPartVector& y) const;
  double row_slack(Index i, const TwoPartVector& y) const;
  double bound_slack(Index j, const TwoPartVector& y) const;

  Polyhedron C_;
  Rows rows_;
  Vec norms_;
  FacePivoting::Rows dense_{};
  bool has_dense_ = false;
  FacePivoting pivoting_{};  ///< with M = I; prepared where it is used
  bool prepared_ = false;
  Projection out_{};
  Point at_{};  ///< the projection's
};

/// y, of the lifted MCP's rows, that proves C empty by proves_infeasible(), from y of C's rows; empty if it is no
/// proof. The sums are exact; excluded are points of norm below proof_radius of the equilibrated problem, for data in
/// doubles need not contradict themselves exactly. `mcp` is lifted(vi) of any vi over C.
Vec proof_of_empty(const AffineMcp& mcp, const Polyhedron& C, In y);

}  // namespace perp::lcp

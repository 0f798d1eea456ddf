#pragma once
/// Lemke-type pivoting for the affine MCP, seen as following a piecewise-linear path.
///
/// The normal map  G(x) = M pi(x) + q + x - pi(x),  pi the projection on [l, u], is linear on each cell of R^n cut out
/// by the bounds, and z = pi(x) solves the affine MCP iff G(x) = 0 (Robinson 1992). From a start x0 with r = G(x0)
/// follow
///     G(x) = (1 - t) r         from t = 0 (x0) to t = 1 (a zero).
/// Each crossing from one cell into the next is one pivot: x_i meets a bound, its column changes between M_{.i}
/// (inside) and e_i (outside), and the path goes on so that x_i keeps its direction (Ralph 1994; Dirkse & Ferris 1995;
/// Cottle, Pang & Stone 1992, section 4.4). t is an unknown like the others, so the path may turn back in t and goes on
/// through cells in which M_BB is singular. With all bounded variables outside their box this is Lemke's method with
/// covering vector -r.
///
/// A path from a start in general position meets no corner where two bounds are hit at once before t = 1, hence cannot
/// cycle; the start is moved into general position by a relative perturbation (`perturbation`), which changes the path
/// but not the problem: the zero at t = 1 does not know r.
#include <chrono>
#include <functional>
#include <string_view>
#include <vector>

#include "lcp/affine_mcp.hpp"
#include "lcp/basis_factor.hpp"

namespace perp::lcp {

enum class PivotEnd {
  Solved,         ///< natural residual <= residual_tol (1 + ||q||_inf)
  Ray,            ///< the path is unbounded: z + s `ray` stays on it for all s >= 0
  Loop,           ///< the path came back to the start: the component through it is closed and holds no solution
  SingularBasis,  ///< the start cell's matrix is singular, or a basis on the way is numerically so
  PivotLimit,
  TimeLimit,
  Interrupted,
  Inaccurate,  ///< t = 1 reached, but the point there fails the natural residual
};
std::string_view to_string(PivotEnd);

enum class LemkeStart {
  Regular,  ///< the cell the given point lies in
  Ray,      ///< all variables with a finite bound outside it, by a generic covering vector: Lemke's classical start
};

struct LemkeOptions {
  LemkeStart start = LemkeStart::Regular;
  int max_pivots = 100'000;
  double residual_tol = 1e-9;  ///< on the natural residual, relative to 1 + ||q||_inf
  double pivot_tol = 1e-9;     ///< smallest pivot, relative to the largest entry of the pivot column
  /// Harris: how far, relative to 1 + |bound|, a variable may overstep its bound in a ratio test. Far below the
  /// perturbation, or a path that begins near a corner is not followed but cut, and may cycle.
  double feasibility_tol = 1e-12;
  double perturbation = 1e-5;     ///< of the start, relative to 1 + |x_i|; 0 keeps the start as it is
  unsigned seed = 1;              ///< of the perturbation and of the covering vector
  double singular_rcond = 1e-15;  ///< a start cell whose matrix has a smaller rcond() counts as singular
  bool keep_path = false;         ///< fill PivotResult::path (n doubles a pivot)
  BasisOptions basis{};
  /// Polled at every pivot: true ends the run as Interrupted.
  std::function<bool()> interrupted{};
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
};

struct Breakpoint {
  double t = 0;
  Vec x;  ///< the point of the normal map; z = project(box, x)
};

struct PivotResult {
  PivotEnd end = PivotEnd::PivotLimit;
  Vec x;              ///< last point of the path, in the normal map's coordinates
  Vec z;              ///< project(box, x)
  Vec ray;            ///< direction in x, if end == Ray
  double t = 0;       ///< homotopy parameter there: 1 at a solution
  double best_t = 0;  ///< largest t met, at best_x
  Vec best_x;
  double residual = 0;  ///< natural residual of z
  double rcond = 0;     ///< SparseLu::rcond() of the matrix of the last linear piece; 0 if t = 1 was not reached
  int pivots = 0;
  int refactorizations = 0;
  std::vector<Breakpoint> path;  ///< every kink from the start on, if keep_path
  bool solved() const { return end == PivotEnd::Solved; }
};

/// Follows the path from `start` (any point of R^n: outside the box it means the cell beyond the bound).
/// Throws std::invalid_argument if the problem or the start is malformed. Terminates for every M in exact arithmetic:
/// a path through a cell with nonsingular matrix is one segment there, so it ends or comes back to the start (Loop).
/// From a Ray start it finds a solution if M is copositive-plus and the problem is feasible, or a P-matrix (LCP).
PivotResult lemke(const AffineMcp& problem, In start, const LemkeOptions& options = {});

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
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
/// Where the start cell's matrix is rank deficient, unit columns of artificial variables, which stay at 0, stand in for
/// the dependent columns, whose variables wait at their values; an artificial that would move is exchanged for the
/// variable it stands for, in the direction in which t grows (Munson 2000, section 2.2). From a ray, dependent free
/// variables are split into differences of nonnegative ones instead, which keeps what Lemke's method promises.
///
/// A path from a start in general position meets no corner where two bounds are hit at once before t = 1, hence cannot
/// cycle; the start is moved into general position by a relative perturbation (`perturbation`), which changes the path
/// but not the problem: the zero at t = 1 does not know r.
#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include "lcp/affine_mcp.hpp"
#include "lcp/lu/basis_factor.hpp"

namespace perp {
class Fields;  // lcp/fields.hpp: options of a method, described
}

namespace perp::lcp {

enum class PivotEnd {
  Solved,  ///< natural residual <= residual_tol (1 + ||q||_inf)
  Ray,     ///< the path is unbounded: x + s `ray` stays on it for all s >= 0
  /// The path came back to the start: the component through it is closed and holds no solution. Or t has not grown for
  /// too long: LemkeOptions::patience; from a rank-deficient start 50 + 2 n pivots.
  Loop,
  SingularBasis,  ///< a basis on the way is numerically singular
  PivotLimit,
  TimeLimit,
  Interrupted,
  Inaccurate,  ///< t = 1 reached, but the point there fails the natural residual
};
std::string_view to_string(PivotEnd);

enum class LemkeStart {
  Regular,  ///< the cell the given point lies in, or `cells`
  Ray,      ///< all variables with a finite bound outside it, by a covering vector: Lemke's classical start
};

/// The covering vector d of a Ray start: F + d z0 covers the negative entries of F at the bounds.
enum class Cover {
  Generic,  ///< uniform in [1/2, 3/2], and larger where F is far from zero, after equilibration of the rows
  Spread,   ///< log-uniform over three decades about 1, after equilibration
  Ones,     ///< e in the units of F: the textbook's
  Given,    ///< `covering`
};

struct LemkeOptions {
  LemkeStart start = LemkeStart::Regular;
  Cover cover = Cover::Generic;
  Vec covering{};  ///< Cover::Given: d > 0, one for each variable; in the units of F
  /// Regular: a warm basis, one cell for each variable, such as PivotResult::cells; the start is moved into it. Empty:
  /// the cell of the start.
  std::vector<Cell> cells{};
  int max_pivots = 100'000;
  /// Pivots in which t must come to a new largest value; else the path ends as a Loop.
  int patience = std::numeric_limits<int>::max();
  double residual_tol = 1e-9;  ///< on the natural residual, relative to 1 + ||q||_inf
  double pivot_tol = 1e-9;     ///< smallest pivot, relative to the largest entry of the pivot column
  /// A pivot smaller than this x the largest entry of its column is taken only where a step of refinement confirms its
  /// column, or from a fresh factorization.
  double doubtful_pivot = 1e-5;
  /// Harris: how far, relative to 1 + |bound|, a variable may overstep its bound in a ratio test. Far below the
  /// perturbation, or a path that begins near a corner is not followed but cut, and may cycle.
  double feasibility_tol = 1e-12;
  double perturbation = 1e-5;     ///< of the start, relative to 1 + |x_i|; 0 keeps the start as it is
  unsigned seed = 1;              ///< of the perturbation and of the covering vector
  double singular_rcond = 1e-15;  ///< a start cell whose matrix has a smaller rcond() is repaired as rank deficient
  /// A rank-deficient start is repaired by artificials; else the path does not begin (SingularBasis).
  bool repair = true;
  /// On a ray PivotResult::certificate is looked for, in exact arithmetic: it may take longer than the path.
  bool certify = true;
  bool keep_basis = false;  ///< keep the factors of the last piece: PivotResult::last_piece
  bool keep_path = false;   ///< fill PivotResult::path (n doubles a kink)
  /// Of a longer path, every 2nd, 4th, 8th ... kink is kept, the first and the last among them.
  std::size_t path_limit = std::numeric_limits<std::size_t>::max();
  BasisOptions basis{};
  /// Polled at every pivot: true ends the run as Interrupted.
  std::function<bool()> interrupted{};
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
};

void describe(LemkeOptions& options, Fields& fields);  ///< but for where the path starts
inline constexpr std::string_view lemke_start_help =
    "where pivoting starts: automatic (the cell of the current point), first (a ray in the first iteration) or "
    "always (a ray, as Lemke's method)";
void describe_start(LemkeStart& start, Fields& fields);

struct Breakpoint {
  double t = 0;
  Vec x;  ///< the point of the normal map; z = project(box, x)
};

class LastPiece;  // last_piece.hpp

struct PivotResult {
  PivotEnd end = PivotEnd::PivotLimit;
  Vec x;                    ///< last point of the path, in the normal map's coordinates
  Vec z;                    ///< project(box, x)
  std::vector<Cell> cells;  ///< the cell of the last linear piece: the final basis
  Vec ray;                  ///< direction in x, if end == Ray
  /// y with proves_infeasible(problem, y) (lcp/judge/result.hpp), if end == Ray, options.certify and its direction is
  /// one: always in exact arithmetic from a Ray start with copositive-plus M (Cottle, Pang & Stone 1992,
  /// theorem 4.4.13).
  Vec certificate;
  double t = 0;       ///< homotopy parameter there: 1 at a solution
  double best_t = 0;  ///< largest t met, at best_x
  Vec best_x;
  double residual = 0;  ///< natural residual of z
  int pivots = 0;
  int refactorizations = 0;
  int repaired = 0;  ///< dependent columns of the start basis that artificials stood in for, or that were split
  std::vector<Breakpoint> path;                   ///< the kinks from the start on, if keep_path
  std::shared_ptr<const LastPiece> last_piece{};  ///< for chord_step(), if LemkeOptions::keep_basis and solved
  bool solved() const { return end == PivotEnd::Solved; }
};

/// dx with B dx = -r, B the matrix of the last linear piece of the path, G(x + dx) = G(x) + B dx: the simplified Newton
/// (chord) step for another residual r of the normal map, at the price of one solve. Pre: result.last_piece. Not to be
/// called by two threads at once.
Vec chord_step(const PivotResult& result, In r);

/// Follows the path from `start` (any point of R^n: outside the box it means the cell beyond the bound).
/// Throws std::invalid_argument if the problem, the start or an option is malformed; std::bad_alloc.
/// Terminates for every M in exact
/// arithmetic: a path through a cell with nonsingular matrix is one segment there, so it ends or comes back to the
/// start (Loop). From a Ray start it finds a solution if M is copositive-plus and the problem is feasible, or a
/// P-matrix (LCP).
PivotResult lemke(const AffineMcp& problem, In start, const LemkeOptions& options = {});

}  // namespace perp::lcp

// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "lcp/pivoting/lemke.hpp"
#include "ncp/problem/mcp.hpp"
#include "ncp/run/options.hpp"

namespace perp::ncp {

/// The merit function Psi of PathSearch, 1/2 ||.||^2 of
enum class PathMerit {
  Fischer,    ///< Phi_FB(z), Fischer-Burmeister's reformulation
  NormalMap,  ///< F_+(x) = F(z) + x - z,  z = pi(x): as in Ralph (1994)
};

/// The way from z^k to the Newton point x^N along which points are tried: T = 1 is the Newton point, T -> 0 is z^k.
enum class Searchtype {
  Path,  ///< the piecewise-linear path of the linearised normal map: its point at t = T
  Line,  ///< z^k + T (pi(x^N) - z^k)
  Arc,   ///< pi(x^k + T (x^N - x^k))
};

/// Where the path of a linearised problem starts.
enum class PathStart {
  Automatic,  ///< from x^k; from a ray where that fails
  First,      ///< from a ray in the first iteration
  Always,     ///< from a ray in every iteration: Lemke's method proper
};

/// Projected Newton steps before the first linearised problem is solved: J_II d_I = -F_I, d = 0
/// elsewhere, searched along z -> pi(z + alpha d); I are the variables that are not held at a bound by the sign of F
/// (Dirkse & Ferris 1997). Any number of variables may come to a bound or leave it in a step of one factorization;
/// where many do, projected Gauss-Seidel sweeps on the linearised problem go first.
struct Crash {
  bool on = true;
  int iteration_limit = 50;
  Index minimum_dimension = 1;  ///< smaller problems go without
  Index nbchange_limit = 1;     ///< ends where fewer variables than this change between bound and inside
  static constexpr double least_step =
      0.1;  ///< ends where alpha would be smaller; in affine problems a thousandth of it
};

/// Non-monotone stabilisation (Ferris & Lucidi 1994; Dirkse & Ferris 1995). The references M_1 .. M_m begin at `factor`
/// Psi(x^0); the largest of them is what a merit must beat, and what the new merit then replaces. A Newton point nearer
/// than Delta is accepted without that test (a D-step) unless mstep_frequency iterations have gone by since the last
/// test; where a test then fails, the run goes back to the last point that had passed one (watchdog). Where a search
/// comes to nothing the Newton point is taken so, too.
struct Nms {
  bool on = true;  ///< off: every step must beat the last merit
  int memory = 10;
  int mstep_frequency = 10;
  double initial_reference_factor = 20;
  int maximum_watchdogs = 5;  ///< of an attempt, after which it takes no more D-steps
  static constexpr double distance_decrease =
      0.5;  ///< a D-step shrinks Delta so; from 0 it grows to the longest step that passed the test
};

/// Newton-Robinson on the normal map with path search: PATH's algorithm (Ralph 1994; Dirkse & Ferris 1995; Ferris,
/// Kanzow & Munson 1999; Munson 2000). The linearised problem MCP(l, u, F(z^k) + (J + lambda I)(. - z^k)) is solved by
/// following M z + q - w + v = (1 - t) r from x^k (t = 0) to the Newton point (t = 1) with lcp::lemke.
struct PathSearch {
  Stop stop{};
  PathMerit merit = PathMerit::Fischer;
  Searchtype search = Searchtype::Path;
  double sigma = 1e-4;  ///< Psi(new) <= reference - 2 sigma T Psi(z^k)
  double beta = 0.5;    ///< T = 1, beta, beta^2, ...
  int max_backtracks = 15;
  Crash crash{};
  Nms nms{};
  PathStart start = PathStart::Automatic;
  /// Simplified Newton steps x - B^-1 F_+(x) after a Newton point, B the matrix of the path's last piece: a solve and
  /// an evaluation of F each, no Jacobian; one is kept if it leaves at most 70 % of the merit (Shamanskii 1967:
  /// order 2 + their number an iteration).
  int chord_steps = 1;
  /// lambda to begin with, relative to the size of J; it shrinks by a factor of 10 an iteration.
  double proximal_perturbation = 0;
  bool proximal_adaptive = true;  ///< lambda > 0 where the path leads nowhere or its way gives no long step
  int gradient_step_limit = 5;    ///< projected gradient steps of the Fischer merit, where nothing else descends
  /// Iterations without 1 % less than the best merit so far, after which an attempt is given up.
  int patience = 20;
  lcp::LemkeOptions lemke{};  ///< max_pivots is for one linearised problem, at most 1000 + 20 n
  /// An affine problem is its own linearised problem: where the path does not solve it, no other step is tried.
  bool only_newton_if_affine = false;
  double proximal_to_residual = 0;  ///< a further lambda to begin with, relative to the natural residual
};

void describe(Crash& crash, Fields& fields);
void describe(Nms& nms, Fields& fields);
void describe(PathSearch& method, Fields& fields);
inline std::string_view name_of(const PathSearch&) { return "path"; }
/// One attempt, from one start with one set of options; the first PathSearch of a run begins with the run's warm basis.
/// Leaves the cells of the last linearised problem that was solved.
void iterate(Run& run, const PathSearch& method, Point point);

}  // namespace perp::ncp

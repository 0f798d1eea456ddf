// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Observers: the only way a solve shows itself. Each gets every Iteration record and may ask to stop.
#include <atomic>
#include <functional>
#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

#include "lcp/pivoting/lemke.hpp"
#include "ncp/problem/mcp.hpp"

namespace perp::ncp {

/// The way of one iteration of PathSearch, in the coordinates of the normal map.
struct WayTaken {
  /// Of the path, from t = 0, each with its t; of a way without kinks begin (t = 0) and end (t = 1) of
  /// pi(x^k + T (end - x^k)).
  std::vector<lcp::Breakpoint> kinks;
  double T = 1;          ///< accepted; 1 is the end, 0 where no point of the way was: the step is another, or none
  bool on_path = false;  ///< searched along the kinks
};

struct Iteration {
  int k = 0;            ///< 0 is the start
  double residual = 0;  ///< natural residual of the iterate projected onto the box
  Index worst = -1;     ///< index where it is largest
  double merit = 0;     ///< the method's own merit function
  double step = 0;      ///< step length t in (0, 1]; 0 at the start
  double prox = 0;      ///< proximal or Levenberg-Marquardt parameter of the step; 0 if none
  double mu = 0;        ///< Smoothing, InteriorPoint: its parameter (tau) after the step; Multiroot: during it
  int pivots = 0;       ///< of this iteration
  int backtracks = 0;   ///< of this iteration
  int F_evals = 0;      ///< so far
  int J_evals = 0;      ///< so far
  /// Of the step: I start, N Newton, Q convex QP, L Levenberg-Marquardt, G gradient, P proximal, R partial path
  /// (NewtonJosephy), E proximal escape, A a linear method. Smoothing: H predictor, S Newton on the active set, U mu
  /// raised; InteriorPoint: S, U likewise; Lmmcp: P of the preprocessor. PathSearch: C crash; a Newton point accepted
  /// by O distance and merit, M merit, D distance; B backtracked, W watchdog, G gradient, R restart.
  char kind = ' ';
  /// PathSearch, the linear problem: S solved, R ray, C cycle, N singular, I pivot limit, T inaccurate, E other.
  /// SemismoothNewton: K solved by the Krylov method, D by LU where that had failed. NewtonJosephy: Q solved as a
  /// quadratic program.
  char linear = ' ';
  bool crash = false;             ///< the start of a crash or one of its steps, which are no major iterations
  Index changes = -1;             ///< crash: variables that came to a bound or left it since the last step
  Index inside = -1;              ///< crash: rows of the system solved
  std::string attempt{};          ///< begun with this record, after the first: "no crash", ...
  bool normal_map = false;        ///< x is a point of the normal map: pi(x) is the iterate
  const Vec* x = nullptr;         ///< the iterate; only during the call
  const Mcp* problem = nullptr;   ///< x and way are points of: the presolved problem, say; only during the call
  const WayTaken* way = nullptr;  ///< PathSearch, for an Observer of ways; only during the call
};

enum class Next { Continue, Stop };

struct Observer : std::function<Next(const Iteration&)> {
  using function::function;
  Observer(std::function<Next(const Iteration&)> f) : function(std::move(f)) {}
  /// Asks for Iteration::way: a path is kept with all its kinks or followed a second time, and each kink of a presolved
  /// problem takes two evaluations of F.
  bool ways = false;
};
Observer of_ways(Observer observer);

/// What a table shows.
struct TableOptions {
  bool crash = true;
  bool major = true;
  bool restarts = true;     ///< the lines that say which attempt begins
  int crash_frequency = 1;  ///< every crash iteration, every 2nd, ...
  int major_frequency = 1;
};

/// PATH's tables, a crash's ("Crash Log") and that of the iterations ("Major Iteration Log"). Columns: major, minor =
/// pivots, func and grad = evaluations of F and J so far, diff = changes, size = inside; residual = sqrt(2 merit), the
/// norm of what the method makes zero; step; type = linear and kind; prox; inorm = the natural residual, which decides,
/// and in brackets the equation where it is largest. The stream and the problem outlive the observer.
Observer print_table(std::ostream& out, const Mcp& mcp, TableOptions options = {});
/// Appends every record, with x = nullptr.
Observer record(std::vector<Iteration>& records);
/// Stops when the flag is set (by a signal handler or another thread).
Observer stop_when(const std::atomic<bool>& flag);
/// Calls all; stops if any asks to.
Observer all(std::vector<Observer> observers);

}  // namespace perp::ncp

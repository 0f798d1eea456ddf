// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the options of several methods share.
#include <atomic>
#include <chrono>
#include <limits>

#include "lcp/judge/shared_options.hpp"
#include "lcp/pivoting/lemke.hpp"
#include "ncp/problem/fields.hpp"

namespace perp::ncp {

// Beside its options every method has name_of(method), and iterate(run, method, point): its loop, from `point`, F and J
// known there, until the run ends. Private to ncp/.
class Run;
struct Point;

/// Of iterations: none. Runs end by time, evaluations and want of progress.
inline constexpr int no_limit = std::numeric_limits<int>::max();

struct Stop {
  double tol = 1e-8;  ///< on the natural residual, inf-norm, absolute
  /// A further condition for a solution: |F_i| <= tol_relative t_i in every row whose variable is not at the bound that
  /// the sign of F_i requires, with t_i = sum_j |J_ij x_j| + |F_i - sum_j J_ij x_j|. Infinity turns it off.
  double tol_relative = std::numeric_limits<double>::infinity();
  /// Major iterations, of all attempts together. With no_limit an attempt ends after 500 without progress.
  int max_iterations = no_limit;
  int max_F_evals = std::numeric_limits<int>::max();  ///< evaluations of F, looked at after each iteration
  int max_pivots = 1'000'000;                         ///< of all attempts of the path search together
  std::chrono::duration<double> max_time{3600};
  /// A run gives up after this time, and 100 iterations, without progress: the natural residual of its best point has
  /// not fallen by a tenth.
  std::chrono::duration<double> max_stall{10};
  /// If another thread sets it, the solve ends as Interrupted, even inside a subproblem. May be null; outlives the
  /// solve.
  const std::atomic<bool>* interrupt = nullptr;
  /// Compare J with differences of F at the start and refuse (std::invalid_argument) a J that is wrong by more than
  /// 1e-4.
  bool check_derivatives = false;
};

/// Non-monotone Armijo test  psi(x + t d) <= max of the last `memory` merits + sigma t psi'(x; d),  t = 1, beta,
/// beta^2, ... (Grippo, Lampariello & Lucidi 1986).
struct Armijo {
  double sigma = 1e-4;
  double beta = 0.5;
  int max_backtracks = 25;  ///< shorter Newton steps than beta^25 lead nowhere: the next kind of direction is tried
  int memory = 5;
};

/// Proximal escapes, for a method that is stuck at xbar (ncp::stuck(), but EvaluationFailed only after an iteration).
/// They solve F(x) + lambda (x - xbar) loosely, move xbar to the solution, and repeat this until the method makes
/// progress from xbar on F itself (Billups 1995; Billups & Ferris 1997). The centres xbar follow the flow xdot = -F(x)
/// in the box by implicit Euler steps of length 1 / lambda. They need not decrease the merit function, so they can
/// leave its local minima. They lead to a solution that attracts the flow; if F is monotone, to some solution.
struct Escape {
  int rounds = 50;    ///< moves of the centre; 0: stay stuck
  double lambda = 2;  ///< first lambda in units of sqrt(||J||_1 ||J||_inf) >= ||J(xbar)||_2: above 1 it is monotone
  static constexpr double grow = 10;     ///< lambda x grow where the perturbed problem has not been solved
  static constexpr double shrink = 0.5;  ///< lambda x shrink after a move
  /// A centre is accepted, and the method continues from it, if its natural residual is at most this share of the best
  /// point's.
  static constexpr double accept = 0.5;
  /// Iterations that the method may take from a centre that was not accepted; its result is accepted by the same test.
  /// 0: it runs from accepted centres only.
  int trial_iterations = 25;
  static constexpr double perturbed_tol =
      1e-6;  ///< natural residual at which a perturbed problem is solved well enough
  static constexpr int perturbed_iterations = 60;
};

void describe(Stop& stop, Fields& fields);
void describe(Armijo& search, Fields& fields);
void describe(Escape& escape, Fields& fields);

// Single options that several methods have.
void describe_search(double& sigma, double& beta, int& max_backtracks, Fields& fields);
using lcp::describe_lu;
using lcp::describe_memory;
using lcp::describe_start;
using lcp::lemke_start_help;

}  // namespace perp::ncp

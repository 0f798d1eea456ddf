#pragma once
/// Methods as values, and solve(). A method's fields are its options; solve(mcp, x0, method) runs it, and only the
/// judge (ncp/residual.hpp) may call the outcome Solved.
#include <array>
#include <atomic>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "lcp/lemke.hpp"
#include "lcp/solve.hpp"
#include "lcp/sparse_lu.hpp"
#include "ncp/cfunction.hpp"
#include "ncp/observe.hpp"
#include "ncp/result.hpp"

namespace perp::ncp {

struct Stop {
  double tol = 1e-8;         ///< on the natural residual, inf-norm, absolute
  int max_iterations = 500;  ///< major iterations
  std::chrono::duration<double> max_time{3600};
  /// Set by anybody: ends the solve as Interrupted, also inside a subproblem. May be null; outlives the solve.
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

/// What to do where a method is stuck (StationaryPoint, NoProgress, SubproblemFailed, EvaluationFailed on the way) at
/// xbar: solve F(x) + lambda (x - xbar), go on from its solution, and so on, until the method reaches a solution of F
/// from there (Billups & Ferris 1997).
struct Escape {
  int rounds = 20;    ///< 0: stay stuck
  double lambda = 2;  ///< lambda in units of sqrt(||J||_1 ||J||_inf), a bound of ||J(xbar)||_2: above 1 it is monotone
};

/// x+ = x + t d,  H d = -Phi(x),  H in the B-subdifferential of Phi  (De Luca, Facchinei & Kanzow 1996, Math. Prog.
/// 75). Levenberg-Marquardt steps (H'H + nu I) d = -H'Phi where H is singular or d is no descent direction, gradient
/// steps where those fail too. Converges q-quadratically to R-regular solutions; every accumulation point is stationary
/// for the merit.
struct SemismoothNewton {
  Stop stop{};
  CFunction cfunction = fischer_burmeister();
  Armijo search{};
  double descent_rho = 1e-9;  ///< a Newton direction needs  grad psi . d <= -rho ||d||^p
  double descent_p = 2.1;
  Escape escape{};
  lcp::LuBackend lu = lcp::LuBackend::Umfpack;
};

/// x+ solves the linearised problem MCP(l, u, F(x) + F'(x)(. - x)), by lcp::lemke from the last basis; damped on the
/// Fischer-Burmeister merit (Josephy 1979; Mathiesen 1985; Rutherford 1993). Quadratic near strongly regular solutions.
struct NewtonJosephy {
  Stop stop{};
  Armijo search{};
  Escape escape{};
  lcp::LemkeOptions lemke{};  ///< max_pivots is for one subproblem, and at most 1000 + 20 n
};

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

/// Projected Newton steps before the first linearised problem is solved: J_II d_I = -F_I, d_i to the bound for i not in
/// I, searched along z -> pi(z + alpha d); I are the variables that are not held at a bound by the sign of F (Dirkse &
/// Ferris 1997). Any number of variables may come to a bound or leave it in a step of one factorization.
struct Crash {
  bool on = true;
  int iteration_limit = 50;
  Index minimum_dimension = 1;  ///< smaller problems go without
  Index nbchange_limit = 1;     ///< ends where fewer variables than this change between bound and inside
  double least_step = 0.1;      ///< ends where alpha would be smaller
};

/// Non-monotone stabilisation (Ferris & Lucidi 1994; Dirkse & Ferris 1995). The references M_1 .. M_m begin at `factor`
/// Psi(x^0); the largest of them is what a merit must beat, and what the new merit then replaces. A Newton point nearer
/// than Delta is accepted without that test (a D-step) unless mstep_frequency iterations have gone by since the last
/// test; where a test then fails, the run goes back to the last point that had passed one (watchdog).
struct Nms {
  bool on = true;  ///< off: every step must beat the last merit
  int memory = 10;
  int mstep_frequency = 10;
  double initial_reference_factor = 20;
  int maximum_watchdogs = 5;       ///< without progress, after which D-steps are no longer taken
  double distance_decrease = 0.5;  ///< Delta, at first the length of the first Newton step, shrinks so by a D-step
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
  bool proximal_adaptive = true;  ///< lambda > 0 where J or the start basis is singular, or the path leads nowhere
  int gradient_step_limit = 5;    ///< projected gradient steps of the Fischer merit, where nothing else descends
  /// Attempts after the first, of the list in ncp/README.md: other options, then other methods.
  int restart_limit = 20;
  int cumulative_iteration_limit = 1'000'000;  ///< pivots in all
  /// Iterations without 1 % less than the best merit so far, after which an attempt is given up.
  int patience = 20;
  bool preprocess = true;          ///< presolve
  bool scaling = true;             ///< where it helps
  lcp::LemkeOptions lemke{};       ///< max_pivots is for one linearised problem, at most 1000 + 20 n
  std::vector<lcp::Cell> basis{};  ///< warm start: Result::basis of a nearby problem
};

/// Affine problems (Mcp::is_affine) only, by a method of lcp/. Stop::tol is relative to 1 + ||F(0)||_inf here;
/// Stop::max_iterations has no meaning but 0.
struct Affine {
  Stop stop{.tol = 1e-9};
  lcp::Method method{};
};

using Method = std::variant<SemismoothNewton, NewtonJosephy, PathSearch, Affine>;
std::string_view name(const Method& method);  ///< "semismooth", "josephy", "path", or the name of the method of lcp/
/// Why the options make no sense (a tolerance that is not positive, ...), if they do not.
std::optional<std::string> invalid(const Method& method);
const Stop& stop(const Method& method);
Stop& stop(Method& method);

/// Solves the MCP from x0 (projected onto the box first). Throws std::invalid_argument for input that is no problem:
/// see check_input(), a J that does not keep its pattern, a basis of another size, and invalid(method). Everything else
/// is a Status with a message.
Result solve(const Mcp& mcp, In x0, const Method& method, const Observer& observer = {});

}  // namespace perp::ncp

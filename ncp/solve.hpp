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

/// Affine problems (Mcp::is_affine) only, by a method of lcp/. Stop::tol is relative to 1 + ||F(0)||_inf here;
/// Stop::max_iterations has no meaning but 0.
struct Affine {
  Stop stop{.tol = 1e-9};
  lcp::Method method{};
};

using Method = std::variant<SemismoothNewton, NewtonJosephy, Affine>;
std::string_view name(const Method& method);  ///< "semismooth", "josephy", or the name of the method of lcp/
/// Why the options make no sense (a tolerance that is not positive, ...), if they do not.
std::optional<std::string> invalid(const Method& method);
const Stop& stop(const Method& method);
Stop& stop(Method& method);

/// Solves the MCP from x0 (projected onto the box first). Throws std::invalid_argument for input that is no problem:
/// see check_input(), a J that does not keep its pattern, and invalid(method). Everything else is a Status with a
/// message.
Result solve(const Mcp& mcp, In x0, const Method& method, const Observer& observer = {});

}  // namespace perp::ncp

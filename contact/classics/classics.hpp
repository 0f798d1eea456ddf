// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Methods of the literature for Coulomb's exact law, on r alone: the lecture's (51)-(81). One file a method. Each
/// works in the coordinates of contact/model/scaling.hpp, where mu = 1, makes iterates until the judge accepts one or a
/// limit is met, and says nothing of them itself. `max_iterations` counts the outermost loop. Those of first order have
/// a limit so high that the time limit ends them.
#include <chrono>
#include <string>
#include <tuple>
#include <type_traits>

#include "contact/classics/alart_curnier.hpp"
#include "contact/classics/local_problem.hpp"
#include "contact/classics/newton.hpp"
#include "contact/classics/vi.hpp"
#include "contact/model/scaling.hpp"
#include "lcp/fields.hpp"

namespace perp::contact {

/// Counts of what a solve has spent.
struct Stats {
  int iterations = 0;       ///< homotopy steps, or iterations of the ncp method or of a classic
  int sweeps = 0;           ///< over all contacts; of Cadoux iterations of ADMM
  int newton_steps = 0;     ///< on Alart & Curnier's equation
  int splitting_steps = 0;  ///< of Douglas & Rachford's splitting: a solve each
  int proximal_steps = 0;   ///< moves of the proximal loop's centre
  int attempts = 0;
  int factorizations = 0;
  std::chrono::duration<double> time{0};
};

class Trial;

inline constexpr int cheap_iterations = 10'000'000;

/// Nonsmooth Gauss-Seidel, (71): sweeps to the end.
struct Nsgs {
  LocalSolver local = LocalSolver::Newton;
  double omega = 1;  ///< relaxation, in (0, 2): PSOR where it is not 1
  int max_iterations = cheap_iterations;
  bool scaling = true;
};

/// De Saxce & Feng's projection, (69)-(70): r = P_K(r - rho F(r)).
struct FixedPoint {
  StepRule rule{};
  int max_iterations = cheap_iterations;
  bool scaling = true;
};

/// Korpelevich (1976): s = P_K(r - rho F(r)), r = P_K(r - rho F(s)).
struct Extragradient {
  StepRule rule{};
  int max_iterations = cheap_iterations;
  bool scaling = true;
};

/// Solodov & Svaiter, SIAM J. Control Optim. 37 (1999) 765: s = P_K(r - F(r)); y the first of r - t (r - s), t = t_0,
/// gamma t_0, .., with F(y).(r - s) >= sigma |r - s|^2; H = {x : F(y).(x - y) <= 0}; r = P_{K and H}(r), or
/// P_K(P_H(r)).
struct Hyperplane {
  double sigma = 0.3;
  double gamma = 0.5;
  double theta = 4;          ///< t_0 of the next iteration is theta times the last t, at most 1
  bool intersection = true;  ///< onto K and H at once, as published; else onto one after the other, as in Siconos
  int max_iterations = cheap_iterations;
  bool scaling = true;
};

/// Alart & Curnier's equation and its kin by Newton's method with a line search, (51)-(63).
struct AlartCurnierNewton {
  enum class Function {
    Standard,    ///< the disk's radius is (r_N - rho_N u_N)+: (52)-(53); in 2D that is Park & Kwak's and Leung's
                 ///< (61)-(62)
    JeanMoreau,  ///< the disk's radius is r_N+
    Hueeber,     ///< Hueeber, Stadler & Wohlmuth (2008): max(R, |y|) r_T = R y, R as Standard, y = r_T - rho_T u_T
    Xuewen       ///< Xuewen, Soh & Wanji (2000), (63)
  };
  Function function = Function::Standard;
  NewtonOptions newton{};
};

/// The Fischer-Burmeister function of the second-order cone, by Newton's method with a line search.
struct FischerBurmeisterNewton {
  NewtonOptions newton{};
};

/// The natural map by Newton's method with a line search, (72)-(74).
struct NaturalMapNewton {
  NewtonOptions newton{};
};

/// Tresca's friction, (75)-(79): the cylinder |r_T| <= theta in place of the cone, theta = r_N of the last solution.
struct Tresca {
  double inner_share = 0.1;  ///< sweeps end when r changes by less than this part of the last outer change
  int inner_sweeps = 1000;   ///< at most, of one inner problem
  int max_iterations = cheap_iterations;
  bool scaling = true;
};

/// Panagiotopoulos' alternation: r_N without friction where r_T is given, then r_T in disks whose r_N is given.
struct Panagiotopoulos {
  double inner_share = 0.1;  ///< as Tresca's
  int inner_sweeps = 1000;   ///< as Tresca's
  int max_iterations = cheap_iterations;
  bool scaling = true;
};

/// Cadoux' fixed point on s = |u_T|, (80)-(81): the convex problem r in K, W r + q + s e_N in K*, orthogonal, by ADMM.
struct Cadoux {
  double inner_share = 0.1;  ///< ADMM ends at residuals below this part of the last outer change
  int inner_iterations = 1000;
  double penalty = 1;       ///< rho of ADMM in the beginning, in scaled units
  double relaxation = 1.5;  ///< of ADMM, in (0, 2)
  int max_iterations = 100'000;
  bool scaling = true;
};

/// Options by name.
void describe(Nsgs& method, Fields& fields);
void describe(FixedPoint& method, Fields& fields);
void describe(Extragradient& method, Fields& fields);
void describe(Hyperplane& method, Fields& fields);
void describe(AlartCurnierNewton& method, Fields& fields);
void describe(FischerBurmeisterNewton& method, Fields& fields);
void describe(NaturalMapNewton& method, Fields& fields);
void describe(Tresca& method, Fields& fields);
void describe(Panagiotopoulos& method, Fields& fields);
void describe(Cadoux& method, Fields& fields);

/// Iterates from r~, `start` or zero where that is empty.
void iterate(Trial& trial, const Scaled& problem, const Nsgs& method, const Vec& start);
void iterate(Trial& trial, const Scaled& problem, const FixedPoint& method, const Vec& start);
void iterate(Trial& trial, const Scaled& problem, const Extragradient& method, const Vec& start);
void iterate(Trial& trial, const Scaled& problem, const Hyperplane& method, const Vec& start);
void iterate(Trial& trial, const Scaled& problem, const Tresca& method, const Vec& start);
void iterate(Trial& trial, const Scaled& problem, const Panagiotopoulos& method, const Vec& start);
void iterate(Trial& trial, const Scaled& problem, const Cadoux& method, const Vec& start);

/// The equation that a Newton method solves; `problem` outlives it.
RowsOf equation(const Scaled& problem, const AlartCurnierNewton& method);
RowsOf equation(const Scaled& problem, const FischerBurmeisterNewton& method);
RowsOf equation(const Scaled& problem, const NaturalMapNewton& method);
/// The same of two disks; of the functions Standard and JeanMoreau.
RowsOfContacts<5> rolling_equation(const Scaled& problem, const AlartCurnierNewton& method);
template <class Method>
requires requires(const Method& method) { method.newton; }
void iterate(Trial& trial, const Scaled& problem, const Method& method, const Vec& start) {
  if constexpr (std::is_same_v<Method, AlartCurnierNewton>)
    if (problem.rolls)
      return newton<5>(trial, problem, method.newton, rolling_equation(problem, method), start_or_zero(problem, start));
  newton<3>(trial, problem, method.newton, equation(problem, method), start_or_zero(problem, start));
}

/// The two options that all have.
void describe_loop(int& max_iterations, bool& scaling, Fields& fields);

}  // namespace perp::contact

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Finds several solutions of one problem by deflation (Brown & Gearhart, Numer. Math. 16 (1971) 334; Farrell,
/// Birkisson & Funke, SIAM J. Sci. Comput. 37 (2015) A2026; for semismooth equations and complementarity Farrell, Croci
/// & Surowiec, Optim. Methods Softw. 35 (2020) 1248).
///
/// With solutions r in R known, semismooth Newton runs again from the same start, and from others near it or near r, on
///     M(x; R) Phi(x) = 0,   M(x; R) = product over r of ((D / ||x - r||)^p + sigma),
/// where Phi is a reformulation by a C-function (ncp/reformulation/cfunction.hpp). Its zeros are those of Phi but for
/// R: near a regular r, Phi falls like ||x - r||, and M Phi does not vanish. sigma > 0 keeps M from vanishing far away,
/// where iterates would run to. D = min(1, ||r||), or 1 if r = 0, makes "far" what it is in problems of small numbers.
///
/// The deflated Newton step is tau d, with d the plain step, tau = 1 / (1 - m'd) and m = grad M / M. It costs one
/// scalar product more than the plain step, for the change of the matrix has rank one.
///
/// There is no guarantee that all solutions are found, or even a second one. If none is found, this does not prove
/// uniqueness. In a continuum of solutions the search finds points that are as far apart as `distinct` demands.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ncp/reformulation/cfunction.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::ncp {

/// Where an attempt starts. A start that is symmetric in a symmetry of the problem keeps all its iterates symmetric:
/// the other two break it.
enum class DeflationStart {
  Same,      ///< x0
  Near,      ///< x0, each entry moved by up to 0.1 (1 + |x_i|), differently in every attempt
  Solution,  ///< the solution found last, moved likewise
};

struct DeflationTry {
  CFunction cfunction = fischer_burmeister();
  double p = 2;        ///< exponent of the pole; > 0
  double sigma = 1;    ///< shift; >= 0
  bool search = true;  ///< Armijo search on log ||M Phi||; false: full steps, shortened only where they are very long
  DeflationStart start = DeflationStart::Same;
};
/// "fischer-burmeister, p = 2, sigma = 1, full steps".
std::string describe(const DeflationTry& attempt);

struct Deflation {
  int solutions = 10;  ///< stop when so many are known; >= 1
  /// Tried in turn, with every solution known so far deflated; after one that finds something, the first again.
  std::vector<DeflationTry> tries = default_tries();
  int max_attempts = 100;    ///< of all tries together; >= 0
  int max_iterations = 100;  ///< of one attempt
  /// A point within distinct (1 + ||r||_inf) of a known r, in the maximum norm, is r again.
  double distinct = 1e-4;

  /// Fischer-Burmeister with sigma = 1, 0.1, 10, p = 2 and 1, with and without search, and min with p = 2, sigma = 1;
  /// then all of them from the last solution.
  static std::vector<DeflationTry> default_tries();
};
std::optional<std::string> invalid(const Deflation& deflation);

struct FoundSolution {
  Result result;      ///< Solved, by the judge of the undeflated problem
  std::string how{};  ///< the label of the method, or describe() of the try
  /// Why J is singular there (ncp/analysis/structure_report.hpp): it may be one of a continuum. Empty: regular, hence
  /// isolated if it is strictly complementary.
  std::string singular{};
};

struct AllSolutions {
  std::vector<FoundSolution> found;  ///< pairwise distinct, in the order found
  Result first;                      ///< of the method from x0, solved or not
  int attempts = 0;                  ///< of deflation
  int duplicates = 0;                ///< attempts that came back to a known solution
  Stats stats;                       ///< of everything
  std::string message;               ///< why the search ended
};

/// Finds the first solution by solve(mcp, x0, method), and the others by deflation from x0. Plain semismooth Newton
/// steps polish each of them, and are kept if the residual falls. The tolerance in stop(method) applies to all
/// solutions. The limits of time and evaluations and the interrupt apply to the whole search; limits of iterations
/// apply to the method and to each attempt. If the first solve fails, there is nothing to deflate and the list is
/// empty. `label` is FoundSolution::how of the first solution, for instance the name of a preset; if it is empty,
/// name(method) is used. Throws std::invalid_argument as solve() does.
AllSolutions solve_all(const Mcp& mcp, In x0, const Method& method = {}, const Deflation& deflation = {},
                       const Observer& observer = {}, std::string_view label = {});

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Contact problems, solved to the exact law of Coulomb: through Glocker's differentiable NCP, or by the methods of
/// contact/classics, on r alone:
///     solve(problem)                                        several methods, one after another: Auto
///     solve(problem, {.method = GlockerHomotopy{}})         the interior-point homotopy alone
///     solve(problem, {.method = GlockerNcp{.method = ncp::path()}})   any method of ncp/
///     solve(problem, {.method = Nsgs{}})                    a classic
/// Only contact::accepted (contact/model/residual.hpp) calls a point solved, and Result::by says what made it. The
/// faceted and frictionless laws have solvers of their own (contact/laws/affine_encoding.hpp); run.hpp takes any law by
/// name.
#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "contact/classics/classics.hpp"
#include "contact/existence/existence.hpp"
#include "contact/laws/glocker.hpp"
#include "contact/model/problem.hpp"
#include "contact/model/residual.hpp"
#include "contact/solvers/homotopy.hpp"
#include "ncp/strategy/solve.hpp"

namespace perp::contact {

/// The homotopy of homotopy.hpp in scaled units, and no other equation: one attempt from its own start.
struct GlockerHomotopy {
  HomotopyOptions options{};
  int max_iterations = 60;  ///< of one attempt
  bool scaling = true;      ///< of contact/model/scaling.hpp
};

/// These kernels, one after another, until one solves the problem (bench/results/ablations.md says what each is worth):
/// sweeps of Gauss-Seidel, and Newton steps on the equation of Alart & Curnier where these leave nothing that sticks;
/// the cones' paths, from the associated law (cone_homotopy.hpp); one attempt of the homotopy, with such Newton steps
/// near a solution (`polish`), and damped ones from its best point where it stalls; groups of contacts that do not act
/// on each other, each by itself; and a proximal loop, which singular W need: r_{k+1} solves the problem with (W +
/// alpha I, q - alpha r_k), alpha falls as long as these problems are solved, and parallel increments are extrapolated.
struct Auto {
  GlockerHomotopy homotopy{};
  /// Sweeps of nonsmooth Gauss-Seidel before anything else (contact/classics/gauss_seidel.hpp), ended where they
  /// contract slowly: they cost little, and weakly coupled contacts need no more. 0: none.
  int sweeps = 100;
  bool cones = true;       ///< interior points over the cones, from the associated law; not without `polish`
  bool polish = true;      ///< Newton steps on Alart & Curnier's equation, damped ones too
  double polish_at = 0.1;  ///< relative natural residual at which they are tried first
  bool proximal = true;
};

/// Returns what Auto tries, in this order.
std::vector<ncp::OutlineLine> outline_of_auto();

/// Glocker's NCP (contact/laws/glocker.hpp) as it stands, by any method of ncp/. With `stages` > 1 and the normalised
/// row, delta is continued: 0.1 first, then in equal factors down to `delta`, each stage from the last one's end.
struct GlockerNcp {
  ncp::Method method = ncp::path();
  GlockerOptions formulation{};
  int stages = 4;
  bool scaling = true;
};

/// To Coulomb's law.
using Method =
    std::variant<Auto, GlockerHomotopy, GlockerNcp, Nsgs, FixedPoint, Extragradient, Hyperplane, AlartCurnierNewton,
                 FischerBurmeisterNewton, NaturalMapNewton, Tresca, Panagiotopoulos, Cadoux>;
/// One of contact/classics?
template <class T>
concept Classic = requires(Trial& trial, const Scaled& problem, const T& method, const Vec& start) {
  iterate(trial, problem, method, start);
};

struct MethodEntry {
  std::string_view name;  ///< "auto", "homotopy"
  std::string_view what;  ///< one line
  Method method;
  bool glocker = false;  ///< uses Glocker's NCP
};
/// Those with a name of their own; GlockerNcp has its method's.
std::span<const MethodEntry> methods();

void describe(GlockerHomotopy& method, ncp::Fields& fields);
void describe(Auto& method, ncp::Fields& fields);        ///< its own, then those of its homotopy
void describe(GlockerNcp& method, ncp::Fields& fields);  ///< beside those of its method of ncp/

/// What made a point.
enum class Origin {
  Zero,          ///< no impulses at all
  WarmStart,     ///< Options::start
  Sweeps,        ///< of Gauss-Seidel
  Cones,         ///< an interior point of the cones
  Homotopy,      ///< a step of it
  Newton,        ///< a step on Alart & Curnier's equation
  DampedNewton,  ///< a shortened one, or any of a search from the best point of an attempt
  Groups,        ///< groups of contacts that do not act on each other, each solved by itself
  Proximal,      ///< the solution of a proximal problem
  Ncp,           ///< the method of GlockerNcp
  Iterate        ///< an iteration of a method of contact/classics
};
/// "zero", "warm-start", "sweeps", "cones", "homotopy", "newton", "damped-newton", "groups", "proximal", "ncp",
/// "iterate".
std::string_view to_string(Origin);

struct Options {
  double tol = 1e-8;  ///< of accepted(): both published metrics, and the law's parts contact by contact
  std::chrono::duration<double> max_time{30};
  const std::atomic<bool>* interrupt = nullptr;  ///< may be null; outlives the solve
  Method method{};
  Vec start{};  ///< r to begin near, of the step before; empty: cold
  /// Called with every r that is better than those before, and what made it; on the thread that solves.
  std::function<void(const Vec& r, Origin by)> better{};
};

/// Infeasible: proven to have no solution, by Result::verdict.certificate (contact/existence/infeasible.hpp).
using perp::Status;
using perp::to_string;

/// One point that was judged.
struct Record {
  int k = 0;
  Origin by = Origin::Zero;
  char letter = ' ';   ///< of Ncp: the method's own (ncp::Iteration::kind); C at the end of a stage
  double tau = 0;      ///< of a homotopy step
  double step = 0;     ///< its length; of a projection rho
  double alpha = 0;    ///< of Newton, DampedNewton, Proximal and Iterate
  double siconos = 0;  ///< metrics of the point
  double rr9118 = 0;
};

struct Result {
  Status status = Status::NoProgress;
  std::string message;
  Solution solution;  ///< the accepted point, or the best one met, whose metrics are `residual`
  Residual residual;
  Origin by = Origin::Zero;  ///< what made it
  Stats stats;
  std::vector<Record> history;
  /// Asked for where a solve is given up: after the first attempt of the homotopy and at the end, in as much time as
  /// was spent before, of what is left, or a tenth of a second. Undecided where it was not asked.
  Verdict verdict;
  bool solved() const { return status == Status::Solved; }
};

/// Why the options make no sense, if they do not.
std::optional<std::string> invalid(const Options& options);

/// Throws std::invalid_argument for what is no problem (contact::check), options that are invalid(), or a start that
/// has not d n finite entries. Memory and time limits as in ncp/strategy/solve.hpp.
Result solve(const Problem& problem, const Options& options = {});

}  // namespace perp::contact

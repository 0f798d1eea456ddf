// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The answer of a solve: a status, a message and advice for the user, the best point, the verdict of the judge, and
/// statistics.
#include <chrono>
#include <iosfwd>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "lcp/judge/refutation.hpp"
#include "lcp/pivoting/lemke.hpp"
#include "lcp/status.hpp"
#include "ncp/problem/mcp.hpp"
#include "ncp/problem/residual.hpp"

namespace perp::ncp {

using perp::Status;
using perp::to_string;

/// Counts for the method and its escapes. Evaluations by check_jacobian and of the J for Result::relative are not
/// counted.
struct Stats {
  int iterations = 0;        ///< major: a linearised problem each
  int crash_iterations = 0;  ///< PathSearch: projected Newton steps, which are no major iterations
  int F_evals = 0;
  int J_evals = 0;
  int J_colours = 0;  ///< groups of columns of J that share no row; 0: J is the problem's own
  int J_F_evals = 0;  ///< of F for J, not among F_evals: by differences, or on dual numbers
  int factorizations = 0;
  int krylov_iterations = 0;  ///< of inexactly solved systems
  int pivots = 0;             ///< minor iterations
  int presolved = 0;          ///< pairs that presolve took out
  int restarts = 0;           ///< attempts after the first
  int gradient_steps = 0;
  int watchdogs = 0;                             ///< returns to the last point that had passed a merit test
  int unchecked_steps = 0;                       ///< D-steps
  int chord_steps = 0;                           ///< that were kept
  int backtracks = 0;                            ///< points refused by a search
  int ray_starts = 0;                            ///< linearised problems solved from a ray
  int rank_deficient = 0;                        ///< start bases repaired by artificials
  int proximal_steps = 0;                        ///< steps of perturbed linearised problems
  std::chrono::duration<double> linear_time{0};  ///< in linearised problems
  std::chrono::duration<double> time{0};

  Stats& operator+=(const Stats& other);
};
/// Calls visit(name, value) for each of them: counts are ints; times are in seconds, and their names end in "_s".
template <class Visit>
void each(const Stats& stats, Visit visit) {
  visit("iterations", stats.iterations);
  visit("crash_iterations", stats.crash_iterations);
  visit("F_evals", stats.F_evals);
  visit("J_evals", stats.J_evals);
  visit("J_colours", stats.J_colours);
  visit("J_F_evals", stats.J_F_evals);
  visit("factorizations", stats.factorizations);
  visit("krylov_iterations", stats.krylov_iterations);
  visit("pivots", stats.pivots);
  visit("presolved", stats.presolved);
  visit("restarts", stats.restarts);
  visit("gradient_steps", stats.gradient_steps);
  visit("watchdogs", stats.watchdogs);
  visit("unchecked_steps", stats.unchecked_steps);
  visit("chord_steps", stats.chord_steps);
  visit("backtracks", stats.backtracks);
  visit("ray_starts", stats.ray_starts);
  visit("rank_deficient", stats.rank_deficient);
  visit("proximal_steps", stats.proximal_steps);
  visit("linear_time_s", stats.linear_time.count());
  visit("time_s", stats.time.count());
}

/// Why a problem has no solution, in numbers; the message has it in words.
struct Infeasibility {
  /// No point has a natural residual of at most this; 0 where nothing is proven.
  double residual_bound = 0;
  bool within_bounds = false;  ///< only points within the bounds are meant: F may not be defined elsewhere
  /// The certificate that others can check (lcp/judge/refutation.hpp), of the affine rows or of `sums`; null if ranges
  /// of F are the proof.
  std::shared_ptr<const lcp::Refutation> certificate{};
  /// F as sums of terms (ncp/analysis/row_sums.hpp) where terms that are not affine are part of the certificate; or
  /// null.
  std::shared_ptr<const lcp::AffineMcp> sums{};
  Vec multipliers{};  ///< of rows, where they alone led to the proof
};

struct Result {
  Status status = Status::IterationLimit;
  std::string message;  ///< what happened, with names and values
  std::string advice;   ///< what to try when it did not work; empty if solved
  Vec x;                ///< the best point met, in the box; the start if nothing better was met
  Vec F;                ///< F(x)
  Residual residual;    ///< of x, by the judge
  /// The largest r_i / t_i, and its row i: the residual of a row relative to the size of its terms
  /// (lcp/judge/judge.hpp). NaN and -1 if J is not defined.
  double relative = std::numeric_limits<double>::quiet_NaN();
  Index relative_row = -1;
  Infeasibility proof{};             ///< if status == Infeasible
  std::vector<std::string> notes{};  ///< what a solution to the tolerance leaves to be said; with names and values
  std::vector<lcp::Cell> basis{};    ///< PathSearch: of the last linearised problem solved; empty if there was none
  Stats stats;
  bool solved() const { return status == Status::Solved; }
  /// Returns whether the problem is solved, to the tolerance or to rounding.
  bool accepted() const { return solved() || status == Status::SolvedToRounding; }
};
/// Calls visit(name, value) for what a result says, as C, Python and JSON have it: a new field is a line here. R is
/// Result or const Result; values that are its members may be moved from.
template <class R, class Visit>
void each(R& result, Visit visit) {
  visit("status", to_string(result.status));
  visit("success", result.solved());
  visit("message", result.message);
  visit("advice", result.advice);
  visit("x", result.x);
  visit("F", result.F);
  visit("residual", result.residual.natural);
  visit("worst", result.residual.worst);
  visit("relative", result.relative);
  visit("relative_row", result.relative_row);
  if (result.proof.residual_bound > 0) visit("residual_bound", result.proof.residual_bound);
  visit("notes", result.notes);
  if (!result.basis.empty()) visit("basis", result.basis);
}
/// Writes one line: status, residual with the index of the worst equation, iterations, message.
std::ostream& operator<<(std::ostream&, const Result&);

}  // namespace perp::ncp

#pragma once
/// What a solve answers: a status, a message a person can act on, the best point, its judgement, and statistics.
#include <chrono>
#include <iosfwd>
#include <limits>
#include <string>
#include <vector>

#include "lcp/pivoting/lemke.hpp"
#include "lcp/status.hpp"
#include "ncp/problem/mcp.hpp"
#include "ncp/problem/residual.hpp"

namespace perp::ncp {

using perp::Status;
using perp::to_string;

/// Of the method and its escapes; what check_jacobian evaluates is not counted, nor the J at x for Result::relative.
struct Stats {
  int iterations = 0;        ///< major: a linearised problem each
  int crash_iterations = 0;  ///< PathSearch: projected Newton steps, which are no major iterations
  int F_evals = 0;
  int J_evals = 0;
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

struct Result {
  Status status = Status::IterationLimit;
  std::string message;  ///< what happened, with names and values
  std::string advice;   ///< what to try when it did not work; empty if solved
  Vec x;                ///< the best point met, in the box; the start if nothing better was met
  Vec F;                ///< F(x)
  Residual residual;    ///< of x, by the judge
  /// max_i r_i / t_i, the residual of a row beside the terms it is the rest of (lcp/judge/judge.hpp), and that row; NaN
  /// and -1 where J is not defined.
  double relative = std::numeric_limits<double>::quiet_NaN();
  Index relative_row = -1;
  std::vector<std::string> notes{};  ///< what a solution to the tolerance leaves to be said; with names and values
  std::vector<lcp::Cell> basis{};    ///< PathSearch: of the last linearised problem solved; empty if there was none
  Stats stats;
  bool solved() const { return status == Status::Solved; }
  /// Solved, to the tolerance or to rounding.
  bool accepted() const { return solved() || status == Status::SolvedToRounding; }
};
/// One line: status, residual with the worst equation's index, iterations, message.
std::ostream& operator<<(std::ostream&, const Result&);

}  // namespace perp::ncp

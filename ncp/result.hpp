#pragma once
/// What a solve answers: a status, a message a person can act on, the best point, its judgement, and statistics.
#include <chrono>
#include <iosfwd>
#include <string>
#include <string_view>

#include "ncp/mcp.hpp"
#include "ncp/residual.hpp"

namespace perp::ncp {

enum class Status {
  Solved,           ///< the natural residual is at most the tolerance
  StationaryPoint,  ///< the gradient of the merit function vanished, the residual did not
  NoProgress,       ///< steps became too short to change x
  IterationLimit,
  TimeLimit,
  Interrupted,          ///< an observer asked to stop
  EvaluationFailed,     ///< F or J is not defined at the start, or at every point tried
  LinearAlgebraFailed,  ///< out of memory, or no direction could be computed
  Infeasible,           ///< proven to have no solution; the message says how
  NotApplicable,        ///< the problem is outside what the method is defined for
  SubproblemFailed,     ///< the linearised problem could not be solved, however regularised
};
std::string_view to_string(Status);  ///< "Solved", "StationaryPoint", ...

/// Of the method and its escapes; what check_jacobian evaluates is not counted.
struct Stats {
  int iterations = 0;
  int F_evals = 0;
  int J_evals = 0;
  int factorizations = 0;
  int pivots = 0;
  std::chrono::duration<double> time{0};
};

struct Result {
  Status status = Status::IterationLimit;
  std::string message;  ///< what happened, with names and values
  std::string advice;   ///< what to try when it did not work; empty if solved
  Vec x;                ///< the best point met, in the box; the start if nothing better was met
  Vec F;                ///< F(x)
  Residual residual;    ///< of x, by the judge
  Stats stats;
  bool solved() const { return status == Status::Solved; }
};
/// One line: status, residual with the worst equation's index, iterations, message.
std::ostream& operator<<(std::ostream&, const Result&);

}  // namespace perp::ncp

#include "ncp/run/result.hpp"

#include <ostream>

namespace perp::ncp {

std::string_view to_string(Status status) {
  switch (status) {
    case Status::Solved:
      return "Solved";
    case Status::SolvedToRounding:
      return "SolvedToRounding";
    case Status::StationaryPoint:
      return "StationaryPoint";
    case Status::NoProgress:
      return "NoProgress";
    case Status::IterationLimit:
      return "IterationLimit";
    case Status::TimeLimit:
      return "TimeLimit";
    case Status::Interrupted:
      return "Interrupted";
    case Status::EvaluationFailed:
      return "EvaluationFailed";
    case Status::LinearAlgebraFailed:
      return "LinearAlgebraFailed";
    case Status::OutOfMemory:
      return "OutOfMemory";
    case Status::Infeasible:
      return "Infeasible";
    case Status::NotApplicable:
      return "NotApplicable";
    case Status::Unbounded:
      return "Unbounded";
    case Status::SubproblemFailed:
      return "SubproblemFailed";
  }
  return "?";
}

Stats& Stats::operator+=(const Stats& other) {
  for (int Stats::*count :
       {&Stats::iterations, &Stats::crash_iterations, &Stats::F_evals, &Stats::J_evals, &Stats::factorizations,
        &Stats::krylov_iterations, &Stats::pivots, &Stats::presolved, &Stats::restarts, &Stats::gradient_steps,
        &Stats::watchdogs, &Stats::unchecked_steps, &Stats::chord_steps, &Stats::backtracks, &Stats::ray_starts,
        &Stats::rank_deficient, &Stats::proximal_steps})
    this->*count += other.*count;
  linear_time += other.linear_time;
  time += other.time;
  return *this;
}

std::ostream& operator<<(std::ostream& out, const Result& result) {
  return out << to_string(result.status) << ", natural residual " << result.residual.natural << " after "
             << result.stats.iterations << " iterations: " << result.message;
}

}  // namespace perp::ncp

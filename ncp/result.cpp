#include "ncp/result.hpp"

#include <ostream>

namespace perp::ncp {

std::string_view to_string(Status status) {
  switch (status) {
    case Status::Solved:
      return "Solved";
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
    case Status::Infeasible:
      return "Infeasible";
    case Status::NotApplicable:
      return "NotApplicable";
    case Status::SubproblemFailed:
      return "SubproblemFailed";
  }
  return "?";
}

std::ostream& operator<<(std::ostream& out, const Result& result) {
  return out << to_string(result.status) << ", natural residual " << result.residual.natural << " after "
             << result.stats.iterations << " iterations: " << result.message;
}

}  // namespace perp::ncp

#include "lcp/status.hpp"

#include <ostream>

namespace perp {

std::string_view to_string(Status status) {
  switch (status) {
    case Status::Solved:
      return "Solved";
    case Status::SolvedToRounding:
      return "SolvedToRounding";
    case Status::Infeasible:
      return "Infeasible";
    case Status::StationaryPoint:
      return "StationaryPoint";
    case Status::NoProgress:
      return "NoProgress";
    case Status::Stalled:
      return "Stalled";
    case Status::Ray:
      return "Ray";
    case Status::Unbounded:
      return "Unbounded";
    case Status::Singular:
      return "Singular";
    case Status::LinearAlgebraFailed:
      return "LinearAlgebraFailed";
    case Status::SubproblemFailed:
      return "SubproblemFailed";
    case Status::EvaluationFailed:
      return "EvaluationFailed";
    case Status::NotApplicable:
      return "NotApplicable";
    case Status::IterationLimit:
      return "IterationLimit";
    case Status::TimeLimit:
      return "TimeLimit";
    case Status::Interrupted:
      return "Interrupted";
    case Status::OutOfMemory:
      return "OutOfMemory";
  }
  return "?";
}

std::ostream& operator<<(std::ostream& out, Status status) { return out << to_string(status); }

}  // namespace perp

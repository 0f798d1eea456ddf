// SPDX-License-Identifier: Apache-2.0
#include "lcp/status.hpp"

#include <ostream>

#include "lcp/words.hpp"

namespace perp {

std::string_view to_string(Status status) {
  using enum Status;
  static constexpr std::pair<Status, std::string_view> words[] = {{Solved, "Solved"},
                                                                  {SolvedToRounding, "SolvedToRounding"},
                                                                  {Infeasible, "Infeasible"},
                                                                  {StationaryPoint, "StationaryPoint"},
                                                                  {NoProgress, "NoProgress"},
                                                                  {Stalled, "Stalled"},
                                                                  {Ray, "Ray"},
                                                                  {Unbounded, "Unbounded"},
                                                                  {Singular, "Singular"},
                                                                  {LinearAlgebraFailed, "LinearAlgebraFailed"},
                                                                  {SubproblemFailed, "SubproblemFailed"},
                                                                  {EvaluationFailed, "EvaluationFailed"},
                                                                  {NotApplicable, "NotApplicable"},
                                                                  {IterationLimit, "IterationLimit"},
                                                                  {TimeLimit, "TimeLimit"},
                                                                  {Interrupted, "Interrupted"},
                                                                  {OutOfMemory, "OutOfMemory"}};
  return word_of(status, words);
}

std::ostream& operator<<(std::ostream& out, Status status) { return out << to_string(status); }

}  // namespace perp

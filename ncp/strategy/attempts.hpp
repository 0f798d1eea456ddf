// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Lists of attempts: what is tried, from where and when, until an attempt does not get stuck. Private to ncp/.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ncp/strategy/strategies.hpp"

namespace perp::ncp {

/// Where an attempt starts.
enum class From {
  Start,    ///< the user's
  Best,     ///< the best point so far
  Origin,   ///< the point of the box nearest to 0
  UnitBox,  ///< a generic point of the unit box next to that
};

struct Attempt {
  std::string name;  ///< its first record says it
  std::string what;  ///< as in strategies: "scaled(path)"
  /// Goes on from a point whose F and J are known, until the run ends.
  std::function<void(Run&, Point)> go;
  From from = From::Start;
  std::string when{};  ///< in words, if not always
  /// Looks at the user's start. Empty: always.
  std::function<bool(Run&, const Point&)> worthwhile{};
  bool counted = true;  ///< against the limit of restarts
};

struct Tried {
  std::vector<const Attempt*> attempts;
  std::vector<Run::Verdict> verdicts;  ///< of those that got stuck
};

/// The attempts in their order, after those tried already, until one does not get stuck or the limit of restarts is
/// met. The list outlives `tried`.
void in_turn(Run& run, const Point& start, const std::vector<Attempt>& list, int restart_limit, Tried& tried);

/// The verdict of a run that is stuck, with what is known about its best point.
Run::Verdict with_diagnosis(Run& run, Run::Verdict verdict, In start);

/// Of the iterations and evaluations left: half, or all where that is few or nothing follows.
Share part_of_left(const Run& run, bool last);

/// For a run within this one: PathSearch with what this one leaves of the pivots.
Method with_pivots_left(const Run& run, Method method);

/// The linear methods within the run: one iteration of it, whatever their pivots.
Result linear_methods(Run& run, In x0, const Share& share);

/// The method's loop, in the run itself.
Attempt loop_attempt(std::string name, Method method, From from = From::Start);
/// The same from the start, on the problem scaled by what `factors` gives when it is the attempt's turn.
Attempt scaled_attempt(std::string name, Method method, std::string when,
                       std::function<std::optional<Scaling>(Run&, const Point&)> factors);

/// Where J is block triangular: the blocks one after the other, several together as long as that goes well, by the
/// method without its crash. Blocks with inequalities are complementarity problems of their own.
Attempt block_attempt(const PathSearch& method);

std::vector<Attempt> path_list(const PathSearch& method);      ///< before restarts
std::vector<Attempt> path_restarts(const PathSearch& method);  ///< after those, if all are stuck
std::vector<Attempt> auto_list(const Auto& method);
std::vector<Attempt> first_list(const StrategyNode& node);

}  // namespace perp::ncp

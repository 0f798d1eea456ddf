#pragma once
/// The methods' entry points behind solve(); private to ncp/.
#include <functional>
#include <optional>
#include <vector>

#include "ncp/run.hpp"
#include "ncp/scaling.hpp"
#include "ncp/solve.hpp"

namespace perp::ncp {

using RunMethod = std::function<Result(const Mcp&, In x0, const Method&, const Observer&)>;

Result run_semismooth_newton(const Mcp& mcp, In x0, const SemismoothNewton& method, const Observer& observer);
Result run_min_newton(const Mcp& mcp, In x0, const MinNewton& method, const Observer& observer);
Result run_smoothing(const Mcp& mcp, In x0, const Smoothing& method, const Observer& observer);
Result run_interior_point(const Mcp& mcp, In x0, const InteriorPoint& method, const Observer& observer);
Result run_newton_josephy(const Mcp& mcp, In x0, const NewtonJosephy& method, const Observer& observer);
/// PathSearch with its presolve, on what run_attempts() does: PathSearch with its restarts.
Result run_path(const Mcp& mcp, In x0, const PathSearch& method, const Observer& observer);
Result run_attempts(const Mcp& mcp, In x0, const PathSearch& method, const Observer& observer);
Result run_newton_robinson(const Mcp& mcp, In x0, const NewtonRobinson& method, const Observer& observer);
Result run_auto(const Mcp& mcp, In x0, const Auto& method, const Observer& observer);
Result run_multiroot(const Mcp& mcp, In x0, const Multiroot& method, const Observer& observer);
Result run_affine(const Mcp& mcp, In x0, const Affine& method, const Observer& observer);
/// `method`, as `run` runs it, on the problem scaled by `factors`; the answer is judged on the problem itself.
Result run_scaled(const Mcp& mcp, const Scaling& factors, In x0, const Method& method, const RunMethod& run,
                  const Observer& observer);
/// Factors of J at x; nothing where J is not defined there or they bring no entries together.
std::optional<Scaling> factors_at(Run& run, const Vec& x);
/// A method that is stuck runs again from x0, on the problem scaled by J at the best point and then (rescalings = 2) by
/// J at x0: what is a local minimum of the merit function depends on the units.
Result retry_scaled(const Mcp& mcp, In x0, const Method& method, int rescalings, Result stuck_at, const RunMethod& base,
                    const Observer& observer);

/// Any method, with its proximal escapes where it is stuck.
Result run_with_escapes(const Mcp& mcp, In x0, const Method& method, const Observer& observer);

// The loops alone, within a run that has begun: from `point` until the run ends.
void semismooth_newton(Run& run, const SemismoothNewton& method, Point point);
void min_newton(Run& run, const MinNewton& method, Point point);
void newton_josephy(Run& run, const NewtonJosephy& method, Point point);
void newton_robinson(Run& run, const NewtonRobinson& method, Point point);
/// One attempt, from one start with one set of options; the list of attempts is in restarts.cpp. Fills `basis` with the
/// cells of the last linearised problem that was solved.
void path_search(Run& run, const PathSearch& method, Point point, std::vector<lcp::Cell>& basis);

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What is made of the loops, within a run; private to ncp/.
#include <functional>
#include <optional>
#include <vector>

#include "ncp/run/run.hpp"
#include "ncp/strategy/solve.hpp"
#include "ncp/transforms/scaling.hpp"

namespace perp::ncp {

/// One of the loops.
void run_loop(Run& run, Point point, const Method& method);

/// PathSearch with its restarts.
void path_attempts(Run& run, In x0, const PathSearch& method);
void automatic(Run& run, In x0, const Auto& method);

/// The method's loop from x0: no presolve, restarts, rescalings, escapes.
void run_once(Run& run, In x0, const Method& method);
/// The method as a user gets it.
void run_method(Run& run, In x0, const Method& method);

/// `body` on the presolved problem, with the basis that belongs to its start there; on the problem itself where nothing
/// can be taken out, or where what was taken out leaves the last digits to do.
void run_presolved(Run& run, In x0, const std::vector<lcp::Cell>& basis,
                   const std::function<void(Run&, In, const std::vector<lcp::Cell>&)>& body);
/// `body` on the problem with its equations in the order that lcp::equation_order() finds, if there is another one.
void run_in_order(Run& run, In x0, const Body& body);
/// What the method's options ask for; PathSearch has both in its list of restarts.
Escape escape_of(const Method& method);
int rescalings_of(const Method& method);
/// Of a run that is stuck: proximal escapes with `base`; no more than so many iterations are spent in all.
void escape(Run& run, const Escape& options, int iterations, const Body& base);

/// Whether the run has ended so that something else may help. EvaluationFailed does after a step: the iterates, which
/// may leave the box, ran against the border of the domain.
bool stuck(const Run& run);

/// Factors of J at x; nothing where J is not defined there or they bring no entries together.
std::optional<Scaling> factors_at(Run& run, const Vec& x);
/// What attempts on the scaled problem are called, by where J was taken.
inline constexpr std::string_view scaled_at_best = "rows and columns scaled as at the best point";
inline constexpr std::string_view scaled_at_start = "rows and columns scaled";
/// Of a run that is stuck: `base` again from x0, on the problem scaled by J at the best point and then (rescalings = 2)
/// by J at x0: what is a local minimum of the merit function depends on the units.
void retry_scaled(Run& run, In x0, int rescalings, const Body& base);

}  // namespace perp::ncp

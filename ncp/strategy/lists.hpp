// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The lists of methods that Perp puts together itself, as values: `perp methods --show path`.
#include "ncp/strategy/plan.hpp"

namespace perp::ncp {

/// PathSearch as a user gets it: presolved, then `kernel`, then other options and methods where it is stuck. With
/// restart_limit = 0 the kernel alone, in the problem's units and in its own.
Method path(const PathSearch& kernel = {}, int restart_limit = 20);
/// PATH's algorithm with the restarts that its documentation lists, the first so many of them: perturbed; tested in
/// each iteration; searched along arcs. Presolved as PATH does it.
Method path_documented(const PathSearch& kernel, int restarts);
/// Chooses by size, structure and class of the problem, and goes on to others where it is stuck.
Method automatic(const Stop& stop = {});

/// The method, then on the problem scaled by J at the best point and at the start: what is a local minimum of the merit
/// function depends on the units.
Method with_rescalings(Method method, std::string name);
/// The same with proximal escapes, on the scaled problems and at last on the problem itself.
Method with_escapes(Method method, std::string name);

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Methods as values, and solve(). A method's fields are its options; solve(mcp, x0, method) runs it, and only the
/// judge (ncp/problem/residual.hpp) may call the outcome Solved.
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "ncp/methods/affine_method.hpp"
#include "ncp/methods/interior_point.hpp"
#include "ncp/methods/lmmcp.hpp"
#include "ncp/methods/min_newton.hpp"
#include "ncp/methods/multiroot.hpp"
#include "ncp/methods/semismooth_newton.hpp"
#include "ncp/methods/smoothing.hpp"
#include "ncp/path/newton_josephy.hpp"
#include "ncp/path/newton_robinson.hpp"
#include "ncp/path/path_search.hpp"
#include "ncp/run/observe.hpp"
#include "ncp/run/options.hpp"
#include "ncp/run/result.hpp"
#include "ncp/strategy/auto.hpp"
#include "ncp/strategy/strategy.hpp"

namespace perp::ncp {

using Method = std::variant<Auto, SemismoothNewton, MinNewton, Smoothing, InteriorPoint, NewtonJosephy, NewtonRobinson,
                            PathSearch, Lmmcp, Multiroot, Affine, Strategy>;
std::string_view name(const Method& method);  ///< "semismooth", "josephy", "path", ..., or that of lcp/
/// Describes all options of the method. An option that depends on another one comes after it.
void describe(Method& method, Fields& fields);
/// Returns what is wrong with the options (a tolerance that is not positive, ...), or nothing.
std::optional<std::string> invalid(const Method& method);
/// Returns the PathSearch that the method is, or that it tries (Auto); nullptr otherwise.
const PathSearch* path_of(const Method& method);
PathSearch* path_of(Method& method);
const Stop& stop(const Method& method);
Stop& stop(Method& method);

/// Returns what the method tries, and in which order.
Outline outline(const Method& method);

/// Make a strategy that runs the method on the presolved problem; on the problem scaled by J at the start, if that
/// brings the sizes of the entries of J closer together; or with proximal escapes where the method is stuck.
Strategy presolved(Method method);
Strategy scaled(Method method);
Strategy escaping(Method method, const Escape& escape = {});
/// Makes a strategy that runs one method after the other, from the same start, until one is not stuck. Each but the
/// last may use half of the iterations and evaluations that are left, but always 100 and 1000 if so many are left.
/// Throws std::invalid_argument if `methods` is empty.
Strategy first_of(std::vector<Method> methods);
/// Returns the preset of that name, or the strategy that the text describes (ncp/strategy/strategy.hpp). Throws
/// std::invalid_argument, naming the place of the error.
Method method_of(std::string_view text);

/// Solves the MCP from the projection of x0 on the box. Throws std::invalid_argument for wrong input: what
/// check_input() and invalid(method) refuse, a J that does not keep its pattern, a basis of another size. Every other
/// outcome is a Status with a message.
Result solve(const Mcp& mcp, In x0, const Method& method, const Observer& observer = {});

}  // namespace perp::ncp

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
                            PathSearch, Multiroot, Affine, Strategy>;
std::string_view name(const Method& method);  ///< "semismooth", "josephy", "path", ..., or that of lcp/
/// All options of the method; what depends on another one stands after it.
void describe(Method& method, Fields& fields);
/// Why the options make no sense (a tolerance that is not positive, ...), if they do not.
std::optional<std::string> invalid(const Method& method);
/// The PathSearch that the method is, or tries (Auto); nullptr otherwise.
const PathSearch* path_of(const Method& method);
PathSearch* path_of(Method& method);
const Stop& stop(const Method& method);
Stop& stop(Method& method);

/// What it tries, and in what order.
Outline outline(const Method& method);

/// The method on the presolved problem; on the problem scaled by J at the start, if that brings the entries of J
/// together; with proximal escapes where it is stuck.
Strategy presolved(Method method);
Strategy scaled(Method method);
Strategy escaping(Method method, const Escape& escape = {});
/// One method after the other, from the same start, until one is not stuck; each but the last gets half of the
/// iterations and evaluations left, at least 100 and 1000. Throws std::invalid_argument if there is none.
Strategy first_of(std::vector<Method> methods);
/// The preset of that name, or a strategy in words (ncp/strategy/strategy.hpp). Throws std::invalid_argument, naming
/// the place.
Method method_of(std::string_view text);

/// Solves the MCP from x0 (projected onto the box first). Throws std::invalid_argument for input that is no problem:
/// see check_input(), a J that does not keep its pattern, a basis of another size, and invalid(method). Everything else
/// is a Status with a message.
Result solve(const Mcp& mcp, In x0, const Method& method, const Observer& observer = {});

}  // namespace perp::ncp

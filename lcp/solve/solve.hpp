// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The methods for the affine MCP as values, and solve(), which runs one of them or lets Auto choose.
#include <span>
#include <string_view>
#include <variant>

#include "lcp/iterative/interior_point.hpp"
#include "lcp/iterative/projected_sor.hpp"
#include "lcp/judge/result.hpp"
#include "lcp/pivoting/block_pivoting.hpp"
#include "lcp/pivoting/lemke.hpp"
#include "lcp/pivoting/lemke_howson.hpp"
#include "lcp/pivoting/principal_pivoting.hpp"
#include "lcp/qp/bound_qp.hpp"
#include "lcp/solve/enumeration.hpp"

namespace perp::lcp {

/// Lemke's method (lcp/pivoting/lemke.hpp) from a ray or, with options.start = Regular, from the given start. By
/// default the covering vector is e, as in textbooks. If the path ends in a ray with a checked certificate, the status
/// is Infeasible.
struct Lemke {
  LemkeOptions options{.start = LemkeStart::Ray, .cover = Cover::Ones};
};
void describe(Lemke& method, Fields& fields);

/// Chooses methods from the structure of M (lcp/classes/classify.hpp) and tries them in turn until one solves the
/// problem or proves it infeasible; Result::message says which and why. The order:
///  * symmetric M not known to be indefinite: block pivoting for small n, the QP for large n;
///  * P-matrices and M-matrices: block pivoting, component by component where M is reducible;
///  * monotone M: Lemke's method with about n pivots at most, interior points, Lemke's method to its end;
///  * anything else: Lemke's method with several covering vectors; enumeration of all cells where there are few;
///    Lemke and Howson's paths; block pivoting.
struct Auto {
  unsigned seed = 1;  ///< of the covering vectors tried after the first
};
void describe(Auto& method, Fields& fields);

using Method = std::variant<Auto, Lemke, LemkeHowson, PrincipalPivoting, BlockPivoting, ProjectedSor, InteriorPoint,
                            BoundQp, Enumeration>;

/// Runs the method from `start` (methods that need none ignore it), with the equations of free variables in the order
/// that equation_order() finds. Throws std::invalid_argument for malformed input. Out of memory,
/// std::bad_alloc leaves solve(), and objects may only be destroyed; limits are looked at between two factorizations.
Result solve(const AffineMcp& problem, In start, const Method& method = Auto{}, const Limits& limits = {});

struct MethodEntry {
  std::string_view name;       ///< "auto", "lemke", ...
  std::string_view what;       ///< one line
  std::string_view reference;  ///< author and year
  Method method;               ///< with its default options
};
/// Returns all methods. Auto is the first.
std::span<const MethodEntry> methods();
std::string_view name(const Method& method);

Result lemke_method(const AffineMcp& problem, In start, const Lemke& method, const Limits& limits = {});
Result automatic(const AffineMcp& problem, In start, const Auto& method, const Limits& limits = {});

}  // namespace perp::lcp

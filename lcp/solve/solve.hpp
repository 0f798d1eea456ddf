// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The methods for the affine MCP as values, and solve(), which runs one of them or lets Auto choose.
#include <span>
#include <string_view>
#include <variant>
#include <vector>

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

struct Attempt;

/// Runs the attempts of a list in turn until one solves the problem or proves it infeasible; Result::message says which
/// and why.
struct Auto {
  Auto();  ///< the default list; here, Attempt is incomplete
  std::vector<Attempt> list;
};
/// An option reaches every method of the list that has it and whose value the list has not itself made another one.
void describe(Auto& method, Fields& fields);

using Method = std::variant<Auto, Lemke, LemkeHowson, PrincipalPivoting, BlockPivoting, ProjectedSor, InteriorPoint,
                            BoundQp, Enumeration>;

/// When an attempt has its turn: what is known of the box and of the class of M (lcp/classes/classify.hpp).
enum class Condition {
  FewRows,    ///< n <= 100
  Large,      ///< more than 2000: multigrid costs less than block pivoting's steps
  Pivotable,  ///< up to 20,000: Lemke's method makes about n pivots
  FewCells,   ///< at most 20 variables have a bound
  Convex,     ///< M is symmetric and not known to be indefinite
  P,          ///< M is a P-matrix: an M- or H+-matrix, positive definite or by its minors
  Monotone,   ///< M is positive semidefinite
};
/// "n <= 100".
std::string_view words_of(Condition condition);

/// A line of a list.
struct Attempt {
  Method method;
  std::string_view title{};       ///< for people; empty: the method's name
  std::vector<Condition> when{};  ///< all of them hold; empty: always
  /// Lemke's method makes at most so many pivots, and so many more a row: ten times what is usual.
  int pivots = 1000, pivots_a_row = 20;
  std::string_view reason{};  ///< why it stands where it does
  std::string_view worth{};   ///< what the list loses without it, measured: bench/linear_list.cpp
};

/// Runs the method from `start` (methods that need none ignore it), with the equations of free variables in the order
/// that equation_order() finds. Throws std::invalid_argument for malformed input. Out of memory,
/// std::bad_alloc leaves solve(), and objects may only be destroyed; limits are looked at between two factorizations.
Result solve(const AffineMcp& problem, In start, const Method& method = Auto{}, const Limits& limits = {});

/// solve() with the equations in the order given.
Result solve_in_order(const AffineMcp& problem, In start, const Method& method, const Limits& limits);

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

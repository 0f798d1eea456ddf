// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Methods as values: what is tried, on what form of the problem, from where and in which order. In text:
///
///     first(path, on(scaled, smooth), escape(semismooth))
///
/// A method is a kernel, which is one loop with its options, or one of three compositions of methods: On, Escaping and
/// First. Options reach every kernel in every composition (describe()).
#include <concepts>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
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
#include "ncp/run/options.hpp"

namespace perp::ncp {

struct Method;

/// Holds a method as a value. A copy shares it until one of the two is changed.
class Held {
 public:
  Held();
  Held(Method method);  // NOLINT: a method is held wherever one is asked for
  template <class M>
  requires(!std::same_as<M, Held>) Held(M method);  // NOLINT: as any of its kinds
  Method& operator*();
  const Method& operator*() const;
  /// Describes the options of the method; where they are only checked, once for all copies that share them.
  void describe(Fields& fields);

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
};

/// Forms that a problem can be given before a method; its answer is brought back.
enum class Form {
  Presolved,  ///< without what constant rows and columns decide (ncp/transforms/presolve.hpp)
  Scaled,     ///< rows and columns scaled by J at the start (ncp/transforms/scaling.hpp)
  Rescaled,   ///< by J at the best point so far
  Blocks,     ///< the diagonal blocks of a block triangular J one after the other
};

/// Runs the method on another form of the problem; on the problem itself where that changes nothing.
struct On {
  Stop stop{};
  Form form = Form::Presolved;
  Held method{};
  bool enabled = true;  ///< off: on the problem itself
  std::string name{};   ///< for people; empty: "on(presolved, ...)"
};

/// Runs the method and, where it is stuck, proximal escapes with it.
struct Escaping {
  Stop stop{};
  Escape escape{};
  Held method{};
  std::string name{};
};

/// When an entry of a list has its turn.
enum class Condition {
  Affine,
  Nonlinear,
  NotMonotone,    ///< J at the start is not known to be positive semidefinite
  QuasiDefinite,  ///< J at the start has an L S L' with the signs of its rows (lcp/linalg/quasi_definite.hpp)
  Large,          ///< more than 2000 variables
  Symmetric,      ///< J at the start
  Unsymmetric,    ///< J at the start
  UniformP,       ///< F is proven to be a uniform P-function
  Scalable,       ///< scaling by J at the start brings its entries together
  Rescalable,     ///< scaling by J at the best point does
  Triangular,     ///< J is block triangular
  Cold,           ///< no warm basis is given
};
/// "the problem is affine".
std::string_view words_of(Condition condition);

/// Starts of entries.
enum class From {
  Start,    ///< the user's
  Best,     ///< the best point so far
  Origin,   ///< the point of the box nearest to 0
  UnitBox,  ///< a generic point of the unit box next to that
};
/// "from the best point"; empty for Start.
std::string_view words_of(From from);

struct Entry;

/// Runs the entries in turn until one is not stuck. Each but the last may use half of the iterations and evaluations
/// that are left, but always 100 and 1000 if so many are left.
struct First {
  Stop stop{};
  std::vector<Entry> entries{};
  std::optional<int> restart_limit{};  ///< of entries after the first one; empty: all have their turn
  bool tells = false;                  ///< the message says which entries were chosen and why
  bool turns = false;                  ///< all of it is one attempt, whose entries are no restarts
  std::string name{};
};

/// Every method. `solve(mcp, x0, method)` runs it.
struct Method : std::variant<SemismoothNewton, MinNewton, Smoothing, InteriorPoint, NewtonJosephy, NewtonRobinson,
                             PathSearch, Lmmcp, Multiroot, Affine, On, Escaping, First> {
  using variant::variant;
};

template <class M>
requires(!std::same_as<M, Held>) Held::Held(M method) : Held(Method(std::move(method))) {}

struct Entry {
  Held method{};
  std::string_view title{};       ///< for people; empty: the method's name
  std::vector<Condition> when{};  ///< all of them hold; empty: always
  From from = From::Start;
  int pivots = no_limit;      ///< the entry's share of them
  std::string_view reason{};  ///< why it stands where it does
  std::string_view worth{};   ///< what the list loses without it, measured
};

/// Make compositions. first() throws std::invalid_argument if it gets no methods.
Method on(Form form, Method method);
Method escaping(Method method, const Escape& escape = {});
Method first(std::vector<Method> methods);

/// "semismooth", "path", "first(path, on(scaled, smooth))"
std::string name(const Method& method);
/// Reads what name() writes, with the names of presets (ncp/strategy/presets.hpp). Throws std::invalid_argument, naming
/// the place of the error.
Method method_of(std::string_view text);

/// Describes all options of the method. An option that depends on another one comes after it. Of a composition, an
/// option reaches every kernel that has it and whose value the composition has not itself made another one.
void describe(Method& method, Fields& fields);
/// The parts of the method with this name: those that a key "NAME.key" reaches. The method itself is one of them.
std::vector<Method*> parts_named(Method& method, std::string_view name);
/// Returns what is wrong with the options (a tolerance that is not positive, ...), or nothing.
std::optional<std::string> invalid(const Method& method);
/// Returns the first PathSearch in the method, which takes a warm basis; nullptr if it has none.
const PathSearch* path_of(const Method& method);
const Stop& stop(const Method& method);
Stop& stop(Method& method);

/// A line of a method's list, as deep as it is nested.
struct OutlineLine {
  int depth = 0;
  std::string method;
  std::string when;  ///< in words; empty: always
  std::string reason, worth;
};
/// Returns what the method tries, in this order; one line for a kernel.
std::vector<OutlineLine> outline(const Method& method);

}  // namespace perp::ncp

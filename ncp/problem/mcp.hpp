// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The mixed complementarity problem MCP(l, u, F): find x in [l, u] such that for every i
///     l_i < x_i < u_i  =>  F_i(x)  = 0
///     x_i = l_i        =>  F_i(x) >= 0        (free if l_i = u_i)
///     x_i = u_i        =>  F_i(x) <= 0.
/// l = 0, u = +inf is the NCP  0 <= x _|_ F(x) >= 0; infinite bounds on both sides make row i an equation.
/// F: R^n -> R^n, J = F' with a fixed sparsity pattern.
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lcp/affine_mcp.hpp"
#include "lcp/box.hpp"
#include "ncp/problem/differences.hpp"

namespace perp::lcp {
struct Polyhedron;  // lcp/vi/polyhedron.hpp
}

namespace perp::ncp {

using lcp::at;
using lcp::Box;
using lcp::In;
using lcp::Index;
using lcp::infinity;
using lcp::Out;
using lcp::SpMat;
using lcp::Vec;

class Enclosure;
class Expression;
struct Expressions;

/// How J is computed, and at which cost.
struct JacobianWork {
  enum class By { Function, Differences, DualNumbers };
  By by = By::Function;  ///< of the problem's own
  Index colours = 0;     ///< groups of columns that share no row (ncp/problem/colouring.hpp)
  long F_evals = 0;      ///< for J, since the problem was made: at points beside x, or on dual numbers
};

/// A problem. One object may be used by one thread at a time; different objects by different threads.
class Mcp {
 public:
  virtual ~Mcp() = default;

  virtual const Box& box() const = 0;
  /// Returns the pattern of J, n x n and compressed. It stays the same for the whole life of the object; its values
  /// have no meaning.
  virtual const SpMat& jacobian_pattern() const = 0;
  /// Computes F(x), with n rows. Returns false if F is not defined at x. Rows that are known to be undefined may be set
  /// to NaN; messages then name them.
  virtual bool eval(In x, Out F) const = 0;
  /// Fills in the values J_ij = dF_i/dx_j. J comes in with jacobian_pattern(). Returns false if J is not defined at x.
  virtual bool jacobian(In x, SpMat& J) const = 0;

  /// Promises, if true, that F(x) = F(0) + J x on all of R^n, with one matrix J.
  virtual bool is_affine() const { return affine() != nullptr; }
  /// Returns M and q of a problem that keeps them, F(x) = M x + q; they live as long as the problem. Null: it keeps
  /// none, though is_affine() may hold.
  virtual const lcp::AffineMcp* affine() const { return nullptr; }
  /// Tells which entries of J are constant, with one flag for each nonzero of jacobian_pattern(), in its order. A flag
  /// at (i, j) promises that there is one number J_ij such that F_i(x) - J_ij x_j does not depend on x_j, wherever F_i
  /// is defined. A row is affine on all of R^n if all of its entries have the flag, or if it has no entries. An empty
  /// vector promises nothing. If is_affine(), all entries are constant.
  virtual std::vector<bool> linear_entries() const;

  /// Ranges of F and J over boxes (ncp/interval/enclosure.hpp), for proofs; they live as long as the problem. Null: the
  /// problem has none.
  virtual const Enclosure* enclosure() const { return nullptr; }
  /// F written down (ncp/interval/expression.hpp), for .nl files. Nothing: the problem cannot.
  virtual std::optional<Expressions> expressions() const;

  /// C, where the problem is that with multipliers of a variational inequality over C (ncp/problem/lifted_vi.hpp): the
  /// first C.size() unknowns are x, the next ones lambda, and F_x at lambda = 0 is F(x). Null: it is none.
  virtual const lcp::Polyhedron* polyhedron() const { return nullptr; }

  /// Tells who computes J.
  virtual JacobianWork jacobian_work() const { return {}; }

  virtual std::string name() const { return "mcp"; }
  /// Return names for messages: "x[1]" and "F[1]", counted from 1, unless the problem has names of its own.
  virtual std::string variable_name(Index i) const;
  virtual std::string equation_name(Index i) const;

  Index size() const { return box().size(); }
};

/// A problem made of functions.
struct Functions {
  std::string name = "mcp";
  Box box;
  SpMat pattern{};                            ///< n x n; every entry that can be nonzero. None, without J: all
  std::function<bool(In x, Out F)> F;         ///< as Mcp::eval
  std::function<bool(In x, SpMat& J)> J{};    ///< as Mcp::jacobian; none: by differences of F
  std::vector<std::string> variable_names{};  ///< empty, or n names
  std::vector<std::string> equation_names{};  ///< empty, or n names
  bool affine = false;                        ///< as Mcp::is_affine
  std::vector<bool> linear_entries{};         ///< as Mcp::linear_entries: empty, or one flag a nonzero of the pattern
  DifferenceFormula differences{};            ///< without J: one evaluation of F a colour of the pattern, or two
  /// F on expressions (ncp/interval/expression.hpp), of which the pattern has every variable a row mentions; with it
  /// the problem has ranges, up to `most_enclosed` variables, and can be written as .nl file. Or none.
  std::function<bool(std::span<const Expression> x, std::span<Expression> F)> expression{};
};
/// Variables up to which problems of functions have ranges: writing them down costs memory, a node an operation.
inline constexpr Index most_enclosed = 5000;
/// Throws std::invalid_argument if F is missing, the sizes of box, pattern, names and flags differ, or J is missing
/// where entries are promised to be constant: differences are not exact.
std::unique_ptr<Mcp> make_mcp(Functions functions);

/// The problem as functions, from which another one can be made; it outlives them. They have no names.
Functions functions_of(const Mcp& mcp);

/// Returns the full n x n pattern, for small dense problems.
SpMat dense_pattern(Index n);

/// Throws std::invalid_argument, naming variables and values, if the box is none (lower > upper, NaN, an infinity on
/// the wrong side), the pattern is not n x n, or x0 has not n finite entries.
void check_input(const Mcp& mcp, In x0);

/// Comparison of J with central differences of F at x.
struct JacobianCheck {
  double worst = 0;  ///< largest |J_ij - D_ij| / max(1, |J_ij|, |D_ij|) over the columns compared
  Index row = -1;    ///< its place; -1 if there is none
  Index col = -1;
  double given = 0;              ///< J_ij there
  double difference = 0;         ///< D_ij there
  bool outside_pattern = false;  ///< D_ij is nonzero where the pattern has no entry
  bool defined = true;           ///< false: F or J is not defined at x, or at no point near it
  Index columns = 0;             ///< compared
};
/// Compares J with D_.j = (F(x + h e_j) - F(x - h e_j)) / 2h, h = step * max(1, |x_j|). The difference is one-sided if
/// F is not defined on one side. If an entry does not match, 100 h, h / 100 and h / 10^4 are tried too, and the closest
/// quotient counts, because rounding and curvature are no mismatch. All rows are compared, so entries that the pattern
/// lacks are found. A column costs 2 evaluations, or 8 if it does not match. With `max_columns` < n only so many
/// columns are compared, spread evenly. Throws std::invalid_argument if x has not n entries or J does not keep its
/// pattern.
JacobianCheck check_jacobian(const Mcp& mcp, In x, double step = 1e-6, Index max_columns = -1);
/// Returns a sentence that names the equation and the variable; empty if check.worst <= tol.
std::string describe(const Mcp& mcp, const JacobianCheck& check, double tol = 1e-4);

}  // namespace perp::ncp

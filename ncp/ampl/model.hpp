// SPDX-License-Identifier: Apache-2.0
#pragma once
/// AMPL models: an .nl file (text or binary) as an Mcp, and the .sol file that answers it, through AMPL's own library.
///
/// A square model has n_eqn + n_cc = n_var. A row that complements a variable gives that variable's F; equations pair
/// in order with the variables no row complements (their F is the row minus its right-hand side, and they are free).
/// What is left over - inequality rows, and bounds on variables paired with an equation - are side inequalities, each
/// with an extra variable y:
///     c(x) >= b  becomes  c(x) - b - y >= 0  _|_  y >= 0
/// (c(x) <= b mirrored, a range one of each), so that the Jacobian has no empty column (Munson's form, the AMPL/PATH
/// driver's). Linear rows with the suffix `polyhedron` are A of a variational inequality over {x: b <= A x <= c}
/// instead: the problem is the one with multipliers of theirs (ncp/problem/lifted_vi.hpp), and polyhedron() is that.
/// References: Ferris, Fourer & Gay, SIAM J. Optim. 9 (1999) 991; Gay, "Writing .nl files" (2005).
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ncp/problem/mcp.hpp"

namespace perp::ncp::ampl {

/// Why a file is refused; code() is AMPL's solve_result_num for it.
class ModelError : public std::runtime_error {
 public:
  /// A fault of the model. `parts`: what is wrong with it, if that is more than one thing; what() has all.
  ModelError(int code, const std::string& what, std::vector<std::string> parts = {})
      : std::runtime_error(what), code_(code), parts_(std::move(parts)) {}
  int code() const { return code_; }
  /// Returns at least one.
  std::vector<std::string> parts() const { return parts_.empty() ? std::vector<std::string>{what()} : parts_; }

 private:
  int code_;
  std::vector<std::string> parts_;
};
inline constexpr int inconsistent_bounds = 200;
inline constexpr int bad_file = 500;  ///< unreadable, malformed, truncated, integer variables, unknown functions
inline constexpr int nonsquare = 504;
/// Of AMPL's failures, 500 to 599, our own: the model is sound, and not of the kind or size that the solver takes.
inline constexpr int not_applicable = 590;

/// An MCP read from an .nl file. The first n_var() unknowns are the model's variables in its order, but for auxiliary
/// ones that only stand for the expression of a condition (Pyomo's); the rest are the y of the side inequalities and
/// the multipliers of a polyhedron. Names come from the .col and .row files beside the stub where they exist.
class Model : public Mcp {
 public:
  virtual const Vec& start() const = 0;  ///< the model's initial guess; 0 where it gives none; size() entries
  virtual Index n_var() const = 0;       ///< variables of the model itself that are unknowns
  virtual Index side_inequalities() const = 0;
  virtual bool has_names() const = 0;      ///< all of its rows and variables, from its .row and .col files
  virtual bool has_objective() const = 0;  ///< (ignored: an MCP has none)
  /// Variables of the modeller's that are no unknowns: each stands for the expression of a condition, and `equation`
  /// gives its value. nan where that is not defined.
  struct Computed {
    std::string name, equation;
    double value = 0;
  };
  /// Those at x, the n_var() unknowns; Pyomo's own, NAME.bv and NAME.v of a condition NAME, are left out.
  virtual std::vector<Computed> computed(In x) const = 0;
  /// Parts of the model that are no condition and deserve a second look: sentences without a full stop.
  virtual std::vector<std::string> remarks() const = 0;
  /// Writes STUB.sol: `message`, all variables, of which x has the n_var() unknowns, and solve_result_num. Throws
  /// ModelError if it cannot be written.
  virtual void write_sol(const std::string& message, In x, int solve_result_num) const = 0;
};

/// Reads `path`, with or without its ".nl". Throws ModelError with the file, the line (or byte, in binary files), and
/// the reason. AMPL's library keeps global state: a lock of this module lets any number of models live in different
/// threads.
std::unique_ptr<Model> read_model(const std::string& path);

/// How to have names where messages call rows and variables by their numbers.
inline constexpr const char* advice_on_names =
    "_svar and _scon stand for names that the model's files lack: write them with symbolic_solver_labels=True in "
    "Pyomo, "
    "with option auxfiles rc in AMPL";

/// Writes a .sol file for a model that could not be read as an MCP, so that AMPL hears why: no solution vector.
void write_failed_sol(const std::string& path, const std::string& message, int solve_result_num);

}  // namespace perp::ncp::ampl

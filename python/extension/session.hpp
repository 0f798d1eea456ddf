// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A solve asked for by Python: options, listeners, signals; and the GIL, which is released while the library works.
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "extension/arguments.hpp"
#include "extension/function_mcp.hpp"
#include "ncp/analysis/verify.hpp"
#include "ncp/settings/settings.hpp"

namespace perp::python {

/// What a solve takes beside problem and start.
struct Wishes {
  py::dict options;      ///< of str, bool and numbers
  py::object basis;      ///< None, or n cells
  py::object callback;   ///< None, or called with the row of each iteration; true ends the solve
  py::object log;        ///< None, or called with each line of the log
  bool keep_log = true;  ///< the rows in the result
};

/// One row of the log.
struct LogRow {
  int k, worst;
  double residual, merit, step, prox, mu;
  int pivots, backtracks, F_evals, J_evals;
  bool crash;
  char kind[4], linear[4];  // UTF-32, as numpy's "U1"
};

/// Runs work(stop) without the GIL. Afterwards: the exception of the problem's functions or of a listener, if there
/// was one. KeyboardInterrupt is not thrown but returned, for the best point goes with it; None: there was none.
class Session {
 public:
  /// functions: of the problem, or null.
  Session(const ncp::Mcp& mcp, FunctionMcp* functions, const Wishes& wishes);

  settings::Applied& options() { return options_; }
  std::atomic<bool>* stop() { return &stop_; }
  /// Takes the notes of the options, the basis, and what depends on the size of the problem.
  void prepare(const Vec& x0);
  ncp::Observer observer();
  py::object run(const std::function<void()>& work);
  void tell(const std::string& line);
  const std::vector<LogRow>& rows() const { return rows_; }

 private:
  bool go_on(const ncp::Iteration& it);
  void flush();

  const ncp::Mcp& mcp_;
  FunctionMcp* functions_;
  const Wishes& wishes_;
  settings::Applied options_;
  std::atomic<bool> stop_{false};
  std::vector<LogRow> rows_{};
  std::ostringstream text_{};
  ncp::Observer table_{};
  std::exception_ptr failure_{};  // of a listener
};

void register_log_dtype();

/// (x, F, status, success, message, advice, residual, worst, relative, relative_row, notes, basis, stats, log,
/// verified), what perp.Result is made of, and interrupt.
py::tuple solved(const ncp::Mcp& mcp, FunctionMcp* functions, const Vec& x0, const Wishes& wishes);
py::tuple result_of(ncp::Result result, const FunctionMcp* functions, const std::vector<LogRow>* rows);
/// (unique, x, radius, active, why_not)
py::tuple verified_of(const ncp::Verified& found);
py::dict stats_of(const ncp::Stats& stats, const FunctionMcp* functions);

}  // namespace perp::python

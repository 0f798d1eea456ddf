// SPDX-License-Identifier: Apache-2.0
/// perp_solve().
#include "capi/solve.hpp"

#include <algorithm>
#include <ostream>
#include <streambuf>
#include <string>

#include "capi/guard.hpp"
#include "ncp/path/warm_basis.hpp"
#include "ncp/strategy/solve.hpp"

static_assert(static_cast<int>(perp::lcp::Cell::Fixed) == PERP_FIXED &&
              static_cast<int>(perp::lcp::Cell::Inside) == PERP_INSIDE);

namespace perp::capi {

namespace {

/// Gives each line to the caller.
class LineBuffer final : public std::streambuf {
 public:
  LineBuffer(perp_log log, void* user) : log_(log), user_(user) {}
  void tell(const std::string& line) const { log_(line.c_str(), user_); }

 private:
  int_type overflow(int_type c) override {
    if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
    if (traits_type::to_char_type(c) != '\n') {
      line_ += traits_type::to_char_type(c);
      return c;
    }
    tell(line_);
    line_.clear();
    return c;
  }

  perp_log log_;
  void* user_;
  std::string line_{};
};

/// The callbacks of a solver that are not the problem's.
class Listeners {
 public:
  Listeners(perp_solver& solver, const ncp::Mcp& mcp)
      : solver_(solver), mcp_(mcp), lines_(solver.log, solver.log_user), out_(&lines_) {
    const settings::Output& output = solver.options.settings.output;
    if (solver.log != nullptr && output.table()) table_ = ncp::print_table(out_, mcp, settings::table_options(output));
  }

  void tell(const std::string& line) const {
    if (solver_.log != nullptr) lines_.tell(line);
  }
  ncp::Observer observer() {
    if (!table_ && solver_.progress == nullptr) return {};
    return [this](const ncp::Iteration& it) {
      if (table_) table_(it);
      return solver_.progress == nullptr || go_on(it) ? ncp::Next::Continue : ncp::Next::Stop;
    };
  }

 private:
  bool go_on(const ncp::Iteration& it) const {
    Vec x;
    if (it.x != nullptr && it.problem == &mcp_) x = lcp::project(mcp_.box(), *it.x);
    const perp_iteration told{.struct_size = sizeof(perp_iteration),
                              .k = it.k,
                              .residual = it.residual,
                              .worst = it.worst,
                              .merit = it.merit,
                              .step = it.step,
                              .prox = it.prox,
                              .mu = it.mu,
                              .pivots = it.pivots,
                              .backtracks = it.backtracks,
                              .F_evals = it.F_evals,
                              .J_evals = it.J_evals,
                              .kind = it.kind,
                              .linear = it.linear,
                              .crash = it.crash ? '\1' : '\0',
                              .attempt = it.attempt.c_str(),
                              .n = mcp_.size(),
                              .x = x.size() == mcp_.size() ? x.data() : nullptr};
    return solver_.progress(&told, solver_.progress_user) == 0;
  }

  perp_solver& solver_;
  const ncp::Mcp& mcp_;
  LineBuffer lines_;
  std::ostream out_;
  ncp::Observer table_{};
};

/// Gives the method the basis.
void warm(ncp::Method& method, const perp_solver& solver, const ncp::Mcp& mcp, const Vec& x0) {
  if (solver.basis.empty()) return;
  ncp::PathSearch* path = ncp::path_of(method);
  if (path == nullptr)
    refuse("solver", "its method, " + solver.options.settings.method_name + ", cannot begin with a basis");
  if (static_cast<Index>(solver.basis.size()) != mcp.size())
    refuse("solver", "its basis has " + std::to_string(solver.basis.size()) + " cells, the problem " +
                         std::to_string(mcp.size()) + " variables");
  path->basis = solver.basis;
  ncp::fit_basis(mcp.box(), x0, path->basis);
}

void check_model(const perp_problem& problem, const settings::Settings& settings) {
  if (settings.sideineq == 2 && problem.model != nullptr && problem.model->side_inequalities() > 0)
    refuse("problem", "the model has " + std::to_string(problem.model->side_inequalities()) +
                          " side inequalities, refused by sideineq = 2");
}

std::unique_ptr<perp_result> solved(perp_solver& solver, const perp_problem& problem, const double* x0) {
  const ncp::Mcp& mcp = problem.mcp;
  const StopsHeard heard(solver.stop);
  check_model(problem, solver.options.settings);
  const Vec start = x0 != nullptr ? vector_of(x0, mcp.size(), "x0") : own_start(problem);
  settings::Applied options = solver.options;
  settings::note_limits_of_size(mcp.size(), options);
  ncp::Method& method = options.settings.method;
  warm(method, solver, mcp, start);
  ncp::stop(method).interrupt = &solver.stop;
  Listeners listeners(solver, mcp);
  for (const std::string& note : options.notes) listeners.tell("note: " + note);
  const Watch watch(problem.callbacks, &solver.stop);
  auto made = std::make_unique<perp_result>();
  ncp::Result& result = made->result;
  result = ncp::solve(mcp, start, method, listeners.observer());
  watch.check();
  if (const std::string who = watch.stopped(); !who.empty() && !result.accepted()) {
    result.status = Status::Interrupted;
    result.message = who + ", asked to stop";
    result.advice = "run on from the point returned";
  }
  if (options.settings.verify && result.accepted()) {
    made->verified = ncp::verify(mcp, ncp::stop(method).tol, result);
    watch.check();
    if (!made->verified->unique) result.notes.push_back("not verified: " + made->verified->why_not);
  }
  for (const lcp::Cell cell : result.basis) made->basis.push_back(static_cast<std::int8_t>(cell));
  if (solver.options.settings.output.all) listeners.tell(std::string(to_string(result.status)) + ": " + result.message);
  return made;
}

/// All as usual.
std::unique_ptr<perp_result> solved(const perp_problem& problem, const double* x0) {
  perp_solver usual;
  return solved(usual, problem, x0);
}

}  // namespace

}  // namespace perp::capi

using namespace perp::capi;  // NOLINT(google-build-using-namespace): what follows is the interface of C

int32_t perp_solve(perp_solver* solver, const perp_problem* problem, const double* x0, perp_result** result,
                   perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    require(problem, "problem");
    return solver == nullptr ? solved(*problem, x0) : solved(*solver, *problem, x0);
  });
}

int32_t perp_lcp_int32(int32_t interface_, int64_t n, const int32_t* start, const int32_t* row, const double* value,
                       const double* q, perp_result** result, perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    return solved(*affine_problem(interface_, n, start, row, value, q, nullptr, nullptr), nullptr);
  });
}

int32_t perp_lcp_int64(int32_t interface_, int64_t n, const int64_t* start, const int64_t* row, const double* value,
                       const double* q, perp_result** result, perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    return solved(*affine_problem(interface_, n, start, row, value, q, nullptr, nullptr), nullptr);
  });
}

// SPDX-License-Identifier: Apache-2.0
/// perp_solve() and the functions beside it.
#include "capi/solve.hpp"

#include <algorithm>
#include <limits>
#include <ostream>
#include <streambuf>
#include <string>

#include "capi/describe.hpp"
#include "capi/guard.hpp"
#include "ncp/analysis/certificate.hpp"
#include "ncp/path/warm_basis.hpp"
#include "ncp/settings/session.hpp"

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
    return [this](const ncp::Iteration& it) {
      if (table_) table_(it);
      return solver_.progress == nullptr || go_on(it) ? ncp::Next::Continue : ncp::Next::Stop;
    };
  }

 private:
  bool go_on(const ncp::Iteration& it) const {
    Vec x;
    perp_iteration told = iteration_of(it, mcp_.size());
    if (it.x != nullptr && it.problem == &mcp_) {
      x = lcp::project(mcp_.box(), *it.x);
      told.x = x.data();
    }
    return solver_.progress(&told, solver_.progress_user) == 0;
  }

  perp_solver& solver_;
  const ncp::Mcp& mcp_;
  LineBuffer lines_;
  std::ostream out_;
  ncp::Observer table_{};
};

/// Gives the settings the basis.
void warm(settings::Settings& settings, const perp_solver& solver, const ncp::Mcp& mcp, const Vec& x0) {
  if (solver.basis.empty()) return;
  if (ncp::path_of(settings.method) == nullptr)
    refuse("basis", "method " + solver.options.settings.method_name + " cannot begin with one; auto and path can");
  if (static_cast<Index>(solver.basis.size()) != mcp.size())
    refuse("basis", "has " + std::to_string(solver.basis.size()) + " cells, the problem " + std::to_string(mcp.size()) +
                        " variables");
  settings.basis = solver.basis;
  ncp::fit_basis(mcp.box(), x0, settings.basis);
}

/// Options for this problem, with the basis.
settings::Applied options_for(perp_solver& solver, const perp_problem& problem, const Vec& x0) {
  settings::Applied options = solver.options;
  settings::note_limits_of_size(problem.mcp.size(), options);
  warm(options.settings, solver, problem.mcp, x0);
  return options;
}

/// Once somebody has asked to stop, no callback is called: what a method then says of the problem is not so.
void note_stop(Work& work, ncp::Result& result) {
  work.watch().check();
  const std::string who = work.watch().stopped();
  if (result.accepted() || !*work.stop() || (who.empty() && result.status == Status::Interrupted)) return;
  result.status = Status::Interrupted;
  result.message = who.empty() ? "interrupted" : who + ", asked to stop";
  result.advice = "run on from the point returned";
}

Part solved(Work& work, const perp_problem& problem, const Vec& x0) {
  const ncp::Mcp& mcp = problem.mcp;
  settings::Applied options = options_for(work.solver(), problem, x0);
  Listeners listeners(work.solver(), mcp);
  for (const std::string& note : options.notes) listeners.tell("note: " + note);
  const bool tells_end = options.settings.output.all;
  const settings::Session session{.mcp = mcp,
                                  .x0 = x0,
                                  .settings = std::move(options.settings),
                                  .model = problem.model,
                                  .interrupt = work.stop(),
                                  .observer = listeners.observer()};
  settings::Outcome outcome = work.watch().over([&] { return session.run(); });
  ncp::Result& result = outcome.result;
  note_stop(work, result);
  if (outcome.verified && !outcome.verified->unique)
    result.notes.push_back("not verified: " + outcome.verified->why_not);
  if (tells_end) {
    listeners.tell(std::string(to_string(result.status)) + ": " + result.message);
    for (const std::string& note : result.notes) listeners.tell("note: " + note);
  }
  const std::string certificate = ncp::certificate_json(mcp, result.x, result.proof);
  Part computed = std::make_unique<perp_result>();
  if (problem.model != nullptr)
    for (const auto& [name, equation, value] : problem.model->computed(result.x.head(problem.model->n_var())))
      computed->add(name, value);
  Part part = part_of(std::move(result), problem.callbacks);
  if (certificate != "null") part->add("certificate", certificate);
  Iterations log{.records = std::move(outcome.iterations)};
  for (const ncp::Iteration& it : log.records) log.rows.push_back(iteration_of(it, mcp.size()));
  part->add("log", std::move(log));
  if (!computed->fields.empty()) part->add("computed", std::move(computed));
  if (outcome.verified) part->add("verified", part_of(std::move(*outcome.verified)));
  return part;
}

Part solved_kept(Work& work, const perp_problem& problem, const Vec& x0) {
  perp_solver& solver = work.solver();
  if (!solver.kept) {
    ncp::Method method = solver.options.settings.method;
    ncp::stop(method).interrupt = work.stop();
    solver.kept.emplace(std::move(method));
  }
  ncp::Result result = solver.kept->solve(problem.mcp, x0);
  note_stop(work, result);
  Part part = part_of(std::move(result), problem.callbacks);
  part->add("kept_by", ncp::to_string(solver.kept->by()));
  return part;
}

Part all_solved(Work& work, const perp_problem& problem, const Vec& x0, std::int64_t solutions) {
  constexpr std::int64_t most_solutions = std::numeric_limits<int>::max();
  if (solutions < 1 || solutions > most_solutions)
    refuse("solutions", std::to_string(solutions) + " is not within 1 and " + std::to_string(most_solutions));
  Listeners listeners(work.solver(), problem.mcp);
  settings::Session session{.mcp = problem.mcp,
                            .x0 = x0,
                            .settings = options_for(work.solver(), problem, x0).settings,
                            .model = problem.model,
                            .interrupt = work.stop(),
                            .observer = listeners.observer()};
  session.settings.solutions = static_cast<int>(solutions);
  session.settings.verify = false;
  ncp::AllSolutions all = *session.run().several;
  note_stop(work, all.first);
  return part_of(std::move(all), problem.callbacks);
}

}  // namespace

ncp::Vec start_of(const perp_problem& problem, const double* x0, const char* argument) {
  return x0 != nullptr ? vector_of(x0, problem.mcp.size(), argument) : own_start(problem);
}

}  // namespace perp::capi

using namespace perp::capi;  // NOLINT(google-build-using-namespace): what follows is the interface of C

int32_t perp_solve(perp_solver* solver, const perp_problem* problem, const double* x0, perp_result** result,
                   perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    require(problem, "problem");
    Work work(solver, problem->callbacks);
    return solved(work, *problem, start_of(*problem, x0, "x0"));
  });
}

int32_t perp_solve_kept(perp_solver* solver, const perp_problem* problem, const double* x0, perp_result** result,
                        perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    require(solver, "solver");
    require(problem, "problem");
    Work work(solver, problem->callbacks);
    return solved_kept(work, *problem, start_of(*problem, x0, "x0"));
  });
}

int32_t perp_solve_all(perp_solver* solver, const perp_problem* problem, const double* x0, int64_t solutions,
                       perp_result** result, perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    require(problem, "problem");
    Work work(solver, problem->callbacks);
    return all_solved(work, *problem, start_of(*problem, x0, "x0"), solutions);
  });
}

int32_t perp_lcp(int32_t interface_, const perp_matrix* M, const double* q, perp_result** result, perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    const std::unique_ptr<perp_problem> problem = affine_problem(interface_, M, q, nullptr, nullptr);
    Work work(nullptr);
    return solved(work, *problem, own_start(*problem));
  });
}

// SPDX-License-Identifier: Apache-2.0
#include "app/report/bounded_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <mutex>
#include <new>
#include <optional>
#include <utility>

#include "app/text/table.hpp"
#include "lcp/memory.hpp"

namespace perp::app {

namespace {

/// What loading took is no more told of than this.
constexpr std::chrono::duration<double> worth_telling{0.05};

/// What a run and whoever waits for it share. The run may be left behind: it owns all it uses.
struct Shared {
  std::shared_ptr<const LoadedProblem> problem;
  Settings settings;
  ncp::Observer observer{};
  ncp::Observer table{};

  std::mutex mutex;  // of what follows, and held while observers print
  Clock::time_point begin = Clock::now();
  bool left = false;   // nobody waits any more
  ncp::Result best{};  // the best point so far
  std::vector<ncp::Iteration> iterations{};
  std::optional<Report> judged{};  // of a run whose method is done; more may be told of its solution
  Report report{};                 // of a run that came back

  const ncp::Mcp& mcp() const { return *problem->mcp; }

  void start() {
    const std::lock_guard lock(mutex);
    keep(lcp::project(mcp().box(), problem->x0));
  }

  /// The observer of the run.
  ncp::Next see(const ncp::Iteration& it) {
    const std::lock_guard lock(mutex);
    if (left) return ncp::Next::Stop;
    if (table) table(it);
    iterations.push_back(it);
    iterations.back().x = nullptr;
    iterations.back().problem = nullptr;
    iterations.back().way = nullptr;
    best.stats.iterations = it.k;
    best.stats.F_evals = it.F_evals;
    best.stats.J_evals = it.J_evals;
    best.stats.pivots += it.pivots;
    if (it.x != nullptr && it.problem == &mcp()) keep(lcp::project(mcp().box(), *it.x));
    return observer ? observer(it) : ncp::Next::Continue;
  }

  void judge(const Report& found) {
    const std::lock_guard lock(mutex);
    judged = found;
  }

  int iterations_so_far() {
    const std::lock_guard lock(mutex);
    return best.stats.iterations;
  }

  void keep(ncp::Vec x) {
    ncp::Vec F(x.size());
    if (!mcp().eval(x, F)) return;
    const ncp::Residual residual = ncp::residual(mcp().box(), x, F);
    if (best.x.size() > 0 && !(residual.natural < best.residual.natural)) return;
    best.x = std::move(x);
    best.F = std::move(F);
    best.residual = residual;
  }
};

/// Why a run has no report of its own.
struct CutShort {
  ncp::Status status;
  std::string message, advice;
};

CutShort left_behind(GivenUp why, int iterations) {
  const bool interrupted = why == GivenUp::Interrupted;
  return {interrupted ? ncp::Status::Interrupted : ncp::Status::TimeLimit,
          fmt::format("{} {}, in a phase that did not end within 0.2 s",
                      interrupted ? "interrupted after" : "the time limit was reached in iteration",
                      interrupted ? count(iterations, "iteration") : std::to_string(iterations + 1)),
          interrupted ? "run on from the point returned" : "raise the time limit"};
}

CutShort out_of_memory(const std::bad_alloc& error) {
  const bool says_why = dynamic_cast<const lcp::NotEnoughMemory*>(&error) != nullptr;
  return {ncp::Status::OutOfMemory, says_why ? error.what() : "out of memory",
          "a smaller problem, more memory, or --method semismooth --option linear_solver=krylov"};
}

/// The report of a run that was cut short.
Report report_of_best(Shared& shared, const CutShort& why) {
  const std::lock_guard lock(shared.mutex);
  shared.left = true;
  if (shared.judged) {  // what the judge has said stands, whatever comes after it
    Report report = *shared.judged;
    report.result.notes.push_back(fmt::format("what was asked for beside the solution was not done: {}", why.message));
    return report;
  }
  Report report;
  report.problem = shared.problem.get();
  report.settings = shared.settings;
  report.iterations = shared.iterations;
  report.result = shared.best;
  ncp::Result& result = report.result;
  if (result.x.size() == 0) {
    result.x = lcp::project(shared.mcp().box(), shared.problem->x0);
    result.F = ncp::Vec::Constant(result.x.size(), std::numeric_limits<double>::quiet_NaN());
  }
  result.relative = std::numeric_limits<double>::quiet_NaN();  // not asked for: it takes a Jacobian
  result.status = why.status;
  result.message = why.message + "; this is the best point met until then, the counts are those of the last iteration";
  result.advice = why.advice;
  result.stats.time = Clock::now() - shared.begin;
  return report;
}

}  // namespace

OutOfTime::OutOfTime(GivenUp why, const std::string& what)
    : std::runtime_error(
          fmt::format("{} while {}", why == GivenUp::Interrupted ? "interrupted" : "the time limit was reached", what)),
      why_(why) {}

ncp::Status OutOfTime::status() const {
  return why_ == GivenUp::Interrupted ? ncp::Status::Interrupted : ncp::Status::TimeLimit;
}

std::shared_ptr<const LoadedProblem> load_within(const Patience& patience, std::function<LoadedProblem()> load,
                                                 const std::string& what) {
  const auto loaded = std::make_shared<std::shared_ptr<const LoadedProblem>>();
  const auto given_up = bounded_call(
      [loaded, load = std::move(load)] { *loaded = std::make_shared<const LoadedProblem>(load()); }, patience);
  if (given_up) throw OutOfTime(*given_up, what);
  return *loaded;
}

Report run_within(const Patience& whole, std::shared_ptr<const LoadedProblem> problem, const Settings& settings,
                  ncp::Index written, std::ostream* log, ncp::Observer observer) {
  const auto shared = std::make_shared<Shared>();
  shared->problem = std::move(problem);
  shared->settings = settings;
  shared->observer = std::move(observer);
  if (log != nullptr) shared->table = live_table(*log, shared->mcp(), settings.output);
  std::chrono::duration<double> left = whole.deadline - Clock::now();
  left -= std::min(left / 2, writing_time(written));
  Settings within = settings;
  std::chrono::duration<double>& limit = ncp::stop(within.method).max_time;
  if (left < limit - worth_telling) limit = std::max(left, decltype(left)::zero());
  const auto work = [shared, within = std::move(within), interrupt = whole.interrupt] {
    shared->start();
    ncp::Observer seen = [&s = *shared](const ncp::Iteration& it) { return s.see(it); };
    seen.ways = shared->observer.ways;
    shared->report =
        run_method(*shared->problem, within, interrupt, seen, [&s = *shared](const Report& found) { s.judge(found); });
  };
  Report report;
  try {
    if (const auto given_up = bounded_call(work, patience(left, whole.interrupt)))
      report = report_of_best(*shared, left_behind(*given_up, shared->iterations_so_far()));
    else
      report = std::move(shared->report);
  } catch (const std::bad_alloc& error) {
    report = report_of_best(*shared, out_of_memory(error));
  }
  report.settings = settings;
  return report;
}

std::chrono::duration<double> patience_with_writing(ncp::Index n) {
  constexpr double slow = 10;  // disks, and machines that have other things to do
  return slow * writing_time(n);
}

std::chrono::duration<double> writing_time(ncp::Index n) {
  constexpr std::chrono::duration<double> of_variable{4e-6};
  return static_cast<double>(n) * of_variable;
}

}  // namespace perp::app

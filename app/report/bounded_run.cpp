// SPDX-License-Identifier: Apache-2.0
#include "app/report/bounded_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <mutex>
#include <optional>
#include <utility>

#include "app/text/table.hpp"

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

/// The report of a run that was left behind.
Report report_of_best(Shared& shared, GivenUp why) {
  const std::lock_guard lock(shared.mutex);
  shared.left = true;
  if (shared.judged) {  // what the judge has said stands, whatever comes after it
    Report report = *shared.judged;
    report.result.notes.push_back(
        fmt::format("what was asked for beside the solution was not done {}",
                    why == GivenUp::Interrupted ? "before the interruption" : "within the time limit"));
    return report;
  }
  Report report{.problem = shared.problem.get(), .settings = shared.settings};
  report.iterations = shared.iterations;
  report.result = shared.best;
  ncp::Result& result = report.result;
  if (result.x.size() == 0) {
    result.x = lcp::project(shared.mcp().box(), shared.problem->x0);
    result.F = ncp::Vec::Constant(result.x.size(), std::numeric_limits<double>::quiet_NaN());
  }
  result.relative = std::numeric_limits<double>::quiet_NaN();  // not asked for: it takes a Jacobian
  const bool interrupted = why == GivenUp::Interrupted;
  result.status = interrupted ? ncp::Status::Interrupted : ncp::Status::TimeLimit;
  result.message = fmt::format(
      "{} {}, in a phase that did not end within 0.2 s; this is the best point met until then, the counts are "
      "those of the last iteration",
      interrupted ? "interrupted after" : "the time limit was reached in iteration",
      interrupted ? count(result.stats.iterations, "iteration") : std::to_string(result.stats.iterations + 1));
  result.advice = interrupted ? "run on from the point returned" : "raise the time limit";
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
  const auto given_up = bounded_call(
      [shared, within = std::move(within), interrupt = whole.interrupt] {
        shared->start();
        ncp::Observer seen = [&s = *shared](const ncp::Iteration& it) { return s.see(it); };
        seen.ways = shared->observer.ways;
        Report report = run_method(*shared->problem, within, nullptr, interrupt, seen);
        if (has_more_to_tell(report)) {
          shared->judge(report);
          tell_more(report);
        }
        shared->report = std::move(report);
      },
      patience(left, whole.interrupt));
  if (given_up) {
    Report best = report_of_best(*shared, *given_up);
    best.settings = settings;
    return best;
  }
  Report report = std::move(shared->report);
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

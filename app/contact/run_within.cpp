#include "app/contact/run_within.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <utility>

namespace perp::app::contacts {

namespace {

/// What a run and whoever waits for it share. The run may be left behind: it owns all it uses.
struct Shared {
  std::shared_ptr<const Loaded> loaded;
  std::mutex mutex;
  lcp::Vec best{};  // r
  Run run{};        // one that came back
};

}  // namespace

std::shared_ptr<const Loaded> load_within(const Patience& patience, const std::string& argument) {
  const auto loaded = std::make_shared<std::shared_ptr<const Loaded>>();
  const auto given_up =
      bounded_call([loaded, argument] { *loaded = std::make_shared<const Loaded>(load(argument)); }, patience);
  if (given_up)
    throw OutOfTime(*given_up, fmt::format("'{}' was being {}", argument, is_generated(argument) ? "made" : "read"));
  return *loaded;
}

Run run_within(const Patience& patience, std::shared_ptr<const Loaded> loaded, const Variant& variant,
               const Limits& limits) {
  const Clock::time_point begin = Clock::now();
  const auto shared = std::make_shared<Shared>();
  shared->loaded = std::move(loaded);
  Limits within = limits;
  within.seconds = std::clamp(std::chrono::duration<double>(patience.deadline - begin).count(), 0.0, limits.seconds);
  within.interrupt = patience.interrupt;
  within.better = [&s = *shared](const lcp::Vec& r) {
    const std::lock_guard lock(s.mutex);
    s.best = r;
  };
  const auto given_up = bounded_call(
      [shared, variant, within] { shared->run = contacts::run(shared->loaded->problem, variant, within); }, patience);
  if (!given_up) {
    shared->run.limits = limits;
    return std::move(shared->run);
  }
  Run run{.variant = variant, .limits = limits};
  const bool interrupted = *given_up == GivenUp::Interrupted;
  run.status = interrupted ? "Interrupted" : "TimeLimit";
  run.message = fmt::format("{} in the middle of a phase that looks at no clock; this is the best point met until then",
                            interrupted ? "interrupted" : "the time limit was reached");
  {
    const std::lock_guard lock(shared->mutex);
    run.solution.r = shared->best;
  }
  const contact::Problem& problem = shared->loaded->problem;
  if (run.solution.r.size() == 0) run.solution.r = lcp::Vec::Zero(problem.q.size());
  run.solution.u = contact::velocities(problem, run.solution.r);
  run.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  judge(run, problem);
  return run;
}

}  // namespace perp::app::contacts

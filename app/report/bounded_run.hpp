// SPDX-License-Identifier: Apache-2.0
#pragma once
/// run_method() within its limits, whatever it is doing when they are reached.
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

#include "app/program/bounded_call.hpp"
#include "app/report/report.hpp"

namespace perp::app {

/// The time was over, or somebody asked to end, before there was a point.
class OutOfTime : public std::runtime_error {
 public:
  /// "the time limit was reached while 'm.nl' was being read".
  OutOfTime(GivenUp why, const std::string& what_was_done);
  GivenUp why() const { return why_; }
  ncp::Status status() const;

 private:
  GivenUp why_;
};

/// What `load` loads. Throws what it throws, and OutOfTime where it does not come back; `what`: "'m.nl' was being
/// read".
std::shared_ptr<const LoadedProblem> load_within(const Patience& patience, std::function<LoadedProblem()> load,
                                                 const std::string& what);

/// run_method() with `settings`, whose time limit is what is left of `whole`, less writing_time(written); `written`
/// variables are written to files afterwards. Where the method does not come back from a phase of linear algebra the
/// report is of the best point met: TimeLimit or Interrupted. `observer`, if there is one, is not called any more then.
Report run_within(const Patience& whole, std::shared_ptr<const LoadedProblem> problem, const Settings& settings,
                  ncp::Index written, std::ostream* log, ncp::Observer observer = {});

/// What writing a report of n variables takes at most, by and large: runs end so long before their time limit.
std::chrono::duration<double> writing_time(ncp::Index n);
/// How long a report that is being written is waited for after a limit or a signal: a result is worth more than a
/// second.
std::chrono::duration<double> patience_with_writing(ncp::Index n);

}  // namespace perp::app

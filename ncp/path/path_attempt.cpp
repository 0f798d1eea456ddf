// SPDX-License-Identifier: Apache-2.0
#include "ncp/path/path_attempt.hpp"

#include <optional>
#include <string>
#include <utility>

#include "ncp/path/crash.hpp"
#include "ncp/path/path_steps.hpp"

namespace perp::ncp {
namespace {

/// An iterate beyond this, relative to 1 + |start|, that is no solution has left for infinity.
constexpr double far_away = 1e15;

bool ran_off(Run& run, const Point& point, double start) {
  Index i = 0;
  if (point.x.size() == 0 || point.x.cwiseAbs().maxCoeff(&i) <= far_away * (1 + start)) return false;
  run.end(Status::Unbounded,
          "variable " + run.mcp().variable_name(i) + " has run off to " + number(point.x[i]) + " without a solution",
          "bound it, or look for a mistake in the model: it may have no solution");
  return true;
}

}  // namespace

struct PathAttempt::State {
  State(Run& r, PathSearch&& m, Point&& p)
      : run(r), method(std::move(m)), point(std::move(p)), lu{lcp::SparseLu(lcp::LuBackend::Auto, r.deadline())} {
    lu.lu.reuse_pivots();  // in affine problems, too: their crash is the same one, observed or not
  }

  Run& run;
  PathSearch method;
  Point point;
  lcp::SharedLu lu;  // of J_II
  double start = 0;  // the size of the point after the crash
  bool stalled = false;
  std::optional<PathSteps> steps;  // after the crash

  bool begin(Iteration& it);
  bool resume(Iteration& it);
};

/// The start and the crash. False: the run is over.
bool PathAttempt::State::begin(Iteration& it) {
  it.crash = method.crash.on && run.box().size() >= method.crash.minimum_dimension;
  it.merit = merit(fischer_merit(), run.box(), point.x, point.F);
  if (!run.go_on(point, it)) return false;
  const CrashEnd crashed = crash(run, method.crash, point, it, lu.lu);
  if (crashed == CrashEnd::Over) return false;
  start = point.x.size() > 0 ? point.x.lpNorm<Eigen::Infinity>() : 0;
  steps.emplace(run, method, point, crashed, lu);
  return true;
}

bool PathAttempt::State::resume(Iteration& it) {
  it.merit = steps->merit();
  steps->resume();
  return run.go_on(point, it);
}

PathAttempt::PathAttempt(Run& run, PathSearch method, Point point)
    : state_(std::make_unique<State>(run, std::move(method), std::move(point))) {}
PathAttempt::~PathAttempt() = default;

bool PathAttempt::stalled() const { return state_->stalled; }

void PathAttempt::go_on(int patience) {
  State& s = *state_;
  Iteration it{.k = 0, .kind = 'I', .normal_map = true};
  bool asked = std::exchange(s.stalled, false);  // whether this iteration was stalled, with less patience
  if (!(s.steps ? s.resume(it) : s.begin(it))) return;
  do {
    if (ran_off(s.run, s.point, s.start)) break;
    s.stalled = !std::exchange(asked, false) && s.steps->stalled(patience);
    if (s.stalled) {
      s.run.end(Status::NoProgress, "the merit function has stopped falling", "try another start");
      break;
    }
    if (!s.steps->iterate(it)) {
      s.run.go_on(s.point, it);
      break;
    }
  } while (s.run.go_on(s.point, it));
  s.run.keep_basis(s.steps->basis());
}

void iterate(Run& run, const PathSearch& method, Point point) {
  PathAttempt(run, method, std::move(point)).go_on(method.patience);
}

}  // namespace perp::ncp

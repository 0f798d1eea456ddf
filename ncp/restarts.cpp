/// PathSearch as a user gets it: the attempts in their order, until one solves the problem or the list is at its end.
#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "ncp/diagnosis.hpp"
#include "ncp/merit.hpp"
#include "ncp/methods.hpp"
#include "ncp/proximal.hpp"
#include "ncp/scale_transform.hpp"

namespace perp::ncp {
namespace {

/// Restarts are given up sooner than the attempt with the user's options.
constexpr int restart_patience = 15;

constexpr int escape_rounds = 10;
constexpr int trial_patience = 6;  // of the tries from the points that an escape visits

/// One attempt without crash, warm start and restarts.
PathSearch once(PathSearch method) {
  method.crash.on = false;
  method.basis.clear();
  method.patience = std::min(method.patience, restart_patience);
  method.restart_limit = 0;
  return method;
}

Body loop_of(Method method) {
  return [method = std::move(method)](Run& run, In x0) { run_once(run, x0, method); };
}

/// Where an attempt starts.
enum class From {
  Start,    ///< the user's
  Best,     ///< the best point so far
  Origin,   ///< the point of the box nearest to 0
  UnitBox,  ///< a generic point of the unit box next to that
};

struct Attempt {
  std::string what;
  From from = From::Start;
  std::function<void(Run&, Point)> go;
  std::function<bool(Run&)> worthwhile = [](Run&) { return true; };
};

/// The attempt's first point with F and J; false if they are not defined there, or it is where others began.
bool begin(Run& run, From from, const Point& user, Point& point) {
  point = user;
  if (from == From::Start) return true;
  if (from == From::Best) {
    point.x = run.best();
    if (!run.evaluate(point)) point = user;
    return true;
  }
  point.x = lcp::project(run.box(), Vec::Zero(user.x.size()));
  if (from == From::UnitBox) {
    const Vec h = generic(user.x.size(), 1);
    for (Index i = 0; i < h.size(); ++i) point.x[i] += point.x[i] + h[i] <= run.box().upper[i] ? h[i] : -h[i];
    point.x = lcp::project(run.box(), point.x);
  }
  return point.x != user.x && run.evaluate(point);
}

class Attempts {
 public:
  Attempts(const Mcp& mcp, const Point& start, const PathSearch& method);
  const std::vector<Attempt>& list() const { return list_; }
  /// How many come before the one with the options given.
  std::size_t before_restarts() const { return before_; }

 private:
  void add_path(std::string what, PathSearch method, From from = From::Start) {
    list_.push_back({std::move(what), from, [method = std::move(method)](Run& run, Point point) {
                       path_search(run, method, std::move(point));
                     }});
  }
  void add_semismooth(std::string what, From from, SemismoothNewton method) {
    list_.push_back({std::move(what), from, [method = std::move(method)](Run& run, Point point) {
                       semismooth_newton(run, method, std::move(point));
                     }});
  }
  void add_josephy(std::string what, NewtonJosephy method) {
    list_.push_back({std::move(what), From::Start, [method = std::move(method)](Run& run, Point point) {
                       newton_josephy(run, method, std::move(point));
                     }});
  }
  /// Smoothing, and again on the problem scaled by J where that has got stuck.
  void add_smoothing(std::string what, const Smoothing& method) {
    list_.push_back({what, From::Start, [this, method](Run& run, const Point& point) {
                       const Result result = run.within(run.mcp(), {}, point.x, loop_of(method));
                       smoothed_ = result.x;
                       run.take(result);
                     }});
    add_scaled(std::move(what) + ", rows and columns scaled", method, [this](const Run&) { return smoothed_; });
  }
  void add_escape(std::string what, Method base) {
    list_.push_back({std::move(what), From::Best, [this, base = std::move(base)](Run& run, const Point& point) {
                       const double natural = residual(run.box(), point.x, point.F).natural;
                       const int k = proximal_escape(run, point.x, natural, Escape{.rounds = escape_rounds},
                                                     std::numeric_limits<int>::max(), loop_of(limited(run, base)));
                       if (run.accepted()) run.remark("after " + quantity(k, "proximal escape"));
                       if (!run.ended()) run.end(Status::NoProgress, "proximal escapes do not help", "");
                     }});
  }
  /// From the start on the problem scaled by J at a point that is known when it is the attempt's turn.
  void add_scaled(std::string what, Method base, std::function<Vec(const Run&)> where) {
    list_.push_back({std::move(what), From::Start,
                     [this, base = std::move(base)](Run& run, const Point& point) {
                       run.take(
                           run.within(ScaleTransform(run.mcp(), *factors_), {}, point.x, loop_of(limited(run, base))));
                     },
                     [this, where = std::move(where)](Run& run) {
                       factors_ = factors_at(run, where(run));
                       return factors_.has_value();
                     }});
  }
  void add_affine(std::string what) {
    list_.push_back({std::move(what), From::Start, [](Run& run, const Point& point) {
                       const Affine linear;
                       Result result = run.within(run.mcp(), {.tol = linear.stop.tol}, point.x,
                                                  [&](Run& inner, In x0) { affine(inner, x0, linear); });
                       result.stats.pivots = std::exchange(result.stats.iterations, 1);
                       run.take(result);
                     }});
  }

  /// With what is left of the pivots.
  Method limited(const Run& run, Method method) const {
    if (auto* path = std::get_if<PathSearch>(&method))
      path->cumulative_iteration_limit = std::max(1, method_.cumulative_iteration_limit - run.stats().pivots);
    return method;
  }

  const PathSearch& method_;
  std::vector<Attempt> list_;
  std::size_t before_ = 0;
  Vec smoothed_;                    // where smoothing has got stuck
  std::optional<Scaling> factors_;  // of the attempt that begins
};

Attempts::Attempts(const Mcp& mcp, const Point& start, const PathSearch& method) : method_(method) {
  if (method.scaling)
    if (const Scaling factors = scaling(mcp, start.J); factors.helps())
      add_scaled("rows and columns scaled", method, [x = start.x](const Run&) { return x; });
  before_ = list_.size();
  add_path("the options given", method);
  if (mcp.is_affine()) add_affine("the best of the linear methods");
  PathSearch again = once(method);
  again.proximal_perturbation = 1;
  add_path("proximal perturbation 1", again);
  again.proximal_perturbation = method.proximal_perturbation;
  add_path("from the origin", again, From::Origin);
  add_path("from a point of the unit box", again, From::UnitBox);
  add_scaled("rows and columns scaled as at the best point", again, [](const Run& run) { return run.best(); });
  again.start = PathStart::Always;
  add_path("Newton points from rays", again);
  again.start = method.start;
  again.merit = method.merit == PathMerit::Fischer ? PathMerit::NormalMap : PathMerit::Fischer;
  again.search = method.search == Searchtype::Line ? Searchtype::Path : Searchtype::Line;
  again.nms.initial_reference_factor = 2;
  add_path("the other merit function, another search", again);
  add_semismooth("semismooth Newton", From::Start, {});
  add_josephy("Newton-Josephy", {});
  PathSearch trial = once(method);
  trial.patience = std::min(method.patience, trial_patience);
  add_escape("proximal escape", trial);
  add_smoothing("smoothing", {.function = smoothed_fischer_burmeister(), .restarts = 1});
  add_semismooth("semismooth Newton from the best point", From::Best, {});
  add_semismooth("semismooth Newton on the min function", From::Start, {.cfunction = natural_min()});
  add_escape("proximal escape with semismooth Newton", SemismoothNewton{});
}

/// The verdict of the first attempt, with what is known about the best point of all.
Run::Verdict last_words(Run& run, const Run::Verdict& first, const Point& user, std::size_t restarts) {
  Run::Verdict verdict = first;
  Point best;
  best.x = run.best();
  if (run.evaluate(best)) {
    const Diagnosis known = diagnose(run.mcp(), best, user.x);
    if (known.unbounded) verdict.status = Status::Unbounded;
    if (known.stationary) verdict.status = Status::StationaryPoint;
    if (!known.message.empty()) {
      verdict.message = known.message;
      verdict.advice = known.advice;
    }
  }
  if (restarts > 0)
    verdict.message += "; " + std::to_string(restarts) +
                       " restarts with other options and other methods have not led to a solution either";
  return verdict;
}

}  // namespace

void path_attempts(Run& run, In x0, const PathSearch& method) {
  Point user;
  if (!run.start(x0, user)) return;
  Attempts attempts(run.mcp(), user, method);
  const int restarts = run.stats().restarts;
  std::size_t tried = 0;
  std::optional<Run::Verdict> first;
  std::string last;
  for (const Attempt& attempt : attempts.list()) {
    Point point;
    if (!begin(run, attempt.from, user, point) || !attempt.worthwhile(run)) continue;
    if (tried > 0) run.resume(attempt.what);
    last = attempt.what;
    run.guard([&] { attempt.go(run, std::move(point)); });
    ++tried;
    if (!run.ended() || !stuck(run.status())) break;
    if (!first) first = run.verdict();
    if (tried > attempts.before_restarts() + static_cast<std::size_t>(method.restart_limit)) break;
  }
  run.stats().restarts = restarts + static_cast<int>(tried) - 1;
  const bool at_limit = first && run.ended() && run.status() == Status::IterationLimit;
  if (run.ended() && (stuck(run.status()) || at_limit)) {
    Run::Verdict verdict = last_words(run, *first, user, tried - 1);
    if (at_limit)
      verdict.message +=
          ", the last one ended by the limit of " + quantity(run.iterations() + run.left().max_iterations, "iteration");
    run.replace_verdict(std::move(verdict));
  }
  if (run.ended() && run.status() == Status::Solved && tried > 1) run.remark("after a restart: " + last);
}

}  // namespace perp::ncp

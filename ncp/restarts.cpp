/// PathSearch as a user gets it: the attempts in their order, until one solves the problem or the list is at its end.
#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "ncp/methods.hpp"
#include "ncp/path_search.hpp"
#include "ncp/proximal.hpp"

namespace perp::ncp {
namespace {

struct Attempt {
  std::string what;
  bool from_best = false;  ///< else from the user's start
  std::function<void(Run&, Point)> go;
};

class Attempts {
 public:
  Attempts(const PathSearch& method, const Observer& observer) : method_(method), observer_(observer) {
    add_path("the options given", false, method, 'I');
    add_path("no crash", false, without_crash(method), 'R');
    PathSearch perturbed = without_crash(method);
    perturbed.proximal_perturbation = 0.1;
    add_path("proximal perturbation 0.1", false, perturbed, 'R');
    PathSearch monotone = without_crash(method);
    monotone.merit = method.merit == PathMerit::Fischer ? PathMerit::NormalMap : PathMerit::Fischer;
    monotone.search = method.search == Searchtype::Line ? Searchtype::Path : Searchtype::Line;
    monotone.nms.initial_reference_factor = 2;
    add_path("the other merit function, line search", false, monotone, 'R');
    PathSearch best = without_crash(method);
    best.proximal_perturbation = 0.01;
    add_path("from the best point, proximal perturbation 0.01", true, best, 'R');
    add_other("semismooth Newton", false, semismooth_newton, SemismoothNewton{});
    add_other("Newton-Josephy", false, newton_josephy, NewtonJosephy{});
    add_other("semismooth Newton from the best point", true, semismooth_newton, SemismoothNewton{});
    add_other("semismooth Newton on the min function", false, semismooth_newton,
              SemismoothNewton{.cfunction = natural_min()});
    add_escape("proximal escape with semismooth Newton", SemismoothNewton{});
    add_escape("proximal escape with Newton-Josephy", NewtonJosephy{});
  }

  const std::vector<Attempt>& list() const { return list_; }
  std::vector<lcp::Cell> basis;

 private:
  static PathSearch without_crash(PathSearch method) {
    method.crash.on = false;
    method.basis.clear();
    return method;
  }
  void add_path(std::string what, bool from_best, PathSearch method, char kind) {
    list_.push_back({std::move(what), from_best, [this, method = std::move(method), kind](Run& run, Point point) {
                       path_search(run, method, std::move(point), kind, basis);
                     }});
  }
  template <class Loop, class Other>
  void add_other(std::string what, bool from_best, Loop loop, Other other) {
    list_.push_back(
        {std::move(what), from_best, [loop, other](Run& run, Point point) { loop(run, other, std::move(point)); }});
  }
  template <class Other>
  void add_escape(std::string what, Other other) {
    list_.push_back({std::move(what), false,
                     [this, other](Run& run, Point point) { escape(run, point, Method(other), other.escape); }});
  }
  void escape(Run& run, const Point& point, Method other, const Escape& options) const;

  const PathSearch& method_;
  const Observer& observer_;
  std::vector<Attempt> list_;
};

void Attempts::escape(Run& run, const Point& point, Method other, const Escape& options) const {
  Stop& limits = stop(other);
  limits = method_.stop;
  limits.max_iterations = std::max(0, method_.stop.max_iterations - run.stats().iterations);
  limits.max_time = std::max(std::chrono::duration<double>(0),
                             std::chrono::duration<double>(run.deadline() - std::chrono::steady_clock::now()));
  const RunMethod base = [](const Mcp& mcp, In x0, const Method& method, const Observer& observer) {
    return std::visit(
        [&](const auto& m) -> Result {
          using M = std::decay_t<decltype(m)>;
          if constexpr (std::is_same_v<M, SemismoothNewton>)
            return run_semismooth_newton(mcp, x0, m, observer);
          else if constexpr (std::is_same_v<M, NewtonJosephy>)
            return run_newton_josephy(mcp, x0, m, observer);
          else
            return {};
        },
        method);
  };
  const int before = run.stats().iterations;
  Result result;
  result.status = Status::NoProgress;
  result.x = point.x;
  result.F = point.F;
  result.residual = residual(run.box(), point.x, point.F);
  const Observer shown = [this, before](const Iteration& it) {
    Iteration counted = it;
    counted.k += before;
    return observer_ ? observer_(counted) : Next::Continue;
  };
  run.take(proximal_escape(run.mcp(), other, options, std::move(result), base, shown));
}

}  // namespace

Result run_path(const Mcp& mcp, In x0, const PathSearch& method, const Observer& observer) {
  Run run(mcp, method.stop, observer);
  Point user;
  if (!run.start(x0, user)) return run.result();
  Attempts attempts(method, observer);
  int tried = 0;
  for (const Attempt& attempt : attempts.list()) {
    if (tried > 0) run.resume();
    Point point = user;
    if (attempt.from_best) {
      point.x = run.best();
      if (!run.evaluate(point)) point = user;
    }
    attempt.go(run, std::move(point));
    ++tried;
    if (!run.ended() || !stuck(run.status()) || tried > method.restart_limit) break;
  }
  run.stats().restarts = tried - 1;
  Result result = run.result();
  if (stuck(result.status) && tried > 1)
    result.message +=
        "; " + std::to_string(tried - 1) + " restarts (other options, other methods) have not led to a solution";
  else if (result.solved() && tried > 1)
    result.message += ", after a restart: " + attempts.list()[static_cast<std::size_t>(tried - 1)].what;
  result.basis = std::move(attempts.basis);
  return result;
}

}  // namespace perp::ncp

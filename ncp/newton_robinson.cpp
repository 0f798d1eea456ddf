#include "ncp/newton_robinson.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "ncp/methods.hpp"
#include "ncp/newton_point.hpp"

namespace perp::ncp {
namespace {

/// The zero of L_k, by the path from y^k, then by rays, as NewtonJosephy finds its point.
lcp::PivotResult zero_of_linearised(Run& run, const lcp::LemkeOptions& options, const Point& point, const Vec& y) {
  const lcp::AffineMcp L = linearised(run.box(), point, 0);
  lcp::PivotResult path = follow_path(L, y, options);
  run.stats().factorizations += path.refactorizations;
  for (std::size_t i = 0; i <= covers.size() && path.end != lcp::PivotEnd::Solved && !run.interrupted(); ++i) {
    lcp::LemkeOptions ray = options;
    ray.start = lcp::LemkeStart::Ray;
    ray.seed += static_cast<unsigned>(i);
    if (i > 0) ray.cover = covers[i - 1];
    const int before = path.pivots;
    path = follow_path(L, y, ray);
    path.pivots += before;
    run.stats().factorizations += path.refactorizations;
  }
  return path;
}

}  // namespace

void newton_robinson(Run& run, const NewtonRobinson& method, Point point) {
  lcp::LemkeOptions options = method.lemke;
  options.interrupted = [&run] { return run.interrupted(); };
  options.deadline = run.deadline();
  options.max_pivots = std::min(options.max_pivots, worthwhile_pivots(run.box().size()));
  Vec y = normal_point(run.box(), point.x, point.F);
  Iteration it{.k = 0, .kind = 'I'};
  it.merit = 0.5 * (point.F + y - point.x).squaredNorm();

  while (run.go_on(point, it)) {
    const lcp::PivotResult path = zero_of_linearised(run, options, point, y);
    it = {.k = it.k + 1, .step = 1, .pivots = path.pivots, .kind = 'N'};
    if (path.end == lcp::PivotEnd::Interrupted || path.end == lcp::PivotEnd::TimeLimit) continue;  // the run says so
    if (path.end != lcp::PivotEnd::Solved) {
      run.end(Status::SubproblemFailed,
              "the linearised problem could not be solved (" + std::string(lcp::to_string(path.end)) + ")",
              "try the method path, which searches along the way to such points, or another start");
      break;
    }
    point.x = lcp::project(run.box(), path.x);
    y = path.x;
    if (!run.evaluate(point)) {
      run.end(Status::EvaluationFailed, "F or its Jacobian is not defined at the Newton point",
              "try the method path, which shortens such steps, or another start");
      break;
    }
    it.merit = 0.5 * (point.F + y - point.x).squaredNorm();
  }
}

Result run_newton_robinson(const Mcp& mcp, In x0, const NewtonRobinson& method, const Observer& observer) {
  Run run(mcp, method.stop, observer);
  Point point;
  if (run.start(x0, point)) newton_robinson(run, method, std::move(point));
  return run.result();
}

std::optional<std::string> invalid(const NewtonRobinson& m) {
  if (auto why = invalid(m.stop)) return why;
  return invalid(m.lemke);
}

}  // namespace perp::ncp

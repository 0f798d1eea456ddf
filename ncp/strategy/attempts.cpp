// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/attempts.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "ncp/analysis/diagnosis.hpp"
#include "ncp/reformulation/merit.hpp"
#include "ncp/transforms/scale_transform.hpp"

namespace perp::ncp {
namespace {

/// Limits this tight are for the first attempt alone.
constexpr int enough_iterations = 100;
constexpr int enough_F_evals = 1000;

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

}  // namespace

void in_turn(Run& run, const Point& start, const std::vector<Attempt>& list, int restart_limit, Tried& tried) {
  int restarts = 0;
  for (const Attempt& attempt : list) {
    if (attempt.counted && restarts == restart_limit) break;
    if (!tried.attempts.empty() && (run.hopeless() || run.stalled())) break;
    Point point;
    if (!begin(run, attempt.from, start, point) || (attempt.worthwhile && !attempt.worthwhile(run, start))) continue;
    if (attempt.counted) ++restarts;
    if (!tried.attempts.empty()) run.resume(attempt.name);
    tried.attempts.push_back(&attempt);
    run.guard([&] { attempt.go(run, std::move(point)); });
    if (!run.ended() || !stuck(run.status())) break;
    tried.verdicts.push_back(run.verdict());
  }
}

Run::Verdict with_diagnosis(Run& run, Run::Verdict verdict, In start) {
  Point best;
  best.x = run.best();
  if (!run.evaluate(best)) return verdict;
  Diagnosis known = diagnose(run.mcp(), best, start, run.earlier());
  if (known.unbounded) verdict.status = Status::Unbounded;
  if (known.stationary) verdict.status = Status::StationaryPoint;
  if (known.message.empty()) return verdict;
  verdict.message = std::move(known.message);
  verdict.advice = std::move(known.advice);
  return verdict;
}

Share part_of_left(const Run& run, bool last) {
  const Stop left = run.left();
  const auto part = [last](int what, int enough) {
    return last || what == no_limit ? what : std::max((what + 1) / 2, std::min(what, enough));
  };
  return {.iterations = part(left.max_iterations, enough_iterations),
          .F_evals = part(left.max_F_evals, enough_F_evals)};
}

Method with_pivots_left(const Run& run, Method method) {
  if (auto* path = std::get_if<PathSearch>(&method))
    path->cumulative_iteration_limit = std::max(1, path->cumulative_iteration_limit - run.stats().pivots);
  return method;
}

Result linear_methods(Run& run, In x0, const Share& share) {
  const Affine method;
  Result result = run.within(run.mcp(), share, x0, [&](Run& inner, In z0) { affine(inner, z0, method); });
  result.stats.pivots += std::exchange(result.stats.iterations, std::min(result.stats.iterations, 1));
  return result;
}

Attempt loop_attempt(std::string name, Method method, From from) {
  std::string what(ncp::name(method));
  return {.name = std::move(name),
          .what = std::move(what),
          .go = [method = std::move(method)](Run& run, Point point) { run_loop(run, std::move(point), method); },
          .from = from};
}

Attempt scaled_attempt(std::string name, Method method, std::string when,
                       std::function<std::optional<Scaling>(Run&, const Point&)> factors) {
  const auto found = std::make_shared<std::optional<Scaling>>();
  std::string what = "scaled(" + std::string(ncp::name(method)) + ")";
  const auto go = [method = std::move(method), found](Run& run, const Point& start) {
    const Method rest = with_pivots_left(run, method);
    run.take(run.within(ScaleTransform(run.mcp(), **found), {}, start.x,
                        [&](Run& scaled, In z0) { run_once(scaled, z0, rest); }));
  };
  return {.name = std::move(name),
          .what = std::move(what),
          .go = go,
          .when = std::move(when),
          .worthwhile = [found, factors = std::move(factors)](Run& run, const Point& start) {
            return (*found = factors(run, start)).has_value();
          }};
}

}  // namespace perp::ncp

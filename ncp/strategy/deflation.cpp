// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/deflation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "ncp/analysis/structure_report.hpp"
#include "ncp/reformulation/merit.hpp"
#include "ncp/strategy/deflated_newton.hpp"
#include "ncp/strategy/run_plan.hpp"

namespace perp::ncp {
namespace {

constexpr double displacement = 0.1;      // of a start, relative to 1 + |x_i|
constexpr double worth_polishing = 1e-3;  // natural residual of an attempt's best point
constexpr double rounding = 1e-13;
constexpr int polish_iterations = 20;

class Search {
 public:
  Search(const Mcp& mcp, In x0, const Method& method, const Deflation& deflation, const Observer& observer)
      : mcp_(mcp),
        x0_(lcp::project(mcp.box(), x0)),
        stop_(without_iteration_limit(stop(method))),
        deflation_(deflation),
        run_(mcp, stop_, observer) {}

  void first(Result result, std::string_view name) {
    run_.charge(result);
    out_.first = result;
    if (result.solved()) keep(polished(std::move(result)), std::string(name));
  }

  bool enough() const { return static_cast<int>(out_.found.size()) >= deflation_.solutions; }

  /// True if it found a solution that is not known.
  bool attempt(const DeflationTry& how) {
    ++out_.attempts;
    run_.next_attempt("deflation " + std::to_string(out_.attempts) + ": " + describe(how));
    Result result = run_.within(mcp_, {.iterations = deflation_.max_iterations}, start(how), [&](Run& inner, In z) {
      Point point;
      if (inner.start(z, point)) deflated_newton(inner, how, roots_, std::move(point));
    });
    run_.charge(result);
    if (result.residual.natural > worth_polishing) return false;
    result = polished(std::move(result));
    if (!result.solved()) return false;
    if (known(result.x)) {
      ++out_.duplicates;
      return false;
    }
    keep(std::move(result), describe(how));
    return true;
  }

  /// Which limit ends everything; empty: none yet.
  std::string stopped() const {
    if (run_.interrupted() || (run_.ended() && run_.status() == Status::Interrupted)) return "interrupted";
    if (std::chrono::steady_clock::now() >= run_.deadline())
      return "the time limit of " + number(stop_.max_time.count()) + " s was reached";
    if (run_.F_evals() >= stop_.max_F_evals)
      return "the limit of " + quantity(stop_.max_F_evals, "evaluation") + " of F was reached";
    return {};
  }
  AllSolutions finish(std::string message) {
    out_.message = std::move(message);
    out_.stats = run_.result(x0_).stats;
    return std::move(out_);
  }
  const AllSolutions& so_far() const { return out_; }

 private:
  /// The tries have their own.
  static Stop without_iteration_limit(Stop stop) {
    stop.max_iterations = std::numeric_limits<int>::max();
    return stop;
  }

  /// The point where an attempt starts; no known solution, but with probability 0. A move out of the box is reflected
  /// at the bound: projected, half of all starts near a solution at a bound would be that solution.
  Vec start(const DeflationTry& how) const {
    Vec x = how.start == DeflationStart::Solution ? roots_.back().r : x0_;
    if (how.start == DeflationStart::Same && !known(x)) return x;
    const Vec h = generic(x.size(), out_.attempts);
    for (Index i = 0; i < x.size(); ++i) {
      const double lower = mcp_.box().lower[i], upper = mcp_.box().upper[i];
      x[i] += (2 * h[i] - 1) * std::min(displacement * (1 + std::abs(x[i])), (upper - lower) / 2);
      if (x[i] < lower)
        x[i] = 2 * lower - x[i];
      else if (x[i] > upper)
        x[i] = 2 * upper - x[i];
    }
    return lcp::project(mcp_.box(), x);  // rounding
  }

  bool known(In x) const {
    return std::any_of(roots_.begin(), roots_.end(), [&](const DeflationOperator::Root& root) {
      return (x - root.r).lpNorm<Eigen::Infinity>() <= deflation_.distinct * (1 + root.r.lpNorm<Eigen::Infinity>());
    });
  }

  /// Plain semismooth Newton steps from there; what they reach if the residual is smaller.
  Result polished(Result result) {
    if (!stopped().empty()) return result;
    const Share share{.iterations = polish_iterations, .tol = std::min(stop_.tol, 1e-12), .shown = false};
    const Result polished =
        run_.within(mcp_, share, result.x, [](Run& inner, In z) { run_plan(inner, z, SemismoothNewton{}); });
    run_.charge(polished);
    if (polished.residual.natural < result.residual.natural) take(result, polished.x, polished.F, polished.residual);
    // Entries that are off a bound by rounding alone.
    Vec x = result.x, F(x.size());
    for (Index i = 0; i < x.size(); ++i)
      for (const double bound : {mcp_.box().lower[i], mcp_.box().upper[i]})
        if (std::isfinite(bound) && std::abs(x[i] - bound) <= rounding * (1 + std::abs(bound))) x[i] = bound;
    if (x == result.x) return result;
    if (!run_.counted().eval(x, F)) return result;
    const Residual snapped = residual(mcp_.box(), x, F);
    if (snapped.natural <= std::max(result.residual.natural, std::min(rounding, stop_.tol)))
      take(result, x, F, snapped);
    return result;
  }

  void take(Result& result, const Vec& x, const Vec& F, const Residual& residual) {
    result.x = x;
    result.F = F;
    result.residual = residual;
    if (!(residual.natural <= stop_.tol)) return;
    result.status = Status::Solved;
    result.advice.clear();
    const Stats before = result.stats;
    judge_here(mcp_, stop_, result, std::make_shared<ExactValues>(mcp_));
    run_.stats().F_evals += result.stats.F_evals - before.F_evals;
    run_.stats().J_evals += result.stats.J_evals - before.J_evals;
  }

  void keep(Result result, std::string how) {
    const double D = std::min(1.0, result.x.norm());
    roots_.push_back({.r = result.x, .D = D > 0 ? D : 1});
    SpMat J = mcp_.jacobian_pattern();
    std::string singular;
    if (run_.counted().jacobian(result.x, J)) singular = explain_singularity(mcp_, J, result.x, result.F);
    out_.found.push_back({.result = std::move(result), .how = std::move(how), .singular = std::move(singular)});
  }

  const Mcp& mcp_;
  const Vec x0_;
  const Stop stop_;
  const Deflation& deflation_;
  Run run_;  // of everything; its best point is nobody's
  AllSolutions out_;
  std::vector<DeflationOperator::Root> roots_;
};

}  // namespace

std::vector<DeflationTry> Deflation::default_tries() {
  std::vector<DeflationTry> tries;
  for (const DeflationStart start : {DeflationStart::Same, DeflationStart::Near, DeflationStart::Solution})
    for (const double sigma : {1.0, 0.1, 10.0})
      for (const bool search : {true, false}) {
        for (const double p : {2.0, 1.0}) tries.push_back({.p = p, .sigma = sigma, .search = search, .start = start});
        if (sigma == 1) tries.push_back({.cfunction = natural_min(), .search = search, .start = start});
      }
  return tries;
}

std::string describe(const DeflationTry& attempt) {
  std::ostringstream text;
  text << attempt.cfunction.name << ", p = " << attempt.p << ", sigma = " << attempt.sigma;
  if (!attempt.search) text << ", full steps";
  if (attempt.start == DeflationStart::Near) text << ", from near the start";
  if (attempt.start == DeflationStart::Solution) text << ", from near the last solution";
  return text.str();
}

std::optional<std::string> invalid(const Deflation& d) {
  Fields f;
  f.check(d.solutions >= 1, "solutions", d.solutions, "at least 1");
  f.check(d.max_attempts >= 0, "max_attempts", d.max_attempts, "at least 0");
  f.check(d.max_iterations >= 0, "max_iterations", d.max_iterations, "at least 0");
  f.check(strictly_between(0, 1).has(d.distinct), "distinct", d.distinct, "in (0, 1)");
  for (const DeflationTry& t : d.tries) {
    f.check(above(0).has(t.p), "p", t.p, "positive and finite");
    f.check(at_least(0).has(t.sigma), "sigma", t.sigma, "at least 0 and finite");
    f.check(static_cast<bool>(t.cfunction.at), "cfunction has no function");
  }
  return f.invalid();
}

AllSolutions solve_all(const Mcp& mcp, In x0, const Method& method, const Deflation& deflation,
                       const Observer& observer, std::string_view label) {
  if (const auto why = invalid(deflation)) throw std::invalid_argument("deflation: " + *why);
  check_input(mcp, x0);
  Search search(mcp, x0, method, deflation, observer);
  search.first(solve(mcp, x0, method, observer), label.empty() ? name(method) : label);
  if (search.so_far().found.empty()) return search.finish("the first solve found no solution: nothing to deflate");
  std::size_t next = 0;
  while (!search.enough() && next < deflation.tries.size()) {
    if (std::string why = search.stopped(); !why.empty()) return search.finish(std::move(why));
    if (search.so_far().attempts >= deflation.max_attempts) return search.finish("the limit of attempts was reached");
    next = search.attempt(deflation.tries[next]) ? 0 : next + 1;
  }
  if (search.enough()) return search.finish("as many solutions as asked for");
  std::string why = search.stopped();  // in the last try
  return search.finish(why.empty() ? "no try finds another one" : std::move(why));
}

}  // namespace perp::ncp

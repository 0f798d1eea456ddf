// SPDX-License-Identifier: Apache-2.0
/// PathSearch as a user gets it: the attempts in their order, until one solves the problem or the list is at its end.
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ncp/path/path_attempt.hpp"
#include "ncp/reformulation/normal_map.hpp"
#include "ncp/strategy/attempts.hpp"
#include "ncp/strategy/proximal.hpp"

namespace perp::ncp {
namespace {

/// Restarts are given up sooner than the attempt with the user's options; and that one for a while, where there is a
/// scaled problem.
constexpr int restart_patience = 15;
constexpr int first_patience = 10;

constexpr std::string_view options_given = "the options given";
constexpr std::string_view options_given_again = "on with the options given";

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

/// Leaves in `stuck_at` where it got stuck.
Attempt smoothing_attempt(const Smoothing& method, const std::shared_ptr<Vec>& stuck_at) {
  const auto go = [method, stuck_at](Run& run, const Point& start) {
    const Result result = run.within(run.mcp(), {}, start.x, [&](Run& inner, In z0) { run_once(inner, z0, method); });
    *stuck_at = result.x;
    run.take(result);
  };
  return {.name = "smoothing", .what = "smooth", .go = go};
}

Attempt escape_attempt(std::string name, const Method& base) {
  const auto go = [base](Run& run, const Point& best) {
    const Body body = [rest = with_pivots_left(run, base)](Run& inner, In z0) { run_once(inner, z0, rest); };
    const int k = proximal_escape(run, best.x, residual(run.box(), best.x, best.F).natural,
                                  Escape{.rounds = escape_rounds}, no_limit, body);
    if (run.accepted()) run.remark("after " + quantity(k, "proximal escape"));
    if (!run.ended()) run.end(Status::NoProgress, "proximal escapes do not help", "");
  };
  return {
      .name = std::move(name), .what = "escape(" + std::string(ncp::name(base)) + ")", .go = go, .from = From::Best};
}

Attempt linear_attempt() {
  const auto go = [](Run& run, const Point& start) { run.take(linear_methods(run, start.x, {})); };
  return {.name = "the best of the linear methods",
          .what = "the linear methods",
          .go = go,
          .when = "the problem is affine",
          .worthwhile = [](Run& run, const Point&) { return run.mcp().is_affine(); }};
}

Attempt uncounted(Attempt attempt) {
  attempt.counted = false;
  return attempt;
}

/// Other options, then other methods.
void add_own_restarts(const PathSearch& method, std::vector<Attempt>& list) {
  list.push_back(block_attempt(method));
  list.push_back(linear_attempt());
  PathSearch again = once(method);
  again.proximal_perturbation = 1;
  list.push_back(loop_attempt("proximal perturbation 1", again));
  again.proximal_perturbation = method.proximal_perturbation;
  list.push_back(loop_attempt("from the origin", again, From::Origin));
  list.push_back(loop_attempt("from a point of the unit box", again, From::UnitBox));
  list.push_back(scaled_attempt(std::string(scaled_at_best), again, "that helps",
                                [](Run& run, const Point&) { return factors_at(run, run.best()); }));
  again.start = PathStart::Always;
  list.push_back(loop_attempt("Newton points from rays", again));
  again.start = method.start;
  again.merit = method.merit == PathMerit::Fischer ? PathMerit::NormalMap : PathMerit::Fischer;
  again.search = method.search == Searchtype::Line ? Searchtype::Path : Searchtype::Line;
  again.nms.initial_reference_factor = 2;
  list.push_back(loop_attempt("the other merit function, another search", again));
  list.push_back(loop_attempt("semismooth Newton", SemismoothNewton{}));
  list.push_back(loop_attempt("Newton-Josephy", NewtonJosephy{}));
  PathSearch trial = once(method);
  trial.patience = std::min(method.patience, trial_patience);
  list.push_back(escape_attempt("proximal escape", trial));
  const Smoothing smoothing{.function = smoothed_fischer_burmeister(), .restarts = 1};
  const auto stuck_at = std::make_shared<Vec>();
  list.push_back(smoothing_attempt(smoothing, stuck_at));
  list.push_back(scaled_attempt("smoothing, rows and columns scaled", smoothing, "that helps",
                                [stuck_at](Run& run, const Point&) { return factors_at(run, *stuck_at); }));
  list.push_back(loop_attempt("semismooth Newton from the best point", SemismoothNewton{}, From::Best));
  list.push_back(loop_attempt("semismooth Newton on the min function", SemismoothNewton{.cfunction = natural_min()}));
  list.push_back(escape_attempt("proximal escape with semismooth Newton", SemismoothNewton{}));
}

/// The three of PATH's documentation (option restart_limit).
void add_documented_restarts(const PathSearch& method, std::vector<Attempt>& list) {
  PathSearch first = method;
  first.crash.on = false;
  first.basis.clear();
  first.nms.initial_reference_factor = 2;
  Attempt perturbed = loop_attempt("PATH's first restart: perturbed by 0.01 times the residual", first);
  perturbed.go = [first](Run& run, Point start) {
    PathSearch there = first;
    there.proximal_perturbation = 0.01 * residual(run.box(), start.x, start.F).natural / size_of(start.J);
    iterate(run, there, std::move(start));
  };
  list.push_back(std::move(perturbed));
  PathSearch second = first;
  second.proximal_perturbation = 0;
  second.nms.mstep_frequency = 1;
  second.nms.initial_reference_factor = 10;
  second.nms.memory = 2;
  list.push_back(loop_attempt("PATH's second restart: a test in each iteration", second));
  PathSearch third = first;
  third.proximal_perturbation = 0;
  third.crash.on = true;
  third.crash.nbchange_limit = 10;
  third.search = Searchtype::Arc;
  list.push_back(loop_attempt("PATH's third restart: searches along arcs", third));
}

/// The verdict of the first attempt, with what is known about the best point of all.
Run::Verdict last_words(Run& run, const Run::Verdict& first, const Point& user, std::size_t restarts) {
  Run::Verdict verdict = with_diagnosis(run, first, user.x);
  if (restarts > 0)
    verdict.message += "; " + quantity(static_cast<Index>(restarts), "restart") + (restarts == 1 ? " has" : " have") +
                       " not led to a solution either";
  return verdict;
}

/// What the attempts before the restarts share: the one with the options given, and whether the problem is one to
/// scale.
struct FirstAttempt {
  std::optional<PathAttempt> path;
  std::optional<Scaling> scaling;
  bool in_haste = false;  ///< it was given up sooner than the options say
};

/// Neither the user's units nor those of the scaled problem are always the better ones: each attempt is given up soon
/// where the other is at hand, and the first one is gone on with where both are stuck.
void add_in_turns(const PathSearch& method, std::vector<Attempt>& list) {
  const auto first = std::make_shared<FirstAttempt>();
  const int soon = std::min(method.patience, first_patience);
  const auto begin = [method, first, soon](Run& run, Point start) {
    first->scaling = helpful_scaling(run.mcp(), start.J);
    first->in_haste = first->scaling && soon < method.patience;
    first->path.emplace(run, method, std::move(start));
    first->path->go_on(first->in_haste ? soon : method.patience);
    if (!first->in_haste || !first->path->stalled()) first->path.reset();  // it holds factors and kinks
  };
  list.push_back({.name = std::string(options_given), .what = "path", .go = begin, .counted = false});
  PathSearch scaled = method;
  scaled.gradient_step_limit = 0;  // those that need them seldom succeed
  scaled.patience = soon;
  list.push_back(uncounted(scaled_attempt(std::string(scaled_at_start), scaled, "that brings the entries of J together",
                                          [first](Run&, const Point&) { return std::move(first->scaling); })));
  list.push_back({.name = std::string(options_given_again),
                  .what = "path",
                  .go =
                      [method, first](Run&, const Point&) {
                        first->path->go_on(method.patience);
                        first->path.reset();
                      },
                  .when = "the first attempt was given up soon",
                  .worthwhile = [first](Run&, const Point&) { return first->path.has_value(); },
                  .counted = false});
}

}  // namespace

std::vector<Attempt> path_list(const PathSearch& method) {
  std::vector<Attempt> list;
  if (method.scaling)
    add_in_turns(method, list);
  else
    list.push_back(uncounted(loop_attempt(std::string(options_given), method)));
  return list;
}

std::vector<Attempt> path_restarts(const PathSearch& method) {
  std::vector<Attempt> list;
  if (method.restarts == PathRestarts::Documented)
    add_documented_restarts(method, list);
  else
    add_own_restarts(method, list);
  return list;
}

namespace {

/// Of the attempt with the options given: at its end, if it has been gone on with to a verdict.
const Run::Verdict& words_of(const Tried& tried) {
  for (std::size_t i = 0; i < tried.verdicts.size(); ++i)
    if (tried.attempts[i]->name == options_given_again) return tried.verdicts[i];
  return tried.verdicts.front();
}

}  // namespace

void path_attempts(Run& run, In x0, const PathSearch& method) {
  Point user;
  if (!run.start(x0, user)) return;
  const int restarts = run.stats().restarts;
  Tried tried;
  const std::vector<Attempt> list = path_list(method);
  in_turn(run, user, list, method.restart_limit, tried);
  std::vector<Attempt> restarts_there;  // most runs need none
  if (run.ended() && stuck(run.status()) && method.restart_limit > 0) {
    restarts_there = path_restarts(method);
    in_turn(run, user, restarts_there, method.restart_limit, tried);
  }
  const auto goes_on = [](const Attempt* attempt) { return attempt->name == options_given_again; };
  const std::size_t restarted =
      tried.attempts.size() - 1 - static_cast<std::size_t>(std::ranges::count_if(tried.attempts, goes_on));
  run.stats().restarts = restarts + static_cast<int>(restarted);
  if (!run.ended()) return;
  const bool at_limit =
      !tried.verdicts.empty() && run.status() == Status::IterationLimit && !goes_on(tried.attempts.back());
  if (stuck(run.status()) || at_limit) {
    Run::Verdict verdict = last_words(run, words_of(tried), user, restarted);
    if (at_limit) verdict.message += ", and in the last one " + run.verdict().message;
    run.replace_verdict(std::move(verdict));
  }
  if (run.status() == Status::Solved && restarted > 0) run.remark("after a restart: " + tried.attempts.back()->name);
}

}  // namespace perp::ncp

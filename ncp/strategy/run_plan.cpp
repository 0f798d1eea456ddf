// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/run_plan.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "ncp/analysis/diagnosis.hpp"
#include "ncp/reformulation/merit.hpp"
#include "ncp/reformulation/normal_map.hpp"
#include "ncp/strategy/conditions.hpp"
#include "ncp/strategy/proximal.hpp"
#include "ncp/strategy/structured_run.hpp"
#include "ncp/transforms/presolve_transform.hpp"
#include "ncp/transforms/scale_transform.hpp"

namespace perp::ncp {
namespace {

/// Limits this tight are for the first attempt alone.
constexpr int enough_iterations = 100;
constexpr int enough_F_evals = 1000;

bool restricts(const Share& share, const Run& run) {
  const Stop left = run.left();
  return share.iterations < left.max_iterations || share.F_evals < left.max_F_evals || share.pivots < left.max_pivots;
}

/// Runs `body` on the problem itself: in a run of its own where the share is less than what is left.
void run_here(Run& run, In x0, const Share& share, const Body& body) {
  if (!restricts(share, run)) return body(run, x0);
  run.take(run.within(run.mcp(), share, x0, body));
}

void run_presolved(Run& run, In x0, const Share& share, const Body& body) {
  const Vec start = lcp::project(run.box(), x0);
  const Presolved pre = presolve(run.mcp(), start);
  if (!pre.infeasible().empty()) {
    Point point;
    if (!run.start(x0, point) || run.ended() || run.disprove({}, pre.infeasible())) return;
    return run_here(run, x0, share, body);  // rounding may have made the contradiction
  }
  if (&pre.problem() == &run.mcp()) return run_here(run, x0, share, body);
  bool accepted = false;
  const Result result = run.within(PresolveTransform(run.mcp(), pre), share, start, body, &accepted);
  run.take(result);
  run.stats().presolved = static_cast<int>(pre.counts().total());
  run.stats().F_evals += pre.F_evals();
  run.stats().J_evals += pre.J_evals();
  if (!accepted || result.solved()) return;
  // Variables that are computed afterwards amplify the residual: the last digits are the full problem's.
  run.resume("on the problem that was not presolved");
  run.warm(result.basis);
  run_here(run, result.x, share, body);
}

void run_scaled(Run& run, In x0, const Vec& at, const Share& share, const Body& body) {
  if (const auto factors = factors_at(run, at))
    return run.take(run.within(ScaleTransform(run.mcp(), *factors), share, x0, body));
  run_here(run, x0, share, body);
  run.remark("not scaled: that brings no entries of J together");
}

void run_on(Run& run, In x0, const On& on, const Share& share) {
  const Body body = [&on](Run& inner, In z0) { run_plan(inner, z0, *on.method); };
  if (!on.enabled) return run_here(run, x0, share, body);
  const Vec start = lcp::project(run.box(), x0);
  switch (on.form) {
    case Form::Presolved:
      return run_presolved(run, x0, share, body);
    case Form::Scaled:
      return run_scaled(run, x0, start, share, body);
    case Form::Rescaled:
      return run_scaled(run, x0, run.best().size() > 0 ? run.best() : start, share, body);
    case Form::Blocks:
      return run_here(run, x0, share, [&body](Run& inner, In z0) { run_blocks(inner, z0, body); });
  }
}

void run_escaping(Run& run, In x0, const Escaping& m) {
  const Body body = [&m](Run& inner, In z0) { run_plan(inner, z0, *m.method); };
  body(run, x0);
  if (!stuck(run) || m.escape.rounds == 0 || run.hopeless() || run.stalled()) return;
  const Run::Verdict before = run.verdict();
  const Vec center = run.best();
  run.resume({});
  const int k = proximal_escape(run, center, run.best_residual(), m.escape, body);
  const std::string escapes = quantity(k, "proximal escape");
  if (run.accepted()) return run.remark("after " + escapes + " from a local minimum");
  if (!run.ended()) run.replace_verdict(before);
  run.remark(escapes + (k == 1 ? " has" : " have") + " not led to a solution");
}

/// Finds the entry's first point, with F and J; false if they are not defined there, or others began there.
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

void run_list(Run& run, const Point& start, const First& list);

/// Runs the entry within its share of the limits.
void run_entry(Run& run, const Entry& entry, bool last, Point point) {
  Share share = part_of_left(run, last);
  share.pivots = entry.pivots;
  // Form::Rescaled looks at the best point of this run.
  if (const auto* on = std::get_if<On>(&*entry.method)) return run_on(run, point.x, *on, share);
  const bool affine = std::holds_alternative<Affine>(*entry.method);
  if (!affine && !restricts(share, run))
    return std::visit(
        [&](const auto& m) {
          if constexpr (requires { iterate(run, m, std::move(point)); })
            iterate(run, m, std::move(point));
          else if constexpr (std::is_same_v<std::remove_cvref_t<decltype(m)>, First>)
            run_list(run, point, m);
          else
            run_plan(run, point.x, *entry.method);
        },
        *entry.method);
  Result result = run.within(run.mcp(), share, point.x, [&](Run& inner, In z0) { run_plan(inner, z0, *entry.method); });
  if (affine) result.stats.pivots += std::exchange(result.stats.iterations, std::min(result.stats.iterations, 1));
  run.take(result);
}

/// Completes the verdict of a run that is stuck with what is known about its best point.
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

std::string title_of(const Entry& entry) {
  if (!entry.title.empty()) return std::string(entry.title);
  return entry.from == From::Start ? name(*entry.method) : text_of(name(*entry.method), ' ', words_of(entry.from));
}

/// "auto chose path (the problem is nonlinear), then ..."
std::string account(const First& list, const std::vector<const Entry*>& tried) {
  std::string why;
  for (const Condition condition : tried.front()->when)
    if (condition != Condition::Cold) why += text_of(why.empty() ? "" : ", ", words_of(condition));
  std::string text = text_of(list.name, " chose ", title_of(*tried.front()), why.empty() ? "" : " (" + why + ')');
  for (std::size_t i = 1; i < tried.size(); ++i) text += (i == 1 ? ", then " : ", ") + title_of(*tried[i]);
  return text;
}

/// Runs the entries from a start with F and J.
void run_list(Run& run, const Point& start, const First& list) {
  Facts facts(run, start);
  std::vector<const Entry*> tried;
  Run::Verdict of_first{};
  for (const Entry& entry : list.entries) {
    if (list.restart_limit && static_cast<int>(tried.size()) > *list.restart_limit) break;
    if (!tried.empty() && (run.hopeless() || run.stalled())) break;
    Point point;
    if (!facts.hold(entry.when) || !begin(run, entry.from, start, point)) continue;
    if (!tried.empty()) run.resume(title_of(entry));
    tried.push_back(&entry);
    run.keep_basis({});
    run_entry(run, entry, &entry == &list.entries.back(), std::move(point));
    if (!run.ended() || !stuck(run.status())) break;
    if (tried.size() == 1) of_first = run.verdict();
  }
  if (tried.empty()) return run.end(Status::NotApplicable, "none of the methods listed is for this problem", "");
  const std::size_t restarts = tried.size() - 1;
  run.stats().restarts += static_cast<int>(restarts);
  if (run.ended() && stuck(run.status())) {
    Run::Verdict verdict = with_diagnosis(run, std::move(of_first), start.x);
    if (run.stalled()) verdict.message += "; given up: no progress in " + number(std::floor(run.idle())) + " s";
    run.replace_verdict(std::move(verdict));
  }
  if (run.accepted() && run.basis().empty()) run.keep_basis(cells_at(run.box(), run.best()));
  if (list.turns) return;
  if (list.tells)
    run.remark(account(list, tried));
  else if (restarts > 0 && run.accepted())
    run.remark("after a restart: " + title_of(*tried.back()));
  else if (restarts > 0)
    run.remark(quantity(static_cast<Index>(restarts), "restart") + (restarts == 1 ? " has" : " have") +
               " not led to a solution either");
}

void run_first(Run& run, In x0, const First& list) {
  Point start;
  if (!run.start(x0, start)) return;
  if (!run.ended()) return run_list(run, start, list);
  run.go_on(start, {.k = 0, .kind = 'I'});
  if (list.tells) run.remark(list.name + " had nothing to choose: the start is a solution");
}

}  // namespace

bool stuck(Status status, const Stats& stats) {
  return stuck(status) && (status != Status::EvaluationFailed || stats.iterations > 0);
}

bool stuck(const Run& run) { return run.ended() && stuck(run.status(), run.stats()); }

Share part_of_left(const Run& run, bool last) {
  const Stop left = run.left();
  const auto part = [last](int what, int enough) {
    return last || what == no_limit ? what : std::max((what + 1) / 2, std::min(what, enough));
  };
  return {.iterations = part(left.max_iterations, enough_iterations),
          .F_evals = part(left.max_F_evals, enough_F_evals)};
}

void run_plan(Run& run, In x0, const Method& method) {
  std::visit(
      Overloaded{[&](const Affine& m) { affine(run, x0, m); }, [&](const On& m) { run_on(run, x0, m, {}); },
                 [&](const Escaping& m) { run_escaping(run, x0, m); }, [&](const First& m) { run_first(run, x0, m); },
                 [&](const auto& kernel) {
                   Point point;
                   if (run.start(x0, point)) iterate(run, kernel, std::move(point));
                 }},
      method);
}

}  // namespace perp::ncp

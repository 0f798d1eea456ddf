// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/auto.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "lcp/cholesky/symmetric.hpp"
#include "lcp/classes/classify.hpp"
#include "ncp/analysis/function_classes.hpp"
#include "ncp/reformulation/normal_map.hpp"
#include "ncp/strategy/attempts.hpp"
#include "ncp/strategy/strategies.hpp"
#include "ncp/transforms/presolve.hpp"

namespace perp::ncp {
namespace {

/// Pivots of the first try of PathSearch on large problems, which needs few of them or very many. On nonlinear ones
/// interior points, which come next, take some ten factorizations, each as much as some tens of pivots.
constexpr int few_pivots_affine = 3000;
constexpr int few_pivots_nonlinear = 50;

/// What presolve can say of a problem without a solution, row by row, is for people; a ray is not.
void explain(const Mcp& mcp, In x0, Result& result) {
  const Presolved pre = presolve(mcp, x0);
  result.stats.F_evals += pre.F_evals();
  result.stats.J_evals += pre.J_evals();
  if (!pre.infeasible().empty()) result.message = "proven to have no solution: " + pre.infeasible();
}

/// What the ranges of F prove of it, where that costs less than a few iterations.
FunctionClasses proven_classes(const Mcp& mcp, In x) {
  constexpr Index most_variables = 300;
  if (mcp.is_affine() || mcp.size() > most_variables || mcp.enclosure() == nullptr) return {};
  return function_classes(mcp, x, {.minors_to = 10, .samples = 0});
}

/// Of a run without a solution, whether there is one.
void tell_existence(Run& run) {
  const FunctionClasses classes = proven_classes(run.mcp(), run.best());
  if (classes.strongly_monotone.answer == lcp::Answer::Yes)
    run.remark("there is exactly one solution, as F is proven to be strongly monotone");
  else if (classes.uniform_p.answer == lcp::Answer::Yes)
    run.remark("there is exactly one solution, as F is proven to be a uniform P-function");
}

Attempt choice(std::string label, Method method, bool last = false) {
  std::string what(std::holds_alternative<Affine>(method) ? label : std::string(ncp::name(method)));
  const auto go = [method = std::move(method), last](Run& run, const Point& start) {
    const Share share = part_of_left(run, last);
    run.keep_basis({});
    Result result =
        std::holds_alternative<Affine>(method)
            ? linear_methods(run, start.x, share)
            : run.within(run.mcp(), share, start.x, [&](Run& inner, In z) { run_method(inner, z, method); });
    if (result.status == Status::Infeasible) explain(run.mcp(), start.x, result);
    run.take(result);
  };
  return {.name = std::move(label), .what = std::move(what), .go = go};
}

Attempt only_if(Attempt attempt, std::string when, std::function<bool(Run&, const Point&)> worthwhile) {
  attempt.when = std::move(when);
  attempt.worthwhile = std::move(worthwhile);
  return attempt;
}

/// "auto chose path (nonlinear, 4 variables), then ..."
std::string account(const Mcp& mcp, const Auto& method, const Tried& tried) {
  const Attempt& first = *tried.attempts.front();
  std::string why = first.when.empty() ? "nonlinear, " + quantity(mcp.size(), "variable") : first.when;
  if (!method.path.basis.empty()) why = "a warm basis is given";
  std::string text = "auto chose " + first.name + " (" + why + ")";
  for (std::size_t i = 1; i < tried.attempts.size(); ++i) text += (i == 1 ? ", then " : ", ") + tried.attempts[i]->name;
  return text;
}

/// Of those that got stuck path's, which knows most, else the first.
const Run::Verdict& telling(const Tried& tried) {
  for (std::size_t i = tried.verdicts.size(); i-- > 0;)
    if (tried.attempts[i]->what == "path") return tried.verdicts[i];
  return tried.verdicts.front();
}

}  // namespace

std::vector<Attempt> auto_list(const Auto& method) {
  const bool warm = !method.path.basis.empty();
  const auto monotone = [=](Run& run, const Point& start) {
    return !warm && run.mcp().is_affine() && lcp::positive_semidefinite(start.J, {.dense_to = 0}).yes();
  };
  const auto large = [most = method.large](const Run& run) { return run.box().size() > most; };
  const auto nonlinear = [](Run& run, const Point&) { return !run.mcp().is_affine(); };
  const auto large_unsymmetric = [=](Run& run, const Point& start) {
    return !warm && large(run) && !lcp::symmetric(start.J);
  };
  const auto large_symmetric = [=](Run& run, const Point& start) {
    return !warm && !run.mcp().is_affine() && large(run) && lcp::symmetric(start.J);
  };
  const std::string of_size = "n > " + std::to_string(method.large) + ", the Jacobian is ";
  const auto brief = [path = method.path](int few_pivots) {
    PathSearch limited = path;
    limited.restart_limit = 0;
    limited.cumulative_iteration_limit = std::min(limited.cumulative_iteration_limit, few_pivots);
    return limited;
  };
  SemismoothNewton penalised = method.semismooth;
  penalised.cfunction = penalised_fischer_burmeister();
  SemismoothNewton escaping = method.semismooth;
  escaping.escape = Escape{};
  return {
      only_if(choice("the linear methods", Affine{}), "the problem is affine and monotone", monotone),
      only_if(choice("path with few pivots", brief(few_pivots_affine)), of_size + "not symmetric",
              [=](Run& run, const Point& start) { return run.mcp().is_affine() && large_unsymmetric(run, start); }),
      only_if(choice("path with few pivots", brief(few_pivots_nonlinear)), of_size + "not symmetric",
              [=](Run& run, const Point& start) { return !run.mcp().is_affine() && large_unsymmetric(run, start); }),
      only_if(choice("interior points", InteriorPoint{}), of_size + "not symmetric", large_unsymmetric),
      only_if(choice("the linear methods", Affine{}), "the problem is affine",
              [=](Run& run, const Point& start) { return !warm && run.mcp().is_affine() && !monotone(run, start); }),
      only_if(choice("josephy", NewtonJosephy{.subproblem = Subproblem::Qp}),
              "nonlinear, " + of_size + "symmetric: quadratic programs by multigrid", large_symmetric),
      choice("path", method.path),
      only_if(choice("semismooth", method.semismooth), "F is proven to be a uniform P-function",
              [](Run& run, const Point& start) {
                return proven_classes(run.mcp(), start.x).uniform_p.answer == lcp::Answer::Yes;
              }),
      only_if(choice("smoothing", Smoothing{.function = smoothed_fischer_burmeister(), .restarts = 1}),
              "the problem is nonlinear", nonlinear),
      only_if(choice("interior points", InteriorPoint{.restarts = 0}), "the problem is nonlinear", nonlinear),
      choice("semismooth on the penalised function", penalised),
      choice("semismooth with proximal escapes", escaping, true),
  };
}

void automatic(Run& run, In x0, const Auto& method) {
  Point start;
  if (!run.start(x0, start)) return;
  if (run.ended()) {
    run.go_on(start, {.k = 0, .kind = 'I'});
    return run.remark("auto had nothing to choose: the start is a solution");
  }
  const std::vector<Attempt> list = auto_list(method);
  Tried tried;
  in_turn(run, start, list, static_cast<int>(list.size()), tried);
  if (run.ended() && stuck(run.status())) {
    Run::Verdict verdict = with_diagnosis(run, telling(tried), start.x);
    if (run.stalled()) verdict.message += "; given up: no progress in " + number(std::floor(run.idle())) + " s";
    run.replace_verdict(std::move(verdict));
  }
  run.stats().restarts += static_cast<int>(tried.attempts.size()) - 1;
  if (run.accepted() && run.basis().empty()) run.keep_basis(cells_at(run.box(), run.best()));
  run.remark(account(run.mcp(), method, tried));
  if (!run.accepted() && run.ended() && run.status() != Status::Infeasible && !run.hopeless()) tell_existence(run);
}

void describe(Auto& m, Fields& f) {
  f.add("auto_large", &m.large, at_least(0),
        "auto: with more variables than this, it takes iterative linear algebra and interior points early");
  describe(m.path, f);
  Fields semismooth;  // its keys would be path's
  describe(m.semismooth, semismooth);
  if (const auto why = semismooth.invalid()) f.check(false, "semismooth: " + *why);
}

}  // namespace perp::ncp

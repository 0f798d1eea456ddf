#include "ncp/auto.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "lcp/krylov.hpp"
#include "ncp/affine.hpp"
#include "ncp/methods.hpp"
#include "ncp/normal_map.hpp"
#include "ncp/presolve.hpp"

namespace perp::ncp {
namespace {

/// Limits this tight are for the first method alone.
constexpr int enough_iterations = 100;
constexpr int enough_F_evals = 1000;

/// Pivots of the first try of PathSearch on large problems, which needs few of them or very many.
constexpr int few_pivots = 3000;

struct Choice {
  std::string label;
  std::string why;
  Method method;
};

/// What is tried first, and why.
Choice first_choice(const Mcp& mcp, const Point& start, const Auto& method) {
  const Index n = mcp.size();
  if (!method.path.basis.empty()) return {"path", "a warm basis is given", method.path};
  if (mcp.is_affine()) return {"the linear methods", "the problem is affine", Affine{}};
  if (n > method.large && lcp::symmetric(start.J))
    return {"josephy",
            "nonlinear, " + quantity(n, "variable") + ", a symmetric Jacobian: quadratic programs by multigrid",
            NewtonJosephy{.subproblem = Subproblem::Qp}};
  return {"path", "nonlinear, " + quantity(n, "variable"), method.path};
}

std::vector<Choice> choices(const Mcp& mcp, const Point& start, const Auto& method) {
  std::vector<Choice> list{first_choice(mcp, start, method)};
  const Index n = mcp.size();
  if (n > method.large && method.path.basis.empty() && !lcp::symmetric(start.J)) {
    PathSearch brief = method.path;
    brief.restart_limit = 0;
    brief.cumulative_iteration_limit = std::min(brief.cumulative_iteration_limit, few_pivots);
    list.insert(list.begin(),
                {{"path with few pivots", quantity(n, "variable"), brief}, {"interior points", "", InteriorPoint{}}});
  }
  if (!std::holds_alternative<PathSearch>(list.back().method)) list.push_back({"path", "", method.path});
  if (!mcp.is_affine())
    list.push_back({"smoothing", "", Smoothing{.function = smoothed_fischer_burmeister(), .restarts = 1}});
  SemismoothNewton penalised = method.semismooth;
  penalised.cfunction = penalised_fischer_burmeister();
  list.push_back({"semismooth on the penalised function", "", penalised});
  SemismoothNewton escaping = method.semismooth;
  escaping.escape = Escape{};
  list.push_back({"semismooth with proximal escapes", "", escaping});
  return list;
}

/// The choice's part of what is left of the limits.
Share part_of(const Run& run, const Choice& choice, bool last) {
  const Stop left = run.left();
  const auto part = [last](int what, int enough) {
    return last ? what : std::max((what + 1) / 2, std::min(what, enough));
  };
  Share share{.iterations = part(left.max_iterations, enough_iterations),
              .F_evals = part(left.max_F_evals, enough_F_evals)};
  if (std::holds_alternative<Affine>(choice.method)) share.tol = std::min(stop(choice.method).tol, left.tol);
  return share;
}

/// "auto chose path (nonlinear, 4 variables); tried before: ..."
std::string account(const std::vector<Choice>& list, std::size_t tried) {
  std::string text = "auto chose " + list.front().label + " (" + list.front().why + ")";
  for (std::size_t i = 1; i < tried; ++i) text += (i == 1 ? ", then " : ", ") + list[i].label;
  return text;
}

/// What presolve can say of a problem without a solution, row by row, is for people; a ray is not.
void explain(const Mcp& mcp, In x0, Result& result) {
  const Presolved pre = presolve(mcp, x0);
  result.stats.F_evals += pre.F_evals();
  result.stats.J_evals += pre.J_evals();
  if (!pre.infeasible().empty()) result.message = "proven to have no solution: " + pre.infeasible();
}

}  // namespace

void automatic(Run& run, In x0, const Auto& method) {
  Point start;
  if (!run.start(x0, start)) return;
  if (run.ended()) {
    run.go_on(start, {.k = 0, .kind = 'I'});
    return run.remark("auto had nothing to choose: the start is a solution");
  }
  const std::vector<Choice> list = choices(run.mcp(), start, method);
  std::string last;  // words of the attempt that solved it
  std::optional<Run::Verdict> first;
  std::size_t tried = 0;
  for (const Choice& choice : list) {
    if (tried > 0) run.resume(choice.label);
    ++tried;
    run.keep_basis({});
    Result result = run.within(run.mcp(), part_of(run, choice, tried == list.size()), start.x,
                               [&](Run& inner, In z) { run_method(inner, z, choice.method); });
    if (std::holds_alternative<Affine>(choice.method))  // one iteration of this run, whatever its pivots
      result.stats.pivots += std::exchange(result.stats.iterations, std::min(result.stats.iterations, 1));
    if (result.status == Status::Infeasible) explain(run.mcp(), start.x, result);
    last = result.message;
    run.take(result);
    if (!run.ended() || !stuck(run.status())) break;
    if (!first || std::holds_alternative<PathSearch>(choice.method)) first = run.verdict();  // path knows most
  }
  if (first && run.ended() && stuck(run.status())) run.replace_verdict(*first);
  run.stats().restarts += static_cast<int>(tried) - 1;
  if (run.accepted() && run.basis().empty()) run.keep_basis(cells_at(run.box(), run.best()));
  if (run.ended() && run.status() == Status::Solved) run.say(last);
  run.remark(account(list, tried));
}

void describe(Auto& m, Fields& f) {
  f.add("auto_large", &m.large, at_least(0),
        "auto: from more variables on it takes iterative linear algebra and interior points first");
  describe(m.path, f);
  Fields semismooth;  // its keys would be path's
  describe(m.semismooth, semismooth);
  if (const auto why = semismooth.invalid()) f.check(false, "semismooth: " + *why);
}

}  // namespace perp::ncp

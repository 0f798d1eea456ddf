// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/run.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <stdexcept>

#include "contact/laws/first_ncp.hpp"
#include "contact/laws/frictionless.hpp"
#include "contact/laws/inner_faceting.hpp"
#include "contact/laws/outer_faceting.hpp"
#include "contact/model/facts.hpp"
#include "lcp/deadline.hpp"
#include "ncp/problem/affine.hpp"

namespace perp::contact {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;
using Law = Variant::Law;

[[noreturn]] void refuse_solver(const Variant& variant) {
  throw std::invalid_argument("contact::run: the solver is none of formulation " + variant.formulation());
}

/// The solver of one law; it must be the law's.
template <class Solver>
const Solver& solver_of(const Variant& variant) {
  if (const auto* solver = std::get_if<Solver>(&variant.solver)) return *solver;
  refuse_solver(variant);
}

/// Has the method itself made the point?
bool of_method(Origin by) { return by == Origin::Ncp || by == Origin::Iterate; }

void run_exact(Run& run, const Problem& problem, const Variant& variant, const RunLimits& limits) {
  Options options{.tol = limits.tol, .max_time = Seconds(limits.seconds), .interrupt = limits.interrupt};
  options.start = limits.start;
  if (limits.better) options.better = [&limits](const Vec& r, Origin) { limits.better(r); };
  const GlockerNcp* ncp = variant.as_ncp();
  const auto take = [&](const auto& solver) {
    if constexpr (is_method<std::remove_cvref_t<decltype(solver)>>)
      options.method = solver;
    else
      refuse_solver(variant);
  };
  std::visit(take, variant.solver);
  if (ncp != nullptr) run.unknowns = Glocker(scaled(problem, true, WForm::Parts), ncp->formulation).size();
  Result result = solve(problem, options);
  run.status = result.status;
  if (result.solved()) run.solved_by = of_method(result.by) ? variant.method : std::string(to_string(result.by));
  run.message = std::move(result.message);
  run.verdict = std::move(result.verdict);
  run.solution = std::move(result.solution);
  run.residual = result.residual;
  run.history = std::move(result.history);
  run.counts = {{"iterations", result.stats.iterations},         {"sweeps", result.stats.sweeps},
                {"newton_steps", result.stats.newton_steps},     {"splitting_steps", result.stats.splitting_steps},
                {"proximal_steps", result.stats.proximal_steps}, {"attempts", result.stats.attempts},
                {"factorizations", result.stats.factorizations}};
  if (ncp != nullptr) run.counts = {run.counts.front(), run.counts.back()};
  if (variant.law == Law::Coulomb) run.counts = {run.counts[0], run.counts[1], run.counts.back()};
}

/// The NCP's own residual says little of the law's: every iterate is judged, and the method goes on while it can.
void run_first_ncp(Run& run, const Problem& problem, const Variant& variant, const RunLimits& limits) {
  constexpr double tightest = 1e-14;
  const FirstNcp mcp(problem);
  const Judge judge(problem);
  ncp::Method method = solver_of<ncp::Method>(variant);
  ncp::Stop& stop = ncp::stop(method);
  stop.interrupt = limits.interrupt;
  stop.max_time = Seconds(limits.seconds);
  stop.tol = tightest;
  const auto is_accepted = [&](const Solution& point) {
    return point.r.allFinite() && accepted(judge(point.r), limits.tol);
  };
  std::optional<Solution> found;
  double best = lcp::infinity;
  const ncp::Observer watch = [&](const ncp::Iteration& it) {
    if (it.x == nullptr || it.problem != &mcp) return ncp::Next::Continue;
    Solution point = mcp.recover(lcp::project(mcp.box(), *it.x));
    if (limits.better && it.residual < best && point.r.allFinite()) {
      best = it.residual;
      limits.better(point.r);
    }
    if (!is_accepted(point)) return ncp::Next::Continue;
    found = std::move(point);  // the NCP's own residual may prefer another one
    return ncp::Next::Stop;
  };
  const ncp::Result result = ncp::solve(mcp, mcp.start(), method, watch);
  run.unknowns = mcp.size();
  run.solution = found ? std::move(*found) : mcp.recover(result.x);
  run.counts = {{"iterations", result.stats.iterations}, {"factorizations", result.stats.factorizations}};
  if (!run.solution.r.allFinite()) run.solution.r.setZero();  // overflowed: no point came back
  const bool solved = is_accepted(run.solution);
  if (solved) run.solved_by = variant.method;
  run.message = result.message;
  run.status = solved ? Status::Solved : result.solved() || result.message.empty() ? Status::NoProgress : result.status;
  if (!solved && result.solved()) run.message = "the NCP is solved to rounding, Coulomb's law is not: " + run.message;
}

/// The affine problem as an MCP, by a method of ncp/ from zero; judged as all affine problems are.
lcp::Result by_ncp(const lcp::AffineMcp& problem, ncp::Method method, const RunLimits& limits,
                   const lcp::Limits& within) {
  ncp::Stop& stop = ncp::stop(method);
  stop.tol = limits.tol;
  stop.max_time = Seconds(limits.seconds);
  stop.interrupt = limits.interrupt;
  const auto mcp = ncp::make_affine_mcp(problem, "polygons");
  ncp::Result ended = ncp::solve(*mcp, Vec::Zero(problem.size()), method);
  const Vec z = ended.x.allFinite() ? ended.x : Vec(Vec::Zero(problem.size()));
  const Status otherwise = ended.solved() ? Status::NoProgress : ended.status;
  lcp::Result result = lcp::judged(problem, z, within, otherwise, std::move(ended.message));
  result.iterations = ended.stats.iterations;
  result.factorizations = static_cast<int>(ended.stats.factorizations);
  return result;
}

/// Why the theory of the polygons' problems promises nothing here.
std::string no_promise(const Problem& problem) {
  constexpr double symmetric = 1e-12;
  const Facts W = facts(problem);
  if (!W.known) return "of W, which has parts of more than 1,000 rows, it is not known whether it is positive definite";
  std::string why;
  if (W.rank < problem.q.size())
    why = "W has the rank " + std::to_string(W.rank) + " of " + std::to_string(problem.q.size());
  else if (!(W.least > 0))
    why = "the symmetric part of W has a negative eigenvalue";
  if (W.asymmetry > symmetric) why += why.empty() ? "W is not symmetric" : ", and is not symmetric";
  return why.empty() ? "W is positive definite: Lemke's method must end in a solution but for rounding"
                     : why + ": that Lemke's method ends in a solution is proven for positive definite W alone";
}

void run_affine(Run& run, const Problem& source, const AffineEncoding& encoding, const Variant& variant,
                const RunLimits& limits, Clock::time_point begin) {
  const lcp::AffineMcp& problem = encoding.affine();
  lcp::Limits within{.tol = limits.tol};
  within.deadline = lcp::deadline_after(Seconds(limits.seconds), begin);
  if (const auto* interrupt = limits.interrupt) within.interrupted = [interrupt] { return interrupt->load(); };
  EncodingResult result;
  if (std::holds_alternative<EncodingAuto>(variant.solver))
    result = solve(encoding, within);
  else if (const auto* as_mcp = std::get_if<ncp::Method>(&variant.solver))
    result = {by_ncp(problem, *as_mcp, limits, within), variant.method.c_str()};
  else
    result = {solve(encoding, solver_of<lcp::Method>(variant), within), variant.method.c_str()};
  if (result.solved()) run.solved_by = result.by;
  run.unknowns = problem.size();
  run.own = result.residual;
  run.status = result.status;
  run.message = result.message;
  if (!result.accepted() && run.status != Status::TimeLimit && run.status != Status::Interrupted && variant.faceted())
    run.message += (run.message.empty() ? "" : "; ") + no_promise(source);
  run.solution = encoding.recover(result.z);
  run.counts = {{"iterations", result.iterations}, {"factorizations", result.factorizations}};
}

/// The problem with Coulomb's law whose cones hold all impulses of the variant's law: what has no solution there has
/// none under that law. Polygons in the disk and intervals are within Coulomb's cone.
Problem enclosing_problem(const Problem& problem, const Variant& variant) {
  if (variant.law == Law::Frictionless) return without_friction(problem);
  Problem enclosing = problem;
  if (variant.law == Law::Outer && problem.dimension == 3) {
    constexpr double rounding = 1e-14;  // of the polygon's own corners
    for (const Polygon& polygon : variant.polygons(problem.dimension))
      enclosing.mu *= polygon.vertices().colwise().norm().maxCoeff() * (1 + rounding);
  }
  return enclosing;
}

/// What contact::solve asks by itself, in as much time as was spent, of what is left. That a solution exists is known
/// of Coulomb's law alone.
void ask_existence(Run& run, const Problem& problem, const Variant& variant, const RunLimits& limits, Seconds spent) {
  // Interrupted is also that of a method which the judge of its iterates stopped.
  if (run.solved || (limits.interrupt != nullptr && limits.interrupt->load())) return;
  const SearchLimits search = search_after(spent, Seconds(limits.seconds), limits.interrupt);
  if (variant.exact()) {
    run.verdict = existence(problem, search);
  } else {
    const Problem enclosing = enclosing_problem(problem, variant);
    if (auto proof = find_infeasibility(enclosing, search)) run.verdict = verdict_of(enclosing, std::move(*proof));
  }
  if (run.status == Status::Infeasible) run.verdict.existence = Existence::None;  // the method's own proof
  if (run.verdict.existence == Existence::None) run.status = Status::Infeasible;
  if (run.verdict.message.empty()) return;
  run.message += run.message.empty() ? run.verdict.message : "; " + run.verdict.message;
}

}  // namespace

AffineEncoding encoding_of(const Problem& problem, const Variant& variant) {
  const EncodingOptions form{.form = variant.form};
  if (variant.law == Law::Inner) return InnerFaceting(problem, variant.polygons(problem.dimension), form);
  if (variant.law == Law::Outer) return OuterFaceting(problem, variant.polygons(problem.dimension), form);
  if (variant.law == Law::Frictionless) return Frictionless(problem);
  throw std::invalid_argument("contact: formulation " + variant.formulation() + " is no affine problem");
}

long Run::steps() const {
  long sum = 0;
  for (const auto& [what, n] : counts)
    if (what == "iterations" || what == "sweeps" || what == "newton_steps") sum += n;
  return sum;
}

Index Run::in_state(State state) const { return std::ranges::count(states, state, &ContactState::state); }

void judge(Run& run, const Problem& problem, const Variant& variant) {
  run.residual = residual(problem, run.solution.r);
  if (variant.exact()) {
    run.states = states(problem, run.solution.r);
    return;
  }
  // Where a polygon's law lets a contact slip |r_T| need not be mu r_N: what moves, slips.
  run.states = states(without_friction(problem), run.solution.r);
  const int d = problem.dimension;
  for (Index a = 0; a < problem.contacts(); ++a)
    if (ContactState& s = run.states[static_cast<std::size_t>(a)]; s.state == State::Stick)
      s.margin = problem.mu[a] * run.solution.r[d * a] - run.solution.r.segment(d * a + 1, d - 1).norm();
}

Run run(const Problem& problem, const Variant& variant, const RunLimits& limits) {
  const Clock::time_point begin = Clock::now();
  Run run;
  const bool exact = variant.law == Law::Glocker || variant.law == Law::Coulomb;
  if (exact)
    run_exact(run, problem, variant, limits);
  else if (variant.law == Law::Ncp1)
    run_first_ncp(run, problem, variant, limits);
  else
    run_affine(run, problem, encoding_of(problem, variant), variant, limits, begin);
  run.solved = run.status == Status::Solved;
  if (!exact) ask_existence(run, problem, variant, limits, Clock::now() - begin);
  run.seconds = Seconds(Clock::now() - begin).count();
  if (exact)
    run.states = states(problem, run.solution);
  else
    judge(run, problem, variant);
  return run;
}

}  // namespace perp::contact

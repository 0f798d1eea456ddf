// SPDX-License-Identifier: Apache-2.0
#include "ncp/strategy/solve.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>

#include "lcp/equilibrate.hpp"
#include "lcp/words.hpp"
#include "ncp/analysis/certificate.hpp"
#include "ncp/analysis/diagnosis.hpp"
#include "ncp/analysis/no_solution.hpp"
#include "ncp/analysis/structure_report.hpp"
#include "ncp/interval/enclosure.hpp"
#include "ncp/run/notes.hpp"
#include "ncp/run/run.hpp"
#include "ncp/run/undefined_start.hpp"
#include "ncp/strategy/conditions.hpp"
#include "ncp/strategy/run_plan.hpp"
#include "ncp/strategy/structured_run.hpp"
#include "ncp/transforms/presolve.hpp"
#include "ncp/transforms/scale_transform.hpp"

namespace perp::ncp {
namespace {

/// Refuses a basis of another problem.
void check_fit(const Mcp& mcp, const std::vector<lcp::Cell>& basis) {
  if (basis.empty() || static_cast<Index>(basis.size()) == mcp.size()) return;
  refuse_input(mcp.name(), ": the warm start's basis has ", basis.size(), " cells, the problem ", mcp.size(),
               " variables");
}

/// Whether the ranges of F over the box leave no point that the judge could accept; looked at once, if at all.
class RangesRefuse {
 public:
  RangesRefuse(const Mcp& mcp, double tol) : mcp_(mcp), tol_(tol) {}
  /// At most about a millisecond.
  bool cheap() const {
    constexpr double little_work = 30'000;
    const Enclosure* enclosure = mcp_.enclosure();
    return enclosure != nullptr && enclosure->work() <= little_work;
  }
  const std::optional<Run::Verdict>& verdict() {
    if (std::exchange(known_, true)) return verdict_;
    if (const auto proof = no_solution(mcp_, tol_))
      verdict_ =
          Run::Verdict{Status::Infeasible,
                       "proven to have no solution: " + describe(mcp_, *proof),
                       "look for a mistake in the model",
                       {.residual_bound = proof->range.is_empty() && !proof->narrowed ? infinity : largest_excluded(),
                        .within_bounds = true}};
    return verdict_;
  }

 private:
  /// To a factor of two; the tolerance where ranges take long.
  double largest_excluded() const {
    if (!cheap()) return tol_;
    double excluded = tol_;
    double factor = 1024;
    while (excluded < 1e100 && no_solution(mcp_, factor * excluded)) excluded *= factor;
    for (; factor > 2; factor = std::sqrt(factor))
      if (no_solution(mcp_, factor * excluded)) excluded *= factor;
    return excluded;
  }

  const Mcp& mcp_;
  double tol_;
  bool known_ = false;
  std::optional<Run::Verdict> verdict_;
};

/// Where methods are stuck, there may be no solution.
void refute(Run& run, double tol) {
  if (std::optional<Infeasibility> proof = no_solution_by_sums(run.mcp(), tol, run.deadline())) {
    std::string words = "proven to have no solution: " + rows_in_words(run.mcp(), *proof) + " contradict each other";
    if (uses_terms(run.mcp(), *proof))
      words += ", whatever values within their ranges the terms have that are not affine";
    return run.replace_verdict(
        {Status::Infeasible, std::move(words), "look for a mistake in the model", std::move(*proof)});
  }
  if (const int parts = no_solution_in_parts(run.mcp(), tol, run.deadline()); parts > 0)
    run.replace_verdict({Status::Infeasible,
                         "proven to have no solution: in each of " + quantity(parts, "part") +
                             " of the box the ranges of F and J leave none",
                         "look for a mistake in the model",
                         {.residual_bound = tol, .within_bounds = true}});
}

/// Says of an affine problem without a solution what presolve says of it row by row, if it finds a contradiction.
void explain(Run& run, In x0) {
  if (run.status() != Status::Infeasible || !run.mcp().is_affine()) return;
  const Presolved pre = presolve(run.mcp(), x0);
  if (pre.infeasible().empty()) return;
  Run::Verdict verdict = run.verdict();
  verdict.message = "proven to have no solution: " + pre.infeasible();
  run.replace_verdict(std::move(verdict));
}

/// The method, and of runs that have found nothing whether there is nothing. Most problems have a solution: the first
/// attempt goes before the proof, and a cheap proof before other attempts.
void solve_or_refute(Run& run, In x0, const Method& method, std::vector<std::string>& notes) {
  const Mcp& mcp = run.mcp();
  const double tol = stop(method).tol;
  const auto refutation = std::make_shared<RangesRefuse>(mcp, tol);
  run.give_up_where([refutation] { return refutation->cheap() && refutation->verdict(); });
  const Body in_order = [&method](Run& outer, In z0) {
    run_in_order(outer, z0, [&method](Run& inner, In z) { run_plan(inner, z, method); });
  };
  in_order(run, x0);
  if (run.ended() && run.status() == Status::EvaluationFailed && run.iterations() == 0)
    if (const auto moved = moved_start(run.counted(), lcp::project(mcp.box(), x0))) {
      notes.push_back(moved->note);
      run.resume({});
      in_order(run, moved->x);
    }
  if (!run.ended()) return;
  explain(run, x0);
  const bool late = run.status() == Status::TimeLimit;
  const bool lost = ncp::stuck(run.status()) || run.status() == Status::IterationLimit || (late && refutation->cheap());
  if (!lost || mcp.enclosure() == nullptr) return;
  if (const auto& verdict = refutation->verdict())
    run.replace_verdict(*verdict);
  else if (!mcp.is_affine() && !late)
    refute(run, tol);
  if (!late && run.status() != Status::Infeasible) run.remark(words_on_existence(mcp, run.best()));
}

/// A derivative that does not match is the most frequent reason of a failure, and the hardest to see.
void blame_derivatives(const Mcp& mcp, Result& result) {
  constexpr Index columns = 50;
  const JacobianCheck check = check_jacobian(mcp, result.x, 1e-6, columns);
  if (!check.defined) return;
  if (const std::string mismatch = describe(mcp, check, 1e-3); !mismatch.empty()) {
    result.message += "; at this point " + mismatch;
    result.advice = "correct the Jacobian first";
  }
}

/// Says of a solution whether it is the only one near it, where that costs little beside the solve.
void tell_undetermined(const Mcp& mcp, const Stop& stop, const SpMat& J, Result& result) {
  if (mcp.polyhedron() != nullptr) return;  // multipliers need not be unique
  constexpr Index always = 1000;            // rows: some milliseconds
  constexpr int often = 5;                  // one factorization more is a fifth of the time
  if ((mcp.size() > always && result.stats.factorizations < often) || result.stats.time >= stop.max_time) return;
  std::string text = undetermined(mcp, J, result.x, result.F, stop.tol);
  if (!text.empty()) result.notes.push_back(std::move(text));
}

/// A row that is balanced to worse than this share of its terms may be solved by being small.
constexpr double poor_balance = 1e-3;

/// Goes on from a solution whose rows are poorly balanced, in units in which J is near 1 and so is q = F - J x, as long
/// as each time they are balanced ten times better. False: it did not pay.
bool balance(Run& run, Point point, const Method& method) {
  constexpr int most = 5;
  const Mcp& mcp = run.mcp();
  const Body body = [&method](Run& inner, In z0) { run_plan(inner, z0, method); };
  const auto balanced = [&] { return imbalance(mcp, point.J, point.x, point.F, run.tol()); };
  double before = balanced();
  int k = 0;
  for (; k < most && before > poor_balance; ++k) {
    const lcp::AffineMcp linear{point.J, point.F - point.J * point.x, mcp.box()};
    if (linear.invalid()) return k > 0;
    const lcp::Scaling units = lcp::equilibrate(linear);
    const ScaleTransform way(mcp, {.rows = units.rows, .columns = units.columns}, run.tol());
    const Result better = run.within(way, {}, run.best(), body);
    if (better.solved()) point.x = better.x;
    const double after = better.solved() && run.evaluate(point) ? balanced() : infinity;
    if (!(after <= before / 10)) {
      run.stats() += better.stats;
      return k > 0;
    }
    const std::string how = run.verdict().message;
    run.take(better);
    if (const auto remarks = how.find("; "); remarks != std::string::npos) run.remark(how.substr(remarks + 2));
    if (k == 0)
      run.remark("gone on with in units in which its terms are near 1: in its own they are below the tolerance");
    before = after;
  }
  return k > 0;
}

/// Says of a point whose residual some tolerance excuses that variables have grown while it fell: there may be no
/// solution but at infinity.
void tell_run_off(Run& run, In x0, const SpMat& J, Result& result) {
  Point point;
  point.x = result.x;
  point.F = result.F;
  point.J = J;
  const Diagnosis known = diagnose(run.mcp(), point, lcp::project(run.box(), x0), run.earlier());
  if (known.unbounded) result.notes.insert(result.notes.begin(), known.message + "; " + known.advice);
}

void comment(Run& run, In x0, const Method& method, Result& result) {
  const Mcp& mcp = run.mcp();
  std::shared_ptr<const SpMat> J = annotate(mcp, stop(method), result);
  if (J && result.solved() && result.relative > poor_balance) {
    Point point;
    point.x = result.x;
    point.F = result.F;
    point.J = *J;
    const bool better = balance(run, std::move(point), method);
    Result again = run.result(x0);
    if (better) {
      result = std::move(again);
      J = annotate(mcp, stop(method), result);
    } else {
      result.stats = again.stats;
    }
  }
  if (J && result.accepted()) {
    if (!result.notes.empty()) tell_run_off(run, x0, *J, result);
    tell_undetermined(mcp, stop(method), *J, result);
  }
  if (std::holds_alternative<Affine>(method)) return;
  if (stuck(result.status, result.stats) || result.status == Status::IterationLimit ||
      result.status == Status::LinearAlgebraFailed)
    blame_derivatives(mcp, result);
}

/// "; no point has a natural residual below 0.31".
std::string words_on_proof(const Infeasibility& proof) {
  if (!(proof.residual_bound > 0) || proof.residual_bound == infinity) return {};  // no point has a residual at all
  std::string words = std::string("; no point ") + (proof.within_bounds ? "within the bounds " : "") +
                      "has a natural residual below " + number_below(proof.residual_bound);
  if (proof.certificate && proof.certificate->radius < infinity)
    words += " unless a variable is beyond " + number_below(proof.certificate->radius);
  return words;
}

}  // namespace

Result solve(const Mcp& mcp, In x0, const Method& method, const Observer& observer,
             const std::vector<lcp::Cell>& basis) {
  if (const auto why = invalid(method)) refuse_input(name(method), ": ", *why);
  check_input(mcp, x0);
  check_fit(mcp, basis);
  if (stop(method).check_derivatives)
    if (const JacobianCheck check = check_jacobian(mcp, lcp::project(mcp.box(), x0)); check.defined)
      if (const std::string mismatch = describe(mcp, check); !mismatch.empty())
        refuse_input(mcp.name(), ": ", mismatch);
  const JacobianWork before = mcp.jacobian_work();
  Run run(mcp, stop(method), observer);
  run.warm(basis);
  std::vector<std::string> notes;
  solve_or_refute(run, x0, method, notes);
  Result result = run.result(x0);
  result.notes = std::move(notes);
  result.message += words_on_proof(result.proof) + words_on_best(mcp, result);
  comment(run, x0, method, result);
  result.stats.J_colours = static_cast<int>(before.colours);
  result.stats.J_F_evals = static_cast<int>(mcp.jacobian_work().F_evals - before.F_evals);
  return result;
}

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#include "ncp/run/run.hpp"

#include <algorithm>
#include <cmath>

#include "lcp/judge/result.hpp"
#include "ncp/problem/linear_part.hpp"
#include "ncp/run/undefined_start.hpp"

namespace perp::ncp {
namespace {

/// Iterations without progress: so many are always granted; after so many an attempt ends; with fewer the residual is
/// still falling.
constexpr int always_granted = 100;
constexpr int stalled_attempt = 500;
constexpr int still_falling = 20;

/// Advice at a limit, after so many iterations, the last `idle` of them without progress: more of the same only if the
/// residual was falling.
std::string raise_or_not(int made, int idle) {
  if (made == 0) return "raise the limit";
  return idle <= std::min(still_falling, made / 2)
             ? "raise the limit, or go on from the point returned: the residual was still falling"
             : "try another method or start: the residual was not falling any more";
}

}  // namespace

std::string solution_found(const Residual& residual) {
  return "solution found: the natural residual is " + number(residual.natural);
}

Run::Run(const Mcp& mcp, const Stop& stop, const Observer& observer, Judge::Word word)
    : counted_(mcp),
      stop_(stop),
      judge_(counted_, stop, std::make_shared<ExactValues>(mcp), word),
      observer_(observer),
      deadline_(lcp::deadline_after(stop.max_time)) {}

void Run::end(Status status, std::string message, std::string advice) {
  if (status_) return;
  const bool proven = status == Status::Infeasible || status == Status::NotApplicable;
  if (!proven && settled()) return;
  status_ = status == Status::SolvedToRounding ? Status::NoProgress : status;  // that is the judge's to say
  message_ = std::move(message);
  advice_ = std::move(advice);
}

Infeasibility Run::proven(const Vec& y) const {
  const std::optional<LinearPart> part =
      linear_part(mcp(), best_.x.size() > 0 ? best_.x : lcp::project(box(), Vec::Zero(box().size())));
  if (!part) return {};
  lcp::Refutation found = lcp::refute(part->problem, y, tol(), part->rows);
  if (found.tolerance < tol()) return {};
  return {.residual_bound = found.tolerance,
          .certificate = std::make_shared<const lcp::Refutation>(std::move(found)),
          .multipliers = y};
}

Infeasibility Run::proven(std::optional<lcp::Refutation> refutation) const {
  const lcp::AffineMcp* problem = judge_.exact()->problem();
  if (!refutation || problem == nullptr || refutation->tolerance < tol() || !lcp::holds(*problem, *refutation))
    return {};
  return {.residual_bound = refutation->tolerance,
          .certificate = std::make_shared<const lcp::Refutation>(std::move(*refutation))};
}

bool Run::disprove(const Vec& y, const std::string& words) {
  Infeasibility proof = proven(y);
  if (!(proof.residual_bound > 0)) return false;
  end_infeasible(std::move(proof), "proven to have no solution: " + words);
  return true;
}

void Run::end_infeasible(Infeasibility proof, std::string message) {
  if (status_) return;
  end(Status::Infeasible, std::move(message), "look for a mistake in the model");
  proof_ = std::move(proof);
}

bool Run::settled() {
  if (best_.x.size() == 0) return false;
  judge_.refine(best_);
  if (solved(best_)) return true;
  if (!judge_.to_rounding(best_)) return false;
  message_ = "the tolerance is not met, but the residual of every equation is within the rounding of its terms";
  advice_ = "scale the model, or ask for no more digits than its numbers have (--tol)";
  status_ = Status::SolvedToRounding;
  return true;
}

bool Run::start(In x0, Point& point, bool with_J) {
  point.x = lcp::project(box(), x0);
  if (with_J) point.J = mcp().jacobian_pattern();
  const bool has_F = counted_.eval(point.x, point.F);
  const bool begins = best_.x.size() == 0;
  if (begins) best_ = {.x = point.x, .F = point.F, .residual = {}};
  if (!has_F) {
    end(Status::EvaluationFailed, undefined_start(mcp(), point.x, point.F), "give a start inside the domain of F");
    return false;
  }
  Judged there{.x = point.x, .F = point.F, .residual = residual(box(), point.x, point.F)};
  const bool solution = solved(there);
  point.F = there.F;
  if (begins) {
    best_ = std::move(there);
    progress_.met(best_.residual.natural, iterations());
    decade_ = best_;
  } else if (solution || there.residual.natural < best_.residual.natural) {
    keep_best(std::move(there));
  }
  if (solution || !with_J) return true;
  if (!counted_.jacobian(point.x, point.J)) {
    end(Status::EvaluationFailed, undefined_start(mcp(), point.x, point.F, &point.J),
        "give a start inside the domain of the Jacobian, for instance away from the bounds");
    return false;
  }
  return true;
}

Judged Run::judged(const Point& point) {
  Judged judged{.x = lcp::project(box(), point.x), .F = point.F, .residual = {}};
  if (judged.x == point.x || counted_.eval(judged.x, judged.F)) judged.residual = residual(box(), judged.x, judged.F);
  return judged;
}

bool Run::solved(Judged& judged, const SpMat* J) {
  if (!judge_.solved(judged, J)) return false;
  message_ = solution_found(judged.residual);
  status_ = Status::Solved;
  return true;
}

void Run::resume(std::string attempt) {
  status_.reset();
  attempt_ = std::move(attempt);
  offset_ = stats_.iterations;
  attempts_ = Progress(offset_);
}

bool Run::attempt_stalled() const {
  const int idle = attempts_.iterations(iterations());
  return (stop_.max_iterations == no_limit && idle >= stalled_attempt) ||
         (idle >= always_granted && attempts_.seconds() >= stop_.max_stall.count());
}

bool Run::stalled() const {
  return progress_.iterations(iterations()) >= always_granted && progress_.seconds() >= stop_.max_stall.count();
}

void Run::keep_best(Judged&& better) {
  best_ = std::move(better);
  progress_.met(best_.residual.natural, iterations());
  if (!(best_.residual.natural <= decade_.residual.natural / 10)) return;
  earlier_ = std::move(decade_);
  decade_ = best_;
}

void Run::end_at(Status limit, std::string advice) {
  if (limit == Status::Interrupted)
    return end(limit, "interrupted after " + quantity(stats_.iterations, "iteration"),
               "run on from the point returned");
  const std::string what = limit == Status::TimeLimit ? "time limit of " + number(stop_.max_time.count()) + " s"
                           : stats_.iterations < stop_.max_iterations
                               ? "limit of " + quantity(stop_.max_F_evals, "evaluation") + " of F"
                               : "limit of " + quantity(stop_.max_iterations, "iteration");
  end(limit, "the " + what + " was reached", std::move(advice));
}

Stop Run::left() const {
  Stop stop = stop_;
  if (stop.max_iterations != no_limit) stop.max_iterations = std::max(0, stop_.max_iterations - iterations());
  if (stop.max_F_evals != no_limit) stop.max_F_evals = std::max(1, stop_.max_F_evals - F_evals());
  stop.max_pivots = std::max(0, stop_.max_pivots - stats_.pivots);
  stop.max_time = std::max(Seconds(0), Seconds(deadline_ - std::chrono::steady_clock::now()));
  return stop;
}

Observer Run::counting_on(bool start_shown) {
  if (!observer_) {
    attempt_.clear();
    return {};
  }
  Observer counting = [this, start_shown, before = iterations(), F = F_evals(), J = J_evals(),
                       attempt = take_attempt()](const Iteration& it) mutable {
    if (it.k == 0 && !start_shown) return Next::Continue;
    Iteration counted = it;
    counted.k += before;
    counted.F_evals += F;
    counted.J_evals += J;
    if (!attempt.empty()) counted.attempt = std::exchange(attempt, {});
    if (counted.kind == 'I' && !counted.attempt.empty()) counted.kind = 'R';
    return observer_(counted);
  };
  counting.ways = observer_.ways;
  return counting;
}

namespace {

/// Records of the transformed problem as those of the problem itself.
Observer brought_back(const Mcp& mcp, const Transform& way, Observer observer) {
  if (!observer) return {};
  const bool ways = observer.ways;
  Observer brought = [&mcp, &way, observer = std::move(observer)](const Iteration& it) {
    Iteration shown = it;
    shown.problem = &mcp;
    if (it.worst >= 0) shown.worst = way.equation_back(it.worst);
    Vec x;
    if (it.x != nullptr) {
      shown.x = &(x = way.iterate_back(*it.x, it.normal_map));
      if (!way.keeps_residuals()) {
        const Vec z = lcp::project(mcp.box(), x);
        Vec F;
        CountedMcp guarded(mcp);  // for the observer: what the run itself evaluates is counted
        const Residual judged = guarded.eval(z, F) ? residual(mcp.box(), z, F) : Residual{};
        shown.residual = judged.natural;
        shown.worst = judged.worst;
      }
    }
    WayTaken taken;
    if (it.way != nullptr) {
      taken = *it.way;
      for (lcp::Breakpoint& kink : taken.kinks) kink.x = way.kink_back(kink.x);
      shown.way = &taken;
    }
    return observer(shown);
  };
  brought.ways = ways;
  return brought;
}

Stop shared(Stop left, const Share& share) {
  left.max_iterations = std::min(left.max_iterations, share.iterations);
  left.max_F_evals = std::min(left.max_F_evals, share.F_evals);
  left.max_pivots = std::min(left.max_pivots, share.pivots);
  left.tol = share.tol.value_or(left.tol);
  return left;
}

}  // namespace

Result Run::within(const Mcp& mcp, const Stop& limits, const Observer& shown, In x0, std::vector<lcp::Cell> basis,
                   const Body& body, Judge::Word word) {
  Run inner(mcp, limits, shown, word);
  inner.warm(std::move(basis));
  if (word == Judge::Word::Preliminary || &mcp == &this->mcp()) inner.give_up_where(hopeless_);
  body(inner, x0);
  return inner.result(x0);
}

Result Run::within(const Mcp& mcp, const Share& share, In x0, const Body& body) {
  const Observer shown = share.shown ? counting_on(share.start_shown) : Observer{};
  return within(mcp, shared(left(), share), shown, x0, take_warm_basis(), body, Judge::Word::Last);
}

Result Run::within(const Transform& way, const Share& share, In x0, const Body& body, bool* accepted_there) {
  const Stop limits = shared(left(), share);
  Stop there = limits;
  there.tol = way.tolerance(limits.tol);
  const Observer shown = share.shown ? counting_on(share.start_shown) : Observer{};
  Result result = within(way.problem(), there, brought_back(mcp(), way, shown), way.there(x0),
                         way.there(take_warm_basis()), body, Judge::Word::Preliminary);
  if (accepted_there != nullptr) *accepted_there = result.accepted();
  result.x = way.back(result.x);
  result.basis = way.back(result.x, std::move(result.basis));
  judge_here(mcp(), limits, result, judge_.exact());
  if (result.status == Status::Infeasible) {
    const std::shared_ptr<const lcp::Refutation> certificate = result.proof.certificate;
    result.proof = proven(way.multipliers_back(result.proof.multipliers));
    if (!(result.proof.residual_bound > 0) && certificate) result.proof = proven(way.refutation_back(*certificate));
    if (!(result.proof.residual_bound > 0)) {
      result.status = Status::NoProgress;
      result.message = "another form of the problem has no solution, which rounding may have made";
    }
  }
  return result;
}

void Run::replace_verdict(Verdict verdict) {
  status_ = verdict.status;
  message_ = std::move(verdict.message);
  advice_ = std::move(verdict.advice);
  proof_ = std::move(verdict.proof);
}

void Run::remark(const std::string& text) {
  if (!text.empty()) message_ += "; " + text;
}

void Run::take(const Result& other) {
  stats_ += other.stats;
  if (!other.basis.empty()) basis_ = other.basis;
  Judged theirs{.x = other.x, .F = other.F, .residual = other.residual};
  const bool done = other.solved() && solved(theirs);
  const bool rounded = other.status == Status::SolvedToRounding && judge_.to_rounding(theirs);
  if (done || rounded || theirs.residual.natural < best_.residual.natural) keep_best(std::move(theirs));
  if (done) {
    message_ = other.message;
    return;
  }
  if (other.solved()) {
    end(Status::NoProgress, "an attempt's solution was not confirmed: F has other values there now",
        "F must be a function of x alone");
    return;
  }
  if (!ended_with(other))  // limits of its own are no reason to stop
    end(other.status == Status::IterationLimit ? Status::NoProgress : other.status, other.message, other.advice);
  if (status_ == Status::Infeasible) proof_ = other.proof;
}

void Run::charge(const Result& other) {
  stats_ += other.stats;
  ended_with(other);
}

void Run::take_point(const Result& other) {
  if (other.residual.natural < best_.residual.natural)
    keep_best({.x = other.x, .F = other.F, .residual = other.residual});
}

bool Run::ended_with(const Result& other) {
  const bool late = other.status == Status::TimeLimit && std::chrono::steady_clock::now() >= deadline_;
  const bool at_end = !other.accepted() && at_limit() && other.status == Status::IterationLimit;
  if (!at_end && other.status != Status::Interrupted && !late) return false;
  // Of a run that bettered the best point, whether it was still doing so, it knows; of others the answer is no.
  const bool bettered = other.stats.iterations > 0 && progress_.iterations(iterations()) == 0;
  end_at(other.status, bettered ? other.advice : raise_or_not(iterations(), iterations()));
  return true;
}

bool Run::show(const Vec& x, Iteration it, Residual& there) {
  Vec F;
  there = counted_.eval(x, F) ? residual(box(), x, F) : Residual{};
  if (!attempt_.empty()) it.attempt = take_attempt();
  it.k = iterations();
  it.residual = there.natural;
  it.worst = there.worst;
  it.F_evals = F_evals();
  it.J_evals = J_evals();
  it.x = &x;
  it.problem = &mcp();
  if (observer_ && observer_(it) == Next::Stop) end_at(Status::Interrupted, "");
  return !ended();
}

bool stuck(Status status) {
  return status == Status::EvaluationFailed || status == Status::StationaryPoint || status == Status::NoProgress ||
         status == Status::SubproblemFailed || status == Status::Unbounded || status == Status::LinearAlgebraFailed;
}

bool Run::go_on(const Point& point, Iteration it) {
  it.k += offset_;
  it.attempt = take_attempt();
  if (!it.attempt.empty()) it.kind = 'R';
  Judged now = judged(point);
  const Residual of_iterate = now.residual;
  const bool accepted = status_ == Status::Solved || status_ == Status::SolvedToRounding;
  // A run that ended unsolved tells of where it ended, rather than of an earlier point that is as good.
  const bool last = status_ && now.residual.natural <= best_.residual.natural;
  const bool solution = !status_ && solved(now, point.J.rows() > 0 ? &point.J : nullptr);
  stats_.iterations = it.k;
  if (solution || (!accepted && (last || now.residual.natural < best_.residual.natural))) keep_best(std::move(now));
  attempts_.met(of_iterate.natural, it.k);
  const bool done = status_.has_value();
  stats_.pivots += it.pivots;
  stats_.backtracks += it.backtracks;
  if (it.kind == 'G') ++stats_.gradient_steps;
  it.residual = of_iterate.natural;
  it.worst = of_iterate.worst;
  it.F_evals = F_evals();
  it.J_evals = J_evals();
  it.x = &point.x;
  it.problem = &mcp();
  const bool asked_to_stop = observer_ && observer_(it) == Next::Stop;
  if (done) return false;
  if (asked_to_stop || interrupted())
    end_at(Status::Interrupted, "");
  else if (std::chrono::steady_clock::now() >= deadline_)
    end_at(Status::TimeLimit, raise_or_not(it.k - offset_, attempts_.iterations(it.k)));
  else if (at_limit())
    end_at(Status::IterationLimit, raise_or_not(it.k - offset_, attempts_.iterations(it.k)));
  else if (attempt_stalled())
    end(Status::NoProgress,
        "the residual has not fallen by a tenth in " + quantity(attempts_.iterations(it.k), "iteration"),
        "try another method or start");
  return !status_;
}

Result Run::result(In x0) {
  Result out;
  // The residual beside a proof is that of exact sums; a point that meets the tolerance would refute it.
  if (status_ == Status::Infeasible && best_.x.size() > 0 && judge_.solved_at(best_)) {
    status_ = Status::Solved;
    message_ = solution_found(best_.residual);
  }
  out.status = status_.value_or(Status::NoProgress);
  out.message = message_;
  if (out.status != Status::Solved) out.advice = advice_;
  out.x = best_.x;
  out.F = best_.F;
  out.residual = best_.residual;
  if (out.x.size() != x0.size()) {
    out.x = lcp::project(box(), x0);
    out.F = Vec::Constant(x0.size(), std::numeric_limits<double>::quiet_NaN());
  }
  out.basis = basis_;
  if (out.status == Status::Infeasible) out.proof = proof_;
  out.stats = stats_;
  out.stats.F_evals += counted_.F_evals();
  out.stats.J_evals += counted_.J_evals();
  out.stats.time = std::chrono::steady_clock::now() - begin_;
  return out;
}

std::string words_on_best(const Mcp& mcp, const Result& result) {
  const Residual& r = result.residual;
  if (result.status == Status::Solved || r.worst < 0 || !std::isfinite(r.natural)) return {};
  // Which free variable a row is paired with is no part of the model.
  return "; the best point has natural residual " + number(r.natural) + ", worst in equation " +
         mcp.equation_name(r.worst) + (mcp.box().is_free(r.worst) ? "" : " of variable " + mcp.variable_name(r.worst));
}

}  // namespace perp::ncp

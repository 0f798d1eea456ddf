#include "ncp/run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "lcp/result.hpp"

namespace perp::ncp {
namespace {

/// The first entry of J that its pattern has not, or of the pattern that J lost; (-1, -1) if there is none.
std::pair<Index, Index> first_difference(const SpMat& J, const SpMat& pattern) {
  for (Index j = 0; j < pattern.cols(); ++j) {
    SpMat::InnerIterator a(J, j);
    SpMat::InnerIterator b(pattern, j);
    for (; a && b; ++a, ++b)
      if (a.row() != b.row()) return {std::min(a.row(), b.row()), j};
    if (a) return {a.row(), j};
    if (b) return {b.row(), j};
  }
  return {-1, -1};
}

constexpr const char* best_point = "; the best point has natural residual ";

}  // namespace

std::string number(double value) {
  std::ostringstream text;
  text.precision(4);
  text << value;
  return text.str();
}

std::string solution_found(const Residual& residual) {
  return "solution found: the natural residual is " + number(residual.natural);
}

std::string quantity(Index n, std::string_view noun) {
  return std::to_string(n).append(" ").append(noun).append(n == 1 ? "" : "s");
}

bool CountedMcp::eval(In x, Vec& F) {
  ++F_evals_;
  F.setZero(x.size());
  return mcp_.eval(x, F) && F.allFinite();
}

bool CountedMcp::jacobian(In x, SpMat& J) {
  ++J_evals_;
  const SpMat& pattern = mcp_.jacobian_pattern();
  if (J.rows() != pattern.rows() || J.nonZeros() != pattern.nonZeros()) J = pattern;
  if (!mcp_.jacobian(x, J)) return false;
  const bool kept =
      J.isCompressed() && J.rows() == pattern.rows() && J.cols() == pattern.cols() &&
      J.nonZeros() == pattern.nonZeros() &&
      std::equal(pattern.outerIndexPtr(), pattern.outerIndexPtr() + pattern.cols() + 1, J.outerIndexPtr()) &&
      std::equal(pattern.innerIndexPtr(), pattern.innerIndexPtr() + pattern.nonZeros(), J.innerIndexPtr());
  if (!kept) {
    std::ostringstream what;
    what << mcp_.name() << ": the Jacobian does not match its pattern";
    if (J.rows() != pattern.rows() || J.cols() != pattern.cols()) {
      what << ": it is " << J.rows() << " x " << J.cols() << ", the pattern " << pattern.rows() << " x "
           << pattern.cols();
    } else if (const auto [i, j] = first_difference(J, pattern); i >= 0) {
      what << " at the derivative of equation " << mcp_.equation_name(i) << " with respect to variable "
           << mcp_.variable_name(j) << ": it has " << J.nonZeros() << " entries, the pattern " << pattern.nonZeros();
    } else {
      what << ": it is not compressed";
    }
    throw std::invalid_argument(what.str());
  }
  return std::all_of(J.valuePtr(), J.valuePtr() + J.nonZeros(), [](double v) { return std::isfinite(v); });
}

Run::Run(const Mcp& mcp, const Stop& stop, const Observer& observer)
    : counted_(mcp),
      stop_(stop),
      judge_(counted_, stop),
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

void Run::guard(const std::function<void()>& part) {
  // Not end(): to settle what is open takes factorizations too.
  lcp::within_limits(part, [this](lcp::Status status, const std::string& why) {
    if (status_) return;
    const bool late = status == lcp::Status::TimeLimit;
    message_ = late ? "stopped before the time limit: " + why : why;
    advice_ = late ? "raise the time limit, or go on from the point returned"
                   : "a smaller problem, more memory, or --method semismooth --option linear_solver=krylov";
    status_ = late ? Status::TimeLimit : Status::OutOfMemory;
  });
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

bool Run::start(In x0, Point& point) {
  point.x = lcp::project(box(), x0);
  point.J = mcp().jacobian_pattern();
  const bool has_F = counted_.eval(point.x, point.F);
  best_ = {.x = point.x, .F = point.F, .residual = {}};
  if (!has_F) {
    end(Status::EvaluationFailed, undefined_at_start(point.x, point.F), "give a start inside the domain of F");
    return false;
  }
  best_.residual = residual(box(), point.x, point.F);
  if (solved(best_)) return true;  // J is not needed
  point.F = best_.F;
  if (!counted_.jacobian(point.x, point.J)) {
    std::string where;
    for (Index j = 0; j < point.J.cols() && where.empty(); ++j)
      for (SpMat::InnerIterator it(point.J, j); it && where.empty(); ++it)
        if (!std::isfinite(it.value()))
          where = ": the derivative of equation " + equation(it.row()) + " with respect to variable " +
                  mcp().variable_name(j) + " is " + number(it.value());
    end(Status::EvaluationFailed, "the Jacobian is not defined at the start" + where,
        "give a start inside the domain of the Jacobian, for instance away from the bounds");
    return false;
  }
  return true;
}

std::string Run::undefined_at_start(In x, In F) const {
  for (Index i = 0; i < F.size(); ++i)
    if (!std::isfinite(F[i])) {
      const char* value = std::isnan(F[i]) ? "NaN" : "infinite (an overflow or a pole)";
      return "equation " + equation(i) + " is " + value + " at the start, where its variable " +
             mcp().variable_name(i) + " = " + number(x[i]);
    }
  return "F is not defined at the start";
}

Judged Run::judged(const Point& point) {
  Judged judged{.x = lcp::project(box(), point.x), .F = point.F, .residual = {}};
  if (judged.x == point.x || counted_.eval(judged.x, judged.F)) judged.residual = residual(box(), judged.x, judged.F);
  return judged;
}

bool Run::solved(Judged& judged) {
  if (!judge_.solved(judged)) return false;
  message_ = solution_found(judged.residual);
  status_ = Status::Solved;
  return true;
}

void Run::resume(std::string attempt) {
  status_.reset();
  attempt_ = std::move(attempt);
  offset_ = stats_.iterations;
}

void Run::end_at(Status limit) {
  if (limit == Status::Interrupted)
    end(limit, "interrupted after " + quantity(stats_.iterations, "iteration"), "run on from the point returned");
  else if (limit == Status::TimeLimit)
    end(limit, "the time limit of " + number(stop_.max_time.count()) + " s was reached",
        "raise the time limit, or go on from the point returned");
  else if (stats_.iterations < stop_.max_iterations)
    end(Status::IterationLimit, "the limit of " + quantity(stop_.max_F_evals, "evaluation") + " of F was reached",
        "raise the limit if the residual was still falling; otherwise try another method or start");
  else
    end(Status::IterationLimit, "the limit of " + quantity(stop_.max_iterations, "iteration") + " was reached",
        "raise the limit if the residual was still falling; otherwise try another method or start");
}

Stop Run::left() const {
  using Seconds = std::chrono::duration<double>;
  Stop stop = stop_;
  stop.max_iterations = std::max(0, stop_.max_iterations - iterations());
  stop.max_F_evals = std::max(1, stop_.max_F_evals - F_evals());
  stop.max_time = std::max(Seconds(0), Seconds(deadline_ - std::chrono::steady_clock::now()));
  return stop;
}

Observer Run::counting_on() {
  if (!observer_) {
    attempt_.clear();
    return {};
  }
  return [this, before = iterations(), F = F_evals(), J = J_evals(),
          attempt = take_attempt()](const Iteration& it) mutable {
    Iteration counted = it;
    counted.k += before;
    counted.F_evals += F;
    counted.J_evals += J;
    if (!attempt.empty()) counted.attempt = std::exchange(attempt, {});
    if (counted.kind == 'I' && !counted.attempt.empty()) counted.kind = 'R';
    return observer_(counted);
  };
}

void Run::replace_verdict(Verdict verdict) {
  status_ = verdict.status;
  message_ = std::move(verdict.message);
  advice_ = std::move(verdict.advice);
}

void Run::remark(const std::string& text) {
  if (!text.empty()) message_ += "; " + text;
}

void Run::take(const Result& other) {
  stats_ += other.stats;
  Judged theirs{.x = other.x, .F = other.F, .residual = other.residual};
  const bool done = other.solved() && solved(theirs);
  const bool rounded = other.status == Status::SolvedToRounding && judge_.to_rounding(theirs);
  if (done || rounded || theirs.residual.natural < best_.residual.natural) best_ = std::move(theirs);
  if (done) return;
  if (other.solved()) {
    end(Status::NoProgress, "an attempt's solution was not confirmed: F has other values there now",
        "F must be a function of x alone");
    return;
  }
  const bool late = other.status == Status::TimeLimit && std::chrono::steady_clock::now() >= deadline_;
  if ((other.status == Status::IterationLimit && at_limit()) || other.status == Status::Interrupted || late)
    end_at(other.status);
  else  // limits of its own are no reason to stop
    end(other.status == Status::IterationLimit ? Status::NoProgress : other.status,
        other.message.substr(0, other.message.find(best_point)), other.advice);  // result() tells of the best of all
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
  const bool solution = !status_ && solved(now);
  if (solution || (!accepted && (last || now.residual.natural < best_.residual.natural))) best_ = std::move(now);
  const bool done = status_.has_value();
  stats_.iterations = it.k;
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
    end_at(Status::Interrupted);
  else if (std::chrono::steady_clock::now() >= deadline_)
    end_at(Status::TimeLimit);
  else if (at_limit())
    end_at(Status::IterationLimit);
  return !status_;
}

Result Run::result() {
  Result out;
  out.status = status_.value_or(Status::NoProgress);
  out.message = message_;
  if (out.status != Status::Solved) out.advice = advice_;
  out.x = best_.x;
  out.F = best_.F;
  out.residual = best_.residual;
  if (out.status != Status::Solved && out.residual.worst >= 0 && std::isfinite(out.residual.natural))
    out.message += best_point + number(out.residual.natural) + ", worst in equation " + equation(out.residual.worst) +
                   " of variable " + mcp().variable_name(out.residual.worst);
  out.stats = stats_;
  out.stats.F_evals += counted_.F_evals();
  out.stats.J_evals += counted_.J_evals();
  out.stats.time = std::chrono::steady_clock::now() - begin_;
  return out;
}

Result Run::result(In x0) {
  Result out = result();
  if (out.x.size() == x0.size()) return out;
  out.x = lcp::project(box(), x0);
  out.F = Vec::Constant(x0.size(), std::numeric_limits<double>::quiet_NaN());
  return out;
}

}  // namespace perp::ncp

// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/nonlinear.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "contact/model/checks.hpp"
#include "lcp/lu/sparse_lu.hpp"
#include "lcp/words.hpp"

namespace perp::contact {
namespace {

/// q for which the judge's velocities at r are u.
void take_velocities(Problem& contact, const Vec& u, const Vec& r) {
  contact.q.setZero();
  contact.q = u - velocities(contact, r);
}

using NewtonClock = std::chrono::steady_clock;

[[noreturn]] void refuse_step(const auto&... parts) { refuse_input("nonlinear contact: ", parts...); }

/// Refuses vectors that have not n finite entries.
void check_entries(const char* what, In x, Index n) {
  if (x.size() != n) refuse_step(what, " has ", x.size(), " entries; there must be ", n);
  for (Index i = 0; i < n; ++i)
    if (!std::isfinite(x[i])) refuse_step(what, '[', i, "] is ", x[i], ", which is not finite");
}

void check_sizes(const NonlinearProblem& p) {
  const Index m = p.size();
  const Index rows = p.dimension * p.contacts();
  if (p.H.rows() != m || p.H.cols() != rows)
    refuse_step("H is ", p.H.rows(), " x ", p.H.cols(), "; it must be ", m, " x ", rows,
                ", degrees of freedom by dimension times contacts");
  for (int j = 0; j < p.H.outerSize(); ++j)
    for (SpMat::InnerIterator it(p.H, j); it; ++it)
      if (!std::isfinite(it.value()))
        refuse_step("H(", it.row(), ", ", it.col(), ") is ", it.value(), ", which is not finite");
  if (!p.H.isCompressed()) refuse_step("H is not compressed");
  check_entries("w", p.w, rows);
  if (p.scale.size() == 0) return;
  check_entries("scale", p.scale, m);
  for (Index i = 0; i < m; ++i)
    if (p.scale[i] < 0) refuse_step("scale[", i, "] is ", p.scale[i], ", not >= 0");
}

/// A point (v, r), with R and the residual of the dynamics.
struct NonlinearPoint {
  Vec v{};
  Vec r{};
  Vec R{};
  Vec rest{};  // R - H r
};

/// R near v: A = R'(v), its factors, and W.
struct Linearised {
  SpMat A{};
  lcp::SparseLu lu{};
  Vec D{};            // of the header
  Problem contact{};  // W, mu; q is that of the last problem solved
};

class NonlinearNewton {
 public:
  NonlinearNewton(const NonlinearProblem& problem, const NonlinearOptions& options)
      : problem_(problem), options_(options), J_R_before_(problem.R->jacobian_work().F_evals) {}

  void run(In v);
  NonlinearResult result();

 private:
  bool end(Status status, std::string message);
  bool over();
  double seconds_left() const;
  bool evaluate(NonlinearPoint& point);
  bool linearise();
  bool make_contact_problem(Linearised& at);
  void begin_on_the_law();
  bool path_point(double t, NonlinearPoint& point);
  bool search();
  void measure(double step);
  void record(double step);
  bool judge(double step);
  double merit(const NonlinearPoint& point) const { return point.rest.cwiseQuotient(linear_.D).norm(); }
  double dynamics_scale() const;

  const NonlinearProblem& problem_;
  const NonlinearOptions& options_;
  const NewtonClock::time_point begin_ = NewtonClock::now();
  NonlinearPoint point_{};
  Linearised linear_{};
  NonlinearResult result_{};
  NonlinearRecord now_{};
  bool ended_ = false;
  std::string inner_message_{};
  Status inner_status_ = Status::Solved;
  long J_R_before_ = 0;
  bool on_the_law_ = true;
};

bool NonlinearNewton::end(Status status, std::string message) {
  result_.status = status;
  result_.message = std::move(message);
  ended_ = true;
  return true;
}

double NonlinearNewton::seconds_left() const {
  return std::chrono::duration<double>(options_.max_time - (NewtonClock::now() - begin_)).count();
}

bool NonlinearNewton::over() {
  if (ended_) return true;
  if (options_.interrupt != nullptr && *options_.interrupt) return end(Status::Interrupted, "interrupted");
  if (seconds_left() <= 0)
    return end(Status::TimeLimit, text_of("the time limit of ", options_.max_time.count(), " s was reached"));
  return false;
}

/// R at point.v; false where it is not defined.
bool NonlinearNewton::evaluate(NonlinearPoint& point) {
  ++result_.stats.R_evals;
  point.R.setZero(problem_.size());
  if (!point.v.allFinite() || !problem_.R->eval(point.v, point.R) || !point.R.allFinite()) return false;
  point.rest = point.R - problem_.H * point.r;
  return point.rest.allFinite();
}

/// A, its factors and W at the point; false where that cannot be, with the reason told and the last ones kept.
bool NonlinearNewton::linearise() {
  Linearised at{.A = problem_.R->jacobian_pattern()};
  ++result_.stats.J_evals;
  if (!problem_.R->jacobian(point_.v, at.A) || !Vec(at.A.coeffs()).allFinite())
    return !end(Status::EvaluationFailed, text_of("R' is not defined after ", now_.k, " Newton steps"));
  if (now_.k > 0 && (at.A.coeffs() == linear_.A.coeffs()).all()) return true;  // R is linear there
  ++result_.stats.factorizations;
  if (at.lu.factor(at.A) != lcp::LuStatus::Ok)
    return !end(Status::Singular, text_of("R' is singular after ", now_.k, " Newton steps"));
  const Vec diagonal = at.A.diagonal().cwiseAbs();
  const double typical = diagonal.maxCoeff() > 0 ? diagonal.maxCoeff() : 1;
  at.D = diagonal.unaryExpr([&](double a) { return std::sqrt(a > 0 ? a : typical); });
  if (problem_.contacts() > 0 && !make_contact_problem(at)) return false;
  linear_ = std::move(at);
  return true;
}

/// W = H' A^-1 H.
bool NonlinearNewton::make_contact_problem(Linearised& at) {
  const Index m = problem_.size();
  ++result_.stats.factorizations;  // condense() factors A by itself
  try {
    at.contact = condense({.M = at.A, .H = problem_.H, .G = SpMat(m, 0), .f = Vec::Zero(m), .w = problem_.w},
                          problem_.mu, problem_.dimension, problem_.name);
  } catch (const std::invalid_argument& why) {  // H, w, mu are checked: A is singular up to rounding
    return !end(Status::Singular, text_of("R' cannot be used after ", now_.k, " Newton steps: ", why.what()));
  }
  at.contact.global.reset();  // q is not its
  at.contact.rounding.q.resize(0);
  return true;
}

/// The point of (*) at t from the last one; false if no r or no R was found there.
bool NonlinearNewton::path_point(double t, NonlinearPoint& point) {
  const Vec& r_k = point_.r;
  const Vec held = t * point_.R + (1 - t) * (problem_.H * r_k);
  Vec step(problem_.size());
  linear_.lu.solve_refined(held, step);
  point.r = r_k;
  if (problem_.contacts() > 0) {
    linear_.contact.q = problem_.H.transpose() * (point_.v - step) + problem_.w;
    if (!linear_.contact.q.allFinite()) return false;
    const RunLimits limits{.tol = options_.inner_share * options_.tol,
                           .seconds = std::max(0.0, seconds_left()),
                           .interrupt = options_.interrupt,
                           .start = r_k.isZero(0) ? Vec() : r_k};
    Run inner = contact::run(linear_.contact, options_.inner, limits);
    ++now_.inner_solves;
    now_.inner_steps += inner.steps();
    inner_status_ = inner.status;
    inner_message_ = std::move(inner.message);
    if (!inner.solved) return false;
    point.r = std::move(inner.solution.r);
  }
  const Vec right = problem_.H * point.r - held;
  linear_.lu.solve_refined(right, step);
  point.v = point_.v + step;
  return evaluate(point);
}

/// The law at v itself, as if by an impact: t = 0 of (*). Where that fails any first step is taken.
void NonlinearNewton::begin_on_the_law() {
  Problem& contact = linear_.contact;
  if (problem_.contacts() == 0) return;
  take_velocities(contact, problem_.H.transpose() * point_.v + problem_.w, point_.r);
  if (accepted(residual(contact, point_.r), options_.tol)) return;
  NonlinearPoint on_it;
  on_the_law_ = path_point(0, on_it);
  if (on_the_law_) point_ = std::move(on_it);
}

double NonlinearNewton::dynamics_scale() const {
  const auto size = [&](const Vec& terms) { return terms.cwiseQuotient(linear_.D).norm(); };
  const Vec impulses = problem_.H.cwiseAbs() * point_.r.cwiseAbs();
  const Vec momenta = linear_.A.cwiseAbs() * point_.v.cwiseAbs();
  const double given = problem_.scale.size() > 0 ? size(problem_.scale) : 0;
  return std::max({size(impulses), size(momenta), given});
}

/// Writes down what the point is worth, in the scales of linear_.
void NonlinearNewton::measure(double step) {
  result_.v = point_.v;
  result_.solution = {point_.r, problem_.H.transpose() * point_.v + problem_.w};
  result_.residual = {};
  if (problem_.contacts() > 0) {
    take_velocities(linear_.contact, result_.solution.u, point_.r);
    result_.residual = residual(linear_.contact, point_.r);
  }
  const double rest = merit(point_);
  result_.dynamics = rest > 0 ? rest / dynamics_scale() : 0;
  now_.step = step;
  now_.dynamics = result_.dynamics;
  now_.law = result_.residual.largest();
}

/// Says whether the point is the end. linear_ is that of the point: by R' of the last one, which may be far stiffer, a
/// residual can be small that is not.
bool NonlinearNewton::judge(double step) {
  record(step);
  const bool balanced = result_.dynamics <= options_.tol;
  if (balanced && accepted(result_.residual, options_.tol)) return end(Status::Solved, "solved");
  if (balanced && !options_.inner.exact() && step == 1)
    return end(Status::NotApplicable,
               text_of("R = H r with the law of ", options_.inner.formulation(), ", which is not Coulomb's"));
  return over();
}

void NonlinearNewton::record(double step) {
  measure(step);
  result_.history.push_back(now_);
  result_.stats.inner_solves += now_.inner_solves;
  result_.stats.inner_steps += now_.inner_steps;
  now_.inner_solves = now_.inner_steps = 0;
  if (options_.observer) options_.observer(now_);
}

/// A Newton step: the largest t = 1, 1/2, 1/4, .. at which |R - H r| falls enough. False where there is none.
bool NonlinearNewton::search() {
  const double before = on_the_law_ ? merit(point_) : lcp::infinity;
  NonlinearPoint next;
  bool defined = false;
  for (double t = 1; t >= options_.shortest_step && !over(); t /= 2) {
    const bool found = path_point(t, next);
    defined = defined || found;
    if (!found && !options_.search) break;
    if (!found || (options_.search && !(merit(next) <= (1 - options_.decrease * t) * before))) continue;
    point_ = std::move(next);
    on_the_law_ = true;
    ++now_.k;
    ++result_.stats.iterations;
    now_.step = t;
    return true;
  }
  if (over()) return false;
  if (defined) return !end(Status::NoProgress, "|R - H r| does not fall along the path");
  if (inner_status_ != Status::Solved)
    return !end(inner_status_ == Status::Infeasible ? Status::Infeasible : Status::SubproblemFailed,
                text_of("the linearised problem was not solved by ", options_.inner.label(), ": ", inner_message_));
  return !end(Status::EvaluationFailed, "R is not defined at the end of any step");
}

void NonlinearNewton::run(In v) {
  result_.v = point_.v = v;
  point_.r = options_.start.size() > 0 ? options_.start : Vec::Zero(problem_.w.size());
  evaluate(point_);  // defined: check() has asked
  result_.solution = {point_.r, problem_.H.transpose() * point_.v + problem_.w};
  result_.dynamics = result_.residual.siconos = lcp::infinity;  // not known before W is
  if (!linearise()) return;
  begin_on_the_law();
  for (double t = 0; !judge(t); t = now_.step) {
    if (now_.k == options_.max_iterations) {
      end(Status::IterationLimit, text_of("not solved after ", now_.k, " Newton steps"));
      return;
    }
    if (!search()) return;
    if (over() || !linearise()) {
      record(now_.step);  // by the last R'
      return;
    }
  }
}

NonlinearResult NonlinearNewton::result() {
  result_.stats.J_R_evals = problem_.R->jacobian_work().F_evals - J_R_before_;
  result_.stats.time = NewtonClock::now() - begin_;
  result_.message =
      text_of(result_.message, ": |R - H r| is ", result_.dynamics, " and Coulomb's law holds to ",
              result_.residual.largest(), ", relative, after ", result_.stats.iterations, " Newton steps");
  return std::move(result_);
}

}  // namespace

void check(const NonlinearProblem& problem, In v) {
  if (!problem.R) refuse_step("there is no R");
  check_dimension(problem.dimension);
  check_friction(problem.mu);
  check_sizes(problem);
  const ncp::Mcp& R = *problem.R;
  const Index m = problem.size();
  if (const auto why = R.box().invalid()) refuse_step("the bounds of v: ", *why);
  for (Index i = 0; i < m; ++i)
    if (R.box().lower[i] != -lcp::infinity || R.box().upper[i] != lcp::infinity)
      refuse_step(R.variable_name(i), " is bounded by [", R.box().lower[i], ", ", R.box().upper[i],
                  "]; velocities have no bounds");
  if (R.jacobian_pattern().rows() != m || R.jacobian_pattern().cols() != m)
    refuse_step("the pattern of R' is ", R.jacobian_pattern().rows(), " x ", R.jacobian_pattern().cols(),
                "; it must be ", m, " x ", m);
  check_entries("v", v, m);
  Vec value = Vec::Zero(m);
  const bool defined = R.eval(v, value);
  for (Index i = 0; i < m; ++i)
    if (!std::isfinite(value[i])) refuse_step("R is ", value[i], " at the start in ", R.equation_name(i));
  if (!defined) refuse_step("R is not defined at the start");
  SpMat J = R.jacobian_pattern();
  if (!R.jacobian(v, J)) refuse_step("R' is not defined at the start");
  for (int j = 0; j < J.outerSize(); ++j)
    for (SpMat::InnerIterator it(J, j); it; ++it)
      if (!std::isfinite(it.value()))
        refuse_step("R' is ", it.value(), " at the start in ", R.equation_name(it.row()), " by ",
                    R.variable_name(it.col()));
}

void describe(NonlinearOptions& o, ncp::Fields& f) {
  f.add("tol", &o.tol, ncp::above(0), "of Coulomb's law and of R = H r");
  f.add("inner_share", &o.inner_share, ncp::strictly_between(0, 1), "tolerance of the inner problems over tol");
  f.add("max_iterations", &o.max_iterations, ncp::at_least(0), "Newton steps");
  f.add("search", &o.search, "shorter steps where |R - H r| does not fall");
  f.add("decrease", &o.decrease, ncp::strictly_between(0, 1), "share of the step by which |R - H r| must fall");
  f.add("shortest_step", &o.shortest_step, ncp::strictly_between(0, 1), "at which the search gives up");
  f.add("max_time", &o.max_time, ncp::at_least(0), "seconds");
}

std::optional<std::string> invalid(const NonlinearOptions& given) {
  NonlinearOptions options = given;
  ncp::Fields fields;
  describe(options, fields);
  return fields.invalid();
}

NonlinearResult solve(const NonlinearProblem& problem, In v, const NonlinearOptions& options) {
  check(problem, v);
  if (const auto why = invalid(options)) refuse_step(*why);
  if (options.start.size() != 0) check_entries("the start r", options.start, problem.w.size());
  NonlinearNewton newton(problem, options);
  newton.run(v);
  return newton.result();
}

}  // namespace perp::contact

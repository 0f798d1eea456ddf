// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>
#include <utility>

#include "lcp/cholesky/symmetric.hpp"
#include "lcp/qp/bound_qp.hpp"
#include "ncp/path/newton_josephy.hpp"
#include "ncp/path/newton_point.hpp"
#include "ncp/reformulation/line_search.hpp"
#include "ncp/reformulation/merit.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {
namespace {

/// lambda of the proximal terms tried in turn, relative to the size of J.
constexpr double prox_first = 1e-6;
constexpr double prox_growth = 100;
constexpr int prox_tries = 5;

/// A path that ends before t = 1 is worth following if it came so far; shorter ones hold a run where it is.
constexpr double partial_path = 0.1;

struct Step {
  lcp::PivotResult path;
  double lambda = 0;
  bool qp = false;
};

/// Auto: pivoting solves smaller problems in milliseconds.
constexpr Index pivoting_to = 2000;

/// Solves subproblems of one run: from the cells the last one ended in, then from a ray, then with a proximal term.
class Subproblems {
 public:
  Subproblems(Run& run, const NewtonJosephy& method)
      : run_(run),
        options_(linearised_options(run, method.lemke)),
        qp_(method.subproblem == Subproblem::Qp ||
            (method.subproblem == Subproblem::Auto && run.box().size() > pivoting_to)) {}

  /// The solution of the linearised problem with this lambda, from `start`, then from rays with several covering
  /// vectors. Not solved: the path from `start`, for the points on a path from a ray say nothing of the way from z^k.
  Step solve(const Point& point, const Vec& start, double lambda) {
    const lcp::AffineMcp problem = linearised(run_.box(), point, lambda);
    if (qp_ && lcp::symmetric(problem.M)) {
      Step by_qp{.path = quadratic(problem, point.x), .lambda = lambda, .qp = true};
      nested_ = false;
      if (by_qp.path.solved() || stopped(by_qp.path)) return by_qp;
    }
    Step step{.path = path_or_rays(problem, start, options_), .lambda = lambda};
    run_.stats().factorizations += step.path.refactorizations;
    pivots_ += step.path.pivots;
    return step;
  }

  /// The linearised problem with J of another point, by bound_qp. Not solved: the answer has no z.
  lcp::PivotResult chord(const Point& point, const SpMat& J) {
    return quadratic({.M = J, .q = point.F - J * point.x, .box = run_.box()}, point.x);
  }

  /// Whether quadratic programs are tried first.
  bool by_qp() const { return qp_; }
  int take_pivots() { return std::exchange(pivots_, 0); }

 private:
  lcp::PivotResult quadratic(const lcp::AffineMcp& problem, In z) {
    if (!finite(problem)) return {};
    const lcp::Limits limits{.tol = subproblem_tol(problem, options_.residual_tol),
                             .deadline = options_.deadline,
                             .interrupted = options_.interrupted};
    const lcp::Result found = lcp::bound_qp(problem, z, {.nested = nested_}, limits);
    run_.stats().factorizations += found.factorizations;
    pivots_ += static_cast<int>(found.iterations);
    lcp::PivotResult path;
    if (found.status == Status::Interrupted) path.end = lcp::PivotEnd::Interrupted;
    if (found.status == Status::TimeLimit) path.end = lcp::PivotEnd::TimeLimit;
    if (!found.accepted()) return path;
    path.end = lcp::PivotEnd::Solved;
    path.z = found.z;
    path.x = normal_point(problem.box, found.z, problem.M * found.z + problem.q);
    path.t = path.best_t = 1;
    return path;
  }

  Run& run_;
  const lcp::LemkeOptions options_;
  bool qp_;
  bool nested_ = true;  // coarse grids give the first start; later ones are near already
  int pivots_ = 0;
};

/// Chord steps from the point of a full step, with the Jacobian of the point before.
void chords(Run& run, const NewtonJosephy& method, Subproblems& subproblems, const SpMat& J, Point& point,
            double& psi) {
  constexpr double keep = 0.25;  // half of the norm
  const CFunction fb = fischer_burmeister();
  Point trial;
  trial.J = point.J;
  for (int k = 0; k < method.chord_steps; ++k) {
    // Where the next point is judged solved there is nothing to gain.
    if (residual(run.box(), point.x, point.F).natural <= run.tol()) break;
    const lcp::PivotResult path = subproblems.chord(point, J);
    if (!path.solved()) break;
    trial.x = path.z;
    if (!run.counted().eval(trial.x, trial.F)) break;
    const double merit_there = merit(fb, run.box(), trial.x, trial.F);
    if (!(merit_there <= keep * psi) || !run.counted().jacobian(trial.x, trial.J)) break;
    std::swap(point, trial);
    psi = merit_there;
    ++run.stats().chord_steps;
  }
}

/// Newton steps with growing proximal terms until one is searched with success. The step that ended the attempts.
Step newton_step(Subproblems& subproblems, const Box& box, const Vec& start, double merit, Searches& searches,
                 Iteration& it, Point& point) {
  Step step;
  double lambda = 0;
  for (int i = 0; i <= prox_tries && !searches.found(); ++i) {
    step = subproblems.solve(point, start, lambda);
    if (stopped(step.path)) break;
    const bool solved = step.path.solved();
    if (solved || step.path.best_t >= partial_path) {
      const Vec end = solved ? step.path.z : lcp::project(box, step.path.best_x);
      // Armijo's slope of a Newton step on Psi = 1/2 ||Phi||^2 is -2 Psi, of the part t of the way -2 t Psi.
      searches.along(end - point.x, -2 * merit * (solved ? 1 : step.path.best_t), point);
      it.linear = step.qp ? 'Q' : ' ';
      it.kind = solved ? (lambda > 0 ? 'P' : 'N') : 'R';
    }
    it.prox = lambda;
    lambda = lambda > 0 ? prox_growth * lambda : prox_first * size_of(point.J);
  }
  return step;
}

void give_up(Run& run, const Step& step, const Searches& searches) {
  if (searches.nowhere_defined())
    run.end(Status::EvaluationFailed, "F or its Jacobian is not defined at any trial point, however short the step",
            "try another start or method");
  else if (!step.path.solved())
    run.end(Status::SubproblemFailed,
            "the linearised problem could not be solved (" + std::string(lcp::to_string(step.path.end)) +
                "), with proximal terms up to " + std::to_string(step.lambda) + " neither",
            "try the semismooth method or another start");
  else
    run.end(Status::NoProgress, "neither the Newton steps nor the gradient decrease the merit function",
            "try the semismooth method or another start");
}

}  // namespace

void iterate(Run& run, const NewtonJosephy& method, Point point) {
  const CFunction fb = fischer_burmeister();
  Linearisation descent;
  Subproblems subproblems(run, method);
  Memory memory(method.search.memory);
  Stall stall;
  Iteration it{.k = 0, .kind = 'I'};
  it.merit = merit(fb, run.box(), point.x, point.F);
  memory.push(it.merit);
  Vec start = normal_point(run.box(), point.x, point.F);

  while (run.go_on(point, it)) {
    linearise(fb, run.box(), point, descent);
    if (stall.stalled(descent.merit)) {
      run.end(Status::NoProgress, "the Fischer-Burmeister merit function has stopped falling",
              "try another start, or --method semismooth");
      break;
    }
    it = {.k = it.k + 1};
    Searches searches(run, fb, method.search, memory.reference(), it);
    const SpMat before = method.chord_steps > 0 && subproblems.by_qp() ? point.J : SpMat();
    const Step step = newton_step(subproblems, run.box(), start, descent.merit, searches, it, point);
    const bool full_step = searches.full_step();
    if (full_step && step.qp) chords(run, method, subproblems, before, point, searches.merit());
    it.pivots = subproblems.take_pivots();
    if (!searches.found() && !stopped(step.path)) {
      const Vec d = lcp::project(run.box(), point.x + descent.cauchy_step()) - point.x;
      it.kind = 'G';
      it.prox = 0;
      if (!searches.along(d, descent.gradient.dot(d), point)) {
        give_up(run, step, searches);
        break;
      }
    }
    it.merit = searches.found() ? searches.merit() : descent.merit;
    it.step = searches.t();
    memory.push(it.merit);
    const bool cells_known = full_step && step.path.solved() && !step.qp;
    start = cells_known ? step.path.x : normal_point(run.box(), point.x, point.F);
  }
}

void describe(NewtonJosephy& m, Fields& f) {
  describe(m.search, f);
  f.add("chord_steps", &m.chord_steps, between(0, 1000),
        "simplified Newton steps with the last matrix after a Newton point, while they pay; where quadratic programs "
        "are solved");
  f.choice("subproblem", &m.subproblem,
           {{"lemke", Subproblem::Lemke}, {"qp", Subproblem::Qp}, {"auto", Subproblem::Auto}},
           "linearised problems of josephy: lemke (pivoting), qp (quadratic programs where J is symmetric) or auto (qp "
           "for more than 2000 variables)");
  describe_start(m.lemke.start, f);
  describe(m.lemke, f);
}

}  // namespace perp::ncp

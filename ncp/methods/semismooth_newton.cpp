// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <utility>

#include "lcp/dense_factors.hpp"
#include "ncp/methods/newton_direction.hpp"
#include "ncp/methods/semismooth_newton.hpp"
#include "ncp/reformulation/line_search.hpp"
#include "ncp/reformulation/merit.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {
namespace {

/// Less merit than this share within 60 iterations is progress.
constexpr double progress = 0.99;

/// After a full Newton step: x+ = x + d with H d = -Phi(x), H that of the Newton step, with Anderson's acceleration: of
/// the last steps dX and the changes dD of d between them, the combination that d is nearest to is taken away.
class ChordSteps {
 public:
  ChordSteps(Run& run, const SemismoothNewton& method, Directions& directions)
      : run_(run), method_(method), directions_(directions) {}

  /// False where none was of use in the last two iterations: the function bends at its kinks, not smoothly.
  bool worthwhile() const { return method_.forcing.chord_steps > 0 && idle_ < 2; }

  /// Moves x and F on while ||Phi|| halves; psi becomes 1/2 ||Phi||^2 there.
  void run(Vec& x, Vec& F, double& psi) {
    Eigen::MatrixXd dX(x.size(), 0);
    Eigen::MatrixXd dD(x.size(), 0);
    Vec Phi(x.size());
    Vec last_d;
    Vec last_x;
    Vec trial;
    Vec F_there;
    bool moved = false;
    reformulate(method_.cfunction, run_.box(), x, F, Phi);
    double norm = Phi.norm();
    for (int k = 0; k < method_.forcing.chord_steps && !solved(x, F); ++k) {
      Vec d;
      if (!directions_.chord(Phi, d)) break;
      Vec step = d;
      if (k > 0) {
        append(dX, x - last_x);
        append(dD, d - last_d);
        const Vec gamma = dD.colPivHouseholderQr().solve(d);
        if (gamma.allFinite()) step -= (dX + dD) * gamma;
      }
      trial = x + step;
      if (!run_.counted().eval(trial, F_there)) break;
      reformulate(method_.cfunction, run_.box(), trial, F_there, Phi);
      const double there = Phi.norm();
      if (!(there <= 0.5 * norm)) break;
      last_d = std::move(d);
      last_x = x;
      x.swap(trial);
      F.swap(F_there);
      norm = there;
      moved = true;
      ++run_.stats().chord_steps;
    }
    idle_ = moved ? 0 : idle_ + 1;
    if (moved) psi = 0.5 * norm * norm;
  }

  /// Nothing is left to do at x: its J is not needed.
  bool solved(const Vec& x, const Vec& F) const {
    return residual(run_.box(), x, F).natural <= run_.tol() && lcp::project(run_.box(), x) == x;
  }

 private:
  static void append(Eigen::MatrixXd& columns, const Vec& column) {
    constexpr Index depth = 4;
    if (columns.cols() == depth) columns.leftCols(depth - 1) = columns.rightCols(depth - 1).eval();
    if (columns.cols() < depth) columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
    columns.rightCols(1) = column;
  }

  Run& run_;
  const SemismoothNewton& method_;
  Directions& directions_;
  int idle_ = 0;
};

/// The step of one iteration.
class Steps {
 public:
  Steps(Run& run, const SemismoothNewton& method)
      : run_(run),
        method_(method),
        directions_(run, method),
        chords_(run, method, directions_),
        halving_(!method.cfunction.smooth_merit),
        searched_(halving_ ? fischer_burmeister() : method.cfunction),
        memory_(method.search.memory) {}

  /// The first of the steps, from the fastest to the safest, that is accepted. False: none is; the run has ended, or is
  /// to stop. Chord steps follow a full Newton step.
  bool take(Point& point, Iteration& it) {
    Direction newton{.d = {}};
    if (!has_J_ && !evaluate_J(point)) return false;
    if (halving_ && halve(point, newton, it)) return true;
    linearise(searched_, run_.box(), point, at_, !directions_.krylov());
    if (std::exchange(halved_, false))
      memory_.reset(at_.merit);
    else
      memory_.push(at_.merit);
    undefined_ = 0;
    return !stuck() && (descend(point, newton, it) || give_up(it));
  }

  std::string remark() const { return directions_.remark(); }

 private:
  /// The full Newton step, if it leaves at most half of the least ||Phi|| so far; `newton` is its direction. There are
  /// infinitely many such steps only if Phi goes to zero, so they do not spoil what the others guarantee (De Luca,
  /// Facchinei & Kanzow, Comput. Optim. Appl. 16 (2000) 173).
  bool halve(Point& point, Direction& newton, Iteration& it) {
    Linearisation own;
    elements(method_.cfunction, run_.box(), point, own.at);
    least_ = std::min(least_, own.at.Phi.norm());
    const auto any = [](const Vec&) { return true; };
    if (!directions_.newton(own, point, any, newton)) return false;
    Vec x = point.x + newton.d;
    Vec F;
    if (!run_.counted().eval(x, F)) return false;
    double psi = merit(method_.cfunction, run_.box(), x, F);
    if (!(psi <= 0.125 * least_ * least_)) return false;
    if (newton.linear == 'K' && chords_.worthwhile()) chords_.run(x, F, psi);
    if (!move(point, std::move(x), std::move(F))) return false;
    halved_ = true;
    tell(newton, 1, it);
    it.merit = psi;
    return true;
  }

  /// J too, unless x looks like a solution. False, and nothing moved, if J is not defined there.
  bool move(Point& point, Vec x, Vec F) {
    has_J_ = !chords_.solved(x, F);
    if (has_J_) {
      if (!run_.counted().jacobian(x, spare_)) return false;
      point.J.swap(spare_);
    }
    point.x = std::move(x);
    point.F = std::move(F);
    return true;
  }

  /// What move() left out, where the judge did not think x a solution.
  bool evaluate_J(Point& point) {
    has_J_ = run_.counted().jacobian(point.x, point.J);
    if (!has_J_)
      run_.end(Status::EvaluationFailed, "the Jacobian is not defined at the last iterate", "try another start");
    return has_J_;
  }

  /// Whether the merit function has let the run down, which has ended then.
  bool stuck() {
    const bool stationary = at_.stationarity <= stationary_tol;
    if (!stationary && !stall_.stalled(at_.merit)) return false;
    run_.end(stationary ? Status::StationaryPoint : Status::NoProgress,
             stationary
                 ? "a stationary point of the merit function 1/2 ||Phi||^2 (" + searched_.name + ") that is no solution"
                 : "the merit function 1/2 ||Phi||^2 (" + searched_.name + ") has stopped falling",
             "try another start, or --method josephy: this method cannot leave a local minimum of its merit function");
    return true;
  }

  /// A search along Newton's, then Levenberg-Marquardt's directions, then the negative gradient.
  bool descend(Point& point, Direction& newton, Iteration& it) {
    const Vec& g = at_.gradient;
    const auto descends = [&](const Vec& d) {
      const double rms = d.norm() / std::sqrt(static_cast<double>(d.size()));
      return g.dot(d) <= -method_.descent_rho * std::pow(rms, method_.descent_p);
    };
    const bool usable =
        halving_ ? newton.d.size() > 0 && descends(newton.d) : directions_.newton(at_, point, descends, newton);
    if (usable && search(newton, point, it)) return true;
    double nu = directions_.first_nu(at_, point);
    const int tries = method_.levenberg_marquardt ? lm_tries : 0;
    for (int i = 0; i < tries && !directions_.stopped(); ++i, nu *= lm_growth) {
      Direction lm;
      if (directions_.levenberg_marquardt(at_, point, nu, lm) && g.dot(lm.d) < 0 && search(lm, point, it)) return true;
    }
    return !directions_.stopped() && search(directions_.gradient(at_, point), point, it);
  }

  bool search(const Direction& direction, Point& point, Iteration& it) {
    const SearchOutcome found = line_search(run_, searched_, method_.search, direction.d, at_.gradient.dot(direction.d),
                                            memory_.reference(), false, point);
    it.backtracks += found.backtracks;
    undefined_ += found.undefined;
    tell(direction, found.t, it);
    if (!found.found) return false;
    it.merit = halving_ ? merit(method_.cfunction, run_.box(), point.x, point.F) : found.merit;
    if (!halving_ && direction.linear == 'K' && direction.kind == 'N' && found.t == 1 && chords_.worthwhile()) {
      Vec x = point.x;
      Vec F = point.F;
      double psi = found.merit;
      chords_.run(x, F, psi);
      if (x != point.x && move(point, std::move(x), std::move(F))) it.merit = psi;
    }
    return true;
  }

  /// No direction was of use: the run ends, unless it is to stop for other reasons.
  bool give_up(const Iteration& it) {
    if (directions_.stopped()) return false;
    const bool nowhere = undefined_ > 0 && undefined_ == it.backtracks;
    run_.end(nowhere ? Status::EvaluationFailed : Status::NoProgress,
             nowhere ? "F or its Jacobian is not defined at any trial point, however short the step"
                     : "no direction (Newton, Levenberg-Marquardt, gradient) decreases the merit function",
             "try another start or method; check the derivatives (--check-derivatives)");
    return false;
  }

  static void tell(const Direction& direction, double t, Iteration& it) {
    it.kind = direction.kind;
    it.prox = direction.nu;
    it.linear = direction.linear;
    it.step = t;
  }

  Run& run_;
  const SemismoothNewton& method_;
  Directions directions_;
  ChordSteps chords_;
  bool halving_;         // the merit of Phi is not differentiable: steps that halve ||Phi||, others are searched on ...
  CFunction searched_;   // ... the merit of this function
  bool halved_ = false;  // by the last step
  double least_ = lcp::infinity;
  int undefined_ = 0;  // trial points of this iteration
  Linearisation at_;
  Memory memory_;
  SpMat spare_;        // the last J
  bool has_J_ = true;  // at the iterate
  Stall stall_{60, progress};
};

}  // namespace

void iterate(Run& run, const SemismoothNewton& method, Point point) {
  Steps steps(run, method);
  Iteration it{.k = 0, .kind = 'I'};
  it.merit = merit(method.cfunction, run.box(), point.x, point.F);

  while (run.go_on(point, it)) {
    it = {.k = it.k + 1, .merit = it.merit};
    steps.take(point, it);
    if (run.ended()) break;
  }
  run.remark(steps.remark());
}

void describe(Forcing& o, Fields& f) {
  f.add("chord_steps", &o.chord_steps, between(0, 1000),
        "simplified Newton steps with the last matrix after a Newton point, while they pay; where krylov solves the "
        "systems");
}

void describe(SemismoothNewton& m, Fields& f) {
  describe(m.cfunction, f);
  describe(m.search, f);
  f.add("levenberg_marquardt", &m.levenberg_marquardt,
        "try Levenberg-Marquardt steps if Newton's step does not descend, before gradient steps");
  describe_lu(m.lu, f);
  f.choice("linear_solver", &m.linear,
           {{"direct", LinearSolver::Direct}, {"krylov", LinearSolver::Krylov}, {"auto", LinearSolver::Auto}},
           "Newton systems of semismooth: direct (LU), krylov (inexactly, in little memory) or auto (krylov for more "
           "than 20000 variables)");
  f.when(m.linear != LinearSolver::Direct, "linear_solver = direct", [&] { describe(m.forcing, f); });
}

}  // namespace perp::ncp

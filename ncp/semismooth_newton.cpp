#include <Eigen/QR>
#include <cmath>
#include <string>
#include <utility>

#include "ncp/merit.hpp"
#include "ncp/methods.hpp"
#include "ncp/newton_direction.hpp"
#include "ncp/refusal.hpp"

namespace perp::ncp {
namespace {

/// nu of the Levenberg-Marquardt steps tried in turn.
constexpr double lm_growth = 1e3;
constexpr int lm_tries = 4;

/// A gradient smaller than this, relative to the terms it is the sum of, is zero.
constexpr double stationary_tol = 1e-9;

/// After a full Newton step: x+ = x + d with H d = -Phi(x), H that of the Newton step, with Anderson's acceleration: of
/// the last steps dX and the changes dD of d between them, the combination that d is nearest to is taken away.
class ChordSteps {
 public:
  ChordSteps(Run& run, const SemismoothNewton& method, const CFunction& smooth, Directions& directions)
      : run_(run), method_(method), smooth_(smooth), directions_(directions) {}

  /// False where none was of use in the last two iterations: the function bends at its kinks, not smoothly.
  bool worthwhile() const { return method_.forcing.chord_steps > 0 && idle_ < 2; }

  /// Moves the point on while ||Phi|| halves; its J is that of the last point accepted, unless that is a solution.
  void run(Point& point, double& psi) {
    Eigen::MatrixXd dX(point.x.size(), 0);
    Eigen::MatrixXd dD(point.x.size(), 0);
    Vec Phi(point.x.size());
    Vec last_d;
    Vec last_x;
    const Vec begin_x = point.x;
    const Vec begin_F = point.F;
    const double begin_psi = psi;
    bool moved = false;
    Point trial{.x = {}, .F = {}, .J = {}};
    reformulate(method_.cfunction, run_.box(), point.x, point.F, Phi);
    double norm = Phi.norm();
    for (int k = 0; k < method_.forcing.chord_steps && !solved(point); ++k) {
      Vec d;
      if (!directions_.chord(Phi, d)) break;
      Vec step = d;
      if (k > 0) {
        append(dX, point.x - last_x);
        append(dD, d - last_d);
        const Vec gamma = dD.colPivHouseholderQr().solve(d);
        if (gamma.allFinite()) step -= (dX + dD) * gamma;
      }
      trial.x = point.x + step;
      if (!run_.counted().eval(trial.x, trial.F)) break;
      reformulate(method_.cfunction, run_.box(), trial.x, trial.F, Phi);
      const double there = Phi.norm();
      if (!(there <= 0.5 * norm)) break;
      last_d = std::move(d);
      last_x = point.x;
      std::swap(point.x, trial.x);
      std::swap(point.F, trial.F);
      norm = there;
      moved = true;
      ++run_.stats().chord_steps;
    }
    idle_ = moved ? 0 : idle_ + 1;
    if (!moved) return;
    psi = merit(smooth_, run_.box(), point.x, point.F);
    if (solved(point)) return;
    trial.J = point.J;
    if (psi <= begin_psi && run_.counted().jacobian(point.x, trial.J)) {
      std::swap(point.J, trial.J);
      return;
    }
    point.x = begin_x;
    point.F = begin_F;
    psi = begin_psi;
  }

 private:
  bool solved(const Point& point) const {
    return residual(run_.box(), point.x, point.F).natural <= method_.stop.tol &&
           lcp::project(run_.box(), point.x) == point.x;
  }
  static void append(Eigen::MatrixXd& columns, const Vec& column) {
    constexpr Index depth = 4;
    if (columns.cols() == depth) columns.leftCols(depth - 1) = columns.rightCols(depth - 1).eval();
    if (columns.cols() < depth) columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
    columns.rightCols(1) = column;
  }

  Run& run_;
  const SemismoothNewton& method_;
  const CFunction& smooth_;
  Directions& directions_;
  int idle_ = 0;
};

}  // namespace

void semismooth_newton(Run& run, const SemismoothNewton& method, Point point) {
  // min's own 1/2 ||Phi||^2 is not differentiable: its steps are searched on the Fischer-Burmeister merit.
  const CFunction smooth = method.cfunction.smooth_merit ? method.cfunction : fischer_burmeister();
  Linearisation newton;
  Linearisation other;
  Directions directions(run, method);
  ChordSteps chords(run, method, smooth, directions);
  Memory memory(method.search.memory);
  Stall stall;
  Iteration it{.k = 0, .kind = 'I'};
  it.merit = merit(smooth, run.box(), point.x, point.F);
  memory.push(it.merit);

  while (run.go_on(point, it)) {
    linearise(method.cfunction, run.box(), point, newton, !directions.krylov());
    if (!method.cfunction.smooth_merit) linearise(smooth, run.box(), point, other, !directions.krylov());
    const Linearisation& descent = method.cfunction.smooth_merit ? newton : other;
    const Vec& g = descent.gradient;
    if (const bool stationary = descent.stationarity <= stationary_tol; stationary || stall.stalled(descent.merit)) {
      run.end(stationary ? Status::StationaryPoint : Status::NoProgress,
              stationary
                  ? "a stationary point of the merit function 1/2 ||Phi||^2 (" + smooth.name + ") that is no solution"
                  : "the merit function 1/2 ||Phi||^2 (" + smooth.name + ") has stopped falling",
              "try another start, or --method josephy: this method cannot leave a local minimum of its merit function");
      break;
    }

    const int k = it.k + 1;
    it = {.k = k};
    SearchOutcome found;
    int undefined = 0;
    const auto search = [&](const Direction& direction) {
      found =
          line_search(run, smooth, method.search, direction.d, g.dot(direction.d), memory.reference(), false, point);
      it.backtracks += found.backtracks;
      undefined += found.undefined;
      it.kind = direction.kind;
      it.prox = direction.nu;
      it.linear = direction.linear;
      return found.found;
    };
    Direction direction;
    const auto descends = [&](const Vec& d) {
      const double rms = d.norm() / std::sqrt(static_cast<double>(d.size()));
      return g.dot(d) <= -method.descent_rho * std::pow(rms, method.descent_p);
    };
    bool done = directions.newton(newton, point, descends, direction) && search(direction);
    double nu = directions.first_nu(descent, point);
    for (int i = 0; i < lm_tries && !done && !directions.stopped(); ++i, nu *= lm_growth)
      done =
          directions.levenberg_marquardt(descent, point, nu, direction) && g.dot(direction.d) < 0 && search(direction);
    if (!done && !directions.stopped()) done = search(directions.gradient(descent, point));
    if (!done && !directions.stopped()) {
      const bool nowhere = undefined > 0 && undefined == it.backtracks;
      run.end(nowhere ? Status::EvaluationFailed : Status::NoProgress,
              nowhere ? "F or its Jacobian is not defined at any trial point, however short the step"
                      : "no direction (Newton, Levenberg-Marquardt, gradient) decreases the merit function",
              "try another start or method; check the derivatives (--check-derivatives)");
      break;
    }
    if (done && direction.linear == 'K' && direction.kind == 'N' && found.t == 1 && chords.worthwhile())
      chords.run(point, found.merit);
    it.merit = done ? found.merit : descent.merit;
    it.step = done ? found.t : 0;
    memory.push(it.merit);
  }
  run.remark(directions.remark());
}

Result run_semismooth_newton(const Mcp& mcp, In x0, const SemismoothNewton& method, const Observer& observer) {
  Run run(mcp, method.stop, observer);
  Point point;
  if (run.start(x0, point)) semismooth_newton(run, method, std::move(point));
  return run.result();
}

std::optional<std::string> invalid(const SemismoothNewton& m) {
  if (auto why = invalid(m.stop)) return why;
  if (!m.cfunction.at) return "cfunction has no function";
  if (!(m.descent_rho > 0)) return refusal("descent_rho", m.descent_rho, "positive");
  if (!(m.descent_p > 2)) return refusal("descent_p", m.descent_p, "greater than 2");
  if (auto why = invalid(m.forcing)) return why;
  if (auto why = invalid(m.escape)) return why;
  return invalid(m.search);
}

std::optional<std::string> invalid(const Forcing& f) {
  if (!(f.eta_max > 0 && f.eta_max < 1)) return refusal("forcing.eta_max", f.eta_max, "in (0, 1)");
  if (!(f.gamma > 0 && f.gamma <= 1)) return refusal("forcing.gamma", f.gamma, "in (0, 1]");
  if (!(f.alpha > 1 && f.alpha <= 2)) return refusal("forcing.alpha", f.alpha, "in (1, 2]");
  if (f.max_iterations < 1) return refusal("forcing.max_iterations", f.max_iterations, "at least 1");
  if (f.chord_steps < 0) return refusal("forcing.chord_steps", f.chord_steps, "at least 0");
  return std::nullopt;
}

}  // namespace perp::ncp

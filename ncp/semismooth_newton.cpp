#include <cmath>
#include <string>
#include <utility>

#include "ncp/merit.hpp"
#include "ncp/methods.hpp"
#include "ncp/refusal.hpp"

namespace perp::ncp {
namespace {

struct Direction {
  Vec d;
  char kind = 'N';
  double nu = 0;
};

/// The directions of one iteration, from the fastest to the safest: Newton, Levenberg-Marquardt with growing nu,
/// gradient.
class Directions {
 public:
  Directions(Run& run, const SemismoothNewton& method) : run_(run), method_(method), lu_(method.lu), lm_(method.lu) {}

  /// H d = -Phi.
  bool newton(const Linearisation& lin, Direction& out) {
    ++run_.stats().factorizations;
    if (lu_.factor(lin.H) != lcp::LuStatus::Ok) return false;
    out = {.d = Vec(lin.at.Phi.size()), .kind = 'N', .nu = 0};
    lu_.solve(-lin.at.Phi, out.d);
    return out.d.allFinite();
  }

  /// (H'H + nu I) d = -H'Phi, as the quasi-definite system  [I H; H' -nu I] (r; d) = (-Phi; 0), which does not square
  /// H.
  bool levenberg_marquardt(const Linearisation& lin, double nu, Direction& out) {
    const Index n = lin.at.Phi.size();
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(2 * (lin.H.nonZeros() + n)));
    for (int i = 0; i < n; ++i) {
      entries.emplace_back(i, i, 1);
      entries.emplace_back(static_cast<int>(n) + i, static_cast<int>(n) + i, -nu);
    }
    for (Index j = 0; j < n; ++j)
      for (SpMat::InnerIterator it(lin.H, j); it; ++it) {
        const int i = static_cast<int>(it.row());
        const int column = static_cast<int>(n + j);
        entries.emplace_back(i, column, it.value());
        entries.emplace_back(column, i, it.value());
      }
    SpMat K(2 * n, 2 * n);
    K.setFromTriplets(entries.begin(), entries.end());
    ++run_.stats().factorizations;
    if (lm_.factor(K) != lcp::LuStatus::Ok) return false;
    Vec rhs = Vec::Zero(2 * n);
    rhs.head(n) = -lin.at.Phi;
    Vec solution(2 * n);
    lm_.solve_refined(rhs, solution);
    out = {.d = solution.tail(n), .kind = 'L', .nu = nu};
    return out.d.allFinite();
  }

  static Direction gradient(const Linearisation& lin) { return {.d = lin.cauchy_step(), .kind = 'G', .nu = 0}; }

  bool descends(const Vec& gradient, const Vec& d) const {
    return gradient.dot(d) <= -method_.descent_rho * std::pow(d.norm(), method_.descent_p);
  }

 private:
  Run& run_;
  const SemismoothNewton& method_;
  lcp::SparseLu lu_, lm_;
};

/// nu of the Levenberg-Marquardt steps tried in turn, relative to the size of H'H: ||Phi|| keeps fast local
/// convergence.
constexpr double lm_growth = 1e3;
constexpr int lm_tries = 4;

/// A gradient smaller than this, relative to the terms it is the sum of, is zero.
constexpr double stationary_tol = 1e-9;

}  // namespace

void semismooth_newton(Run& run, const SemismoothNewton& method, Point point) {
  // min's own 1/2 ||Phi||^2 is not differentiable: its steps are searched on the Fischer-Burmeister merit.
  const CFunction smooth = method.cfunction.smooth_merit ? method.cfunction : fischer_burmeister();
  Linearisation newton;
  Linearisation descent;
  Directions directions(run, method);
  Memory memory(method.search.memory);
  Stall stall;
  Iteration it{.k = 0, .kind = 'I'};
  it.merit = merit(smooth, run.box(), point.x, point.F);
  memory.push(it.merit);

  while (run.go_on(point, it)) {
    linearise(method.cfunction, run.box(), point, newton);
    if (method.cfunction.smooth_merit)
      descent = newton;
    else
      linearise(smooth, run.box(), point, descent);
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
      return found.found;
    };
    Direction direction;
    bool done = directions.newton(newton, direction) && directions.descends(g, direction.d) && search(direction);
    double nu = std::min(1.0, descent.at.Phi.norm()) *
                std::max(1e-8, 1e-6 * descent.H.squaredNorm() / static_cast<double>(point.x.size()));
    for (int i = 0; i < lm_tries && !done; ++i, nu *= lm_growth)
      done = directions.levenberg_marquardt(descent, nu, direction) && g.dot(direction.d) < 0 && search(direction);
    if (!done) done = search(Directions::gradient(descent));
    if (!done) {
      const bool nowhere = undefined > 0 && undefined == it.backtracks;
      run.end(nowhere ? Status::EvaluationFailed : Status::NoProgress,
              nowhere ? "F or its Jacobian is not defined at any trial point, however short the step"
                      : "no direction (Newton, Levenberg-Marquardt, gradient) decreases the merit function",
              "try another start or method; check the derivatives (--check-derivatives)");
      break;
    }
    it.merit = found.merit;
    it.step = found.t;
    memory.push(it.merit);
  }
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
  if (auto why = invalid(m.escape)) return why;
  return invalid(m.search);
}

}  // namespace perp::ncp

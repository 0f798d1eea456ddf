// SPDX-License-Identifier: Apache-2.0
#include "ncp/methods/min_newton.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "ncp/methods/least_squares_step.hpp"
#include "ncp/reformulation/line_search.hpp"
#include "ncp/reformulation/merit.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {
namespace {

/// A step whose model predicts less than this share of theta to go is none: the point is stationary.
constexpr double stationary_decrease = 1e-10;

/// The search becomes monotone when theta has not been lower for so many iterations: with a memory it can cycle.
constexpr int patience = 10;

/// The Newton step by blocks: d_A = -Phi_A, J_II d_I = -F_I - J_IA d_A.
class NewtonSteps {
 public:
  NewtonSteps(Run& run, lcp::LuBackend lu) : run_(run), lu_(lu, run.deadline()) {}

  /// False where J_II is singular.
  bool solve(const Linearisation& lin, const SpMat& J, Vec& d) {
    const Index n = d.size();
    place_.assign(static_cast<std::size_t>(n), -1);
    int inside = 0;
    for (Index i = 0; i < n; ++i) {
      d[i] = -lin.at.Phi[i];
      if (lin.at.Db[i] != 0) place_[static_cast<std::size_t>(i)] = inside++;
    }
    if (inside == 0) return true;
    std::vector<Eigen::Triplet<double>> entries;
    Vec rhs(inside);
    for (Index i = 0; i < n; ++i)
      if (const int row = place_[static_cast<std::size_t>(i)]; row >= 0) rhs[row] = d[i];
    for (Index j = 0; j < n; ++j) {
      const int column = place_[static_cast<std::size_t>(j)];
      for (SpMat::InnerIterator it(J, j); it; ++it) {
        const int row = place_[static_cast<std::size_t>(it.row())];
        if (row < 0) continue;
        if (column >= 0)
          entries.emplace_back(row, column, it.value());
        else
          rhs[row] -= it.value() * d[j];
      }
    }
    SpMat block(inside, inside);
    block.setFromTriplets(entries.begin(), entries.end());
    ++run_.stats().factorizations;
    if (!lu_.try_factor(block)) return false;
    Vec inner(inside);
    lu_.solve_refined(rhs, inner);
    for (Index i = 0; i < n; ++i)
      if (const int row = place_[static_cast<std::size_t>(i)]; row >= 0) d[i] = inner[row];
    return d.allFinite();
  }

 private:
  Run& run_;
  lcp::SparseLu lu_;
  std::vector<int> place_;  // of an index among those of I; -1 outside
};

struct Step {
  Vec d;
  double slope = 0;  ///< Phi'H d
  char kind = ' ';
  double nu = 0;
};

/// Up to rounding: the search projects.
bool in_box(const Box& box, const Vec& x) {
  const Vec outside = (x - lcp::project(box, x)).cwiseAbs();
  return (outside.array() <= 1e-14 * (1 + x.array().abs())).all();
}

/// nu of the first Levenberg-Marquardt step, relative to the size of H'H: of the order of ||Phi||, which keeps fast
/// local convergence.
double first_nu(const Linearisation& lin) {
  return std::min(1.0, lin.at.Phi.norm()) *
         std::max(1e-8, 1e-6 * lin.H.squaredNorm() / static_cast<double>(lin.at.Phi.size()));
}

}  // namespace

void describe(MinNewton& m, Fields& f) {
  describe(m.search, f);
  describe(m.escape, f);
  describe_lu(m.lu, f);
}

void iterate(Run& run, const MinNewton& method, Point point) {
  const CFunction min = natural_min();
  const bool qp_only = method.direction == MinNewton::Direction::ConvexQp;
  Linearisation lin;
  NewtonSteps newton(run, method.lu);
  LeastSquaresSteps least_squares(run);
  Memory memory(method.search.memory);
  Stall stall;
  Iteration it{.k = 0, .kind = 'I'};
  it.merit = merit(min, run.box(), point.x, point.F);
  memory.push(it.merit);
  double best = it.merit;
  int since_best = 0;

  while (run.go_on(point, it)) {
    linearise(min, run.box(), point, lin);
    if (stall.stalled(lin.merit)) {
      run.end(Status::NoProgress, "the merit function theta = 1/2 ||min||^2 has stopped falling",
              "try --method proxi, which leaves local minima, another start or --method semismooth");
      break;
    }
    it = {.k = it.k + 1};
    SearchOutcome found;
    int undefined = 0;
    const auto search = [&](const Step& step) {
      found = line_search(run, min, method.search, step.d, step.slope, memory.reference(), true, point);
      it.backtracks += found.backtracks;
      undefined += found.undefined;
      it.kind = step.kind;
      it.prox = step.nu;
      return found.found;
    };

    Step step{.d = Vec(point.x.size()), .slope = -2 * lin.merit, .kind = 'N', .nu = 0};
    const bool regular = newton.solve(lin, point.J, step.d);
    bool done = regular && (!qp_only || in_box(run.box(), point.x + step.d)) && search(step);
    bool stopped = false;
    bool stationary = false;
    double nu = qp_only && regular ? 0 : first_nu(lin);
    for (int i = 0; i < lm_tries && !done && !stopped; ++i) {
      LeastSquaresStep qp = least_squares.solve(lin, point.x, nu);
      stopped = qp.end == LeastSquaresStep::End::Stopped;
      stationary = qp.end == LeastSquaresStep::End::Found && -qp.model <= 2 * stationary_decrease * lin.merit;
      if (stationary) break;
      step = {.d = std::move(qp.d), .slope = qp.model, .kind = nu > 0 ? 'L' : 'Q', .nu = nu};
      done = !stopped && step.slope < 0 && search(step);
      nu = nu > 0 ? lm_growth * nu : first_nu(lin);
    }
    it.pivots = least_squares.take_pivots();
    if (!done && !stopped) {
      const bool nowhere = undefined > 0 && undefined == it.backtracks;
      if (stationary)
        run.end(Status::StationaryPoint,
                "no feasible step reduces the linearised equations: a point that is not regular",
                "try --method proxi, which leaves local minima, or another start");
      else
        run.end(nowhere ? Status::EvaluationFailed : Status::NoProgress,
                nowhere ? "F or its Jacobian is not defined at any trial point, however short the step"
                        : "no direction decreases the merit function theta = 1/2 ||min||^2",
                "try --method proxi, another start or method; check the derivatives (--check-derivatives)");
      break;
    }
    it.merit = done ? found.merit : lin.merit;
    it.step = done ? found.t : 0;
    if (it.merit < best) {
      best = it.merit;
      since_best = 0;
    }
    if (++since_best > patience)
      memory.reset(it.merit);
    else
      memory.push(it.merit);
  }
}

}  // namespace perp::ncp

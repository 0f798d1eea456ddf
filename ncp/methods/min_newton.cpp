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
  NewtonSteps(Run& run, lcp::LuBackend lu) : run_(run), lu_(lu) {}

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
    if (lu_.factor(block) != lcp::LuStatus::Ok) return false;
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

void give_up(Run& run, bool stationary, const Searches& searches) {
  if (stationary)
    run.end(Status::StationaryPoint, "no feasible step reduces the linearised equations: a point that is not regular",
            "try --method proxi, which leaves local minima, or another start");
  else
    run.end(searches.nowhere_defined() ? Status::EvaluationFailed : Status::NoProgress,
            searches.nowhere_defined() ? "F or its Jacobian is not defined at any trial point, however short the step"
                                       : "no direction decreases the merit function theta = 1/2 ||min||^2",
            "try --method proxi, another start or method; check the derivatives (--check-derivatives)");
}

/// How the Levenberg-Marquardt steps of a major iteration ended.
enum class LeastSquaresEnd { Found, NoDescent, Stationary, Stopped };

/// Least-squares steps with nu, and with growing terms after it, until one is searched with success.
LeastSquaresEnd least_squares_step(LeastSquaresSteps& steps, const Linearisation& lin, double nu, Searches& searches,
                                   Iteration& it, Point& point) {
  for (int i = 0; i < lm_tries; ++i) {
    const LeastSquaresStep qp = steps.solve(lin, point.x, nu);
    if (qp.end == LeastSquaresStep::End::Stopped) return LeastSquaresEnd::Stopped;
    if (qp.end == LeastSquaresStep::End::Found && -qp.model <= 2 * stationary_decrease * lin.merit)
      return LeastSquaresEnd::Stationary;
    if (qp.model < 0) {
      it.kind = nu > 0 ? 'L' : 'Q';
      it.prox = nu;
      if (searches.along(qp.d, qp.model, point)) return LeastSquaresEnd::Found;
    }
    nu = nu > 0 ? lm_growth * nu : first_nu(lin);
  }
  return LeastSquaresEnd::NoDescent;
}

}  // namespace

void describe(MinNewton& m, Fields& f) {
  describe(m.search, f);
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
  Vec d(point.x.size());

  while (run.go_on(point, it)) {
    linearise(min, run.box(), point, lin);
    if (stall.stalled(lin.merit)) {
      run.end(Status::NoProgress, "the merit function theta = 1/2 ||min||^2 has stopped falling",
              "try --method proxi, which leaves local minima, another start or --method semismooth");
      break;
    }
    it = {.k = it.k + 1};
    Searches searches(run, min, method.search, memory.reference(), it);
    const bool regular = newton.solve(lin, point.J, d);
    if (regular && (!qp_only || in_box(run.box(), point.x + d))) {
      it.kind = 'N';
      searches.along(d, -2 * lin.merit, point);
    }
    if (!searches.found()) {
      const double nu = qp_only && regular ? 0 : first_nu(lin);
      const LeastSquaresEnd end = least_squares_step(least_squares, lin, nu, searches, it, point);
      it.pivots = least_squares.take_pivots();
      if (end == LeastSquaresEnd::NoDescent || end == LeastSquaresEnd::Stationary) {
        give_up(run, end == LeastSquaresEnd::Stationary, searches);
        break;
      }
    }
    it.merit = searches.found() ? searches.merit() : lin.merit;
    it.step = searches.found() ? searches.t() : 0;
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

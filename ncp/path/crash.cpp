// SPDX-License-Identifier: Apache-2.0
#include "ncp/path/crash.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "lcp/classes/classify.hpp"
#include "lcp/linalg/blocks.hpp"
#include "ncp/reformulation/line_search.hpp"
#include "ncp/reformulation/normal_map.hpp"

namespace perp::ncp {
namespace {

/// The proximal term of a singular J_II, relative to the size of J; it grows by this factor until J_II + lambda I is
/// not singular.
constexpr double crash_prox_growth = 100;
constexpr int crash_prox_tries = 4;
/// A step is worth a factorization if it leaves less than this share of the merit, or moves so many variables from or
/// to a bound, which a path would do by as many pivots.
constexpr double worthwhile = 0.9;
constexpr Index many_pivots = 200;
constexpr Index fewer_pivots = 10;  // or n / 20, of affine problems: their one path takes what the crash leaves
/// Of Crash::least_step, in affine problems: a step that short changes the active set, and the next one may be long.
constexpr double shorter_step = 1e-3;
constexpr int most_unpaid = 5;  ///< steps in turn that pay by the pivots they save alone
/// A step with a proximal term, in nonlinear problems, must leave less than `worthwhile` and reach this share of the
/// fall that the linearised problem promises, or it is taken back: the path then starts better from where it led away.
constexpr double promised = 0.25;

/// Whether a quarter of the variables has a diagonal entry in J: a quadratic program. To a linear one each lambda gives
/// another vertex.
bool curved(const SpMat& J) { return 4 * (J.diagonal().array() > 0).count() >= J.rows(); }

using Places = std::vector<bool>;  // inside?

/// The variables that the sign of F does not hold at a bound.
Places inside(const Box& box, const Point& point) {
  Places in(static_cast<std::size_t>(point.x.size()));
  for (Index i = 0; i < point.x.size(); ++i) {
    const bool held =
        (point.x[i] == box.lower[i] && point.F[i] >= 0) || (point.x[i] == box.upper[i] && point.F[i] <= 0);
    in[static_cast<std::size_t>(i)] = !held && box.lower[i] < box.upper[i];
  }
  return in;
}

Index differences(const Places& a, const Places& b) {
  Index count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i];
  return count;
}

std::vector<Index> members(const Places& in) {
  std::vector<Index> I;
  I.reserve(in.size());
  for (std::size_t i = 0; i < in.size(); ++i)
    if (in[i]) I.push_back(static_cast<Index>(i));
  return I;
}

/// Below this min |U_ii| / max |U_ii| it is in doubt whether a matrix is regular: one in other units has such pivots,
/// too.
constexpr double doubtful = 1e-12;
/// Where the terms of B d cancel to such a part of them, B is singular but for rounding.
constexpr double cancelled = 1e-10;

/// d with B d = b. False if B is singular, or no more than rounding makes it regular.
bool solved(lcp::SparseLu& lu, const SpMat& B, const Vec& b, Vec& d) {
  if (lu.factor(B) != lcp::LuStatus::Ok) return false;
  d.resize(b.size());
  lu.solve(b, d);
  if (!d.allFinite()) return false;
  const double ratio = lu.pivot_ratio();
  if (ratio == 0 || ratio >= doubtful) return true;  // 0: the library does not tell
  const Vec terms = B.cwiseAbs() * d.cwiseAbs();     // whatever the units of the variables
  return b.lpNorm<Eigen::Infinity>() >= cancelled * terms.maxCoeff();
}

/// J_II + lambda I.
SpMat block(const SpMat& J, const std::vector<Index>& I, double lambda) {
  SpMat B = lcp::principal_block(J, I);
  return lambda > 0 ? plus_diagonal(B, lambda) : B;
}

/// lambda, 0 until a J_II is singular.
class ProximalTerm {
 public:
  double lambda() const { return lambda_; }
  /// The problem is affine, and J was found to be positive semidefinite when the first J_II was singular.
  bool monotone() const { return monotone_; }

  /// Takes J and F_I of the point.
  void raise(const Run& run, const SpMat& J, const Vec& F) {
    if (lambda_ > 0) {
      lambda_ *= crash_prox_growth;
      return;
    }
    double first = 0;
    if (!run.mcp().is_affine()) {
      first = 0.01 * std::min(1.0, F.norm());
      decay_ = 0.9;
    } else if (monotone_ = lcp::positive_semidefinite(J, {.dense_to = 0}).yes(); monotone_) {
      first = 0.3;  // steps with less are too long for a search
      decay_ = 0.5;
    } else {
      first = 1e-6;  // the exact step is worth more, and the path needs no term
      decay_ = 0.1;
    }
    lambda_ = first * size_of(J);
  }
  /// After a step.
  void shrink() { lambda_ *= decay_; }

 private:
  double lambda_ = 0;
  double decay_ = 1;
  bool monotone_ = false;
};

/// d with (J_II + lambda I) d_I = -F_I, d = 0 elsewhere; lambda > 0 if J_II is singular. False: no lambda helped.
bool direction(Run& run, const Point& point, const Places& in, lcp::SparseLu& lu, ProximalTerm& term, Vec& d) {
  if (std::find(in.begin(), in.end(), true) == in.end()) return false;
  const std::vector<Index> I = members(in);
  const Vec rhs = -point.F(I);
  Vec step;
  for (int tries = 0; tries <= crash_prox_tries; ++tries) {
    ++run.stats().factorizations;
    if (solved(lu, block(point.J, I, term.lambda()), rhs, step)) {
      d.setZero(point.x.size());
      for (std::size_t k = 0; k < I.size(); ++k) d[I[k]] = step[static_cast<Index>(k)];
      return true;
    }
    term.raise(run, point.J, rhs);
  }
  return false;
}

/// So many variables changing their places in one step are worth a try of cheaper changes.
constexpr Index many_changes = 16;
constexpr int sweeps = 50;

/// Projected Gauss-Seidel sweeps on the problem linearised at `point`, z_i <- mid(l_i, z_i - F_i / J_ii, u_i), F <- F +
/// J_.i dz_i: an active set that moves by one layer of variables a factorization moves by many in sweeps that cost as
/// much as a product with J. False if a diagonal entry is not positive.
bool relax(const Box& box, const Point& point, Vec& z) {
  z = point.x;
  Vec F = point.F;
  const Vec diagonal = point.J.diagonal();
  if (!(diagonal.minCoeff() > 0)) return false;
  for (int k = 0; k < sweeps; ++k) {
    bool moved = false;
    for (Index i = 0; i < z.size(); ++i) {
      const double to = std::clamp(z[i] - F[i] / diagonal[i], box.lower[i], box.upper[i]);
      const double by = to - z[i];
      if (by == 0) continue;
      moved = true;
      z[i] = to;
      for (SpMat::InnerIterator e(point.J, i); e; ++e) F[e.row()] += e.value() * by;
    }
    if (!moved || !F.allFinite()) break;
  }
  return F.allFinite();
}

/// relax(), if the merit falls by it.
bool relaxed(Run& run, const CFunction& fb, Point& point, double& psi) {
  Point trial;
  if (!relax(run.box(), point, trial.x) || !run.counted().eval(trial.x, trial.F)) return false;
  const double merit_there = merit(fb, run.box(), trial.x, trial.F);
  if (!(merit_there < psi) || !run.counted().jacobian(trial.x, trial.J)) return false;
  std::swap(point, trial);
  psi = merit_there;
  return true;
}

/// Whether J_II is, at the point the crash has led to.
bool singular(Run& run, const Point& point, lcp::SparseLu& lu) {
  const std::vector<Index> I = members(inside(run.box(), point));
  if (I.empty()) return false;
  ++run.stats().factorizations;
  Vec step;
  return !solved(lu, block(point.J, I, 0), -point.F(I), step);
}

/// Of a step of length t along a direction that would solve the linearised problem.
bool keeps_promise(const SearchOutcome& found, double psi) {
  return found.merit < worthwhile * psi && psi - found.merit >= promised * found.t * (2 - found.t) * psi;
}

/// The search along d. Where some steps fail and the shortest one that the rule allows, too, those between seldom find
/// anything, at the price of an evaluation each.
SearchOutcome search(Run& run, const CFunction& fb, const Armijo& rule, const Vec& d, double psi, double reference,
                     Point& point) {
  constexpr int some = 3;
  if (rule.max_backtracks <= 2 * some) return line_search(run, fb, rule, d, -2 * psi, reference, true, point);
  Armijo first = rule;
  first.max_backtracks = some;
  SearchOutcome found = line_search(run, fb, first, d, -2 * psi, reference, true, point);
  if (found.found || found.backtracks <= some) return found;
  const double shortest = std::pow(rule.beta, rule.max_backtracks);
  Point trial;
  trial.x = lcp::project(run.box(), point.x + shortest * d);
  const bool moves = trial.x != point.x;  // else the rule allows steps below rounding
  if (moves && !(run.counted().eval(trial.x, trial.F) &&
                 merit(fb, run.box(), trial.x, trial.F) <= reference - 2 * rule.sigma * shortest * psi))
    return found;
  Armijo rest = rule;
  rest.max_backtracks -= found.backtracks;
  const SearchOutcome later =
      line_search(run, fb, rest, d, -2 * psi, reference, true, point, std::pow(rule.beta, found.backtracks));
  found.backtracks += later.backtracks;
  found.undefined += later.undefined;
  found.found = later.found;
  found.t = later.t;
  found.merit = later.merit;
  return found;
}

struct Met {
  bool proximal = false;  ///< a singular J_II, in a step that was kept
  bool monotone = false;  ///< ProximalTerm::monotone
};

/// The steps. False: the run is over.
bool descend(Run& run, const Crash& options, Point& point, Iteration& it, lcp::SparseLu& lu, Met& met) {
  const CFunction& fb = fischer_merit();
  const bool affine = run.mcp().is_affine();
  const double least_step = affine ? shorter_step * options.least_step : options.least_step;
  const Armijo rule{.max_backtracks = static_cast<int>(std::ceil(-std::log2(least_step)))};
  Places before;
  bool sweeping = false;  // then full steps may raise the merit for a while: the set they overshoot to is a better one
  bool sweeps_pay = true;
  double psi = merit(fb, run.box(), point.x, point.F);
  ProximalTerm term;
  Memory memory(4);
  memory.push(psi);
  Stall stall(2);
  (void)stall.stalled(psi);
  int unpaid = 0;
  const Index worth_a_step = affine ? std::clamp<Index>(run.box().size() / 20, fewer_pivots, many_pivots) : many_pivots;
  for (int c = 0; c < options.iteration_limit; ++c) {
    Places in = inside(run.box(), point);
    const Index changes = before.empty() ? 0 : differences(in, before);
    if (c > 0 && changes < options.nbchange_limit) return true;
    if (c > 0 && changes >= many_changes && sweeps_pay) {
      sweeps_pay = relaxed(run, fb, point, psi);
      sweeping = sweeping || sweeps_pay;
      in = inside(run.box(), point);
    }
    before = std::move(in);
    Vec d;
    if (!direction(run, point, before, lu, term, d)) return true;
    const double lambda = term.lambda();
    const double reference = sweeping ? memory.reference() : psi;
    const bool on_trial = lambda > 0 && !affine;
    const std::optional<Point> from = on_trial ? std::optional(point) : std::nullopt;
    const SearchOutcome found = search(run, fb, rule, d, psi, reference, point);
    if (!found.found) {  // sweeps may lead to a set from which a step is longer
      if (sweeping || !sweeps_pay || run.box().size() < many_pivots || !relaxed(run, fb, point, psi)) return true;
      sweeping = true;
      memory.push(psi);
      continue;
    }
    if (from && !keeps_promise(found, psi)) {
      point = *from;
      return true;
    }
    met.proximal = met.proximal || lambda > 0;
    met.monotone = term.monotone();
    memory.push(found.merit);
    const bool stalled = stall.stalled(found.merit);
    const bool falls = sweeping ? !stalled : found.merit < worthwhile * psi;
    unpaid = falls ? 0 : unpaid + 1;
    const bool pays = falls || ((lambda == 0 || affine) && unpaid <= most_unpaid &&
                                differences(before, inside(run.box(), point)) >= worth_a_step);
    psi = found.merit;
    it = {.k = it.k,
          .merit = psi,
          .step = found.t,
          .prox = lambda,
          .backtracks = found.backtracks,
          .kind = 'C',
          .crash = true,
          .changes = changes,
          .inside = std::count(before.begin(), before.end(), true),
          .normal_map = true};
    ++run.stats().crash_iterations;
    if (!run.go_on(point, it)) return false;
    if (!pays) return true;
    term.shrink();
  }
  return true;
}

}  // namespace

CrashEnd crash(Run& run, const Crash& options, Point& point, Iteration& it, lcp::SparseLu& lu) {
  if (!options.on || run.box().size() < options.minimum_dimension) return CrashEnd::Regular;
  Met met;
  if (!descend(run, options, point, it, lu, met)) return CrashEnd::Over;
  if (!met.proximal) return CrashEnd::Regular;
  if (run.mcp().is_affine()) return met.monotone && curved(point.J) ? CrashEnd::Doubtful : CrashEnd::Regular;
  return singular(run, point, lu) ? CrashEnd::Singular : CrashEnd::Regular;
}

}  // namespace perp::ncp

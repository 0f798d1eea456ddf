// SPDX-License-Identifier: Apache-2.0
#include "ncp/path/newton_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lcp/classes/classify.hpp"
#include "lcp/pivoting/straight_path.hpp"

namespace perp::ncp {
namespace {

/// Doubles that the kinks of one path may take.
constexpr Index kink_memory = 4'000'000;
constexpr Index most_kinks = 4096;

/// A path with so few pivots may be followed by one without.
constexpr int few_pivots = 3;

/// Pivots in which t must grow. A path that turns back for longer seldom comes to t = 1 before thousands of pivots, and
/// from its best point the next linearised problem is another one. What is affine has no next one.
int patience_on_paths(const Mcp& mcp) {
  return mcp.is_affine() ? std::numeric_limits<int>::max() : 30 + static_cast<int>(mcp.size() / 10);
}

/// The same where a path from a ray is promised to lead on.
int patience_before_rays(Index n) { return 20 + static_cast<int>(n / 5); }

}  // namespace

double subproblem_tol(const lcp::AffineMcp& problem, double relative) {
  return relative * (1 + (problem.size() > 0 ? problem.q.lpNorm<Eigen::Infinity>() : 0));
}

int worthwhile_pivots(Index n) { return 1000 + 20 * static_cast<int>(std::min<Index>(n, 1'000'000)); }

bool finite(const lcp::AffineMcp& problem) {
  const double* values = problem.M.valuePtr();
  return problem.q.allFinite() &&
         std::all_of(values, values + problem.M.nonZeros(), [](double value) { return std::isfinite(value); });
}

namespace {

/// One that ends where it begins.
lcp::PivotResult no_path(const lcp::Box& box, const Vec& start, lcp::PivotEnd end) {
  lcp::PivotResult none;
  none.end = end;
  none.x = none.best_x = start;
  none.z = lcp::project(box, start);
  return none;
}

}  // namespace

lcp::LemkeOptions linearised_options(const Run& run, lcp::LemkeOptions asked) {
  asked.interrupted = [&run] { return run.interrupted(); };
  asked.deadline = run.deadline();
  asked.max_pivots = std::min(asked.max_pivots, worthwhile_pivots(run.box().size()));
  asked.certify = false;
  return asked;
}

lcp::PivotResult follow_path(const lcp::AffineMcp& linearised, const Vec& start, const lcp::LemkeOptions& options) {
  if (finite(linearised) && start.allFinite()) return lcp::lemke(linearised, start, options);
  return no_path(linearised.box, start, lcp::PivotEnd::Inaccurate);
}

bool stopped(const lcp::PivotResult& path) {
  return path.end == lcp::PivotEnd::Interrupted || path.end == lcp::PivotEnd::TimeLimit;
}

lcp::PivotResult path_or_rays(const lcp::AffineMcp& linearised, const Vec& start, const lcp::LemkeOptions& options) {
  lcp::PivotResult path = follow_path(linearised, start, options);
  int pivots = path.pivots;
  int refactorizations = path.refactorizations;
  lcp::LemkeOptions ray = options;
  ray.start = lcp::LemkeStart::Ray;
  for (std::size_t i = 0; i <= covers.size() && !path.solved() && !stopped(path); ++i) {
    ray.seed = options.seed + static_cast<unsigned>(i);
    if (i > 0) ray.cover = covers[i - 1];
    lcp::PivotResult from_ray = follow_path(linearised, start, ray);
    pivots += from_ray.pivots;
    refactorizations += from_ray.refactorizations;
    if (from_ray.solved() || stopped(from_ray)) path = std::move(from_ray);
  }
  path.pivots = pivots;
  path.refactorizations = refactorizations;
  return path;
}

char NewtonPoint::letter() const {
  switch (path.end) {
    case lcp::PivotEnd::Solved:
      return 'S';
    case lcp::PivotEnd::Ray:
      return 'R';
    case lcp::PivotEnd::Loop:
      return 'C';
    case lcp::PivotEnd::SingularBasis:
      return 'N';
    case lcp::PivotEnd::PivotLimit:
      return 'I';
    case lcp::PivotEnd::Inaccurate:
      return 'T';
    case lcp::PivotEnd::TimeLimit:
    case lcp::PivotEnd::Interrupted:
      return 'E';
  }
  return 'E';
}

NewtonPoints::NewtonPoints(Run& run, const PathSearch& method, lcp::SharedLu& straight_lu)
    : run_(run),
      method_(method),
      options_(linearised_options(run, method.lemke)),
      lu_{lcp::SparseLu(method.lemke.basis.lu)},
      straight_lu_(straight_lu),
      left_(run.left().max_pivots) {
  const Index n = run.box().size();
  if (method.proximal_adaptive) options_.patience = std::min(options_.patience, patience_on_paths(run.mcp()));
  // The path of an affine problem may be followed a second time, for its kinks, unless ways are shown: where
  // they are, other digits of that one would make the run another one.
  if (!run.mcp().is_affine()) lu_.lu.reuse_pivots();
  options_.basis.shared = &lu_;
  options_.keep_basis = method.chord_steps > 0;
  options_.path_limit =
      static_cast<std::size_t>(std::clamp<Index>(kink_memory / std::max<Index>(n, 1), 16, most_kinks));
}

lcp::PivotResult NewtonPoints::follow(const lcp::AffineMcp& problem, const Vec& x, const lcp::LemkeOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  lcp::PivotResult path = follow_path(problem, x, options);
  Stats& stats = run_.stats();
  stats.linear_time += std::chrono::steady_clock::now() - begin;
  stats.factorizations += path.refactorizations;
  if (path.repaired > 0) ++stats.rank_deficient;
  if (options.start == lcp::LemkeStart::Ray) ++stats.ray_starts;
  pivots_ += path.pivots;
  left_ -= path.pivots;
  return path;
}

/// The path where it has no pivots, if the last one had few; or none, ended by the limit of pivots, where it is too
/// long.
std::optional<lcp::PivotResult> NewtonPoints::straight(const lcp::AffineMcp& problem, const Vec& x,
                                                       const lcp::LemkeOptions& options) {
  if (run_.mcp().is_affine() || last_pivots_ > few_pivots || !finite(problem) || !x.allFinite()) return std::nullopt;
  const auto begin = std::chrono::steady_clock::now();
  Index left_by = 0;
  std::optional<lcp::PivotResult> path = lcp::straight_path(problem, x, options, straight_lu_, &left_by);
  Stats& stats = run_.stats();
  stats.linear_time += std::chrono::steady_clock::now() - begin;
  ++stats.factorizations;
  if (!path && left_by > left_) {  // each leaves by a pivot, as a rule
    path = no_path(problem.box, x, lcp::PivotEnd::PivotLimit);
    needed_ = left_by;
  }
  return path;
}

/// Whether a path from the cell of the start would begin with artificials, and one from a ray leads to a solution if
/// there is one and the problem is monotone: affine problems with free variables that occur in no equation of a free
/// one, as multipliers in linear programs.
bool NewtonPoints::ray_if_monotone(const lcp::AffineMcp& problem) const {
  if (!run_.mcp().is_affine()) return false;
  const auto is_free = [&box = problem.box](Index i) { return box.is_free(i); };
  const auto alone = [&](Index j) {
    for (SpMat::InnerIterator it(problem.M, j); it; ++it)
      if (it.value() != 0 && is_free(it.row())) return false;
    return is_free(j);
  };
  for (Index j = 0; j < problem.size(); ++j)
    if (alone(j)) return true;
  return false;
}

NewtonPoint NewtonPoints::solve(const Point& point, const Vec& x, const std::vector<lcp::Cell>& cells, double lambda,
                                Repair repair, Fallback fallback) {
  const lcp::AffineMcp problem = linearised(run_.box(), point, lambda);
  const bool first = std::exchange(first_, false);
  NewtonPoint newton{.path = {}, .lambda = lambda};
  lcp::LemkeOptions options = options_;
  options.max_pivots = std::min(options.max_pivots, std::max(left_, 1));
  options.certify = lambda == 0 && run_.mcp().is_affine();
  const bool ray_asked = method_.start == PathStart::Always || (method_.start == PathStart::First && first) ||
                         options.start == lcp::LemkeStart::Ray;
  bool promised = false;
  if (!ray_asked) {
    const int patience = options.patience;
    const bool if_monotone = lambda == 0 && cells.empty() && ray_if_monotone(problem);
    if (if_monotone) options.patience = std::min(patience, patience_before_rays(problem.size()));
    options.cells = cells;
    options.keep_path = method_.search == Searchtype::Path && !leaves_out_kinks();
    if (std::optional<lcp::PivotResult> path = straight(problem, x, options)) {
      newton.path = *std::move(path);
      return newton;
    }
    options.repair = repair == Repair::Artificials;
    newton.path = follow(problem, x, options);
    if (!options.repair && newton.path.end == lcp::PivotEnd::SingularBasis && newton.path.pivots == 0) {
      newton.singular = true;
      return newton;
    }
    options.repair = true;
    // Most paths lead on before it matters whether the problem is monotone.
    promised = if_monotone && !newton.solved() && !newton.stopped() &&
               lcp::positive_semidefinite(problem.M, {.dense_to = 0}).yes();
    if (newton.path.end == lcp::PivotEnd::Loop && !promised && options.patience < patience) {
      options.patience = patience;
      newton.path = follow(problem, x, options);
    }
    if (leaves_out_kinks()) path_options_ = options;
    last_pivots_ = newton.path.pivots;
    newton.singular = newton.path.repaired > 0 && !newton.solved() && !run_.mcp().is_affine();
    if (newton.solved() || newton.stopped() || fallback == Fallback::None) return newton;
  }
  options.start = lcp::LemkeStart::Ray;
  options.cells.clear();
  options.keep_path = false;
  if (promised) options.keep_basis = false;  // dependent free variables may be split
  const std::size_t rays = first || ray_asked ? covers.size() + 1 : 1;
  for (std::size_t i = 0; i < rays && left_ > 0 && (i == 0 || !newton.usable()); ++i) {
    if (i > 0) options.cover = covers[i - 1];
    options.seed = options_.seed + static_cast<unsigned>(i);
    lcp::PivotResult path = follow(problem, x, options);
    const bool good = path.solved();
    if (good || (i == 0 && ray_asked)) {
      newton.path = std::move(path);
      newton.from_ray = true;
    }
    if (good || newton.stopped()) break;
  }
  return newton;
}

std::vector<lcp::Breakpoint> NewtonPoints::kinks(const Point& point, const Vec& x, double lambda) const {
  lcp::LemkeOptions options = path_options_;
  options.keep_path = true;
  options.certify = false;
  return follow_path(linearised(run_.box(), point, lambda), x, options).path;
}

}  // namespace perp::ncp

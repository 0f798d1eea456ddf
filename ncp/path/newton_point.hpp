// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The linearised problems of PathSearch, solved by following the path from x^k; private to ncp/.
#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "ncp/path/path_search.hpp"
#include "ncp/path/pivot_limit.hpp"
#include "ncp/reformulation/normal_map.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {

/// Covering vectors of rays, in the order they are tried.
inline constexpr std::array covers{lcp::Cover::Generic, lcp::Cover::Ones, lcp::Cover::Spread};

/// Whether M and q are finite: they may overflow where F and J do not.
bool finite(const lcp::AffineMcp& problem);
/// A linearised problem is solved well enough for a step relative to its own size: relative (1 + ||q||_inf).
double subproblem_tol(const lcp::AffineMcp& problem, double relative = 1e-9);

/// Those asked for, with the limits of the run and of worthwhile_pivots(). No ray is certified: that a linearised
/// problem has no solution says nothing of F.
lcp::LemkeOptions linearised_options(const Run& run, lcp::LemkeOptions asked);

/// lcp::lemke, for linearised problems: q = F - J x may overflow where F and J do not, and then no path begins
/// (PivotEnd::Inaccurate, best_x = start).
lcp::PivotResult follow_path(const lcp::AffineMcp& linearised, const Vec& start, const lcp::LemkeOptions& options);

/// The path from `start`; where that does not solve the problem, rays with the covering vector asked for and then with
/// `covers`. Not solved: the path from `start`, for the points on a path from a ray say nothing of the way from it.
/// pivots and refactorizations are those of all.
lcp::PivotResult path_or_rays(const lcp::AffineMcp& linearised, const Vec& start, const lcp::LemkeOptions& options);
/// Interrupted, or past the deadline.
bool stopped(const lcp::PivotResult& path);

/// What becomes of a singular start basis: artificials take the places of dependent columns, or the path does not
/// begin.
enum class Repair { Artificials, Never };

/// What follows on a path that does not get anywhere.
enum class Fallback { Rays, None };

struct NewtonPoint {
  lcp::PivotResult path;
  double lambda = 0;      ///< of the proximal term, absolute
  bool from_ray = false;  ///< the kinks of `path` then say nothing of the way from x^k
  bool singular = false;  ///< the path began in a singular basis and led nowhere, or was not to begin there
  bool solved() const { return path.solved(); }
  /// Its start basis is singular, and was not to be repaired.
  bool not_begun() const { return singular && path.end == lcp::PivotEnd::SingularBasis && path.pivots == 0; }
  /// Came far enough to be of use: t = 1, or the part of a path from x^k that has this share of it.
  bool usable() const { return solved() || (!from_ray && path.best_t >= 0.1); }
  double t() const { return solved() ? 1 : path.best_t; }
  const Vec& x() const { return solved() ? path.x : path.best_x; }
  bool stopped() const { return ncp::stopped(path); }
  char letter() const;  ///< Iteration::linear
};

class NewtonPoints {
 public:
  /// `straight_lu` serves the paths without pivots.
  NewtonPoints(Run& run, const PathSearch& method, lcp::SharedLu& straight_lu);
  NewtonPoints(const NewtonPoints&) = delete;
  NewtonPoints& operator=(const NewtonPoints&) = delete;

  /// Of the problem linearised at `point` with this lambda, from x (and its cells, if they are known); from rays with
  /// several covering vectors if it is the first one or the path from x does not get anywhere. Repair::Never: no path
  /// at all where the basis of the cell is singular. Fallback::None: no rays but where the options ask for one.
  NewtonPoint solve(const Point& point, const Vec& x, const std::vector<lcp::Cell>& cells, double lambda,
                    Repair repair = Repair::Artificials, Fallback fallback = Fallback::Rays);

  /// The kinks of a path that solve() has followed from this x with this lambda and not kept: followed once more. Of
  /// affine problems nearly every Newton point is accepted, and nobody asks for the way there.
  std::vector<lcp::Breakpoint> kinks(const Point& point, const Vec& x, double lambda) const;
  /// Whether solve() leaves them out.
  bool leaves_out_kinks() const { return run_.mcp().is_affine() && !run_.shows_ways(); }

  int take_pivots() { return std::exchange(pivots_, 0); }
  /// Whether no pivots are left, or fewer than the next path would take.
  bool exhausted() const { return left_ <= 0 || needed_ > 0; }
  /// About so many, where the next path was not followed as that is more than are left; else 0.
  Index needed() const { return needed_; }
  int left() const { return std::max(left_, 0); }

 private:
  lcp::PivotResult follow(const lcp::AffineMcp& problem, const Vec& x, const lcp::LemkeOptions& options);
  std::optional<lcp::PivotResult> straight(const lcp::AffineMcp& problem, const Vec& x,
                                           const lcp::LemkeOptions& options);
  bool ray_if_monotone(const lcp::AffineMcp& problem) const;

  Run& run_;
  const PathSearch& method_;
  lcp::LemkeOptions options_;
  lcp::LemkeOptions path_options_;  ///< of the last path from an x, where its kinks were left out
  lcp::SharedLu lu_;                ///< of all paths: their bases have few patterns
  lcp::SharedLu& straight_lu_;
  int last_pivots_ = 0;  ///< of the last path
  int pivots_ = 0;
  int left_;
  Index needed_ = 0;
  bool first_ = true;
};

}  // namespace perp::ncp

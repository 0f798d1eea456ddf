// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The major iterations of PathSearch; private to ncp/.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "lcp/iterative/search_memory.hpp"
#include "ncp/path/crash.hpp"
#include "ncp/path/newton_point.hpp"
#include "ncp/path/path_search.hpp"
#include "ncp/reformulation/line_search.hpp"
#include "ncp/reformulation/merit.hpp"
#include "ncp/run/run.hpp"

namespace perp::ncp {

/// The reference values M_1 .. M_m.
class References {
 public:
  References(const Nms& nms, double psi)
      : values_(static_cast<std::size_t>(nms.on ? nms.memory : 1), (nms.on ? nms.initial_reference_factor : 1) * psi) {}
  double largest() const { return *std::max_element(values_.begin(), values_.end()); }
  void replace_largest(double psi) { *std::max_element(values_.begin(), values_.end()) = psi; }
  void reset(double psi) { std::fill(values_.begin(), values_.end(), psi); }

 private:
  std::vector<double> values_;
};

/// The iterations of one attempt: z^k = point.x with F and J, x^k, and what the non-monotone test remembers.
class PathSteps {
 public:
  /// All outlive it.
  PathSteps(Run& run, const PathSearch& method, Point& point, CrashEnd crashed, lcp::SharedLu& lu);

  /// One major iteration. False: no step was found, and the run has a verdict or was asked to stop.
  bool iterate(Iteration& it);
  /// Whether the merit has not fallen by 1 % in `patience` iterations. Asked once an iteration.
  bool stalled(int patience) { return stall_.stalled(best_psi_, patience); }
  double merit() const { return psi_; }
  const std::vector<lcp::Cell>& basis() const { return basis_; }

 private:
  struct Saved {  // the last point that passed the merit test, and the way from it
    Point point;
    Way way;
    double t = 1;
    double psi = 0;
  };

  double psi(In z, In F, In x) const {
    if (method_.merit == PathMerit::Fischer) return ncp::merit(fb_, run_.box(), z, F);
    return 0.5 * (F + x - z).squaredNorm();
  }
  /// O(||Phi||), to keep the local order; `size` is that of J.
  double lambda_of(double share, double size) const { return share * std::min(1.0, std::sqrt(2 * psi_)) * size; }
  double lambda_after(double lambda, double size) const;
  /// To begin with where J_II is singular.
  double lambda_of_singular();
  Way way_to(const NewtonPoint& newton) const;  ///< from where it was made
  NewtonPoint without_artificials(double& lambda);
  NewtonPoint doubtful_point(double& lambda);
  bool newton_step(Iteration& it);
  bool only_newton() const { return run_.mcp().is_affine() && method_.only_newton_if_affine; }
  /// Whether steps other than Newton's may still be tried in this iteration.
  bool may_go_on() const {
    const bool given_up = only_newton() && !last_->solved();
    return !run_.ended() && !last_->stopped() && !newton_points_.exhausted() && !given_up;
  }
  bool accept(const NewtonPoint& newton, double least, Iteration& it);
  void follow_chord(const NewtonPoint& newton, Point& trial, Vec& x, double& merit);
  bool leap(const NewtonPoint& newton, Iteration& it);
  bool search(const Way& way, double t, double from, double least, Iteration& it);
  bool watchdog(Iteration& it);
  bool gradient_step(Iteration& it);
  void moved(Point&& to, Vec x, double merit);
  void explain(const Iteration& it);

  Run& run_;
  const PathSearch& method_;
  Point trial_;  // kept for its memory; after a step the last point
  const CFunction& fb_ = fischer_merit();
  Point& point_;
  Vec x_;
  std::vector<lcp::Cell> cells_;  // of x^k, if known
  std::vector<lcp::Cell> basis_;
  NewtonPoints newton_points_;
  double lambda_;
  int iterations_ = 0;
  bool doubtful_ = false;        // CrashEnd::Doubtful, and proximal terms have led on so far
  int singular_ = 0;             // iterations in which a path from a singular basis led nowhere
  bool proximal_start_ = false;  // the first path had a proximal term because its basis was singular without
  double psi_;
  References references_;
  Stall stall_;
  Vec best_z_;
  double best_psi_;
  double delta_ = 0;   // the distance up to which steps go unchecked; that of the first step accepted
  int unchecked_ = 0;  // D-steps since the last merit test
  int watchdogs_ = 0;
  int gradient_steps_ = 0;
  std::optional<Saved> saved_;
  std::optional<NewtonPoint> last_;
  int undefined_ = 0;  // trial points of this iteration where F or J is not defined
  WayTaken taken_;
};

}  // namespace perp::ncp

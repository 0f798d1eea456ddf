// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/cone_homotopy.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "contact/cones/region.hpp"
#include "contact/solvers/solve.hpp"

namespace perp::contact {
namespace {

constexpr int most_cone_steps = 40;  // of one path
constexpr double cone_end = 1e-9;    // where one ends
/// Below `settled_tau` slip does not depend on tau any more where it is real: so many steps in a row that leave more
/// than `settled_share` of the gap |y_T| - s end a path.
constexpr double settled_tau = 1e-3;
constexpr double settled_share = 0.7;
constexpr int settled_steps = 3;
/// Where more than this part of the contacts slips the pile collapses, and Glocker's homotopy needs fewer steps.
constexpr double most_moving = 0.1;
constexpr double least_slip = 1e-3;

/// Coupled paths: two steps below this length in a row say that one turns back. What slips by the associated law is
/// coupled from the last point with tau above `slip_tau`, what begins to slip on the way from the last one with tau
/// above `spread_share` times its speed; `most_coupled_steps` in all. All contacts are coupled from the last point with
/// tau above `early_tau`, if W has at most `most_all_coupled_rows`: these paths need LU.
constexpr double turning_step = 0.15;
constexpr int turning_steps = 2;
constexpr int most_coupled_steps = 60;
constexpr int most_all_coupled_steps = 15;
constexpr Index most_all_coupled_rows = 6000;
constexpr double early_tau = 0.3;
constexpr double slip_tau = 0.1;
constexpr double spread_share = 0.3;
/// Cadoux' fixed point: at most so many openings, and so many in a row that leave more than `opening_share` of the
/// least gap. A path begins at the last point with tau above `restart_share` times their change, and ends at this share
/// of the gap. From each of them coupled paths begin at the last points with tau above `slip_late_tau`; from the first
/// `coupled_openings` of them one with all contacts coupled at the last with tau above `late_tau`.
constexpr int most_openings = 10;
constexpr int opening_patience = 2;
constexpr int coupled_openings = 2;
constexpr double opening_share = 0.8;
constexpr double restart_share = 0.1;
constexpr double end_share = 1e-2;
constexpr double largest_end = 1e-5;
constexpr double least_end = 1e-7;
constexpr double late_tau = 1e-4;
constexpr std::array slip_late_tau{1e-2, 1e-4};

/// Regions of slipping contacts, in rounds: a region, and a path with its openings. The path begins near the region's
/// point, at `reopen_share` times its tau, or, where the natural map there is above `far_map`, at the last point of the
/// associated path with tau above `slip_tau`. It ends at `round_share` of it, or below it where the gap falls no more:
/// above it slips would be seen less clearly. Where the others are too soft, impulses far outside of the cones or a
/// problem that is not solved say so: then they are made stiffer. Where contacts do not slip yet the path goes on
/// first.
constexpr int most_rounds = 6;
constexpr double reopen_share = 100;
constexpr double latest_reopen = 1e-2;
constexpr double far_map = 0.1;
constexpr double round_share = 0.1;
constexpr int most_round_steps = 10;
constexpr int most_late_steps = 10;
constexpr std::array stiffnesses{1.0, 10.0, 100.0};
/// A region begins with at most `most_of_start` of the contacts: more are no mechanism of a few bodies, and the pile is
/// about to collapse. It has at most `most_of_region` of them, so that its own regions end, and at most so many. It
/// grows so often, to `most_in_small_region` or so many times its size in all, and at once by no more than
/// `most_growth` or its size. Its problem is solved to few digits, with so much work: rows^3 a step. More digits are
/// had where a few steps find them, and spare a Newton step of ours.
constexpr double most_of_start = 1.0 / 12;
constexpr double most_of_region = 0.25;
constexpr std::size_t most_in_region = 250;
constexpr std::size_t most_in_small_region = 100;
constexpr std::size_t most_times_region = 3;
constexpr std::size_t most_growth = 60;
constexpr int most_growths = 12;
constexpr double region_tol = 1e-6;
constexpr double region_digits = 1e-9;
constexpr int region_digit_steps = 6;
constexpr double region_work = 3e9;
constexpr double least_region_steps = 60;
constexpr double most_region_steps = 400;

/// The splitting. Its steps are looked at in lots. A path begins where they have come to `split_map`, or where openings
/// change, relative to the largest, by less than `split_change` in so many lots in a row; the next ones at
/// `split_again` of that; the map says nothing in the first `least_split_steps`, before openings have grown. It begins
/// near the splitting's point with tau `split_start_share` times the map there, at least `split_end` and at most
/// `latest_reopen`, and ends at `split_end_share` times it, at least `split_last` and at most `split_end`. Openings
/// below `least_opening` of the largest are none. Points below `split_judged` are judged.
constexpr int split_settled = 2;
constexpr int least_split_steps = 125;
constexpr int most_split_steps = 1500;
constexpr int most_split_paths = 3;
constexpr double split_change = 2e-3;
constexpr double split_map = 5e-4;
constexpr double split_again = 0.01;
constexpr double split_judged = 1e-7;
constexpr double split_start_share = 20;
constexpr double split_end_share = 0.02;
constexpr double split_end = 1e-5;
constexpr double split_last = 1e-7;
constexpr int most_split_path_steps = 15;
constexpr double least_opening = 1e-6;

/// Newton steps. On the way: of the associated path first at `newton_tau` and again when tau has fallen by
/// `newton_tau_again`, unless the gap is above `real_gap` times tau, which says that contacts slip in the end; of a
/// coupled one, where tau says less, by the natural map; where one turns back with a map above `turned_map`, none; from
/// a region's point below `regional_map`, until one goes astray along the kernel of W.
constexpr double newton_tau = 1e-4;
constexpr double real_gap = 200;
constexpr double newton_tau_again = 1e-2;
constexpr double newton_map = 0.01;
constexpr double newton_map_again = 0.3;
constexpr double turned_map = 0.02;
constexpr double regional_map = 2e-3;
constexpr NewtonSteps quick_newton{.most = 2, .halvings = 0};
constexpr NewtonSteps coupled_newton{.most = 6, .halvings = 0};
constexpr NewtonSteps regional_newton{.most = 6, .halvings = 0, .most_growth = 100};
constexpr NewtonSteps last_newton{};

/// Whether the gap falls no more.
class Settling {
 public:
  explicit Settling(double below = settled_tau) : below_(below) {}
  void see(double tau, double gap) {
    steps_ = tau < below_ && gap > settled_share * before_ ? steps_ + 1 : 0;
    before_ = gap;
  }
  bool done() const { return steps_ >= settled_steps; }

 private:
  double below_;
  double before_ = std::numeric_limits<double>::infinity();
  int steps_ = 0;
};

/// And have they friction?
bool blocks_of_one_size(const Scaled& problem) {
  const int size = problem.blocks.front().size;
  const auto same = [size](const Scaled::Block& block) { return block.size == size; };
  return size > 1 && std::ranges::all_of(problem.blocks, same);
}

}  // namespace

ConeHomotopy::ConeHomotopy(Referee& referee, const Scaled& problem, AlartCurnier& newton, ContactSystem& system,
                           bool splitting)
    : referee_(referee),
      problem_(problem),
      newton_(newton),
      system_(system),
      splitting_(splitting),
      path_(problem, system) {}

bool ConeHomotopy::run() {
  if (associated()) return true;
  if (points_.empty() || moves()) return false;
  return slips(slip_tau) || all_coupled(points_[last_above(early_tau)].second);
}

/// One step of the path; true if it went on, and the run is not over.
bool ConeHomotopy::step() {
  if (!path_.step()) return false;
  ++referee_.stats().iterations;
  return !referee_.judge(path_.r(), {.by = Origin::Cones, .tau = path_.tau(), .step = path_.last_step()});
}

/// The path of the openings, to `until`; whether the run is over.
bool ConeHomotopy::follow(double until) {
  Settling settling;
  for (int k = 0; k < most_cone_steps && path_.tau() > until && !settling.done(); ++k) {
    if (!step()) return referee_.over();
    points_.emplace_back(path_.tau(), path_.point());
    settling.see(path_.tau(), gap());
  }
  return false;
}

bool ConeHomotopy::associated() {
  Settling settling;
  double at = newton_tau;
  for (int k = 0; k < most_cone_steps && path_.tau() > cone_end && !settling.done(); ++k) {
    if (!step()) break;
    points_.emplace_back(path_.tau(), path_.point());
    const double now = gap();
    settling.see(path_.tau(), now);
    if (path_.tau() > at || now > real_gap * path_.tau()) continue;
    at = newton_tau_again * path_.tau();
    if (try_newton(quick_newton)) return true;
  }
  const std::span all(stiffnesses);
  const bool may_split = splitting_ && !moves();
  if (referee_.over() || regions(most_rounds, may_split ? all.first(1) : all)) return true;
  const bool refused = refused_;  // the splitting has regions of its own
  if (may_split && (split() || (refused && regions(most_rounds, all.subspan(1))))) return true;
  return try_newton(last_newton);
}

/// Coulomb's law in the region of the contacts that slip at the end of this path, then the path with the openings that
/// it has there, whose metric is that of a point nearer to the solution, and so on. At the end of a path there is one
/// round alone: what it does not solve has slips that vanish. Back to where the path was if the run is not over.
bool ConeHomotopy::regions(int rounds, std::span<const double> first_stiffnesses) {
  const ConePath::Point back = path_.point();
  const Vec openings = path_.openings();
  bool over = false;
  for (int k = 0; k < rounds && !over; ++k) {
    const std::optional<Regional> found = late_region(k == 0 ? first_stiffnesses : std::span(stiffnesses));
    if (k == 0) refused_ = !found;
    if (!found) break;
    const double map = natural_map(problem_, found->r);
    over = referee_.judge(found->r, {.by = Origin::Cones, .tau = found->tau}) ||
           (map <= regional_map && newton_steps(referee_, problem_, newton_, found->r, regional_newton));
    if (over || found->tau <= cone_end) break;
    over = reopen(*found, map);
  }
  if (over || referee_.over()) return true;
  path_.open(back, openings);
  return false;
}

/// At the first point of the path from here on where contacts slip: with the others so many times as stiff as they are.
std::optional<ConeHomotopy::Regional> ConeHomotopy::late_region(std::span<const double> tries) {
  for (int k = 0; k < most_late_steps && slipping().empty(); ++k)
    if (path_.tau() <= cone_end || !step()) return {};
  for (const double stiffness : tries)
    if (auto found = region(stiffness)) return found;
  return {};
}

/// The path with these openings, from near this point if its natural map is not too large; whether the run is over.
bool ConeHomotopy::reopen(const Regional& from, double map) {
  const double tau = std::min(reopen_share * from.tau, latest_reopen);
  if (map > far_map && !points_.empty())
    path_.open(points_[last_above(slip_tau)].second, from.openings);
  else
    path_.open(path_.near(from.r, from.openings, tau), from.openings);
  Settling settling(from.tau);
  for (int k = 0; k < most_round_steps && path_.tau() > round_share * from.tau && !settling.done(); ++k) {
    if (!step()) break;
    settling.see(path_.tau(), gap());
  }
  return referee_.over();
}

/// Those that slip or are opened at this point of the path.
std::vector<std::size_t> ConeHomotopy::slipping() const {
  std::vector<std::size_t> contacts;
  const Vec speed = path_.slip();
  const Vec openings = path_.openings();
  for (Index a = 0; a < speed.size(); ++a)
    if (std::max(speed[a], openings[a]) > real_gap * path_.tau()) contacts.push_back(static_cast<std::size_t>(a));
  return contacts;
}

/// In the region of those that slip at this point, which grows by the contacts whose impulses leave the cone. The
/// others are so many times as stiff as the path's metric.
std::optional<ConeHomotopy::Regional> ConeHomotopy::region(double stiffness) {
  std::vector<std::size_t> inside = slipping();
  const auto all = static_cast<double>(problem_.blocks.size());
  const auto share = static_cast<std::size_t>(most_of_region * all);
  const std::size_t grown = std::max(most_in_small_region, most_times_region * inside.size());
  const std::size_t most = std::min({most_in_region, share, grown});
  if (inside.empty() || static_cast<double>(inside.size()) > most_of_start * all || inside.size() > most ||
      !blocks_of_one_size(problem_))
    return {};
  std::vector<Eigen::Matrix3d> A;
  std::vector<Eigen::Matrix3d> inverse;
  path_.metric(path_.point(), A, inverse);
  for (Eigen::Matrix3d& of : A) of *= stiffness;
  for (Eigen::Matrix3d& of : inverse) of /= stiffness;
  Region region(problem_, system_, std::move(A), std::move(inverse), path_.r(), std::move(inside));
  if (!region.factor()) return {};
  for (int k = 0; k < most_growths && !referee_.over(); ++k) {
    const std::optional<Solution> solved = solution_of(region.problem());
    if (!solved) return {};
    Regional found{.r = region.whole(solved->r), .openings = Vec(), .tau = path_.tau()};
    if (!found.r.allFinite()) return {};
    found.openings = region.slips(solved->u);
    const std::vector<std::size_t> leaving = region.leaving(found.r);
    if (leaving.empty()) return found;
    if (leaving.size() > std::min(std::max(region.size(), most_growth), most - region.size())) return {};
    region.grow(leaving);
  }
  return {};
}

/// Of a region's problem; nothing: it took too much work.
std::optional<Solution> ConeHomotopy::solution_of(const Problem& region) {
  Options options{.tol = region_tol, .interrupt = referee_.interrupt(), .method = Auto{.splitting = false}};
  options.max_time = std::chrono::duration<double>(std::max(0.0, referee_.seconds_left()));
  const double steps = region_work / std::pow(static_cast<double>(region.q.size()), 3);
  options.max_steps = static_cast<int>(std::clamp(steps, least_region_steps, most_region_steps));
  Result result = solve(region, options);
  referee_.stats().region_factorizations += result.stats.factorizations + result.stats.region_factorizations;
  if (!result.solved()) return {};
  options.tol = region_digits;
  options.start = result.solution.r;
  options.max_steps = region_digit_steps;
  Result better = solve(region, options);
  referee_.stats().region_factorizations += better.stats.factorizations + better.stats.region_factorizations;
  return std::move((better.solved() ? better : result).solution);
}

/// Openings by the splitting from the end of this path, and paths with them, from nearer and nearer to a solution. Back
/// to where the path was if the run is not over.
bool ConeHomotopy::split() {
  const ConePath::Point back = path_.point();
  const Vec openings = path_.openings();
  Splitting splitting(problem_, system_, back.r, back.y);
  double change = split_change;
  double map = split_map;
  bool over = false;
  for (int paths = 0; !over && paths < most_split_paths && splitting.factor(); ++paths) {
    if (!settle(splitting, change, map)) break;
    const double now = natural_map(problem_, splitting.r());
    change *= split_again;
    map = split_again * std::min(map, now);
    over = referee_.over() || with_openings(splitting, now);
  }
  path_.open(back, openings);
  return over || referee_.over();
}

/// Steps until the run is over, the natural map is at most `map`, or the openings change by less than `change` of the
/// largest in one lot after the other; false: there were too many, or they lead to no numbers.
bool ConeHomotopy::settle(Splitting& splitting, double change, double map) {
  int& steps = referee_.stats().splitting_steps;
  Vec last = splitting.openings();
  for (int settled = 0; settled < split_settled;) {
    if (steps >= most_split_steps) return false;
    for (int i = 0; i < splitting_lot; ++i, ++steps) {
      if (referee_.over()) return true;
      splitting.step();
    }
    const double now_map = natural_map(problem_, splitting.r());
    if (!std::isfinite(now_map)) return false;
    if (now_map <= split_judged ? referee_.judge(splitting.r(), {.by = Origin::Cones}) : referee_.over()) return true;
    if (now_map <= map && steps >= least_split_steps) return true;
    const Vec now = splitting.openings();
    settled = (now - last).lpNorm<Eigen::Infinity>() <= change * now.lpNorm<Eigen::Infinity>() ? settled + 1 : 0;
    last = now;
    splitting.accelerate();
  }
  return true;
}

/// The path with these openings from near the splitting's point, whose natural map this is, and a region from its end;
/// whether the run is over.
bool ConeHomotopy::with_openings(const Splitting& splitting, double map) {
  Vec openings = splitting.openings();
  const double least = least_opening * openings.maxCoeff();
  openings = (openings.array() >= least).select(openings, 0.0);
  const double tau = std::clamp(split_start_share * map, split_end, latest_reopen);
  path_.open(path_.near(splitting.r(), openings, tau), openings);
  const double end = std::clamp(split_end_share * map, split_last, split_end);
  for (int k = 0; k < most_split_path_steps && path_.tau() > end; ++k)
    if (!step()) break;
  return referee_.over() || regions(1, stiffnesses) ||
         (natural_map(problem_, path_.r()) <= turned_map && try_newton(regional_newton));
}

/// Whether many contacts slip at the end of the associated path.
bool ConeHomotopy::moves() const {
  const auto slipping = (path_.slip().array() > least_slip).count();
  return static_cast<double>(slipping) > most_moving * static_cast<double>(problem_.blocks.size());
}

/// The fastest slip of the contacts that are not coupled, where it is one in the end; 0: none.
double ConeHomotopy::other_slip() const {
  if (path_.tau() > settled_tau) return 0;
  const Vec speed = path_.slip();
  double most = 0;
  for (std::size_t a = 0; a < coupled_.size(); ++a)
    if (coupled_[a] == 0) most = std::max(most, speed[static_cast<Index>(a)]);
  return most > real_gap * path_.tau() ? most : 0;
}

/// Couples those that slip in the end.
void ConeHomotopy::couple_slips() {
  const Vec speed = path_.slip();
  for (std::size_t a = 0; a < coupled_.size(); ++a)
    if (speed[static_cast<Index>(a)] > real_gap * path_.tau()) coupled_[a] = 1;
}

/// The coupled path from this point, until others slip or it turns back; whether the run is over.
bool ConeHomotopy::follow_coupled(const ConePath::Point& from, int& steps) {
  path_.couple(from, coupled_);
  double at = newton_map;
  for (int turning = 0; steps > 0 && path_.tau() > cone_end && turning < turning_steps; --steps) {
    if (!step()) break;
    points_.emplace_back(path_.tau(), path_.point());
    turning = path_.last_step() < turning_step ? turning + 1 : 0;
    if (other_slip() > 0) return false;
    const double map = natural_map(problem_, path_.r());
    if (map > at) continue;
    at = newton_map_again * map;
    if (try_newton(coupled_newton)) return true;
  }
  return referee_.over() || (natural_map(problem_, path_.r()) <= turned_map && try_newton(last_newton));
}

/// A path coupled at the contacts of coupled_ from this point, and more of them, each coupled besides at the contacts
/// that slip at the end of the one before. Back to where the path was if the run is not over.
bool ConeHomotopy::coupled(ConePath::Point from, int steps) {
  const ConePath::Point back = path_.point();
  const Vec openings = path_.openings();
  const std::size_t kept = points_.size();
  bool over = follow_coupled(from, steps);
  while (!over && steps > 0 && other_slip() > 0) {
    from = points_[last_above(spread_share * other_slip())].second;
    couple_slips();
    over = follow_coupled(from, steps);
  }
  points_.resize(kept);
  path_.open(back, openings);
  return over;
}

/// Coulomb's law where contacts slip at the end of this path, from its last point with tau above this: the others obey
/// it there.
bool ConeHomotopy::slips(double tau) {
  coupled_.assign(problem_.blocks.size(), 0);
  couple_slips();
  return coupled(points_[last_above(tau)].second, most_coupled_steps);
}

bool ConeHomotopy::all_coupled(const ConePath::Point& from) {
  if (problem_.size() > most_all_coupled_rows) return false;
  coupled_.assign(problem_.blocks.size(), 1);
  return coupled(from, most_all_coupled_steps);
}

/// The last point with tau above this.
std::size_t ConeHomotopy::last_above(double tau) const {
  std::size_t i = points_.size() - 1;
  while (i > 0 && points_[i].first < tau) --i;
  return i;
}

bool ConeHomotopy::fixed_point() {
  if (points_.empty() || moves()) return false;
  Vec last_image;  // |u_T| of the openings before
  Vec last_gap;
  double least = gap();
  for (int k = 0, since = 0; k < most_openings && since < opening_patience; ++k) {
    const Vec s = path_.openings();
    const Vec image = path_.slip();
    const Vec g = image - s;
    Vec next = image;
    if (last_gap.size() > 0) {
      const Vec change = g - last_gap;
      const double square = change.squaredNorm();
      if (square > 0) next -= g.dot(change) / square * (image - last_image);
      next = next.cwiseMax(0.0);
    }
    last_image = image;
    last_gap = g;
    points_.resize(last_above(restart_share * (next - s).lpNorm<Eigen::Infinity>()) + 1);
    path_.open(points_.back().second, next);
    if (follow(std::clamp(end_share * g.lpNorm<Eigen::Infinity>(), least_end, largest_end)) || try_newton(last_newton))
      return true;
    const double now = gap();
    since = now <= opening_share * least ? 0 : since + 1;
    least = std::min(least, now);
    for (const double tau : slip_late_tau)
      if (slips(tau)) return true;
    if (k < coupled_openings && all_coupled(points_[last_above(late_tau)].second)) return true;
  }
  return referee_.over();
}

}  // namespace perp::contact

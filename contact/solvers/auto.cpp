// SPDX-License-Identifier: Apache-2.0
/// Auto: a list of kernels. GlockerHomotopy is one of them alone.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include "contact/classics/alart_curnier.hpp"
#include "contact/classics/gauss_seidel.hpp"
#include "contact/solvers/cone_homotopy.hpp"
#include "contact/solvers/follow.hpp"
#include "contact/solvers/newton_steps.hpp"
#include "contact/solvers/referee.hpp"

namespace perp::contact {
namespace {

/// Sweeps between two judgements, and the change of r from lot to lot beyond which they end: the sweeps that are left
/// take longer than a path then, which is longer itself where all contacts slide.
constexpr int sweeping_lot = 4;
constexpr double sweeping_contraction = 0.25;
constexpr double sliding_contraction = 0.5;

/// Newton steps from no impulses where nothing sticks.
constexpr NewtonSteps from_nothing{.most = 20, .halvings = 4, .decrease = 0.95, .patience = 3};

/// Newton steps from a point of the homotopy.
constexpr NewtonSteps polishing{.most = 12, .halvings = 0, .decrease = 0.5, .most_growth = 1e3};
constexpr double polish_again = 0.1;  ///< they are tried again when the homotopy has come so much closer
/// Values of alpha in W + alpha I, tried in turn: next to nothing for regular W, then more.
constexpr std::array polish_alphas{1e-10, 1e-4, 1e-7};

/// Steps this short in a row end an attempt.
constexpr double short_step = 0.1;
constexpr int short_steps = 5;

/// Damped Newton steps from the best point of an attempt.
constexpr NewtonSteps search_steps{
    .most = 100, .alpha = 1e-5, .decrease = 0.9, .full = Origin::DampedNewton, .patience = 40};

struct ProximalLoop {
  double least_alpha = 1e-5;
  double shrink = 0.7;         ///< of alpha after a subproblem that was solved; after another alpha is 4 times as large
  double relaxation = 0.9;     ///< of the bound, twice the alpha that failed last, below which alpha does not fall
  int patience = 3000;         ///< moves without half of the residual that end the loop
  double homotopy_from = 0.3;  ///< alpha from which the homotopy solves what Newton's method does not
};
constexpr ProximalLoop proximal_loop_of{};

/// Requests of the loop to a subproblem.
struct Subproblem {
  int newton = 10;       ///< steps
  int homotopy = 60;     ///< steps
  double tol = 1e-11;    ///< natural map in scaled units, or
  double share = 0.1;    ///< this part of alpha |r - centre|
  double accept = 1e-7;  ///< what the homotopy must come to
};
constexpr Subproblem subproblem{};

template <int Size>
class Solver {
 public:
  Solver(Referee& referee, const Scaled& problem, const Auto& method)
      : referee_(referee),
        problem_(problem),
        method_(method),
        options_(method.homotopy.options),
        system_(problem, options_.lu),
        newton_(problem, system_) {}
  ~Solver() { referee_.stats.factorizations += system_.factorizations(); }
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  /// Runs the list's kernels until the run is over.
  void run(const Vec& start) {
    start_ = start;
    for (const Entry& entry : list)
      if ((this->*entry.when)() && (this->*entry.kernel)()) return;
  }

  /// A line of the list.
  struct Entry {
    std::string_view name, when_in_words, reason, worth;  ///< worth: measured (bench/results/ablations.md)
    bool (Solver::*when)() const;
    bool (Solver::*kernel)();  ///< returns whether the run is over
  };
  static const std::array<Entry, 7> list;

 private:
  bool is_warm() const { return start_.size() > 0; }
  bool sweeps() const { return !is_warm() && method_.sweeps > 0; }
  bool over_cones() const { return method_.cones && method_.polish && Size == 3; }
  bool always() const { return true; }
  bool proximal() const { return method_.proximal; }

  bool from_start();
  bool newton_from_nothing();
  bool sweep();
  bool cones() {
    if constexpr (Size == 3)
      return ConeHomotopy(referee_, problem_, newton_, system_).run();
    else
      return false;
  }
  bool homotopy();
  bool proof() { return referee_.no_solution(); }
  bool by_groups();
  bool proximal_loop();

  bool polish(const Vec& r, double alpha);
  bool newton_on(In centre, double alpha, Vec& r);
  bool homotopy_on(In centre, double alpha, Vec& r);
  Scaled proximal_problem(In centre, double alpha) const;

  Referee& referee_;
  const Scaled& problem_;
  const Auto& method_;
  HomotopyOptions options_;
  ContactSystemOf<Size> system_;  // of all: one analysis, and one set of factors in memory
  AlartCurnierOf<Size> newton_;
  Vec start_{};
};

template <int Size>
const std::array<typename Solver<Size>::Entry, 7> Solver<Size>::list{{
    {"Newton steps, sweeps and paths from the start", "a start is given", "the solution of a similar problem is near",
     "", &Solver<Size>::is_warm, &Solver<Size>::from_start},
    {"sweeps of Gauss-Seidel, and Newton steps from no impulses where these leave nothing that sticks",
     "no start is given", "weakly coupled contacts need no more, nor do contacts that all slide",
     "they alone solve 20 of 31 recorded sets; inclines of up to 50 contacts take 0.2 to 0.6 of the time",
     &Solver<Size>::sweeps, &Solver<Size>::sweep},
    {"paths over the cones", "no contact has rolling friction", "the path of the associated law cannot turn back",
     "without its splitting 2 of 463 problems are lost, and 22 % of the time", &Solver<Size>::over_cones,
     &Solver<Size>::cones},
    {"homotopy", "", "it follows Coulomb's law itself, with Newton steps near a solution and damped ones at its end",
     "without the damped steps 22 % more factorizations", &Solver<Size>::always, &Solver<Size>::homotopy},
    {"proof that there is no solution", "", "what has none need not be tried longer", "", &Solver<Size>::proximal,
     &Solver<Size>::proof},
    {"groups of contacts by themselves", "", "no step is shortened by what happens elsewhere",
     "RockPile with mu = 0.2 takes 3,509 factorizations without, 265 with", &Solver<Size>::proximal,
     &Solver<Size>::by_groups},
    {"proximal loop", "", "singular W need it", "without its homotopy RockPile is not solved in 20 s",
     &Solver<Size>::proximal, &Solver<Size>::proximal_loop},
}};

/// Goes on as from the step before of a sequence; of two disks by Newton steps alone.
template <int Size>
bool Solver<Size>::from_start() {
  if (referee_.judge(start_, {.by = Origin::WarmStart}) || !method_.polish) return referee_.over();
  if constexpr (Size == 5) return polish(start_, polish_alphas.front());
  Follower follower(referee_.stats);
  const Scaled& coordinates = follower.take(referee_.problem());
  const auto convert = [](const Scaled& from, const Scaled& to, In r) { return to.reduce(from.expand(r)); };
  const auto accept = [&](const Vec& r, Origin by) {
    return referee_.judge(convert(coordinates, problem_, r), {.by = by}) && referee_.solved();
  };
  follower.from(convert(problem_, coordinates, start_), accept, [&] { return referee_.over(); });
  return referee_.over();
}

/// Takes the disk's radius (r_N - rho_N u_N)+, which friction has before there are impulses.
template <int Size>
bool Solver<Size>::newton_from_nothing() {
  AlartCurnierOf<Size> newton(problem_, system_, FrictionDisk::Augmented);
  return newton_steps(referee_, problem_, newton, Vec::Zero(problem_.size()), from_nothing);
}

/// Tells whether every contact that presses has all of its friction.
bool nothing_sticks(const Scaled& problem, const Vec& r) {
  return std::all_of(problem.blocks.begin(), problem.blocks.end(), [&](const Scaled::Block& block) {
    constexpr double border = 1 - 1e-9;
    return block.size == 1 || r.segment(block.first + 1, block.entries()).norm() >= border * r[block.first];
  });
}

/// Sweeps while they contract. Where nothing sticks after the first ones, Newton steps from no impulses.
template <int Size>
bool Solver<Size>::sweep() {
  const GaussSeidel method(problem_);
  Vec r = Vec::Zero(problem_.size());
  Vec u = problem_.q;
  double before = lcp::infinity;  // change of r in the last lot
  bool slide = false;
  for (int k = 0; k < method_.sweeps; k += sweeping_lot) {
    const Vec last = r;
    for (int i = 0; i < sweeping_lot; ++i) method.sweep(r, u);
    referee_.stats.sweeps += sweeping_lot;
    if (referee_.judge(r, {.by = Origin::Sweeps})) return true;
    if (k == 0) slide = nothing_sticks(problem_, r);
    if (k == 0 && slide && method_.polish && newton_from_nothing()) return true;
    const double change = (r - last).norm();
    if (!(change <= (slide ? sliding_contraction : sweeping_contraction) * before)) return false;
    before = change;
  }
  return false;
}

/// Takes steps of the homotopy, with Newton steps where it comes near a solution; then damped Newton steps from the
/// point of the least natural map.
template <int Size>
bool Solver<Size>::homotopy() {
  ++referee_.stats.attempts;
  Homotopy<Size> homotopy(problem_, system_, options_);
  double polish_at = method_.polish_at;
  std::size_t polished = 0;
  Vec best = homotopy.r();
  double least = lcp::infinity;
  for (int k = 0, in_a_row = 0; k < method_.homotopy.max_iterations && in_a_row < short_steps; ++k) {
    const bool going = homotopy.step();
    ++referee_.stats.iterations;
    const HomotopyIteration& last = homotopy.last();
    if (referee_.judge(homotopy.r(), {.by = Origin::Homotopy, .tau = last.tau, .step = last.step})) return true;
    if (!going) break;
    in_a_row = last.step < short_step ? in_a_row + 1 : 0;
    if (!method_.polish) continue;
    // In the scaled problem's own measure: what decides here must not depend on the problem's units.
    const double map = natural_map(problem_, homotopy.r());
    if (map < least) {
      least = map;
      best = homotopy.r();
    }
    const double largest =
        std::max(homotopy.r().template lpNorm<Eigen::Infinity>(), homotopy.u().template lpNorm<Eigen::Infinity>());
    const double near = map / std::max(largest, 1e-300);
    if (near > polish_at) continue;
    polish_at = polish_again * near;
    if (polish(homotopy.r(), polish_alphas[polished++ % polish_alphas.size()])) return true;
  }
  return method_.polish && !referee_.over() && newton_steps(referee_, problem_, newton_, std::move(best), search_steps);
}

/// Newton steps on the equation of Alart & Curnier with the proximal term of the iterate itself.
template <int Size>
bool Solver<Size>::polish(const Vec& r, double alpha) {
  NewtonSteps steps = polishing;
  steps.alpha = alpha;
  return newton_steps(referee_, problem_, newton_, r, steps);
}

/// Groups of contacts that do not act on each other, each by itself: most need no more than sweeps, and in what is left
/// no step is shortened by what happens elsewhere. False where the whole is one group.
template <int Size>
bool Solver<Size>::by_groups() {
  const Problem& whole = referee_.problem();
  const int d = whole.dimension;
  Vec r = referee_.best_impulses();
  bool all = true;
  const std::vector<ContactGroup> groups = separated(whole);
  for (const ContactGroup& group : groups) {
    if (referee_.over()) break;
    const Scaled coordinates = scaled(group.problem, method_.homotopy.scaling);
    Options options = referee_.options();
    options.better = {};
    options.max_time = std::chrono::duration<double>(std::max(0.0, referee_.seconds_left()));
    Referee part(group.problem, coordinates, options, true);
    if (!part.over()) run_auto(part, coordinates, method_, {});
    referee_.add(part.stats);
    all = all && part.solved();
    for (std::size_t k = 0; k < group.contacts.size(); ++k)
      r.segment(d * group.contacts[k], d) = part.best_impulses().segment(d * static_cast<Index>(k), d);
  }
  if (groups.empty()) return false;
  return referee_.judge(problem_.reduce(r), {.by = Origin::Groups}) || referee_.over() || !all;
}

template <int Size>
Scaled Solver<Size>::proximal_problem(In centre, double alpha) const {
  Scaled proximal = problem_;
  proximal.W = problem_.W.plus(alpha);
  proximal.q -= alpha * centre;
  return proximal;
}

/// Newton's method on the proximal problem of `centre`, from r.
template <int Size>
bool Solver<Size>::newton_on(In centre, double alpha, Vec& r) {
  Vec x = r;
  double least = lcp::infinity;
  for (int k = 0; k <= subproblem.newton; ++k) {
    const double far = natural_map(problem_, x, centre, alpha);
    if (far < subproblem.tol || (k > 0 && far < std::min(1e-6, subproblem.share * alpha * (x - centre).norm()))) {
      r = x;
      return true;
    }
    if (!(far <= 1e3 * least) || k == subproblem.newton) return false;
    least = std::min(least, far);
    Vec to;
    ++referee_.stats.newton_steps;
    if (!newton_.step(x, centre, alpha, to)) return false;
    x = std::move(to);
  }
  return false;
}

template <int Size>
bool Solver<Size>::homotopy_on(In centre, double alpha, Vec& r) {
  const Scaled proximal = proximal_problem(centre, alpha);
  HomotopyOptions careful = options_;
  careful.least_centring = std::max(0.1, careful.least_centring);
  careful.to_boundary = 0.99;
  ContactSystemOf<Size> system(proximal, system_);
  Homotopy<Size> homotopy(proximal, system, careful);
  double least = lcp::infinity;
  for (int k = 0; k < subproblem.homotopy && least > 1e-9 && !referee_.over(); ++k) {
    const bool going = homotopy.step();
    ++referee_.stats.iterations;
    if (const double far = natural_map(proximal, homotopy.r()); far < least) {
      least = far;
      r = homotopy.r();
    }
    if (!going || (k > 15 && homotopy.last().step < 0.02)) break;
  }
  referee_.stats.factorizations += system.factorizations();
  return least <= subproblem.accept;
}

template <int Size>
bool Solver<Size>::proximal_loop() {
  ++referee_.stats.attempts;
  Vec centre = Vec::Zero(problem_.size());
  Vec reached = centre;  // the last subproblem's solution
  Vec r = centre;
  std::optional<Vec> increment;
  double alpha = 1;
  double bound = 0;
  double milestone = lcp::infinity;
  int since = 0;  // moves since the best point was half as good
  while (!referee_.over() && since < proximal_loop_of.patience) {
    if (!newton_on(centre, alpha, r) && (alpha < proximal_loop_of.homotopy_from || !homotopy_on(centre, alpha, r))) {
      if (alpha >= 100) return referee_.over();
      bound = 2 * alpha;
      alpha *= 4;
      centre = r = reached;
      increment.reset();
      continue;
    }
    ++referee_.stats.proximal_steps;
    if (referee_.judge(r, {.by = Origin::Proximal, .alpha = alpha})) return true;
    ++since;
    if (referee_.best() <= 0.5 * milestone) {
      milestone = referee_.best();
      since = 0;
    }
    const Vec moved = r - centre;
    centre = reached = r;
    if (increment && moved.dot(*increment) > 0.95 * moved.norm() * increment->norm()) {
      // Nearly parallel (cosine above 0.95): to the limit of the geometric series, or five increments far.
      const double ratio = moved.norm() / increment->norm();
      centre += std::min(5.0, ratio < 1 ? ratio / (1 - ratio) : 5.0) * moved;
      increment.reset();
    } else {
      increment = moved;
    }
    bound *= proximal_loop_of.relaxation;
    alpha = std::max({proximal_loop_of.least_alpha, proximal_loop_of.shrink * alpha, bound});
  }
  return referee_.over();
}

}  // namespace

std::vector<ncp::OutlineLine> outline_of_auto() {
  std::vector<ncp::OutlineLine> lines;
  for (const Solver<3>::Entry& entry : Solver<3>::list)
    lines.push_back({.method = std::string(entry.name),
                     .when = std::string(entry.when_in_words),
                     .reason = std::string(entry.reason),
                     .worth = std::string(entry.worth)});
  return lines;
}

void run_auto(Referee& referee, const Scaled& problem, const Auto& method, const Vec& start) {
  with_size(problem, [&]<int Size>() { Solver<Size>(referee, problem, method).run(start); });
}

}  // namespace perp::contact

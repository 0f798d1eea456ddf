// SPDX-License-Identifier: Apache-2.0
/// Auto, and GlockerHomotopy as a part of it: sweeps, the cones' paths, attempts of the homotopy, Newton steps, the
/// proximal loop.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include "contact/classics/alart_curnier.hpp"
#include "contact/classics/gauss_seidel.hpp"
#include "contact/solvers/cone_homotopy.hpp"
#include "contact/solvers/newton_steps.hpp"
#include "contact/solvers/referee.hpp"

namespace perp::contact {
namespace {

struct Sweeping {
  int lot = 4;               ///< sweeps between two judgements
  double contraction = 0.5;  ///< of the change of r from lot to lot; slower sweeps end
  int settling = 24;         ///< sweeps that are made in any case near a solution, until the contacts have their states
  double near = 1e-2;        ///< what is near, both metrics
};
constexpr Sweeping sweeping{};

/// Two steps of Glocker's homotopy are all that easy problems need. In more rows one LU takes as long as half of the
/// associated path, whose matrices are Cholesky's.
constexpr int first_steps = 2;
constexpr Index first_steps_rows = 2000;

/// Newton steps from a point of the homotopy.
struct Polishing {
  int steps = 12;
  int failures = 2;    ///< so many steps in a row that do not halve the residual end them
  double again = 0.1;  ///< the next ones are tried when the homotopy has come so much closer
};
constexpr Polishing polishing{};
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

class Solver {
 public:
  Solver(Referee& referee, const Scaled& problem, const Auto& method)
      : referee_(referee),
        problem_(problem),
        method_(method),
        options_(method.homotopy.options),
        system_(problem, options_.lu, referee.deadline()),
        newton_(problem, system_) {}
  ~Solver() { referee_.stats().factorizations += system_.factorizations(); }
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  void run(const Vec& start) {
    if (start.size() > 0 ? warm(start) : sweep()) return;
    if (method_.cones && method_.polish ? with_cones() : attempt(options_)) return;
    if (method_.proximal && !referee_.no_solution() && !by_groups()) proximal_loop();
  }

 private:
  /// Each of these answers whether the run is over.
  bool warm(const Vec& start);
  bool sweep();
  bool with_cones();
  bool attempt(const HomotopyOptions& options, const Vec* from = nullptr, double tau = 1);
  bool homotopy_steps(const HomotopyOptions& options, int most, Vec& best, const Vec* from = nullptr, double tau = 1);
  bool search(Vec from);
  bool polish(Vec r, double alpha);
  bool by_groups();
  bool proximal_loop();

  bool newton_on(In centre, double alpha, Vec& r);
  bool homotopy_on(In centre, double alpha, Vec& r);
  Scaled proximal_problem(In centre, double alpha) const;

  Referee& referee_;
  const Scaled& problem_;
  const Auto& method_;
  HomotopyOptions options_;
  ContactSystem system_;  // of all: one analysis, and one set of factors in memory
  AlartCurnier newton_;
};

/// Newton steps from the last solution, then the homotopy from near it.
bool Solver::warm(const Vec& start) {
  if (referee_.judge(start, {.by = Origin::WarmStart})) return true;
  if (method_.polish && polish(start, polish_alphas.front())) return true;
  const double far = natural_map(problem_, start);
  return attempt(options_, &start, std::clamp(far * far, 1e-6, 1.0));
}

/// Sweeps while they contract.
bool Solver::sweep() {
  const GaussSeidel method(problem_);
  Vec r = Vec::Zero(problem_.size());
  Vec u = problem_.q;
  double before = lcp::infinity;  // change of r in the last lot
  for (int k = 0; k < method_.sweeps; k += sweeping.lot) {
    const Vec last = r;
    for (int i = 0; i < sweeping.lot; ++i) method.sweep(r, u);
    referee_.stats().sweeps += sweeping.lot;
    if (referee_.judge(r, {.by = Origin::Sweeps})) return true;
    const double change = (r - last).norm();
    const bool settling = k < sweeping.settling && referee_.last() <= sweeping.near;
    if (!settling && !(change <= sweeping.contraction * before)) return false;
    before = change;
  }
  return false;
}

/// The cones' paths, and the first attempt.
bool Solver::with_cones() {
  Vec best;
  if (problem_.size() <= first_steps_rows && homotopy_steps(options_, first_steps, best)) return true;
  return ConeHomotopy(referee_, problem_, newton_, system_).run() || attempt(options_);
}

bool Solver::attempt(const HomotopyOptions& options, const Vec* from, double tau) {
  ++referee_.stats().attempts;
  Vec best;
  return homotopy_steps(options, method_.homotopy.max_iterations, best, from, tau) || search(std::move(best));
}

/// At most so many of an attempt; `best` is the point of the least natural map.
bool Solver::homotopy_steps(const HomotopyOptions& options, int most, Vec& best, const Vec* from, double tau) {
  Homotopy homotopy(problem_, system_, options);
  if (from != nullptr) homotopy.start(*from, tau);
  double polish_at = method_.polish_at;
  std::size_t polished = 0;
  best = homotopy.r();
  double least = lcp::infinity;
  int in_a_row = 0;
  bool over = false;
  for (int k = 0; k < most && in_a_row < short_steps && !over; ++k) {
    const bool going = homotopy.step();
    ++referee_.stats().iterations;
    const HomotopyIteration& last = homotopy.last();
    over = referee_.judge(homotopy.r(), {.by = Origin::Homotopy, .tau = last.tau, .step = last.step});
    if (over || !going) break;
    in_a_row = last.step < short_step ? in_a_row + 1 : 0;
    if (!method_.polish) continue;
    // In the scaled problem's own measure: what decides here must not depend on the problem's units.
    const double map = natural_map(problem_, homotopy.r());
    if (map < least) {
      least = map;
      best = homotopy.r();
    }
    const double largest = std::max(homotopy.r().lpNorm<Eigen::Infinity>(), homotopy.u().lpNorm<Eigen::Infinity>());
    if (const double near = map / std::max(largest, 1e-300); near <= polish_at) {
      polish_at = polishing.again * near;
      over = polish(homotopy.r(), polish_alphas[polished++ % polish_alphas.size()]);
    }
  }
  return over;
}

/// Damped Newton steps after an attempt.
bool Solver::search(Vec from) {
  if (!method_.polish || referee_.over()) return referee_.over();
  return newton_steps(referee_, problem_, newton_, std::move(from), search_steps);
}

/// Newton steps on the equation of Alart & Curnier with the proximal term of the iterate itself.
bool Solver::polish(Vec r, double alpha) {
  double last = natural_map(problem_, r);
  int failures = 0;
  for (int k = 0; k < polishing.steps && failures < polishing.failures; ++k) {
    Vec to;
    if (!newton_.step(r, r, alpha, to)) return false;
    r = std::move(to);
    ++referee_.stats().newton_steps;
    if (referee_.judge(r, {.by = Origin::Newton, .alpha = alpha})) return true;
    const double now = natural_map(problem_, r);
    if (!(now <= 1e3 * last)) return false;
    failures = now <= 0.5 * last ? 0 : failures + 1;
    last = std::min(last, now);
  }
  return false;
}

/// Groups of contacts that do not act on each other, each by itself: most need no more than sweeps, and in what is left
/// no step is shortened by what happens elsewhere. False where the whole is one group.
bool Solver::by_groups() {
  const Problem& whole = referee_.problem();
  const int d = whole.dimension;
  Vec r = referee_.best_impulses();
  bool all = true;
  const std::vector<ContactGroup> groups = separated(whole);
  for (const ContactGroup& group : groups) {
    if (referee_.over()) break;
    Options options{.tol = referee_.tol(), .interrupt = referee_.interrupt(), .method = method_};
    options.max_time = std::chrono::duration<double>(std::max(0.0, referee_.seconds_left()));
    options.max_steps = referee_.steps_left();  // and no proof is asked for: it was, for the whole
    const Result part = solve(group.problem, options);
    referee_.add(part.stats);
    if (part.status == Status::OutOfMemory) throw std::bad_alloc();
    all = all && part.solved();
    for (std::size_t k = 0; k < group.contacts.size(); ++k)
      r.segment(d * group.contacts[k], d) = part.solution.r.segment(d * static_cast<Index>(k), d);
  }
  if (groups.empty()) return false;
  return referee_.judge(problem_.reduce(r), {.by = Origin::Groups}) || referee_.over() || !all;
}

Scaled Solver::proximal_problem(In centre, double alpha) const {
  Scaled proximal = problem_;
  proximal.W = problem_.W.plus(alpha);
  proximal.q -= alpha * centre;
  return proximal;
}

/// Newton's method on the proximal problem of `centre`, from r.
bool Solver::newton_on(In centre, double alpha, Vec& r) {
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
    ++referee_.stats().newton_steps;
    if (!newton_.step(x, centre, alpha, to)) return false;
    x = std::move(to);
  }
  return false;
}

bool Solver::homotopy_on(In centre, double alpha, Vec& r) {
  const Scaled proximal = proximal_problem(centre, alpha);
  HomotopyOptions careful = options_;
  careful.least_centring = std::max(0.1, careful.least_centring);
  careful.to_boundary = 0.99;
  ContactSystem system(proximal, system_);
  Homotopy homotopy(proximal, system, careful);
  double least = lcp::infinity;
  for (int k = 0; k < subproblem.homotopy && least > 1e-9 && !referee_.over(); ++k) {
    const bool going = homotopy.step();
    ++referee_.stats().iterations;
    if (const double far = natural_map(proximal, homotopy.r()); far < least) {
      least = far;
      r = homotopy.r();
    }
    if (!going || (k > 15 && homotopy.last().step < 0.02)) break;
  }
  referee_.stats().factorizations += system.factorizations();
  return least <= subproblem.accept;
}

bool Solver::proximal_loop() {
  ++referee_.stats().attempts;
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
    ++referee_.stats().proximal_steps;
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

void run_auto(Referee& referee, const Scaled& problem, const Auto& method, const Vec& start) {
  Solver(referee, problem, method).run(start);
}

}  // namespace perp::contact

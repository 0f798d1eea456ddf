// SPDX-License-Identifier: Apache-2.0
#include "contact/solvers/solve.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <type_traits>
#include <utility>

#include "contact/solvers/referee.hpp"
#include "lcp/judge/result.hpp"
#include "lcp/words.hpp"

namespace perp::contact {
namespace {

template <class M>
bool scales(const M& m) {
  if constexpr (requires { m.homotopy; })
    return m.homotopy.scaling;
  else if constexpr (requires { m.newton; })
    return m.newton.scaling;
  else
    return m.scaling;
}

void run(Referee& referee, const Scaled& problem, const Auto& method, const Vec& start) {
  run_auto(referee, problem, method, start);
}
void run(Referee& referee, const Scaled& problem, const GlockerHomotopy& method, const Vec& start) {
  run_auto(referee, problem, {.homotopy = method, .sweeps = 0, .cones = false, .polish = false, .proximal = false},
           start);
}
void run(Referee& referee, const Scaled& problem, const GlockerNcp& method, const Vec& start) {
  run_ncp(referee, problem, method, start);
}
template <Classic M>
void run(Referee& referee, const Scaled& problem, const M& method, const Vec& start) {
  iterate(referee, problem, method, start);
}

/// Returns whether the method knows contacts with two disks.
template <class M>
inline constexpr bool rolls =
    std::is_same_v<M, Auto> || std::is_same_v<M, GlockerHomotopy> || std::is_same_v<M, GlockerNcp> ||
    std::is_same_v<M, Nsgs> || std::is_same_v<M, FixedPoint> || std::is_same_v<M, Extragradient> ||
    std::is_same_v<M, Hyperplane> || std::is_same_v<M, AlartCurnierNewton>;

double larger_metric(const Residual& residual) { return std::max(residual.siconos, residual.rr9118); }

}  // namespace

std::span<const MethodEntry> methods() {
  static const std::array all{
      MethodEntry{"auto",
                  "Gauss-Seidel, paths over the cones, Glocker's homotopy, a proximal loop, until one solves it",
                  Auto{}, true},
      MethodEntry{"homotopy", "Glocker's NCP by the interior-point homotopy", GlockerHomotopy{}, true},
      MethodEntry{"nsgs", "nonsmooth Gauss-Seidel: contact by contact, to the end", Nsgs{}},
      MethodEntry{"fixed-point", "De Saxce & Feng's projection onto the cones", FixedPoint{}},
      MethodEntry{"extragradient", "Korpelevich's extragradient method on the variational inequality", Extragradient{}},
      MethodEntry{"hyperplane", "Solodov & Svaiter's projection onto hyperplanes", Hyperplane{}},
      MethodEntry{"alart-curnier", "Newton's method with a line search on Alart & Curnier's equation",
                  AlartCurnierNewton{}},
      MethodEntry{"fischer-burmeister", "Newton's method with a line search on the cone's Fischer-Burmeister function",
                  FischerBurmeisterNewton{}},
      MethodEntry{"natural-map", "Newton's method with a line search on the natural map", NaturalMapNewton{}},
      MethodEntry{"tresca", "a fixed point on Tresca's threshold", Tresca{}},
      MethodEntry{"panagiotopoulos", "normal and tangential problems in turn", Panagiotopoulos{}},
      MethodEntry{"cadoux", "Cadoux' fixed point on s = |u_T|, convex problems over the cones", Cadoux{}}};
  return all;
}

void describe(GlockerHomotopy& m, ncp::Fields& f) {
  HomotopyOptions& o = m.options;
  f.add("max_iterations", &m.max_iterations, ncp::at_least(1), "iterations of one attempt");
  f.add("scaling", &m.scaling, "in the units of the contacts");
  f.add("delta_share", &o.delta_share, ncp::strictly_between(0, 10), "delta = delta_share tau");
  f.add("eps_share", &o.eps_share, {.low = 0, .high = 10, .open_high = true}, "eps = eps_share tau");
  f.add("least_centring", &o.least_centring, ncp::strictly_between(0, 1), "sigma at least");
  f.add("to_boundary", &o.to_boundary, ncp::strictly_between(0, 1), "share of the way to the boundary");
  f.add("neighbourhood", &o.neighbourhood, ncp::strictly_between(0, 1), "least product over the mean");
  ncp::describe_lu(o.lu, f);
}

void describe(Auto& m, ncp::Fields& f) {
  f.add("sweeps", &m.sweeps, ncp::at_least(0), "of Gauss-Seidel, before anything else");
  f.add("cones", &m.cones, "interior points over the cones, from the associated law, before the homotopy");
  f.add("polish", &m.polish, "Newton steps on Alart & Curnier's equation");
  f.add("polish_at", &m.polish_at, ncp::above(0), "relative natural residual at which they are tried first");
  f.add("proximal", &m.proximal, "a proximal loop after all attempts");
  describe(m.homotopy, f);
}

void describe(GlockerNcp& m, ncp::Fields& f) {
  describe(m.formulation, f);
  f.add("stages", &m.stages, ncp::at_least(1), "in which delta is continued from 0.1");
  f.add("scaling", &m.scaling, "in the units of the contacts");
}

std::string_view to_string(Origin origin) {
  using enum Origin;
  static constexpr std::pair<Origin, std::string_view> words[] = {{Zero, "zero"},
                                                                  {WarmStart, "warm-start"},
                                                                  {Sweeps, "sweeps"},
                                                                  {Cones, "cones"},
                                                                  {Homotopy, "homotopy"},
                                                                  {Newton, "newton"},
                                                                  {DampedNewton, "damped-newton"},
                                                                  {Groups, "groups"},
                                                                  {Proximal, "proximal"},
                                                                  {Ncp, "ncp"},
                                                                  {Iterate, "iterate"}};
  return word_of(origin, words);
}

std::optional<std::string> invalid(const Options& given) {
  Options options = given;
  ncp::Fields fields;
  fields.add("tol", &options.tol, ncp::above(0), "of accepted()");
  fields.add("max_time", &options.max_time, ncp::at_least(0), "seconds");
  std::visit([&](auto& method) { describe(method, fields); }, options.method);
  if (auto why = fields.invalid()) return why;
  const auto* ncp = std::get_if<GlockerNcp>(&options.method);
  return ncp == nullptr ? std::nullopt : ncp::invalid(ncp->method);
}

Referee::Referee(const Problem& problem, const Scaled& scaled, const Options& options, bool part)
    : problem_(problem), judge_(problem), scaled_(scaled), options_(options), part_(part) {
  take(Vec::Zero(scaled.size()), Vec::Zero(scaled.whole), Origin::Zero);
}

/// An accepted point is the end; else the best one is that of the least metrics, which say how near all of it is.
bool Referee::judge(In r, Record record) {
  last_ = lcp::infinity;
  // Impulses that overflow are no solution, and no error of whoever asked.
  if (const Vec impulses = scaled_.expand(r); impulses.allFinite()) {
    const Residual now = take(r, impulses, record.by);
    record.k = static_cast<int>(result_.history.size());
    record.siconos = now.siconos;
    record.rr9118 = now.rr9118;
    result_.history.push_back(record);
  }
  return over();
}

/// Judges a point, and keeps it if it is the best one. What is far from a solution is judged in working precision.
Residual Referee::take(In r, const Vec& impulses, Origin by) {
  Vec u;
  const std::optional<Residual> far = judge_.far(impulses, options_.tol);
  const Residual residual = far ? *far : judge_(impulses, u);
  last_ = larger_metric(residual);
  const bool solved = !far && accepted(residual, options_.tol);
  if (result_.solved() || !(solved || last_ < best_metric_ || best_.size() != r.size())) return residual;
  Vec best = r;  // what may throw comes first: the point and what is said of it change together
  Vec solution = impulses;
  if (solved) result_.status = Status::Solved;
  best_metric_ = last_;
  best_ = std::move(best);
  result_.solution = {.r = std::move(solution), .u = std::move(u)};
  result_.residual = residual;
  result_.by = by;
  if (options_.better) options_.better(result_.solution.r, by);
  return residual;
}

bool Referee::judge_iterate(In r, const TrialStep& step) {
  return judge(r, {.by = Origin::Iterate, .step = step.step, .alpha = step.alpha});
}

bool Referee::over() {
  if (result_.status == Status::NoProgress) {
    if (options_.interrupt != nullptr && *options_.interrupt)
      result_.status = Status::Interrupted;
    else if (seconds_left() <= 0)
      result_.status = Status::TimeLimit;
  }
  return result_.status != Status::NoProgress;
}

void Referee::add(const Stats& of_part) {
  stats.iterations += of_part.iterations;
  stats.sweeps += of_part.sweeps;
  stats.newton_steps += of_part.newton_steps;
  stats.splitting_steps += of_part.splitting_steps;
  stats.proximal_steps += of_part.proximal_steps;
  stats.attempts += of_part.attempts;
  stats.factorizations += of_part.factorizations;
}

double Referee::seconds_left() const {
  return std::chrono::duration<double>(options_.max_time - (std::chrono::steady_clock::now() - begin_)).count();
}

bool Referee::no_solution() {
  if (searched_ || part_ || result_.status == Status::Solved || result_.status == Status::Interrupted) return over();
  const auto begin = std::chrono::steady_clock::now();
  const SearchLimits limits = search_after(begin - begin_, options_.max_time, options_.interrupt);
  std::optional<Infeasible> proof = find_infeasibility(problem_, limits);
  searched_ = proof || std::chrono::steady_clock::now() - begin < limits.max_time;
  if (proof) {
    result_.status = Status::Infeasible;
    result_.verdict = verdict_of(problem_, std::move(*proof));
  }
  return over();
}

/// What is known where no solution was found. Both searches together keep to the limits of one.
void Referee::ask_existence() {
  const auto unknown = [this] { return result_.status == Status::NoProgress || result_.status == Status::TimeLimit; };
  const auto begin = std::chrono::steady_clock::now();
  SearchLimits limits = search_after(begin - begin_, options_.max_time, options_.interrupt);
  if (unknown()) no_solution();
  limits.max_time -= std::chrono::steady_clock::now() - begin;
  if (unknown()) result_.verdict = verdict_without_certificate(problem_, limits);
}

Result Referee::result(const std::string& message) {
  ask_existence();
  if (result_.solution.u.size() != result_.solution.r.size())
    result_.residual = judge_(result_.solution.r, result_.solution.u);
  std::ostringstream text;
  if (result_.status == Status::Solved)
    text << "solved: ";
  else if (result_.status == Status::TimeLimit)
    text << "the time limit of " << options_.max_time.count() << " s was reached: ";
  else if (result_.status == Status::Interrupted)
    text << "interrupted: ";
  else if (result_.status == Status::Infeasible)
    text << result_.verdict.message << "; at the best point ";
  else
    text << message << ": ";
  text.precision(3);
  const Residual& e = result_.residual;
  text << "the natural map is " << e.siconos << " (largest of |q|, |r|, |u|) and " << e.rr9118 << " (|q|), relative";
  if (result_.status != Status::Solved && larger_metric(e) <= options_.tol)
    text << "; contact by contact cone, normal and slip hold to " << e.cone_share << ", " << e.normal_share << " and "
         << e.slip_share << ", relative";
  if (result_.status != Status::Solved && e.worst >= 0) text << "; worst at contact " << e.worst + 1;
  if ((result_.status == Status::NoProgress || result_.status == Status::TimeLimit) && !result_.verdict.message.empty())
    text << "; " << result_.verdict.message;
  result_.message = text.str();
  result_.stats = stats;
  result_.stats.time = std::chrono::steady_clock::now() - begin_;
  return std::move(result_);
}

Result solve(const Problem& problem, const Options& options) {
  check(problem);
  if (const auto why = invalid(options)) refuse_input("contact::solve: ", *why);
  if (options.start.size() != 0 && (options.start.size() != problem.q.size() || !options.start.allFinite()))
    refuse_input("contact::solve: the start has ", options.start.size(),
                 " entries, or some that are not finite; the problem has ", problem.q.size());
  const bool scale = std::visit([](const auto& m) { return scales(m); }, options.method);
  const Scaled coordinates = scaled(problem, scale);
  if (coordinates.rolls && !std::visit([]<class M>(const M&) { return rolls<M>; }, options.method))
    refuse_input(
        "contact::solve: the method knows no rolling friction; auto does, homotopy, methods for NCPs, nsgs, "
        "fixed-point, "
        "extragradient, hyperplane and alart-curnier");
  Referee referee(problem, coordinates, options);
  const Vec start = options.start.size() > 0 ? coordinates.reduce(options.start) : Vec();
  if (!referee.over())
    std::visit([&](const auto& method) { run(referee, coordinates, method, start); }, options.method);
  return referee.result("no attempt comes closer");
}

}  // namespace perp::contact

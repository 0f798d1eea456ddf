#include "app/contact/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <limits>
#include <optional>

#include "app/contact/method_options.hpp"
#include "app/program.hpp"
#include "contact/first_ncp.hpp"
#include "contact/frictionless.hpp"
#include "contact/generators.hpp"
#include "contact/inner_faceting.hpp"
#include "contact/outer_faceting.hpp"
#include "contact/read.hpp"
#include "lcp/solve.hpp"

namespace perp::app::contacts {

namespace {

using contact::Problem;
using Clock = std::chrono::steady_clock;
using Law = Variant::Law;

std::string_view name_of(const std::string& argument) {
  return std::string_view(argument).substr(0, argument.find(':'));
}

bool known_generator(std::string_view name) {
  return std::ranges::any_of(contact::generators(), [&](const auto& entry) { return entry.name == name; });
}

std::string generator_names() {
  std::vector<std::string_view> names;
  for (const contact::GeneratorEntry& entry : contact::generators()) names.push_back(entry.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string similar(std::string_view name) {
  std::vector<std::string_view> names;
  for (const contact::GeneratorEntry& entry : contact::generators()) names.push_back(entry.name);
  return did_you_mean(name, names);
}

template <class Number>
Number parse_count(const std::string& argument, std::string_view digits, const char* what) {
  Number value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || digits.empty())
    throw InputError(
        fmt::format("'{}': '{}' is no {}; NAME:SIZE[:SEED] is meant, as in spheres:100:7", argument, digits, what));
  return value;
}

void run_glocker(Run& run, const Problem& problem) {
  contact::Options options{.tol = run.limits.tol,
                           .max_time = std::chrono::duration<double>(run.limits.seconds),
                           .interrupt = run.limits.interrupt};
  if (run.limits.better) options.better = [&run](const lcp::Vec& r, contact::Origin) { run.limits.better(r); };
  MethodOptions method = method_options(run.variant);
  if (run.variant.automatic()) {
    options.method = method.automatic;
  } else if (run.variant.homotopy()) {
    options.method = method.homotopy;
  } else {
    run.unknowns = contact::Glocker(contact::scaled(problem), method.glocker.formulation).size();
    options.method = std::move(method.glocker);
  }
  contact::Result result = contact::solve(problem, options);
  run.status = contact::to_string(result.status);
  const bool by_ncp = result.by == contact::Origin::Ncp;
  if (result.solved()) run.solved_by = by_ncp ? run.variant.method : std::string(contact::to_string(result.by));
  run.message = std::move(result.message);
  run.verdict = std::move(result.verdict);
  run.solution = std::move(result.solution);
  run.history = std::move(result.history);
  run.counts = {{"iterations", result.stats.iterations},     {"sweeps", result.stats.sweeps},
                {"newton_steps", result.stats.newton_steps}, {"proximal_steps", result.stats.proximal_steps},
                {"attempts", result.stats.attempts},         {"factorizations", result.stats.factorizations}};
  if (run.variant.as_ncp()) run.counts = {run.counts.front(), run.counts.back()};
}

/// The NCP's own residual says little of the law's: every iterate is judged, and the method goes on while it can.
void run_first_ncp(Run& run, const Problem& problem) {
  constexpr double tightest = 1e-14;
  const contact::FirstNcp mcp(problem);
  const contact::Judge judge(problem);
  ncp::Method method = method_options(run.variant).method;
  ncp::Stop& stop = ncp::stop(method);
  stop.interrupt = run.limits.interrupt;
  stop.max_time = std::chrono::duration<double>(run.limits.seconds);
  stop.tol = tightest;
  const auto accepted = [&](const contact::Solution& point) {
    return point.r.allFinite() && contact::accepted(judge(point.r), run.limits.tol);
  };
  std::optional<contact::Solution> found;
  double best = lcp::infinity;
  const ncp::Observer watch = [&](const ncp::Iteration& it) {
    if (it.x == nullptr || it.problem != &mcp) return ncp::Next::Continue;
    contact::Solution point = mcp.recover(lcp::project(mcp.box(), *it.x));
    if (run.limits.better && it.residual < best && point.r.allFinite()) {
      best = it.residual;
      run.limits.better(point.r);
    }
    if (!accepted(point)) return ncp::Next::Continue;
    found = std::move(point);  // the NCP's own residual may prefer another one
    return ncp::Next::Stop;
  };
  const ncp::Result result = ncp::solve(mcp, mcp.start(), method, watch);
  run.unknowns = mcp.size();
  run.solution = found ? std::move(*found) : mcp.recover(result.x);
  run.counts = {{"iterations", result.stats.iterations}, {"factorizations", result.stats.factorizations}};
  if (!run.solution.r.allFinite()) run.solution.r.setZero();  // overflowed: no point came back
  const bool solved = accepted(run.solution);
  if (solved) run.solved_by = run.variant.method;
  run.message = result.message;
  run.status = solved                                      ? "Solved"
               : result.solved() || result.message.empty() ? "NoProgress"
                                                           : std::string(ncp::to_string(result.status));
  if (!solved && result.solved()) run.message = "the NCP is solved to rounding, Coulomb's law is not: " + run.message;
}

/// As the other statuses are written.
std::string_view status_name(lcp::Status status) {
  constexpr std::array<std::string_view, 11> names{"Solved",    "SolvedToRounding", "Infeasible", "Ray",
                                                   "Singular",  "NotApplicable",    "Stalled",    "IterationLimit",
                                                   "TimeLimit", "Interrupted",      "OutOfMemory"};
  return names.at(static_cast<std::size_t>(status));
}

template <class Encoding>
void run_affine(Run& run, const Encoding& encoding, Clock::time_point begin) {
  const lcp::AffineMcp& problem = encoding.affine();
  lcp::Limits limits{.tol = run.limits.tol};
  limits.deadline =
      begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(run.limits.seconds));
  if (const auto* interrupt = run.limits.interrupt) limits.interrupted = [interrupt] { return interrupt->load(); };
  contact::EncodingResult result;
  if (run.variant.method == "auto")
    result = contact::solve(encoding, limits);
  else
    result = {lcp::solve(problem, lcp::Vec::Zero(problem.size()),
                         std::get<ncp::Affine>(method_options(run.variant).method).method, limits),
              run.variant.method.c_str()};
  if (result.solved()) run.solved_by = result.by;
  run.unknowns = problem.size();
  run.own = result.residual;
  run.status = status_name(result.status);
  run.message = result.message;
  run.solution = encoding.recover(result.z);
  run.counts = {{"iterations", result.iterations}, {"factorizations", result.factorizations}};
}

contact::Polygons polygons(const Problem& problem, const Variant& variant) {
  if (problem.dimension == 2) return {contact::Polygon::interval()};
  return {variant.law == Law::Inner ? contact::Polygon::inscribed(variant.facets, variant.rotation)
                                    : contact::Polygon::circumscribed(variant.facets, variant.rotation)};
}

/// The problem with Coulomb's law whose cones hold all impulses of the variant's law: what has no solution there has
/// none under that law. Polygons in the disk and intervals are within Coulomb's cone.
Problem enclosing_problem(const Problem& problem, const Variant& variant) {
  if (variant.law == Law::Frictionless) return contact::without_friction(problem);
  Problem enclosing = problem;
  if (variant.law == Law::Outer && problem.dimension == 3) {
    constexpr double rounding = 1e-14;  // of the polygon's own corners
    for (const contact::Polygon& polygon : polygons(problem, variant))
      enclosing.mu *= polygon.vertices().colwise().norm().maxCoeff() * (1 + rounding);
  }
  return enclosing;
}

/// What contact::solve asks by itself, in as much time as was spent, of what is left. That a solution exists is known
/// of Coulomb's law alone.
void ask_existence(Run& run, const Problem& problem, Clock::duration spent) {
  // Status "Interrupted" is also that of a method which the judge of its iterates stopped.
  if (run.solved || (run.limits.interrupt != nullptr && run.limits.interrupt->load())) return;
  constexpr std::chrono::duration<double> least_search{0.1};
  const std::chrono::duration<double> taken = spent;
  const contact::SearchLimits limits{
      .max_time = std::max(least_search, std::min(taken, std::chrono::duration<double>(run.limits.seconds) - taken)),
      .interrupt = run.limits.interrupt};
  if (run.variant.exact()) {
    run.verdict = contact::existence(problem, limits);
  } else {
    const Problem enclosing = enclosing_problem(problem, run.variant);
    if (auto proof = contact::find_infeasibility(enclosing, limits))
      run.verdict = contact::verdict_of(enclosing, std::move(*proof));
  }
  if (run.status == "Infeasible") run.verdict.existence = contact::Existence::None;  // the method's own proof
  if (run.verdict.existence == contact::Existence::None) run.status = "Infeasible";
  if (run.verdict.message.empty()) return;
  run.message += run.message.empty() ? run.verdict.message : "; " + run.verdict.message;
}

}  // namespace

bool is_generated(const std::string& argument) {
  std::error_code ignored;
  return argument.find(':') != std::string::npos && known_generator(name_of(argument)) &&
         !std::filesystem::exists(argument, ignored);
}

std::vector<FileUse> files_of(const std::vector<std::string>& arguments) {
  std::vector<FileUse> files;
  for (const std::string& argument : arguments)
    if (!is_generated(argument)) files.push_back({"", argument});
  return files;
}

Loaded generate(const std::string& argument) {
  const std::string_view name = name_of(argument);
  if (!known_generator(name))
    throw InputError(fmt::format("'{}': '{}' is none of {}.{}", argument, name, generator_names(), similar(name)));
  if (name.size() == argument.size()) throw InputError(fmt::format("'{0}': how many contacts? {0}:100, say", argument));
  const std::string_view rest = std::string_view(argument).substr(name.size() + 1);
  const std::size_t colon = rest.find(':');
  const auto size = parse_count<lcp::Index>(argument, rest.substr(0, colon), "number of contacts");
  if (size < 1) throw InputError(fmt::format("'{}': at least 1 contact is needed", argument));
  const unsigned seed =
      colon == std::string_view::npos ? 1U : parse_count<unsigned>(argument, rest.substr(colon + 1), "seed");
  return {argument, contact::make_scene(name, size, seed).problem()};
}

Loaded load(const std::string& argument) {
  std::error_code ignored;
  if (is_generated(argument)) return generate(argument);
  if (std::filesystem::is_directory(argument, ignored))
    throw InputError(fmt::format("'{}' is a directory, not a file", argument));
  if (!std::filesystem::exists(argument, ignored))
    throw InputError(fmt::format("there is no file '{}'; problems that can be made, as NAME:SIZE[:SEED]: {}.{}",
                                 argument, generator_names(), similar(name_of(argument))));
  return {argument, contact::read_problem(argument)};
}

long Run::steps() const {
  long sum = 0;
  for (const auto& [what, n] : counts)
    if (what == "iterations" || what == "sweeps" || what == "newton_steps") sum += n;
  return sum;
}

lcp::Index Run::in_state(contact::State state) const {
  return std::ranges::count(states, state, &contact::ContactState::state);
}

void judge(Run& run, const Problem& problem) {
  run.residual = contact::residual(problem, run.solution.r);
  if (run.variant.exact()) {
    run.states = contact::states(problem, run.solution.r);
    return;
  }
  // Where a polygon's law lets a contact slip |r_T| need not be mu r_N: what moves, slips.
  run.states = contact::states(contact::without_friction(problem), run.solution.r);
  const int d = problem.dimension;
  for (lcp::Index a = 0; a < problem.contacts(); ++a)
    if (contact::ContactState& s = run.states[static_cast<std::size_t>(a)]; s.state == contact::State::Stick)
      s.margin = problem.mu[a] * run.solution.r[d * a] - run.solution.r.segment(d * a + 1, d - 1).norm();
}

Run run(const Problem& problem, const Variant& variant, const Limits& limits) {
  const Clock::time_point begin = Clock::now();
  Run run{.variant = variant, .limits = limits};
  run.limits.seconds = std::min(limits.seconds, most_seconds);
  const contact::EncodingOptions form{.form = variant.form};
  switch (variant.law) {
    case Law::Glocker:
      run_glocker(run, problem);
      break;
    case Law::Ncp1:
      run_first_ncp(run, problem);
      break;
    case Law::Inner:
      run_affine(run, contact::InnerFaceting(problem, polygons(problem, variant), form), begin);
      break;
    case Law::Outer:
      run_affine(run, contact::OuterFaceting(problem, polygons(problem, variant), form), begin);
      break;
    case Law::Frictionless:
      run_affine(run, contact::Frictionless(problem), begin);
      break;
  }
  run.solved = run.status == "Solved";
  if (variant.law != Law::Glocker) ask_existence(run, problem, Clock::now() - begin);
  run.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  judge(run, problem);
  return run;
}

}  // namespace perp::app::contacts

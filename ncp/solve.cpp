#include "ncp/solve.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "ncp/methods.hpp"
#include "ncp/proximal.hpp"
#include "ncp/run.hpp"

namespace perp::ncp {
namespace {

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

template <class Value>
std::string bad(const char* option, const Value& value, const char* range) {
  std::ostringstream why;
  why << option << " is " << value << "; it must be " << range;
  return why.str();
}

std::optional<std::string> invalid(const Stop& s) {
  if (!(s.tol > 0) || std::isinf(s.tol)) return bad("stop.tol", s.tol, "positive and finite");
  if (s.max_iterations < 0) return bad("stop.max_iterations", s.max_iterations, "at least 0");
  if (!(s.max_time.count() >= 0)) return bad("stop.max_time", s.max_time.count(), "at least 0 s");
  return std::nullopt;
}

std::optional<std::string> invalid(const Armijo& a) {
  if (!(a.sigma > 0 && a.sigma < 1)) return bad("search.sigma", a.sigma, "in (0, 1)");
  if (!(a.beta > 0 && a.beta < 1)) return bad("search.beta", a.beta, "in (0, 1)");
  if (a.max_backtracks < 0) return bad("search.max_backtracks", a.max_backtracks, "at least 0");
  if (a.memory < 1) return bad("search.memory", a.memory, "at least 1");
  return std::nullopt;
}

std::optional<std::string> invalid(const lcp::LemkeOptions& l) {
  if (l.max_pivots < 0) return bad("lemke.max_pivots", l.max_pivots, "at least 0");
  if (!(l.residual_tol > 0) || std::isinf(l.residual_tol))
    return bad("lemke.residual_tol", l.residual_tol, "positive and finite");
  if (!(l.pivot_tol > 0 && l.pivot_tol < 1)) return bad("lemke.pivot_tol", l.pivot_tol, "in (0, 1)");
  if (!(l.feasibility_tol >= 0)) return bad("lemke.feasibility_tol", l.feasibility_tol, "at least 0");
  if (!(l.perturbation >= 0) || std::isinf(l.perturbation))
    return bad("lemke.perturbation", l.perturbation, "at least 0 and finite");
  if (!(l.singular_rcond >= 0 && l.singular_rcond < 1))
    return bad("lemke.singular_rcond", l.singular_rcond, "in [0, 1)");
  if (l.basis.refactor_every < 1) return bad("lemke.basis.refactor_every", l.basis.refactor_every, "at least 1");
  if (!(l.basis.fill_limit > 0)) return bad("lemke.basis.fill_limit", l.basis.fill_limit, "positive");
  if (!(l.basis.unstable_tol >= 0 && l.basis.unstable_tol < 1))
    return bad("lemke.basis.unstable_tol", l.basis.unstable_tol, "in [0, 1)");
  if (!(l.basis.singular_tol >= 0 && l.basis.singular_tol < 1))
    return bad("lemke.basis.singular_tol", l.basis.singular_tol, "in [0, 1)");
  return std::nullopt;
}

std::optional<std::string> invalid(const Escape& e) {
  if (e.rounds < 0) return bad("escape.rounds", e.rounds, "at least 0");
  if (!(e.lambda > 0) || std::isinf(e.lambda)) return bad("escape.lambda", e.lambda, "positive and finite");
  return std::nullopt;
}

std::optional<std::string> invalid(const PathSearch& m) {
  if (!(m.sigma > 0 && m.sigma < 1)) return bad("sigma", m.sigma, "in (0, 1)");
  if (!(m.beta > 0 && m.beta < 1)) return bad("beta", m.beta, "in (0, 1)");
  if (m.max_backtracks < 0) return bad("max_backtracks", m.max_backtracks, "at least 0");
  if (m.crash.iteration_limit < 0) return bad("crash.iteration_limit", m.crash.iteration_limit, "at least 0");
  if (!(m.crash.least_step > 0 && m.crash.least_step <= 1))
    return bad("crash.least_step", m.crash.least_step, "in (0, 1]");
  if (m.nms.memory < 1) return bad("nms.memory", m.nms.memory, "at least 1");
  if (m.nms.mstep_frequency < 1) return bad("nms.mstep_frequency", m.nms.mstep_frequency, "at least 1");
  if (!(m.nms.initial_reference_factor >= 1) || std::isinf(m.nms.initial_reference_factor))
    return bad("nms.initial_reference_factor", m.nms.initial_reference_factor, "at least 1 and finite");
  if (m.nms.maximum_watchdogs < 0) return bad("nms.maximum_watchdogs", m.nms.maximum_watchdogs, "at least 0");
  if (!(m.nms.distance_decrease > 0 && m.nms.distance_decrease <= 1))
    return bad("nms.distance_decrease", m.nms.distance_decrease, "in (0, 1]");
  if (m.chord_steps < 0) return bad("chord_steps", m.chord_steps, "at least 0");
  if (!(m.proximal_perturbation >= 0) || std::isinf(m.proximal_perturbation))
    return bad("proximal_perturbation", m.proximal_perturbation, "at least 0 and finite");
  if (m.gradient_step_limit < 0) return bad("gradient_step_limit", m.gradient_step_limit, "at least 0");
  if (m.patience < 1) return bad("patience", m.patience, "at least 1");
  if (m.restart_limit < 0) return bad("restart_limit", m.restart_limit, "at least 0");
  if (m.cumulative_iteration_limit < 1)
    return bad("cumulative_iteration_limit", m.cumulative_iteration_limit, "at least 1");
  return invalid(m.lemke);
}

/// What only the problem shows to be wrong with a method.
void check_fit(const Mcp& mcp, const Method& method) {
  const auto* path = std::get_if<PathSearch>(&method);
  if (path == nullptr || path->basis.empty() || static_cast<Index>(path->basis.size()) == mcp.size()) return;
  throw std::invalid_argument(mcp.name() + ": path: the warm start's basis has " + std::to_string(path->basis.size()) +
                              " cells, the problem " + std::to_string(mcp.size()) + " variables");
}

Result run(const Mcp& mcp, In x0, const Method& method, const Observer& observer) {
  return std::visit(Overloaded{[&](const SemismoothNewton& m) { return run_semismooth_newton(mcp, x0, m, observer); },
                               [&](const NewtonJosephy& m) { return run_newton_josephy(mcp, x0, m, observer); },
                               [&](const PathSearch& m) { return run_path(mcp, x0, m, observer); },
                               [&](const Affine& m) { return run_affine(mcp, x0, m, observer); }},
                    method);
}

/// EvaluationFailed after a step: the iterates, which may leave the box, ran against the border of the domain.
bool stuck(const Result& result) {
  return stuck(result.status) && (result.status != Status::EvaluationFailed || result.stats.iterations > 0);
}

/// A derivative that does not match is the most frequent reason of a failure, and the hardest to see.
void blame_derivatives(const Mcp& mcp, Result& result) {
  constexpr Index columns = 50;
  const JacobianCheck check = check_jacobian(mcp, result.x, 1e-6, columns);
  if (!check.defined) return;
  if (const std::string mismatch = describe(mcp, check, 1e-3); !mismatch.empty()) {
    result.message += "; at this point " + mismatch;
    result.advice = "correct the Jacobian first";
  }
}

}  // namespace

std::string_view name(const Method& method) {
  return std::visit(Overloaded{[](const SemismoothNewton&) { return std::string_view("semismooth"); },
                               [](const NewtonJosephy&) { return std::string_view("josephy"); },
                               [](const PathSearch&) { return std::string_view("path"); },
                               [](const Affine& m) { return lcp::name(m.method); }},
                    method);
}

const Stop& stop(const Method& method) {
  return std::visit([](const auto& m) -> const Stop& { return m.stop; }, method);
}

Stop& stop(Method& method) {
  return std::visit([](auto& m) -> Stop& { return m.stop; }, method);
}

std::optional<std::string> invalid(const Method& method) {
  if (auto why = invalid(stop(method))) return why;
  return std::visit(Overloaded{[](const SemismoothNewton& m) -> std::optional<std::string> {
                                 if (!m.cfunction.at) return "cfunction has no function";
                                 if (!(m.descent_rho > 0)) return bad("descent_rho", m.descent_rho, "positive");
                                 if (!(m.descent_p > 2)) return bad("descent_p", m.descent_p, "greater than 2");
                                 if (auto why = invalid(m.escape)) return why;
                                 return invalid(m.search);
                               },
                               [](const NewtonJosephy& m) -> std::optional<std::string> {
                                 if (auto why = invalid(m.search)) return why;
                                 if (auto why = invalid(m.escape)) return why;
                                 return invalid(m.lemke);
                               },
                               [](const PathSearch& m) { return invalid(m); },
                               [](const Affine&) -> std::optional<std::string> { return std::nullopt; }},
                    method);
}

Result solve(const Mcp& mcp, In x0, const Method& method, const Observer& observer) {
  if (const auto why = invalid(method)) throw std::invalid_argument(std::string(name(method)) + ": " + *why);
  check_input(mcp, x0);
  check_fit(mcp, method);
  if (stop(method).check_derivatives)
    if (const JacobianCheck check = check_jacobian(mcp, lcp::project(mcp.box(), x0)); check.defined)
      if (const std::string mismatch = describe(mcp, check); !mismatch.empty())
        throw std::invalid_argument(mcp.name() + ": " + mismatch);
  Result result = run(mcp, x0, method, observer);
  if (std::holds_alternative<Affine>(method)) return result;
  const Escape escape = std::visit(Overloaded{[](const Affine&) { return Escape{.rounds = 0}; },
                                              [](const PathSearch&) { return Escape{.rounds = 0}; },  // in its list
                                              [](const auto& m) { return m.escape; }},
                                   method);
  if (stuck(result) && escape.rounds > 0)
    result = proximal_escape(mcp, method, escape, std::move(result), run, observer);
  if (stuck(result) || result.status == Status::IterationLimit || result.status == Status::LinearAlgebraFailed)
    blame_derivatives(mcp, result);
  return result;
}

}  // namespace perp::ncp

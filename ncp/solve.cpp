#include "ncp/solve.hpp"

#include <cmath>
#include <new>
#include <stdexcept>

#include "ncp/methods.hpp"
#include "ncp/notes.hpp"
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

/// What only the problem shows to be wrong with a method.
void check_fit(const Mcp& mcp, const Method& method) {
  const PathSearch* path = path_of(method);
  if (path == nullptr || path->basis.empty() || static_cast<Index>(path->basis.size()) == mcp.size()) return;
  throw std::invalid_argument(mcp.name() + ": path: the warm start's basis has " + std::to_string(path->basis.size()) +
                              " cells, the problem " + std::to_string(mcp.size()) + " variables");
}

Result run(const Mcp& mcp, In x0, const Method& method, const Observer& observer) {
  return std::visit(Overloaded{[&](const SemismoothNewton& m) { return run_semismooth_newton(mcp, x0, m, observer); },
                               [&](const MinNewton& m) { return run_min_newton(mcp, x0, m, observer); },
                               [&](const Smoothing& m) { return run_smoothing(mcp, x0, m, observer); },
                               [&](const InteriorPoint& m) { return run_interior_point(mcp, x0, m, observer); },
                               [&](const NewtonJosephy& m) { return run_newton_josephy(mcp, x0, m, observer); },
                               [&](const NewtonRobinson& m) { return run_newton_robinson(mcp, x0, m, observer); },
                               [&](const PathSearch& m) { return run_path(mcp, x0, m, observer); },
                               [&](const Auto& m) { return run_auto(mcp, x0, m, observer); },
                               [&](const Multiroot& m) { return run_multiroot(mcp, x0, m, observer); },
                               [&](const Affine& m) { return run_affine(mcp, x0, m, observer); }},
                    method);
}

/// EvaluationFailed after a step: the iterates, which may leave the box, ran against the border of the domain.
bool stuck(const Result& result) {
  return stuck(result.status) && (result.status != Status::EvaluationFailed || result.stats.iterations > 0);
}

/// PathSearch has its escapes in its list of restarts.
Escape escape_of(const Method& method) {
  return std::visit(
      [](const auto& m) {
        if constexpr (requires { m.escape; })
          return m.escape;
        else
          return Escape{.rounds = 0};
      },
      method);
}

int rescalings_of(const Method& method) {
  if (const auto* smoothing = std::get_if<Smoothing>(&method)) return smoothing->rescalings;
  const Escape escape = escape_of(method);
  return escape.rounds > 0 ? escape.rescalings : 0;
}

/// On a scaled problem: the escapes get a part of the iterations, so that some are left for those on the problem
/// itself.
Result run_and_escape(const Mcp& mcp, In x0, const Method& method, const Observer& observer) {
  Result result = run(mcp, x0, method, observer);
  const Escape escape = escape_of(method);
  if (!stuck(result) || escape.rounds == 0) return result;
  Method limited = method;
  stop(limited).max_iterations /= 3;
  return proximal_escape(mcp, limited, escape, std::move(result), run, observer);
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

namespace {

/// What needs memory between the runs, too. The point is lost then: the runs keep theirs (Run::guard).
Result guarded(const Mcp& mcp, In x0, const Method& method, const Observer& observer) {
  Run run(mcp, stop(method), observer);
  Result result;
  run.guard([&] { result = run_with_escapes(mcp, x0, method, observer); });
  return run.ended() ? run.result(x0) : result;
}

}  // namespace

Result run_with_escapes(const Mcp& mcp, In x0, const Method& method, const Observer& observer) {
  Result result = run(mcp, x0, method, observer);
  const Escape escape = escape_of(method);
  const int rescalings = rescalings_of(method);
  if (stuck(result) && rescalings > 0)
    result = retry_scaled(mcp, x0, method, rescalings, std::move(result), run_and_escape, observer);
  if (stuck(result) && escape.rounds > 0)
    result = proximal_escape(mcp, method, escape, std::move(result), run, observer);
  return result;
}

std::string_view name(const Method& method) {
  return std::visit(Overloaded{[](const SemismoothNewton&) { return std::string_view("semismooth"); },
                               [](const MinNewton& m) {
                                 return m.direction == MinNewton::Direction::Newton ? std::string_view("newton-min")
                                                                                    : std::string_view("nesqp");
                               },
                               [](const Smoothing&) { return std::string_view("smooth"); },
                               [](const InteriorPoint&) { return std::string_view("interior"); },
                               [](const NewtonJosephy&) { return std::string_view("josephy"); },
                               [](const NewtonRobinson&) { return std::string_view("robinson"); },
                               [](const PathSearch&) { return std::string_view("path"); },
                               [](const Auto&) { return std::string_view("auto"); },
                               [](const Multiroot& m) { return to_string(m.solver); },
                               [](const Affine& m) { return lcp::name(m.method); }},
                    method);
}

const PathSearch* path_of(const Method& method) {
  const auto* automatic = std::get_if<Auto>(&method);
  return automatic != nullptr ? &automatic->path : std::get_if<PathSearch>(&method);
}

PathSearch* path_of(Method& method) { return const_cast<PathSearch*>(path_of(std::as_const(method))); }

const Stop& stop(const Method& method) {
  return std::visit([](const auto& m) -> const Stop& { return m.stop; }, method);
}

Stop& stop(Method& method) {
  return std::visit([](auto& m) -> Stop& { return m.stop; }, method);
}

std::optional<std::string> invalid(const Method& method) {
  return std::visit(
      Overloaded{[](const Affine& m) { return invalid(m.stop); }, [](const auto& m) { return invalid(m); }}, method);
}

namespace {

void comment(const Mcp& mcp, const Method& method, Result& result) {
  annotate(mcp, stop(method), result);
  if (std::holds_alternative<Affine>(method)) return;
  if (stuck(result) || result.status == Status::IterationLimit || result.status == Status::LinearAlgebraFailed)
    blame_derivatives(mcp, result);
}

}  // namespace

Result solve(const Mcp& mcp, In x0, const Method& method, const Observer& observer) {
  if (const auto why = invalid(method)) throw std::invalid_argument(std::string(name(method)) + ": " + *why);
  check_input(mcp, x0);
  check_fit(mcp, method);
  if (stop(method).check_derivatives)
    if (const JacobianCheck check = check_jacobian(mcp, lcp::project(mcp.box(), x0)); check.defined)
      if (const std::string mismatch = describe(mcp, check); !mismatch.empty())
        throw std::invalid_argument(mcp.name() + ": " + mismatch);
  Result result = guarded(mcp, x0, method, observer);
  try {
    if (result.status != Status::OutOfMemory) comment(mcp, method, result);
  } catch (const std::bad_alloc&) {  // the result stands without a comment
  }
  return result;
}

}  // namespace perp::ncp

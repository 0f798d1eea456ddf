#include "app/report.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <ostream>

#include "app/table.hpp"
#include "ncp/affine.hpp"

namespace perp::app {

namespace {

constexpr std::size_t long_table = 60;
constexpr double wrong_derivative = 1e-4;  // as ncp::describe

/// Prints the table at once, so that someone who watches a pipe or a log file sees the run as it goes.
ncp::Observer flushed_table(std::ostream& out, const ncp::Mcp& mcp) {
  return [&out, print = ncp::print_table(out, mcp)](const ncp::Iteration& it) {
    const ncp::Next next = print(it);
    out.flush();
    return next;
  };
}

std::string seconds(double s) {
  if (s < 1e-3) return fmt::format("{:.0f} us", 1e6 * s);
  if (s < 1) return fmt::format("{:.3g} ms", 1e3 * s);
  return fmt::format("{:.4g} s", s);
}

/// The known solution nearest to x.
std::optional<std::pair<std::size_t, double>> nearest_known(const Report& report) {
  std::optional<std::pair<std::size_t, double>> nearest;
  const auto& solutions = report.problem->solutions;
  for (std::size_t k = 0; k < solutions.size(); ++k) {
    if (solutions[k].x.size() != report.result.x.size()) continue;
    const double distance = (solutions[k].x - report.result.x).lpNorm<Eigen::Infinity>();
    if (!nearest || distance < nearest->second) nearest = {k, distance};
  }
  return nearest;
}

}  // namespace

void settle_auto(const LoadedProblem& problem, Applied& options) {
  const auto* affine = std::get_if<ncp::Affine>(&options.settings.method);
  if (affine == nullptr || !std::holds_alternative<lcp::Auto>(affine->method) || problem.mcp->is_affine()) return;
  ncp::Method chosen = find_method(default_method)->method;
  const double tol = ncp::stop(chosen).tol;
  ncp::stop(chosen) = affine->stop;
  if (affine->stop.tol == ncp::Affine{}.stop.tol) ncp::stop(chosen).tol = tol;  // not given
  options.settings.method = chosen;
  options.settings.method_name = default_method;
  options.notes.push_back(fmt::format("auto: the problem is nonlinear, hence {}", default_method));
}

Report run_method(const LoadedProblem& problem, const Settings& settings, std::ostream* table,
                  const std::atomic<bool>* interrupt) {
  Report report{.problem = &problem, .settings = settings};
  if (settings.sideineq == 2 && problem.model != nullptr && problem.model->side_inequalities() > 0)
    throw ncp::ampl::ModelError(
        side_inequalities_refused,
        fmt::format("{}: the model has {}, refused by sideineq = 2", problem.label,
                    problem.model->side_inequalities() == 1
                        ? std::string("1 side inequality")
                        : fmt::format("{} side inequalities", problem.model->side_inequalities())));
  ncp::Stop& stop = ncp::stop(report.settings.method);
  stop.interrupt = interrupt;
  if (stop.check_derivatives) {  // ncp::solve would refuse a wrong Jacobian, but not say how good a right one is
    ncp::check_input(*problem.mcp, problem.x0);
    report.derivatives = ncp::check_jacobian(*problem.mcp, lcp::project(problem.mcp->box(), problem.x0));
    if (const std::string wrong = ncp::describe(*problem.mcp, *report.derivatives, wrong_derivative); !wrong.empty())
      throw InputError(fmt::format("{}: {}", problem.label, wrong));
  }
  ncp::Method method = report.settings.method;
  ncp::stop(method).check_derivatives = false;
  std::vector<ncp::Observer> observers{ncp::record(report.iterations)};
  if (table != nullptr) observers.push_back(flushed_table(*table, *problem.mcp));
  report.result = ncp::solve(*problem.mcp, problem.x0, method, ncp::all(std::move(observers)));
  if (const auto* affine = std::get_if<ncp::Affine>(&method))
    if (const auto* enumeration = std::get_if<lcp::Enumeration>(&affine->method);
        enumeration && report.result.solved()) {
      lcp::Limits limits{.tol = stop.tol};
      if (interrupt != nullptr) limits.interrupted = [interrupt] { return interrupt->load(); };
      report.all_solutions = lcp::enumerate(*ncp::affine_part(*problem.mcp), *enumeration, limits);
    }
  return report;
}

std::string_view state_name(const ncp::Box& box, ncp::Index i, double x, double tol) {
  if (box.lower[i] == -ncp::infinity && box.upper[i] == ncp::infinity) return "free";
  switch (lcp::bound_state(box, i, x, tol)) {
    case lcp::BoundState::AtLower:
      return "at lower";
    case lcp::BoundState::AtUpper:
      return "at upper";
    case lcp::BoundState::Fixed:
      return "fixed";
    case lcp::BoundState::Free:
      break;
  }
  return "basic";
}

double F_value(const Report& report, ncp::Index i) {
  return i < report.result.F.size() ? report.result.F[i] : std::numeric_limits<double>::quiet_NaN();
}

void print_heading(std::ostream& out, const LoadedProblem& problem, const Settings& settings) {
  out << fmt::format("{}: {}, {} in the Jacobian", problem.label, count(problem.mcp->size(), "variable"),
                     count(problem.mcp->jacobian_pattern().nonZeros(), "nonzero"));
  if (problem.model != nullptr) {
    if (const ncp::Index side = problem.model->side_inequalities(); side > 0)
      out << fmt::format(", {} of the variables for side inequalities", side);
    if (problem.model->has_objective()) out << ", an objective that is ignored";
  } else {
    out << fmt::format(", start {} of {}", problem.start, problem.starts);
  }
  out << "; method " << settings.method_name << '\n';
}

void print_solution(std::ostream& out, const Report& report, bool full) {
  const ncp::Box& box = report.mcp().box();
  Table table({{"variable", Align::Left},
               {"lower", Align::Right},
               {"value", Align::Right},
               {"upper", Align::Right},
               {"F", Align::Right},
               {"state", Align::Left}});
  const double tol = ncp::stop(report.settings.method).tol;
  for (ncp::Index i = 0; i < box.size(); ++i) {
    const double x = report.result.x[i];
    table.add({report.mcp().variable_name(i), number(box.lower[i]), number(x), number(box.upper[i]),
               number(F_value(report, i), 4), std::string(state_name(box, i, x, tol))});
  }
  table.print(out, 0, full ? 0 : long_table, "--full shows them");
}

void print_all_solutions(std::ostream& out, const Report& report, bool full) {
  if (!report.all_solutions) return;
  const auto& [found, complete, nodes, stopped, message] = *report.all_solutions;
  out << fmt::format("{}{}:\n", count(static_cast<ncp::Index>(found.size()), "solution"),
                     complete ? ", and there are no others" : "; the search is not complete: " + message);
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (!full && k == long_table) {
      out << "  ... --full shows them\n";
      break;
    }
    out << fmt::format("  {}:", k + 1);
    if (found[k].dimension > 0) out << fmt::format(" (one of a set of dimension {})", found[k].dimension);
    for (ncp::Index i = 0; i < found[k].z.size(); ++i)
      if (found[k].z[i] != 0) out << fmt::format(" {} = {}", report.mcp().variable_name(i), number(found[k].z[i]));
    out << '\n';
  }
}

void print_summary(std::ostream& out, const Report& report) {
  const ncp::Result& result = report.result;
  const ncp::Stats& stats = result.stats;
  out << fmt::format("{}: {}\n", ncp::to_string(result.status), result.message);
  if (!result.advice.empty()) out << fmt::format("Try: {}\n", result.advice);
  out << fmt::format("{}, {}, {}, {}, {}, {}\n", count(stats.iterations, "iteration"),
                     count(stats.F_evals, "F evaluation"), count(stats.J_evals, "Jacobian"),
                     count(stats.factorizations, "factorization"), count(stats.pivots, "pivot"),
                     seconds(stats.time.count()));
  if (report.derivatives)
    out << fmt::format("Jacobian checked by differences at the start: {}\n",
                       report.derivatives->defined
                           ? fmt::format("largest relative deviation {:.1e}", report.derivatives->worst)
                           : "F or its Jacobian is not defined there");
  if (const auto nearest = nearest_known(report); nearest && result.solved()) {
    const auto& [k, distance] = *nearest;
    const auto& known = report.problem->solutions[k];
    const std::string which = known.label.empty() ? "" : fmt::format(" '{}'", known.label);
    out << fmt::format("Nearest known solution{}: at a distance of {:.1e}\n", which, distance);
  }
}

void print_options(std::ostream& out, const Settings& settings) {
  Settings copy = settings;
  out << "options:";
  for (const Option& option : options())
    if (const Field field = option.field(copy); !std::holds_alternative<std::monostate>(field))
      out << fmt::format(" {}={}", option.key, value_text(field));
  out << '\n';
}

}  // namespace perp::app

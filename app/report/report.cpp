// SPDX-License-Identifier: Apache-2.0
#include "app/report/report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <ostream>
#include <vector>

#include "app/text/table.hpp"
#include "ncp/analysis/certificate.hpp"
#include "ncp/problem/affine.hpp"
#include "ncp/problem/words.hpp"

namespace perp::app {

namespace {

/// "  what . . . . . . value (where)".
void line(std::ostream& out, const std::string& what, const std::string& value, const std::string& where = "") {
  out << fmt::format("  {} {}{}\n", dotted(what, 28), value, where.empty() ? "" : fmt::format(" ({})", where));
}

void print_largest(std::ostream& out, const char* what, ncp::In values, const ncp::Mcp& mcp,
                   std::string (ncp::Mcp::*name)(ncp::Index) const) {
  ncp::Index i = 0;
  if (values.size() == 0) return;
  const double largest = values.cwiseAbs().maxCoeff(&i);
  line(out, fmt::format("largest entry of {}", what), fmt::format("{:.4e}", largest), (mcp.*name)(i));
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

ncp::Observer live_table(std::ostream& out, const ncp::Mcp& mcp, const Output& output) {
  return [&out, print = ncp::print_table(out, mcp, settings::table_options(output))](const ncp::Iteration& it) {
    const ncp::Next next = print(it);
    out.flush();
    return next;
  };
}

Report run_method(const LoadedProblem& problem, const Settings& settings, const std::atomic<bool>* interrupt,
                  const ncp::Observer& observer, const std::function<void(const Report&)>& found) {
  const auto report = [&](settings::Outcome outcome) { return Report{{std::move(outcome)}, &problem, settings, {}}; };
  settings::Session session{.mcp = *problem.mcp,
                            .x0 = problem.x0,
                            .settings = settings,
                            .model = problem.model,
                            .interrupt = interrupt,
                            .observer = observer};
  if (found) session.found = [&](const settings::Outcome& outcome) { found(report(outcome)); };
  return report(session.run());
}

std::string_view state_name(const ncp::Box& box, ncp::Index i, double x, double tol) {
  if (box.lower[i] == -ncp::infinity && box.upper[i] == ncp::infinity) return "free";
  switch (lcp::cell_of(box, i, x, tol)) {
    case lcp::Cell::Below:
      return "at lower";
    case lcp::Cell::Above:
      return "at upper";
    case lcp::Cell::Fixed:
      return "fixed";
    case lcp::Cell::Inside:
      break;
  }
  return "basic";
}

std::vector<ncp::ampl::Model::Computed> computed(const Report& report) {
  const ncp::ampl::Model* model = report.problem->model;
  if (model == nullptr) return {};
  return model->computed(report.result.x.head(model->n_var()));
}

double F_value(const Report& report, ncp::Index i) {
  return i < report.result.F.size() ? report.result.F[i] : std::numeric_limits<double>::quiet_NaN();
}

void print_size(std::ostream& out, const LoadedProblem& problem) {
  out << fmt::format("{}: {}, {} in the Jacobian", problem.label, count(problem.mcp->size(), "variable"),
                     count(problem.mcp->jacobian_pattern().nonZeros(), "nonzero"));
  if (problem.model == nullptr) return;
  if (const ncp::Index side = problem.model->side_inequalities(); side > 0)
    out << fmt::format(", {} of the variables for side inequalities", side);
  if (problem.model->has_objective()) out << ", an objective that is ignored";
}

void print_heading(std::ostream& out, const LoadedProblem& problem, const Settings& settings) {
  print_size(out, problem);
  if (problem.model == nullptr) out << fmt::format(", start {} of {}", problem.start, problem.starts);
  out << "; method " << settings.method_name << '\n';
}

void print_solution(std::ostream& out, const Report& report, bool full) {
  const ncp::Box& box = report.mcp().box();
  Table table({"variable", ">lower", ">value", ">upper", ">F", "state"});
  const double tol = ncp::stop(report.settings.method).tol;
  const std::size_t limit = full ? 0 : long_table;
  const std::vector<ncp::ampl::Model::Computed> others = computed(report);
  const auto size = static_cast<std::size_t>(box.size());
  table.fill(size + others.size(), limit, [&](std::size_t k) -> std::vector<std::string> {
    if (k >= size) {
      const auto& [name, equation, value] = others[k - size];
      return {name, number(-ncp::infinity), number(value), number(ncp::infinity), "0", std::string(computed_state)};
    }
    const auto i = static_cast<ncp::Index>(k);
    const double x = report.result.x[i];
    return {report.mcp().variable_name(i), number(box.lower[i]),          number(x),
            number(box.upper[i]),          number(F_value(report, i), 4), std::string(state_name(box, i, x, tol))};
  });
  table.print(out, 0, limit, "--full shows them");
}

void print_all_solutions(std::ostream& out, const Report& report, bool full) {
  if (!report.all_solutions) return;
  const lcp::Solutions& all = *report.all_solutions;
  const std::vector<lcp::Solution>& found = all.found;
  out << fmt::format("{}{}:\n", count(static_cast<ncp::Index>(found.size()), "solution"),
                     all.complete ? ", and there are no others" : "; the search is not complete: " + all.message);
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

void print_initial_statistics(std::ostream& out, const LoadedProblem& problem) {
  const ncp::Mcp& mcp = *problem.mcp;
  const ncp::Vec x = lcp::project(mcp.box(), problem.x0);
  ncp::Vec F(x.size());
  ncp::SpMat J = mcp.jacobian_pattern();
  out << "Initial statistics\n";
  print_largest(out, "x", x, mcp, &ncp::Mcp::variable_name);
  if (mcp.eval(x, F))
    print_largest(out, "F", F, mcp, &ncp::Mcp::equation_name);
  else
    out << "  F is not defined\n";
  if (!mcp.jacobian(x, J)) {
    out << "  the Jacobian is not defined\n";
    return;
  }
  ncp::Index row = -1;
  ncp::Index column = -1;
  double largest = -1;
  for (ncp::Index j = 0; j < J.cols(); ++j)
    for (ncp::SpMat::InnerIterator e(J, j); e; ++e)
      if (std::abs(e.value()) > largest) largest = std::abs(e.value()), row = e.row(), column = j;
  if (row >= 0)
    line(out, "largest entry of J", fmt::format("{:.4e}", largest),
         fmt::format("{}, {}", mcp.equation_name(row), mcp.variable_name(column)));
}

void print_notes(std::ostream& out, const Report& report) {
  for (const std::string& note : report.result.notes) out << fmt::format("Note: {}\n", note);
}

void print_verdict(std::ostream& out, const Report& report) {
  const ncp::Result& result = report.result;
  out << fmt::format("{}: {}\n", ncp::to_string(result.status), result.message);
  if (result.proof.certificate)
    out << fmt::format("Proof: {} contradict each other; --json writes the certificate\n",
                       ncp::rows_in_words(report.mcp(), result.proof));
  else if (result.proof.residual_bound > 0)
    out << "Proof: by the ranges of F, rounded outwards; it has no certificate, and another run repeats it\n";
  if (!result.advice.empty()) out << fmt::format("Try: {}\n", result.advice);
}

void print_final_statistics(std::ostream& out, const Report& report) {
  const ncp::Residual& r = report.result.residual;
  const ncp::Mcp& mcp = report.mcp();
  out << "Final statistics\n";
  line(out, "natural residual", fmt::format("{:.4e}", r.natural), r.worst >= 0 ? mcp.equation_name(r.worst) : "");
  if (report.result.relative_row >= 0)
    line(out, "beside the row's terms", fmt::format("{:.4e}", report.result.relative),
         mcp.equation_name(report.result.relative_row));
  line(out, "complementarity", fmt::format("{:.4e}", r.complementarity));
  line(out, "violation of bounds", fmt::format("{:.4e}", r.bounds));
  print_largest(out, "x", report.result.x, mcp, &ncp::Mcp::variable_name);
  print_largest(out, "F", report.result.F, mcp, &ncp::Mcp::equation_name);
}

void print_final_summary(std::ostream& out, const Report& report) {
  const ncp::Stats& stats = report.result.stats;
  struct Count {
    const char* what;
    int count;
    bool paths;  // PathSearch alone has it
  };
  const bool path = ncp::path_of(report.settings.method) != nullptr;
  out << "Final summary\n";
  for (const auto& [what, count, paths] : {Count{"major iterations", stats.iterations, false},
                                           {"minor iterations (pivots)", stats.pivots, false},
                                           {"crash iterations", stats.crash_iterations, true},
                                           {"evaluations of F", stats.F_evals, false},
                                           {"evaluations of J", stats.J_evals, false},
                                           {"factorizations", stats.factorizations, false},
                                           {"variables presolved", stats.presolved, true},
                                           {"restarts", stats.restarts, true},
                                           {"gradient steps", stats.gradient_steps, true},
                                           {"watchdog returns", stats.watchdogs, true},
                                           {"D-steps (untested)", stats.unchecked_steps, true},
                                           {"chord steps", stats.chord_steps, true},
                                           {"points refused by a search", stats.backtracks, true},
                                           {"starts from a ray", stats.ray_starts, true},
                                           {"rank-deficient start bases", stats.rank_deficient, true},
                                           {"steps with proximal term", stats.proximal_steps, true}})
    if (path || !paths) line(out, what, fmt::format("{}", count));
  if (stats.J_colours > 0) {
    line(out, "groups of columns of J", fmt::format("{}", stats.J_colours));
    line(out, "evaluations of F for J", fmt::format("{}", stats.J_F_evals));
  }
  if (path) line(out, "time in linear problems", seconds_text(stats.linear_time.count()));
  line(out, "time in all", seconds_text(stats.time.count()));
}

void print_short_summary(std::ostream& out, const Report& report) {
  const ncp::Stats& stats = report.result.stats;
  out << fmt::format("{}, {}, {}, {}, {}, {}\n", count(stats.iterations, "iteration"),
                     count(stats.F_evals, "F evaluation"), count(stats.J_evals, "Jacobian"),
                     count(stats.factorizations, "factorization"), count(stats.pivots, "pivot"),
                     seconds_text(stats.time.count()));
}

void print_remarks(std::ostream& out, const Report& report) {
  if (report.verified) out << verified_text(*report.verified) << '\n';
  if (report.derivatives)
    out << fmt::format("Jacobian checked by differences at the start: {}\n",
                       report.derivatives->defined
                           ? fmt::format("largest relative deviation {:.1e}", report.derivatives->worst)
                           : "F or its Jacobian is not defined there");
  if (const auto nearest = nearest_known(report); nearest && report.result.solved()) {
    const auto& [k, distance] = *nearest;
    const auto& known = report.problem->solutions[k];
    const std::string which = known.label.empty() ? "" : fmt::format(" '{}'", known.label);
    out << fmt::format("Nearest known solution{}: at a distance of {:.1e}\n", which, distance);
  }
}

std::string verified_text(const ncp::Verified& verified) {
  if (!verified.unique) return fmt::format("not verified: {}", verified.why_not);
  return fmt::format(
      "verified: exactly one solution in the box of half-widths up to {} about this point; {} of its variables are at "
      "a "
      "bound",
      ncp::number_above(verified.largest_radius()), verified.active);
}

void print_options(std::ostream& out, const Settings& settings) {
  Settings copy = settings;
  out << "options:";
  for (const ncp::Field& field : fields_of(copy).options())
    if (const std::string value = value_text(field); value != "-") out << fmt::format(" {}={}", field.key, value);
  out << '\n';
}

}  // namespace perp::app

// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "petsc/mpi/run.hpp"

namespace perp::petsc {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

Json index(PetscInt i) { return i >= 0 ? Json(i) : Json(nullptr); }

std::string line(const char* name, const std::string& value) {
  std::string dots(name);
  dots += ' ';
  while (dots.size() < 27) dots += dots.size() % 2 == 0 ? ' ' : '.';
  return "  " + dots + " " + value + "\n";
}

std::string scientific(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4e", value);
  return text;
}

std::string seconds(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g s", value);
  return text;
}

}  // namespace

std::string report_text(const Outcome& o) {
  std::ostringstream text;
  const Counts& c = o.counts;
  text << '\n'
       << to_string(o.status) << ": " << o.message << ": the natural residual is " << scientific(c.worst) << '\n';
  if (!o.advice.empty()) text << "Try " << o.advice << '\n';
  text << "Final statistics\n"
       << line("natural residual", scientific(c.worst) + " (row " + std::to_string(c.row + 1) + ")")
       << line("complementarity", scientific(o.complementarity)) << line("violation of bounds", scientific(o.bounds))
       << "Final summary\n"
       << line("major iterations", std::to_string(o.iterations))
       << line("semismooth steps", std::to_string(c.semismooth)) << line("Krylov iterations", std::to_string(o.krylov))
       << line("evaluations of F", std::to_string(o.F_evals)) << line("evaluations of J", std::to_string(c.jacobians))
       << line("preconditioners", std::to_string(c.faces))
       << line("memory of a rank", std::to_string(static_cast<long>(o.memory / 1e6)) + " MB")
       << line("time to read", seconds(o.read_seconds)) << line("time in all", seconds(o.seconds));
  return text.str();
}

std::string report_json(const Task& task, const Outcome& o) {
  const Counts& c = o.counts;
  Json json{{"program", "perp"},
            {"version", PERP_VERSION},
            {"schema", "perp/solve-mpi/1"},
            {"problem", task.matrix},
            {"size", o.size},
            {"nonzeros", static_cast<std::int64_t>(o.nonzeros)},
            {"ranks", o.ranks},
            {"method", "snes-perp"},
            {"status", to_string(o.status)},
            {"exit_code", o.status == Status::Solved ? 0 : 1},
            {"message", o.message},
            {"advice", o.advice}};
  json["residual"] = {{"natural", number(c.worst)},
                      {"worst_index", index(c.row)},
                      {"bounds", number(o.bounds)},
                      {"complementarity", number(o.complementarity)}};
  json["stats"] = {{"iterations", o.iterations},
                   {"semismooth_steps", c.semismooth},
                   {"krylov_iterations", o.krylov},
                   {"F_evals", o.F_evals},
                   {"J_evals", c.jacobians},
                   {"preconditioners", c.faces},
                   {"memory_bytes", static_cast<std::int64_t>(o.memory)},
                   {"read_time_s", number(o.read_seconds)},
                   {"time_s", number(o.seconds)}};
  json["options"] = {{"convergence_tolerance", number(task.tol)},
                     {"major_iteration_limit", task.max_iterations},
                     {"time_limit", number(task.time_limit)},
                     {"lower", task.lower},
                     {"upper", task.upper},
                     {"petsc", task.petsc}};
  json["iterations"] = Json::array();
  for (const Record& r : o.records)
    json["iterations"].push_back({{"k", r.k},
                                  {"residual", number(r.residual)},
                                  {"worst_index", index(r.row)},
                                  {"krylov_iterations", r.krylov},
                                  {"F_evals", r.F_evals},
                                  {"J_evals", r.J_evals},
                                  {"inside", r.face}});
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace perp::petsc

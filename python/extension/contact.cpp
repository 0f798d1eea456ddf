// SPDX-License-Identifier: Apache-2.0
/// perp.contact: contact with Coulomb friction.
#include <utility>

#include <fmt/format.h>

#include "contact/io/read.hpp"
#include "contact/solvers/named_options.hpp"
#include "contact/solvers/run.hpp"
#include "extension/interrupt.hpp"
#include "extension/problem.hpp"

namespace perp::python {

namespace {

contact::Problem problem_of(py::handle W, py::handle q, py::handle mu) {
  contact::Problem problem;
  problem.q = vector_of(q, -1, "q");
  problem.mu = vector_of(mu, -1, "mu");
  const Index n = problem.mu.size();
  if (problem.q.size() != 2 * n && problem.q.size() != 3 * n)
    refuse("q",
           fmt::format("has {} entries, and must have 2 or 3 for each of the {} contacts of mu", problem.q.size(), n));
  for (Index a = 0; a < n; ++a)
    if (problem.mu[a] < 0) refuse("mu", fmt::format("entry [{}] is {}, negative", a, problem.mu[a]));
  problem.dimension = static_cast<int>(problem.q.size() / n);
  problem.W = MatrixArgument(W, "W", problem.q.size(), problem.q.size()).entries();
  contact::check(problem);
  return problem;
}

contact::Variant variant_of(const std::string& text) {
  try {
    return contact::variant_of(text);
  } catch (const contact::UnknownWord& unknown) {
    refuse("variant", unknown.what() + settings::did_you_mean(unknown.word(), unknown.known()));
  } catch (const std::invalid_argument& wrong) {
    refuse("variant", wrong.what());
  }
}

py::dict measures_of(const contact::Run& run) {
  const contact::Residual& r = run.residual;
  py::dict named(py::arg("natural") = r.natural, py::arg("siconos") = r.siconos, py::arg("rr9118") = r.rr9118,
                 py::arg("scaled") = r.scaled, py::arg("cone") = r.cone, py::arg("normal") = r.normal,
                 py::arg("slip") = r.slip, py::arg("largest") = r.largest());
  named["own"] = run.own;
  return named;
}

/// (r, u, status, success, message, solved_by, residual, states, stats, interrupt)
py::tuple solve(const contact::Problem& problem, const std::string& text, const py::dict& options) {
  contact::Variant variant = variant_of(text);
  contact::RunLimits limits = contact::apply_options(variant, options_of(options));
  std::atomic<bool> stop{false};
  limits.interrupt = &stop;
  contact::Run run;
  {
    const StopOnInterrupt on_interrupt(&stop);
    const Released released(&stop);
    run = contact::run(problem, variant, limits);
  }
  py::object interrupt = py::none();
  if (PyErr_CheckSignals() != 0) {
    const py::error_already_set error;
    if (!error.matches(PyExc_KeyboardInterrupt)) throw error;
    interrupt = error.value();
  }
  py::list states;
  for (const contact::ContactState& one : run.states) states.append(contact::name(one.state));
  py::dict stats(py::arg("time_s") = run.seconds);
  for (const auto& [name, count] : run.counts) stats[py::str(name)] = count;
  return py::make_tuple(array_of(run.solution.r), array_of(run.solution.u), std::string(to_string(run.status)),
                        run.solved, run.message, run.solved_by, measures_of(run), states, stats, interrupt);
}

}  // namespace

void define_contact(py::module_& module) {
  py::class_<contact::Problem>(module, "ContactProblem")
      .def(py::init(&problem_of), py::arg("W"), py::arg("q"), py::arg("mu"))
      .def_property_readonly("dimension", [](const contact::Problem& p) { return p.dimension; })
      .def_property_readonly("contacts", &contact::Problem::contacts)
      .def_property_readonly("name", [](const contact::Problem& p) { return p.name; })
      .def_property_readonly("W", [](const contact::Problem& p) { return scipy_of(p.W.matrix()); })
      .def_property_readonly("q", [](const contact::Problem& p) { return array_of(p.q); })
      .def_property_readonly("mu", [](const contact::Problem& p) { return array_of(p.mu); })
      .def("solve", &solve, py::arg("variant"), py::arg("options"))
      .def("judge", [](const contact::Problem& problem, py::handle r, double tolerance) {
        contact::Run run;
        run.residual = contact::residual(problem, vector_of(r, problem.q.size(), "r"));
        return py::make_tuple(contact::accepted(run.residual, tolerance), measures_of(run));
      });
  module.def("read_contact", [](const std::string& path) {
    const Released released;
    return contact::read_problem(path);
  });
}

}  // namespace perp::python

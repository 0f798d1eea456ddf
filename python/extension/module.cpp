// SPDX-License-Identifier: Apache-2.0
/// The module perp._core, which perp's own Python stands on. Nobody else calls it.
#include <pybind11/stl.h>

#include <string>

#include "extension/interrupt.hpp"
#include "extension/problem.hpp"
#include "lcp/io/file_error.hpp"
#include "ncp/ampl/model.hpp"
#include "ncp/collection/collection.hpp"
#include "ncp/settings/method_table.hpp"

namespace perp::python {

namespace {

Wishes wishes_of(py::dict options, py::object basis, py::object callback, py::object log) {
  return {std::move(options), std::move(basis), std::move(callback), std::move(log)};
}

std::unique_ptr<AffineView> affine_of(py::handle M, py::handle q, py::handle lower, py::handle upper) {
  Vec shift = vector_of(q, -1, "q");
  lcp::Box box = box_of(lower, upper, shift.size(), 0, lcp::infinity);
  return std::make_unique<AffineView>(M, std::move(shift), std::move(box));
}

Vec affine_start(py::handle x0, Index n) { return x0.is_none() ? Vec(Vec::Zero(n)) : vector_of(x0, n, "x0"); }

/// What perp.lcp and perp.mcp_affine do.
py::tuple solve_affine(py::handle M, py::handle q, py::handle lower, py::handle upper, py::handle x0, py::dict options,
                       py::object basis, py::object callback, py::object log) {
  const std::unique_ptr<AffineView> mcp = affine_of(M, q, lower, upper);
  return solved(*mcp, nullptr, affine_start(x0, mcp->size()),
                wishes_of(std::move(options), std::move(basis), std::move(callback), std::move(log)));
}

std::unique_ptr<Problem> affine_problem(py::handle M, py::handle q, py::handle lower, py::handle upper, py::handle x0) {
  std::unique_ptr<AffineView> mcp = affine_of(M, q, lower, upper);
  Vec start = affine_start(x0, mcp->size());
  return std::make_unique<Problem>(std::move(mcp), std::move(start));
}

std::unique_ptr<Problem> function_problem(py::object F, py::handle x0, py::handle lower, py::handle upper,
                                          py::object jac, py::object pattern, std::string name,
                                          std::vector<std::string> variable_names,
                                          std::vector<std::string> equation_names) {
  Vec start = vector_of(x0, -1, "x0");
  lcp::Box box = box_of(lower, upper, start.size(), 0, lcp::infinity);
  auto mcp = std::make_unique<FunctionMcp>(
      FunctionMcp::Parts{std::move(F), std::move(jac), std::move(pattern), std::move(name), std::move(variable_names),
                         std::move(equation_names)},
      std::move(box), start);
  return std::make_unique<Problem>(std::move(mcp), std::move(start));
}

py::list names_of(const Problem& problem, std::string (ncp::Mcp::*named)(Index) const) {
  py::list names;
  for (Index i = 0; i < problem.mcp().size(); ++i) names.append((problem.mcp().*named)(i));
  return names;
}

py::list option_table() {
  py::list all;
  for (const settings::Option& option : settings::options())
    all.append(py::make_tuple(std::string(option.key), option.takes, option.help));
  return all;
}

py::list method_table() {
  py::list all;
  for (const settings::MethodEntry& entry : settings::methods())
    all.append(py::make_tuple(std::string(entry.name), std::string(entry.what), std::string(entry.reference)));
  return all;
}

py::list collection_table() {
  py::list all;
  for (const ncp::collection::Entry& entry : ncp::collection::entries())
    all.append(py::make_tuple(std::string(entry.name), std::string(entry.problem_class), entry.size,
                              std::string(entry.source), std::string(entry.hard)));
  return all;
}

void define_problem(py::module_& module) {
  py::class_<Problem>(module, "Problem")
      .def_property_readonly("name", [](const Problem& p) { return p.mcp().name(); })
      .def_property_readonly("size", [](const Problem& p) { return p.mcp().size(); })
      .def_property_readonly("nonzeros", [](const Problem& p) { return p.mcp().jacobian_pattern().nonZeros(); })
      .def_property_readonly("affine", [](const Problem& p) { return p.mcp().is_affine(); })
      .def_property_readonly("source", [](const Problem& p) { return p.made_by; })
      .def_property_readonly("lower", [](const Problem& p) { return array_of(p.mcp().box().lower); })
      .def_property_readonly("upper", [](const Problem& p) { return array_of(p.mcp().box().upper); })
      .def_property_readonly("starts",
                             [](const Problem& p) {
                               py::list all;
                               for (const Vec& start : p.starts()) all.append(array_of(start));
                               return all;
                             })
      .def_property_readonly("variable_names", [](const Problem& p) { return names_of(p, &ncp::Mcp::variable_name); })
      .def_property_readonly("equation_names", [](const Problem& p) { return names_of(p, &ncp::Mcp::equation_name); })
      .def("F", &Problem::F)
      .def("jac", &Problem::jac)
      .def("residual", &Problem::residual)
      .def("check_jacobian", &Problem::check_jacobian)
      .def("inspect", &Problem::inspect)
      .def("verify", &Problem::verify)
      .def("sensitivity", &Problem::sensitivity)
      .def(
          "solve",
          [](const Problem& p, py::handle x0, py::dict options, py::object basis, py::object callback, py::object log) {
            return p.solve(x0, wishes_of(std::move(options), std::move(basis), std::move(callback), std::move(log)));
          })
      .def("solve_all", [](const Problem& p, py::handle x0, int solutions, py::dict options, py::object log) {
        return p.solve_all(x0, solutions, wishes_of(std::move(options), py::none(), py::none(), std::move(log)));
      });
}

/// Bad options and files have exceptions of their own; what else the library throws is ValueError, MemoryError and
/// RuntimeError, as pybind11 has it.
void define_exceptions(py::module_& module) {
  static py::exception<settings::InputError> option_error(module, "OptionError", PyExc_ValueError);
  static py::exception<lcp::FileError> file_error(module, "FileError", PyExc_ValueError);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const settings::InputError& error) {
      PyErr_SetString(option_error.ptr(), error.what());
    } catch (const lcp::FileError& error) {
      PyErr_SetString(file_error.ptr(), error.what());
    } catch (const ncp::ampl::ModelError& error) {
      PyErr_SetString(file_error.ptr(), error.what());
    }
  });
}

/// Before 2.12 pybind11 misreads the types of numpy 2, without a word.
void check_numpy() {
#if PYBIND11_VERSION_HEX < 0x020C0000
  const auto version = py::cast<std::string>(py::module_::import("numpy").attr("__version__"));
  if (std::stoi(version) >= 2)
    throw py::import_error(
        "perp was built with pybind11 " PYBIND11_TOSTRING(PYBIND11_VERSION_MAJOR) "." PYBIND11_TOSTRING(
            PYBIND11_VERSION_MINOR) " for numpy 1, and this is numpy " +
        version + ": pip install perp again, or numpy<2");
#endif
}

}  // namespace

}  // namespace perp::python

PYBIND11_MODULE(_core, module) {
  using namespace perp::python;  // NOLINT(google-build-using-namespace): the module is what this namespace is for
  check_numpy();
  module.attr("__version__") = PERP_VERSION;
  remember_main_thread(py::cast<unsigned long>(py::module_::import("threading").attr("main_thread")().attr("ident")));
  stop_at_exit();
  register_log_dtype();
  define_exceptions(module);
  define_problem(module);
  define_contact(module);
  module.def("solve_affine", &solve_affine);
  module.def("affine_problem", &affine_problem);
  module.def("function_problem", &function_problem);
  module.def("read_nl", &read_nl);
  module.def("collection", &from_collection);
  module.def("collection_table", &collection_table);
  module.def("option_table", &option_table);
  module.def("method_table", &method_table);
}

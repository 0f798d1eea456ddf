// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Arguments from Python, checked. A refusal is an exception of Python's that begins with the argument's name:
/// ValueError for values and shapes, TypeError for what is no array of numbers at all.
#include <string>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "lcp/box.hpp"
#include "ncp/settings/assignments.hpp"

namespace perp::python {

namespace py = pybind11;
using lcp::Index;
using lcp::SpMat;
using lcp::Vec;

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Throws "NAME: WHY".
[[noreturn]] void refuse(const std::string& name, const std::string& why);
[[noreturn]] void refuse_type(const std::string& name, const std::string& why);
/// Within a handler: what the error says of the argument, as ValueError or TypeError; other errors as they are.
[[noreturn]] void refuse_as(py::error_already_set& error, const std::string& name);

/// Real numbers in one block, of any shape. Numbers that are no doubles are converted; text, complex numbers and masked
/// entries are refused.
Doubles doubles_of(py::handle given, const std::string& name);
/// n finite numbers; any number of them, but at least one, if n < 0.
Vec vector_of(py::handle given, Index n, const std::string& name);
/// Bounds: None is all as `usual`, a number stands for all, else n numbers, which may be infinite.
lcp::Box box_of(py::handle lower, py::handle upper, Index n, double usual_lower, double usual_upper);

/// n numbers as an array of Python's own.
py::array_t<double> array_of(lcp::In values);

/// Options as key and text: of a dict from str to str, bool, int, float.
std::vector<settings::Assignment> options_of(const py::dict& given);

/// "(3, 4)"
std::string shape_text(const py::array& array);
/// numpy's name of its type.
std::string dtype_text(const py::array& array);
/// The name of its class.
std::string type_text(py::handle object);

}  // namespace perp::python

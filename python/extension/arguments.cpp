// SPDX-License-Identifier: Apache-2.0
#include "extension/arguments.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace perp::python {

void refuse(const std::string& name, const std::string& why) { throw py::value_error(name + ": " + why); }
void refuse_type(const std::string& name, const std::string& why) { throw py::type_error(name + ": " + why); }

std::string type_text(py::handle object) { return py::str(py::type::handle_of(object).attr("__name__")); }
std::string dtype_text(const py::array& array) { return py::str(array.dtype()); }

std::string shape_text(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t k = 0; k < array.ndim(); ++k) text += (k > 0 ? ", " : "") + std::to_string(array.shape(k));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

void refuse_as(py::error_already_set& error, const std::string& name) {
  const auto is = [&](PyObject* type) { return error.matches(type); };
  const std::string why = py::str(error.value());
  if (is(PyExc_AttributeError) || is(PyExc_TypeError)) refuse_type(name, why);
  if (is(PyExc_ValueError) || is(PyExc_LookupError) || is(PyExc_OverflowError)) refuse(name, why);
  throw;
}

namespace {

/// numpy.ma's arrays have places without a number. Other classes of arrays have none.
void refuse_masked(py::handle array, const std::string& name) {
  const auto* plain = reinterpret_cast<PyTypeObject*>(py::detail::npy_api::get().PyArray_Type_);
  if (Py_TYPE(array.ptr()) == plain || !py::isinstance<py::array>(array)) return;
  if (py::cast<bool>(py::module_::import("numpy.ma").attr("is_masked")(array)))
    refuse(name, "has masked entries, which are no numbers");
}

/// Says what numpy says.
[[noreturn]] void refuse_as_array(py::handle given, const std::string& name) {
  std::string why;
  try {
    py::module_::import("numpy").attr("asarray")(given);
  } catch (py::error_already_set& error) {
    why = ": " + std::string(py::str(error.value()));
  }
  refuse_type(name, "is of type " + type_text(given) + ", which makes no array of numbers" + why);
}

}  // namespace

Doubles doubles_of(py::handle given, const std::string& name) {
  refuse_masked(given, name);
  if (py::isinstance<Doubles>(given)) return py::reinterpret_borrow<Doubles>(given);
  if (given.is_none()) refuse_type(name, "is None, and must be an array of numbers");
  const auto array = py::array::ensure(given);
  if (!array) refuse_as_array(given, name);
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u' && kind != 'b')
    refuse_type(name, "has dtype " + dtype_text(array) + ", and must have real numbers");
  auto numbers = Doubles::ensure(array);
  if (!numbers) refuse_type(name, "has dtype " + dtype_text(array) + ", which does not become float64");
  return numbers;
}

Vec vector_of(py::handle given, Index n, const std::string& name) {
  const Doubles numbers = doubles_of(given, name);
  if (numbers.ndim() != 1 || (n >= 0 && numbers.shape(0) != n))
    refuse(name, "has shape " + shape_text(numbers) + ", and must have shape " +
                     (n < 0 ? "(n,)" : "(" + std::to_string(n) + ",)"));
  if (numbers.size() == 0) refuse(name, "is empty: a problem has at least one variable");
  if (numbers.size() >= std::numeric_limits<int>::max()) refuse(name, "has more than 2^31 - 2 entries");
  const Eigen::Map<const Vec> values(numbers.data(), numbers.size());
  if (!values.allFinite())
    for (Index i = 0; i < values.size(); ++i)
      if (!std::isfinite(values[i])) refuse(name, fmt::format("entry [{}] is {}, no finite number", i, values[i]));
  return values;
}

namespace {

Vec bounds_of(py::handle given, Index n, double usual, const std::string& name) {
  if (given.is_none()) return Vec::Constant(n, usual);
  if (PyFloat_Check(given.ptr())) return Vec::Constant(n, PyFloat_AS_DOUBLE(given.ptr()));
  const Doubles numbers = doubles_of(given, name);
  if (numbers.ndim() == 0) return Vec::Constant(n, *numbers.data());
  if (numbers.ndim() != 1 || numbers.shape(0) != n)
    refuse(name, fmt::format("has shape {}, and must be a number or have shape ({},)", shape_text(numbers), n));
  return Eigen::Map<const Vec>(numbers.data(), n);
}

}  // namespace

lcp::Box box_of(py::handle lower, py::handle upper, Index n, double usual_lower, double usual_upper) {
  lcp::Box box{.lower = bounds_of(lower, n, usual_lower, "lower"), .upper = bounds_of(upper, n, usual_upper, "upper")};
  if (const auto i = box.first_invalid()) {
    const bool low = std::isnan(box.lower[*i]) || box.lower[*i] == lcp::infinity;
    refuse(low ? "lower" : "upper",
           fmt::format("entry [{}]: [{}, {}] is no interval", *i, box.lower[*i], box.upper[*i]));
  }
  return box;
}

py::array_t<double> array_of(lcp::In values) {
  py::array_t<double> array(values.size());
  Eigen::Map<Vec>(array.mutable_data(), values.size()) = values;
  return array;
}

namespace {

std::string option_text(const std::string& key, py::handle value) {
  if (PyUnicode_Check(value.ptr())) return py::cast<std::string>(value);
  const std::string type = type_text(value);
  if (PyBool_Check(value.ptr()) || type == "bool_" || type == "bool")
    return PyObject_IsTrue(value.ptr()) == 1 ? "yes" : "no";
  if (PyFloat_Check(value.ptr())) return fmt::format("{}", PyFloat_AS_DOUBLE(value.ptr()));
  if (PyIndex_Check(value.ptr()) != 0) {
    const auto integer = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
    if (integer) return py::str(integer);
    PyErr_Clear();  // an array of numpy's, which is one if it is of one integer
  }
  if (py::hasattr(value, "__float__")) {
    const double number = PyFloat_AsDouble(value.ptr());
    if (PyErr_Occurred() == nullptr) return fmt::format("{}", number);
    PyErr_Clear();
  }
  refuse_type("options", key + " is of type " + type + ", and must be text, a number, or True or False");
}

}  // namespace

std::vector<settings::Assignment> options_of(const py::dict& given) {
  std::vector<settings::Assignment> options;
  for (const auto& [key, value] : given) {
    if (!PyUnicode_Check(key.ptr())) refuse_type("options", "a key is of type " + type_text(key) + ", no text");
    auto text = py::cast<std::string>(key);
    options.push_back({text, option_text(text, value), "option"});
  }
  return options;
}

}  // namespace perp::python

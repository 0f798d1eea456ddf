// SPDX-License-Identifier: Apache-2.0
#include "extension/function_mcp.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace perp::python {

namespace {

void check_names(const std::vector<std::string>& names, Index n, const char* argument) {
  if (!names.empty() && static_cast<Index>(names.size()) != n)
    refuse(argument, fmt::format("has {} names, and must have {}", names.size(), n));
}

void require_callable(const py::object& function, const char* argument, const char* or_what) {
  if (PyCallable_Check(function.ptr()) == 0)
    refuse_type(argument, "is of type " + type_text(function) + ", and must be a function of x" + or_what);
}

}  // namespace

FunctionMcp::FunctionMcp(Parts parts, lcp::Box box, const Vec& start) : parts_(std::move(parts)), box_(std::move(box)) {
  const Index n = box_.size();
  require_callable(parts_.F, "F", "");
  check_names(parts_.variable_names, n, "variable_names");
  check_names(parts_.equation_names, n, "equation_names");
  const bool given = !parts_.jac.is_none();
  if (given) require_callable(parts_.jac, "jac", ", or None");
  if (!parts_.pattern.is_none()) {
    pattern_ = pattern_of(parts_.pattern, n, "pattern", false);
  } else if (given) {
    first_x_ = lcp::project(box_, start);
    first_J_ = parts_.jac(array_of(first_x_));
    ++J_calls_;
    pattern_ = pattern_of(first_J_, n, "jac", true);
  } else {
    pattern_ = ncp::dense_pattern(n);
  }
  reader_.emplace(pattern_);
  if (!given) differences_.emplace(pattern_);
}

FunctionMcp::~FunctionMcp() {
  const py::gil_scoped_acquire gil;
  parts_.F = parts_.jac = parts_.pattern = first_J_ = py::object();
  failure_ = nullptr;
}

std::string FunctionMcp::variable_name(Index i) const {
  return parts_.variable_names.empty() ? Mcp::variable_name(i) : parts_.variable_names[lcp::at(i)];
}

std::string FunctionMcp::equation_name(Index i) const {
  return parts_.equation_names.empty() ? Mcp::equation_name(i) : parts_.equation_names[lcp::at(i)];
}

void FunctionMcp::begin(std::atomic<bool>* stop) {
  stop_ = stop;
  failure_ = nullptr;
  F_calls_ = J_calls_ = 0;
}

void FunctionMcp::end() {
  stop_ = nullptr;
  failure_ = nullptr;
}

template <class Call>
bool FunctionMcp::guarded(Call call) const {
  if (failure_) return false;
  const py::gil_scoped_acquire gil;
  try {
    call();
    return true;
  } catch (...) {
    failure_ = std::current_exception();
    if (stop_ != nullptr) *stop_ = true;
    return false;
  }
}

void FunctionMcp::call_F(ncp::In x, double* F) const {
  ++F_calls_;
  const py::object returned = parts_.F(array_of(x));
  const Doubles values = doubles_of(returned, "F");
  const bool number = values.ndim() == 0 && x.size() == 1;
  if (!number && (values.ndim() != 1 || values.size() != x.size()))
    refuse("F", fmt::format("returned shape {}, and must return shape ({},)", shape_text(values), x.size()));
  std::copy_n(values.data(), x.size(), F);
}

void FunctionMcp::call_jac(ncp::In x, double* value) const {
  if (first_J_ && x == first_x_) {
    reader_->read(std::exchange(first_J_, py::object()), value);
    return;
  }
  ++J_calls_;
  reader_->read(parts_.jac(array_of(x)), value);
}

bool FunctionMcp::eval(ncp::In x, ncp::Out F) const {
  const bool defined = guarded([&] { call_F(x, F.data()); });
  if (defined && differences_) differences_->keep(x, F);
  return defined;
}

bool FunctionMcp::jacobian(ncp::In x, SpMat& J) const {
  if (!differences_) return guarded([&] { call_jac(x, J.valuePtr()); });
  const auto F = [this](ncp::In z, ncp::Out value) { return guarded([&] { call_F(z, value.data()); }); };
  return differences_->jacobian(F, box_, x, J.valuePtr());
}

ncp::JacobianWork FunctionMcp::jacobian_work() const {
  if (!differences_) return {};
  return {ncp::JacobianWork::By::Differences, differences_->colours(), differences_->F_evals()};
}

}  // namespace perp::python

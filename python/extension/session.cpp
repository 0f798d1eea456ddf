// SPDX-License-Identifier: Apache-2.0
#include "extension/session.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "extension/interrupt.hpp"
#include "ncp/path/warm_basis.hpp"

namespace perp::python {

namespace {

const settings::Applied& usual() {
  static const settings::Applied options = settings::apply_options({});
  return options;
}

std::vector<lcp::Cell> basis_of(py::handle given, Index n) {
  const auto array = py::array::ensure(given);
  const char kind = array ? array.dtype().kind() : '?';
  if (kind != 'i' && kind != 'u') refuse_type("basis", "must be an array of integers, as Result.basis is");
  const auto cells = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(array);
  if (cells.ndim() != 1 || cells.size() != n)
    refuse("basis", fmt::format("has shape {}, and must have shape ({},)", shape_text(cells), n));
  std::vector<lcp::Cell> basis;
  for (Index i = 0; i < n; ++i) {
    const std::int64_t cell = cells.data()[i];
    if (cell < 0 || cell > static_cast<std::int64_t>(lcp::Cell::Fixed))
      refuse("basis",
             fmt::format("entry [{}] is {}, and must be 0 (below), 1 (inside), 2 (above) or 3 (fixed)", i, cell));
    basis.push_back(static_cast<lcp::Cell>(cell));
  }
  return basis;
}

LogRow row_of(const ncp::Iteration& it) {
  return {.k = it.k,
          .worst = static_cast<int>(it.worst),
          .residual = it.residual,
          .merit = it.merit,
          .step = it.step,
          .prox = it.prox,
          .mu = it.mu,
          .pivots = it.pivots,
          .backtracks = it.backtracks,
          .F_evals = it.F_evals,
          .J_evals = it.J_evals,
          .crash = it.crash,
          .kind = {it.kind == ' ' ? '\0' : it.kind},
          .linear = {it.linear == ' ' ? '\0' : it.linear}};
}

py::dtype log_dtype() {
  py::list names, formats, offsets;
  const auto add = [&](const char* name, const char* format, std::size_t offset) {
    names.append(name);
    formats.append(format);
    offsets.append(offset);
  };
  add("k", "i4", offsetof(LogRow, k));
  add("residual", "f8", offsetof(LogRow, residual));
  add("worst", "i4", offsetof(LogRow, worst));
  add("merit", "f8", offsetof(LogRow, merit));
  add("step", "f8", offsetof(LogRow, step));
  add("prox", "f8", offsetof(LogRow, prox));
  add("mu", "f8", offsetof(LogRow, mu));
  add("pivots", "i4", offsetof(LogRow, pivots));
  add("backtracks", "i4", offsetof(LogRow, backtracks));
  add("F_evals", "i4", offsetof(LogRow, F_evals));
  add("J_evals", "i4", offsetof(LogRow, J_evals));
  add("crash", "?", offsetof(LogRow, crash));
  add("kind", "U1", offsetof(LogRow, kind));
  add("linear", "U1", offsetof(LogRow, linear));
  return py::dtype::from_args(py::dict(py::arg("names") = names, py::arg("formats") = formats,
                                       py::arg("offsets") = offsets, py::arg("itemsize") = sizeof(LogRow)));
}

/// numpy's description of a row; made at import.
PyObject*& known_dtype() {
  static PyObject* known = nullptr;
  return known;
}

py::array log_array(const std::vector<LogRow>& rows) {
  return {py::reinterpret_borrow<py::dtype>(known_dtype()),
          {static_cast<py::ssize_t>(rows.size())},
          {static_cast<py::ssize_t>(sizeof(LogRow))},
          rows.data()};
}

py::object basis_array(const std::vector<lcp::Cell>& basis) {
  if (basis.empty()) return py::none();
  py::array_t<std::int8_t> array(static_cast<py::ssize_t>(basis.size()));
  std::ranges::transform(basis, array.mutable_data(), [](lcp::Cell cell) { return static_cast<std::int8_t>(cell); });
  return array;
}

}  // namespace

void register_log_dtype() { known_dtype() = log_dtype().release().ptr(); }

Session::Session(const ncp::Mcp& mcp, FunctionMcp* functions, const Wishes& wishes)
    : mcp_(mcp), functions_(functions), wishes_(wishes) {
  if (wishes.options.empty())
    options_ = usual();
  else
    options_ = settings::apply_options(options_of(wishes.options));
}

void Session::prepare(const Vec& x0) {
  settings::note_limits_of_size(mcp_.size(), options_);
  ncp::Method& method = options_.settings.method;
  ncp::stop(method).interrupt = &stop_;
  if (!wishes_.basis.is_none()) {
    ncp::PathSearch* path = ncp::path_of(method);
    if (path == nullptr)
      refuse("basis", "method " + options_.settings.method_name + " cannot begin with one; auto and path can");
    path->basis = basis_of(wishes_.basis, mcp_.size());
    ncp::fit_basis(mcp_.box(), x0, path->basis);
  }
  if (wishes_.log.is_none()) return;
  const settings::Output& output = options_.settings.output;
  if (output.table()) table_ = ncp::print_table(text_, mcp_, settings::table_options(output));
  for (const std::string& note : options_.notes) tell("note: " + note);
}

void Session::tell(const std::string& line) {
  if (!wishes_.log.is_none()) wishes_.log(line);
}

void Session::flush() {
  std::istringstream lines(std::exchange(text_, std::ostringstream()).str());
  for (std::string line; std::getline(lines, line);) tell(line);
}

bool Session::go_on(const ncp::Iteration& it) {
  if (failure_) return false;
  if (wishes_.keep_log) rows_.push_back(row_of(it));
  const bool heard = !wishes_.callback.is_none() || !wishes_.log.is_none();
  const bool signals = on_main_thread();
  if (!heard && !signals) return true;
  if (table_) table_(it);
  const py::gil_scoped_acquire gil;
  try {
    if (signals && PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (table_) flush();
    if (wishes_.callback.is_none()) return true;
    py::object x = py::none();
    if (it.x != nullptr && it.problem == &mcp_) x = array_of(lcp::project(mcp_.box(), *it.x));
    const py::array row = log_array({row_of(it)});
    const py::object answer = wishes_.callback(row[py::int_(0)], x);
    const int truth = answer.is_none() ? 0 : PyObject_IsTrue(answer.ptr());
    if (truth < 0) throw py::error_already_set();  // an array of several numbers is neither
    return truth == 0;
  } catch (py::error_already_set& error) {
    if (error.matches(PyExc_StopIteration)) return false;
    failure_ = std::current_exception();
  } catch (...) {
    failure_ = std::current_exception();
  }
  stop_ = true;
  return false;
}

ncp::Observer Session::observer() {
  return [this](const ncp::Iteration& it) { return go_on(it) ? ncp::Next::Continue : ncp::Next::Stop; };
}

py::object Session::run(const std::function<void()>& work) {
  if (functions_ != nullptr) functions_->begin(&stop_);
  {
    const StopOnInterrupt on_interrupt(&stop_);
    const Released released(&stop_);
    work();
  }
  std::exception_ptr failure = std::exchange(failure_, nullptr);
  if (functions_ != nullptr) {
    if (!failure) failure = functions_->failure();
    functions_->end();
  }
  try {
    if (failure) std::rethrow_exception(std::exchange(failure, nullptr));
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  } catch (py::error_already_set& error) {
    if (!error.matches(PyExc_KeyboardInterrupt)) throw;
    return error.value();
  }
  return py::none();
}

py::dict stats_of(const ncp::Stats& stats, const FunctionMcp* functions) {
  py::dict named;
  each(stats, [&](const char* name, auto value) { named[name] = value; });
  if (functions == nullptr) return named;
  named["F_calls"] = functions->F_calls();
  named["jac_calls"] = functions->J_calls();
  named["difference_groups"] = functions->groups();
  return named;
}

py::tuple result_of(ncp::Result result, const FunctionMcp* functions, const std::vector<LogRow>* rows) {
  py::list notes;
  for (const std::string& note : result.notes) notes.append(note);
  const std::string_view status = to_string(result.status);
  return py::make_tuple(array_of(result.x), array_of(result.F), py::str(status.data(), status.size()), result.solved(),
                        result.message, result.advice, result.residual.natural, result.residual.worst, result.relative,
                        result.relative_row, notes, basis_array(result.basis), stats_of(result.stats, functions),
                        rows == nullptr ? py::object(py::none()) : py::object(log_array(*rows)));
}

py::tuple verified_of(const ncp::Verified& found) {
  return py::make_tuple(found.unique, array_of(found.x), array_of(found.radius), found.active, found.why_not);
}

py::tuple solved(const ncp::Mcp& mcp, FunctionMcp* functions, const Vec& x0, const Wishes& wishes) {
  Session session(mcp, functions, wishes);
  session.prepare(x0);
  ncp::Result result;
  std::optional<ncp::Verified> verified;
  const settings::Settings& settings = session.options().settings;
  const py::object interrupt = session.run([&] {
    result = ncp::solve(mcp, x0, settings.method, session.observer());
    if (!settings.verify || !result.accepted()) return;
    verified = ncp::verify(mcp, ncp::stop(settings.method).tol, result);
    if (!verified->unique) result.notes.push_back("not verified: " + verified->why_not);
  });
  if (interrupt.is_none() && settings.output.all)
    session.tell(std::string(to_string(result.status)) + ": " + result.message);
  const py::object proof = verified ? py::object(verified_of(*verified)) : py::object(py::none());
  return py::make_tuple(result_of(std::move(result), functions, &session.rows()) + py::make_tuple(proof), interrupt);
}

}  // namespace perp::python

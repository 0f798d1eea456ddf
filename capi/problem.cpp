// SPDX-License-Identifier: Apache-2.0
/// The problems of perp.h.
#include <algorithm>
#include <memory>
#include <utility>

#include "capi/guard.hpp"
#include "capi/handles.hpp"
#include "ncp/problem/affine.hpp"

namespace perp::capi {

namespace {

template <class Integer>
Columns<Integer> square(std::int64_t n, const Integer* start, const Integer* row, const double* value) {
  return {.name = "", .rows = n, .columns = n, .start = start, .row = row, .value = value, .pattern = value == nullptr};
}

template <class Integer>
std::unique_ptr<perp_problem> functions(std::int32_t interface, std::int64_t n, const double* lower,
                                        const double* upper, const Integer* start, const Integer* row, perp_F F,
                                        perp_J J, void* user) {
  require_interface(interface);
  check_size(n, "n");
  if (F == nullptr) refuse("F", "is NULL");
  lcp::Box box = box_of(lower, upper, n);  // asks for the memory before the pattern is read
  auto callbacks =
      std::make_unique<CallbackMcp>(std::move(box), matrix_of(square<Integer>(n, start, row, nullptr)), F, J, user);
  CallbackMcp* known = callbacks.get();
  auto problem = std::make_unique<perp_problem>(std::move(callbacks));
  problem->callbacks = known;
  return problem;
}

void check_x(const perp_problem* problem, const double* x) {
  require(problem, "problem");
  if (problem->mcp.size() > 0) require(x, "x");
}

Eigen::Map<const Vec> point(const perp_problem* problem, const double* x) { return {x, problem->mcp.size()}; }

void copy_name(const perp_problem* problem, std::int64_t i, char* name, std::int64_t size,
               std::string (ncp::Mcp::*named)(Index) const) {
  require(problem, "problem");
  if (i < 0 || i >= problem->mcp.size())
    refuse("i", std::to_string(i) + " is not within 0 and " + std::to_string(problem->mcp.size() - 1));
  copy_text((problem->mcp.*named)(i), name, size, "name");
}

std::vector<std::string> names_of(const char* const* names, Index n, const char* argument) {
  std::vector<std::string> copy;
  if (names == nullptr) return copy;
  for (Index i = 0; i < n; ++i) {
    if (names[i] == nullptr) refuse(argument, "name " + std::to_string(i + 1) + " is NULL");
    copy.emplace_back(names[i]);
  }
  return copy;
}

}  // namespace

template <class Integer>
std::unique_ptr<perp_problem> affine_problem(std::int32_t interface, std::int64_t n, const Integer* start,
                                             const Integer* row, const double* value, const double* q,
                                             const double* lower, const double* upper) {
  require_interface(interface);
  check_size(n, "n");
  Columns<Integer> M = square(n, start, row, value);
  M.pattern = false;
  lcp::AffineMcp affine{.M = {}, .q = vector_of(q, n, "q"), .box = box_of(lower, upper, n)};
  matrix_of(M).entries.swap(affine.M);
  affine.M.markAsRValue();  // not copied
  return std::make_unique<perp_problem>(ncp::make_affine_mcp(std::move(affine), "affine"));
}
template std::unique_ptr<perp_problem> affine_problem(std::int32_t, std::int64_t, const std::int32_t*,
                                                      const std::int32_t*, const double*, const double*, const double*,
                                                      const double*);
template std::unique_ptr<perp_problem> affine_problem(std::int32_t, std::int64_t, const std::int64_t*,
                                                      const std::int64_t*, const double*, const double*, const double*,
                                                      const double*);

ncp::Vec own_start(const perp_problem& problem) {
  const ncp::Vec start =
      problem.model != nullptr ? problem.model->start() : ncp::Vec(ncp::Vec::Zero(problem.mcp.size()));
  return lcp::project(problem.mcp.box(), start);
}

}  // namespace perp::capi

using namespace perp::capi;  // NOLINT(google-build-using-namespace): what follows is the interface of C

int32_t perp_problem_create_int32(int32_t interface_, int64_t n, const double* lower, const double* upper,
                                  const int32_t* start, const int32_t* row, perp_F F, perp_J J, void* user,
                                  perp_problem** problem, perp_error* error) {
  return guarded_make(problem, "problem", error,
                      [&] { return functions(interface_, n, lower, upper, start, row, F, J, user); });
}

int32_t perp_problem_create_int64(int32_t interface_, int64_t n, const double* lower, const double* upper,
                                  const int64_t* start, const int64_t* row, perp_F F, perp_J J, void* user,
                                  perp_problem** problem, perp_error* error) {
  return guarded_make(problem, "problem", error,
                      [&] { return functions(interface_, n, lower, upper, start, row, F, J, user); });
}

int32_t perp_problem_affine_int32(int32_t interface_, int64_t n, const int32_t* start, const int32_t* row,
                                  const double* value, const double* q, const double* lower, const double* upper,
                                  perp_problem** problem, perp_error* error) {
  return guarded_make(problem, "problem", error,
                      [&] { return affine_problem(interface_, n, start, row, value, q, lower, upper); });
}

int32_t perp_problem_affine_int64(int32_t interface_, int64_t n, const int64_t* start, const int64_t* row,
                                  const double* value, const double* q, const double* lower, const double* upper,
                                  perp_problem** problem, perp_error* error) {
  return guarded_make(problem, "problem", error,
                      [&] { return affine_problem(interface_, n, start, row, value, q, lower, upper); });
}

int32_t perp_problem_read_nl(int32_t interface_, const char* path, perp_problem** problem, perp_error* error) {
  return guarded_make(problem, "problem", error, [&] {
    require_interface(interface_);
    require(path, "path");
    std::unique_ptr<perp::ncp::ampl::Model> model = perp::ncp::ampl::read_model(path);
    const perp::ncp::ampl::Model* known = model.get();
    auto made = std::make_unique<perp_problem>(std::move(model));
    made->model = known;
    return made;
  });
}

void perp_problem_free(perp_problem* problem) { delete problem; }

int64_t perp_problem_size(const perp_problem* problem) { return problem == nullptr ? 0 : problem->mcp.size(); }

int64_t perp_problem_nonzeros(const perp_problem* problem) {
  return problem == nullptr ? 0 : problem->mcp.jacobian_pattern().nonZeros();
}

int32_t perp_problem_bounds(const perp_problem* problem, double* lower, double* upper, perp_error* error) {
  return guarded(error, [&] {
    require(problem, "problem");
    const perp::lcp::Box& box = problem->mcp.box();
    if (lower != nullptr) std::copy_n(box.lower.data(), box.size(), lower);
    if (upper != nullptr) std::copy_n(box.upper.data(), box.size(), upper);
  });
}

int32_t perp_problem_start(const perp_problem* problem, double* x, perp_error* error) {
  return guarded(error, [&] {
    check_x(problem, x);
    const Vec start = own_start(*problem);
    std::copy_n(start.data(), start.size(), x);
  });
}

int32_t perp_problem_set_name(perp_problem* problem, const char* name, perp_error* error) {
  return guarded(error, [&] {
    require(problem, "problem");
    require(name, "name");
    problem->mcp.set_name(name);
  });
}

int32_t perp_problem_set_names(perp_problem* problem, const char* const* variables, const char* const* equations,
                               perp_error* error) {
  return guarded(error, [&] {
    require(problem, "problem");
    if (problem->model != nullptr) refuse("problem", "comes from a file, which has names of its own");
    const Index n = problem->mcp.size();
    problem->mcp.set_names(names_of(variables, n, "variables"), names_of(equations, n, "equations"));
  });
}

int32_t perp_problem_variable_name(const perp_problem* problem, int64_t i, char* name, int64_t size,
                                   perp_error* error) {
  return guarded(error, [&] { copy_name(problem, i, name, size, &perp::ncp::Mcp::variable_name); });
}

int32_t perp_problem_equation_name(const perp_problem* problem, int64_t i, char* name, int64_t size,
                                   perp_error* error) {
  return guarded(error, [&] { copy_name(problem, i, name, size, &perp::ncp::Mcp::equation_name); });
}

int32_t perp_problem_set_linear(perp_problem* problem, const int8_t* linear, perp_error* error) {
  return guarded(error, [&] {
    require(problem, "problem");
    if (problem->callbacks == nullptr) refuse("problem", "knows by itself which entries are linear");
    problem->callbacks->set_linear(linear);
  });
}

int32_t perp_problem_residual(const perp_problem* problem, const double* x, double* natural, int64_t* worst,
                              perp_error* error) {
  return guarded(error, [&] {
    check_x(problem, x);
    const Watch watch(problem->callbacks, nullptr);
    const perp::ncp::Residual residual = perp::ncp::residual(problem->mcp, point(problem, x));
    watch.check();
    if (natural != nullptr) *natural = residual.natural;
    if (worst != nullptr) *worst = residual.worst;
  });
}

int32_t perp_problem_check_jacobian(const perp_problem* problem, const double* x, double* worst, int64_t* row,
                                    int64_t* column, perp_error* error) {
  return guarded(error, [&] {
    check_x(problem, x);
    const Watch watch(problem->callbacks, nullptr);
    const perp::ncp::Vec at = vector_of(x, problem->mcp.size(), "x");
    perp::ncp::check_input(problem->mcp, at);
    const perp::ncp::JacobianCheck check = perp::ncp::check_jacobian(problem->mcp, at);
    watch.check();
    if (!check.defined) refuse("x", "F or J is not defined there, or nowhere near");
    if (worst != nullptr) *worst = check.worst;
    if (row != nullptr) *row = check.row;
    if (column != nullptr) *column = check.col;
  });
}

// SPDX-License-Identifier: Apache-2.0
/// Contact problems of perp.h.
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <utility>

#include "capi/guard.hpp"
#include "capi/handles.hpp"
#include "capi/solve.hpp"
#include "contact/io/read.hpp"
#include "contact/model/residual.hpp"
#include "contact/solvers/named_options.hpp"

namespace perp::capi {

namespace {

static_assert(static_cast<int>(contact::State::Open) == PERP_OPEN &&
              static_cast<int>(contact::State::Stick) == PERP_STICK &&
              static_cast<int>(contact::State::Slip) == PERP_SLIP);

std::unique_ptr<perp_contact> handle(contact::Problem problem) {
  auto made = std::make_unique<perp_contact>();
  made->problem = std::move(problem);
  return made;
}

/// d n.
Index size_of(std::int32_t dimension, std::int64_t contacts) {
  if (dimension != 2 && dimension != 3) refuse("dimension", std::to_string(dimension) + " is neither 2 nor 3");
  check_size(contacts, "contacts");
  check_size(dimension * contacts, "contacts");
  return dimension * contacts;
}

Vec friction(const double* mu, std::int64_t contacts) {
  Vec copy = vector_of(mu, contacts, "mu");
  for (Index a = 0; a < contacts; ++a)
    if (copy[a] < 0) refuse("mu", "entry " + std::to_string(a + 1) + " is " + std::to_string(copy[a]) + ", negative");
  return copy;
}

template <class Integer>
std::unique_ptr<perp_contact> local(std::int32_t interface, std::int32_t dimension, std::int64_t contacts,
                                    const Integer* start, const Integer* row, const double* value, const double* q,
                                    const double* mu) {
  require_interface(interface);
  const Index size = size_of(dimension, contacts);
  contact::Problem problem{.dimension = dimension};
  problem.W = matrix_of(Columns<Integer>{
                            .name = "W", .rows = size, .columns = size, .start = start, .row = row, .value = value})
                  .entries;
  problem.q = vector_of(q, size, "q");
  problem.mu = friction(mu, contacts);
  contact::check(problem);
  return handle(std::move(problem));
}

template <class Integer>
struct Bodies {
  const Integer* M_start;
  const Integer* M_row;
  const double* M_value;
  const Integer* H_start;
  const Integer* H_row;
  const double* H_value;
};

template <class Integer>
std::unique_ptr<perp_contact> condensed(std::int32_t interface, std::int32_t dimension, std::int64_t contacts,
                                        std::int64_t m, const Bodies<Integer>& bodies, const double* f, const double* w,
                                        const double* mu) {
  require_interface(interface);
  const Index size = size_of(dimension, contacts);
  check_size(m, "m");
  contact::Global global;
  global.M = matrix_of(Columns<Integer>{.name = "M",
                                        .rows = m,
                                        .columns = m,
                                        .start = bodies.M_start,
                                        .row = bodies.M_row,
                                        .value = bodies.M_value})
                 .entries;
  global.H = matrix_of(Columns<Integer>{.name = "H",
                                        .rows = m,
                                        .columns = size,
                                        .start = bodies.H_start,
                                        .row = bodies.H_row,
                                        .value = bodies.H_value})
                 .entries;
  global.G.resize(m, 0);
  global.f = vector_of(f, m, "f");
  global.w = vector_of(w, size, "w");
  return handle(contact::condense(std::move(global), friction(mu, contacts), dimension));
}

contact::Variant variant_of(const char* words) {
  try {
    return contact::variant_of(words == nullptr ? "glocker" : words);
  } catch (const std::invalid_argument& wrong) {
    refuse("variant", wrong.what());
  }
}

std::unique_ptr<perp_contact_result> solved(perp_solver& solver, const contact::Problem& problem, const char* words) {
  const StopsHeard heard(solver.stop);
  contact::Variant variant = variant_of(words);
  contact::RunLimits limits = contact::apply_options(variant, solver.given);
  limits.interrupt = &solver.stop;
  auto made = std::make_unique<perp_contact_result>();
  made->run = contact::run(problem, variant, limits);
  for (const contact::ContactState& state : made->run.states)
    made->states.push_back(static_cast<std::int8_t>(state.state));
  return made;
}

std::optional<double> number_of(const contact::Run& run, const std::string& name) {
  const contact::Residual& r = run.residual;
  const std::array<std::pair<const char*, double>, 10> known{{{"natural", r.natural},
                                                              {"siconos", r.siconos},
                                                              {"rr9118", r.rr9118},
                                                              {"scaled", r.scaled},
                                                              {"cone", r.cone},
                                                              {"normal", r.normal},
                                                              {"slip", r.slip},
                                                              {"largest", r.largest()},
                                                              {"own", run.own},
                                                              {"time_s", run.seconds}}};
  for (const auto& [key, value] : known)
    if (name == key) return value;
  for (const auto& [key, value] : run.counts)
    if (name == key) return static_cast<double>(value);
  return std::nullopt;
}

}  // namespace

}  // namespace perp::capi

using namespace perp::capi;  // NOLINT(google-build-using-namespace): what follows is the interface of C

int32_t perp_contact_create_int32(int32_t interface_, int32_t dimension, int64_t contacts, const int32_t* W_start,
                                  const int32_t* W_row, const double* W_value, const double* q, const double* mu,
                                  perp_contact** contact, perp_error* error) {
  return guarded_make(contact, "contact", error,
                      [&] { return local(interface_, dimension, contacts, W_start, W_row, W_value, q, mu); });
}

int32_t perp_contact_create_int64(int32_t interface_, int32_t dimension, int64_t contacts, const int64_t* W_start,
                                  const int64_t* W_row, const double* W_value, const double* q, const double* mu,
                                  perp_contact** contact, perp_error* error) {
  return guarded_make(contact, "contact", error,
                      [&] { return local(interface_, dimension, contacts, W_start, W_row, W_value, q, mu); });
}

int32_t perp_contact_condense_int32(int32_t interface_, int32_t dimension, int64_t contacts, int64_t m,
                                    const int32_t* M_start, const int32_t* M_row, const double* M_value,
                                    const int32_t* H_start, const int32_t* H_row, const double* H_value,
                                    const double* f, const double* w, const double* mu, perp_contact** contact,
                                    perp_error* error) {
  return guarded_make(contact, "contact", error, [&] {
    return condensed<int32_t>(interface_, dimension, contacts, m, {M_start, M_row, M_value, H_start, H_row, H_value}, f,
                              w, mu);
  });
}

int32_t perp_contact_condense_int64(int32_t interface_, int32_t dimension, int64_t contacts, int64_t m,
                                    const int64_t* M_start, const int64_t* M_row, const double* M_value,
                                    const int64_t* H_start, const int64_t* H_row, const double* H_value,
                                    const double* f, const double* w, const double* mu, perp_contact** contact,
                                    perp_error* error) {
  return guarded_make(contact, "contact", error, [&] {
    return condensed<int64_t>(interface_, dimension, contacts, m, {M_start, M_row, M_value, H_start, H_row, H_value}, f,
                              w, mu);
  });
}

int32_t perp_contact_read(int32_t interface_, const char* path, perp_contact** contact, perp_error* error) {
  return guarded_make(contact, "contact", error, [&] {
    require_interface(interface_);
    require(path, "path");
    return handle(perp::contact::read_problem(path));
  });
}

void perp_contact_free(perp_contact* contact) { delete contact; }

int32_t perp_contact_dimension(const perp_contact* contact) {
  return contact == nullptr ? 0 : contact->problem.dimension;
}
int64_t perp_contact_contacts(const perp_contact* contact) {
  return contact == nullptr ? 0 : contact->problem.contacts();
}
const double* perp_contact_q(const perp_contact* contact) {
  return contact == nullptr ? nullptr : contact->problem.q.data();
}
const double* perp_contact_mu(const perp_contact* contact) {
  return contact == nullptr ? nullptr : contact->problem.mu.data();
}

int32_t perp_contact_judge(const perp_contact* contact, const double* r, double tolerance, int32_t* accepted,
                           double* largest, perp_error* error) {
  return guarded(error, [&] {
    require(contact, "contact");
    if (!(tolerance > 0)) refuse("tolerance", std::to_string(tolerance) + " is no number > 0");
    const perp::contact::Residual residual =
        perp::contact::residual(contact->problem, vector_of(r, contact->problem.q.size(), "r"));
    if (accepted != nullptr) *accepted = perp::contact::accepted(residual, tolerance) ? 1 : 0;
    if (largest != nullptr) *largest = residual.largest();
  });
}

int32_t perp_contact_solve(perp_solver* solver, const perp_contact* contact, const char* variant,
                           perp_contact_result** result, perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    require(contact, "contact");
    if (solver != nullptr) return solved(*solver, contact->problem, variant);
    perp_solver usual;
    return solved(usual, contact->problem, variant);
  });
}

void perp_contact_result_free(perp_contact_result* result) { delete result; }

int32_t perp_contact_result_status(const perp_contact_result* result) {
  return result == nullptr ? -1 : static_cast<int32_t>(result->run.status);
}
int32_t perp_contact_result_solved(const perp_contact_result* result) {
  return result != nullptr && result->run.solved ? 1 : 0;
}
const char* perp_contact_result_message(const perp_contact_result* result) {
  return result == nullptr ? "" : result->run.message.c_str();
}
const char* perp_contact_result_solved_by(const perp_contact_result* result) {
  return result == nullptr ? "" : result->run.solved_by.c_str();
}
int64_t perp_contact_result_size(const perp_contact_result* result) {
  return result == nullptr ? 0 : result->run.solution.r.size();
}
const double* perp_contact_result_r(const perp_contact_result* result) {
  return result == nullptr ? nullptr : result->run.solution.r.data();
}
const double* perp_contact_result_u(const perp_contact_result* result) {
  return result == nullptr ? nullptr : result->run.solution.u.data();
}
const int8_t* perp_contact_result_states(const perp_contact_result* result) {
  return result == nullptr || result->states.empty() ? nullptr : result->states.data();
}

int32_t perp_contact_result_number(const perp_contact_result* result, const char* name, double* value,
                                   perp_error* error) {
  return guarded(error, [&] {
    require(result, "result");
    require(name, "name");
    require(value, "value");
    const std::optional<double> number = number_of(result->run, name);
    if (!number) refuse("name", std::string("there is no number '") + name + "' in this result");
    *value = *number;
  });
}

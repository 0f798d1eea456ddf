// SPDX-License-Identifier: Apache-2.0
/// Contact problems of perp.h.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "capi/describe.hpp"
#include "capi/guard.hpp"
#include "capi/handles.hpp"
#include "capi/solve.hpp"
#include "contact/io/read.hpp"
#include "contact/model/residual.hpp"
#include "contact/scenes/generators.hpp"
#include "contact/solvers/named_options.hpp"
#include "contact/solvers/sensitivity.hpp"
#include "lcp/threads.hpp"

namespace perp::capi {

namespace {

static_assert(static_cast<int>(contact::State::Open) == PERP_OPEN &&
              static_cast<int>(contact::State::Stick) == PERP_STICK &&
              static_cast<int>(contact::State::Slip) == PERP_SLIP &&
              static_cast<int>(contact::State::Roll) == PERP_ROLL);

std::unique_ptr<perp_contact> handle(contact::Problem problem) {
  auto made = std::make_unique<perp_contact>();
  made->problem = std::move(problem);
  return made;
}

/// Writes it as the k-th, where there is a place.
void put(double* all, std::size_t k, const Vec& one) {
  if (all != nullptr) std::ranges::copy(one, all + k * static_cast<std::size_t>(one.size()));
}

/// d n, d one of these two.
Index size_of(std::int32_t dimension, std::int64_t contacts, std::int32_t plane = 2, std::int32_t space = 3) {
  if (dimension != plane && dimension != space)
    refuse("dimension", fmt::format("{} is neither {} nor {}", dimension, plane, space));
  check_size(contacts, "contacts");
  check_size(dimension * contacts, "contacts");
  return dimension * contacts;
}

Vec friction(const double* mu, std::int64_t contacts, const char* name = "mu") {
  Vec copy = vector_of(mu, contacts, name);
  for (Index a = 0; a < contacts; ++a)
    if (copy[a] < 0) refuse(name, fmt::format("entry [{}] is {}, negative", a, copy[a]));
  return copy;
}

/// `mu_r`: NULL without rolling friction.
contact::Problem local(std::int32_t dimension, std::int64_t contacts, const perp_matrix* W, const double* q,
                       const double* mu, const double* mu_r = nullptr) {
  const Index size = mu_r == nullptr ? size_of(dimension, contacts) : size_of(dimension, contacts, 3, 5);
  contact::Problem problem{.dimension = dimension};
  problem.W = std::move(matrix_of(W, "W", size, size).entries);
  problem.q = vector_of(q, size, "q");
  problem.mu = friction(mu, contacts);
  if (mu_r != nullptr) problem.mu_r = friction(mu_r, contacts, "mu_r");
  contact::check(problem);
  return problem;
}

contact::Variant variant_of(const char* words) {
  try {
    return contact::variant_of(words == nullptr ? "glocker" : words);
  } catch (const contact::UnknownWord& unknown) {
    refuse("variant", unknown.what() + settings::did_you_mean(unknown.word(), unknown.known()));
  } catch (const std::invalid_argument& wrong) {
    refuse("variant", wrong.what());
  }
}

/// The variant in words, and what a solver asks of it.
contact::SequenceOptions asked_of(const perp_solver& solver, const char* words) {
  contact::SequenceOptions asked{.variant = variant_of(words)};
  const contact::AppliedOptions options = contact::apply_options(asked.variant, solver.given);
  asked.limits.tol = options.tol.value_or(asked.limits.tol);
  asked.limits.seconds = options.seconds.value_or(asked.limits.seconds);
  return asked;
}

Part solved(Work& work, const contact::Problem& problem, const char* words, const double* r0) {
  contact::SequenceOptions asked = asked_of(work.solver(), words);
  asked.limits.interrupt = work.stop();
  if (r0 != nullptr) asked.limits.start = vector_of(r0, problem.q.size(), "r0");
  return part_of(contact::run(problem, asked.variant, asked.limits));
}

Part existence(Work& work, const contact::Problem& problem) {
  contact::Variant usual = variant_of(nullptr);
  const double seconds = contact::apply_options(usual, work.solver().given).seconds.value_or(30);
  return part_of(
      contact::existence(problem, {.max_time = std::chrono::duration<double>(seconds), .interrupt = work.stop()}));
}

/// Reads the derivatives that are not NULL.
contact::ParameterDerivatives derivatives_of(const contact::Problem& problem, std::int64_t m, const perp_matrix* dq,
                                             const perp_matrix* dmu, const perp_matrix* dW) {
  const Index size = problem.q.size();
  if (dq == nullptr && dmu == nullptr && dW == nullptr) {
    if (m != 0) refuse("m", fmt::format("is {}, without dq, dmu and dW", m));
    return contact::by_q_and_mu(problem);
  }
  check_size(m, "m");
  contact::ParameterDerivatives out;
  if (dq != nullptr) out.dq = std::move(matrix_of(dq, "dq", size, m).entries);
  if (dmu != nullptr) out.dmu = std::move(matrix_of(dmu, "dmu", problem.contacts(), m).entries);
  for (std::int64_t j = 0; dW != nullptr && j < m; ++j)
    out.dW.push_back(std::move(matrix_of(dW + j, "dW", size, size).entries));
  return out;
}

}  // namespace

}  // namespace perp::capi

using namespace perp::capi;  // NOLINT(google-build-using-namespace): what follows is the interface of C

int32_t perp_contact_create(int32_t interface_, int32_t dimension, int64_t contacts, const perp_matrix* W,
                            const double* q, const double* mu, perp_contact** contact, perp_error* error) {
  return guarded_make(contact, "contact", error, [&] {
    require_interface(interface_);
    return handle(local(dimension, contacts, W, q, mu));
  });
}

int32_t perp_contact_create_rolling(int32_t interface_, int32_t dimension, int64_t contacts, const perp_matrix* W,
                                    const double* q, const double* mu, const double* mu_r, perp_contact** contact,
                                    perp_error* error) {
  return guarded_make(contact, "contact", error, [&] {
    require_interface(interface_);
    require(mu_r, "mu_r");
    return handle(local(dimension, contacts, W, q, mu, mu_r));
  });
}

int32_t perp_contact_condense(int32_t interface_, int32_t dimension, int64_t contacts, const perp_matrix* M,
                              const perp_matrix* H, const double* f, const double* w, const double* mu,
                              perp_contact** contact, perp_error* error) {
  return guarded_make(contact, "contact", error, [&] {
    require_interface(interface_);
    const Index size = size_of(dimension, contacts);
    require(M, "M");
    const Index m = M->columns;
    perp::contact::Global global;
    global.M = std::move(matrix_of(M, "M", m, m).entries);
    global.H = std::move(matrix_of(H, "H", m, size).entries);
    global.G.resize(m, 0);
    global.f = vector_of(f, m, "f");
    global.w = vector_of(w, size, "w");
    return handle(perp::contact::condense(std::move(global), friction(mu, contacts), dimension));
  });
}

int32_t perp_contact_scene(int32_t interface_, const char* scene, int64_t contacts, int64_t seed,
                           perp_contact** contact, perp_error* error) {
  return guarded_make(contact, "contact", error, [&] {
    require_interface(interface_);
    require(scene, "scene");
    if (contacts < 1) refuse("contacts", std::to_string(contacts) + " is less than 1");
    if (seed < 0 || seed > std::numeric_limits<std::uint32_t>::max())
      refuse("seed", std::to_string(seed) + " is not within 0 and 2^32 - 1");
    check_size(contacts, "contacts");
    if (std::ranges::find(perp::contact::generators(), std::string_view(scene), &perp::contact::GeneratorEntry::name) ==
        perp::contact::generators().end()) {
      std::vector<std::string_view> names;
      for (const perp::contact::GeneratorEntry& one : perp::contact::generators()) names.push_back(one.name);
      refuse("scene", fmt::format("there is no scene '{}' among {}", scene, fmt::join(names, ", ")) +
                          perp::settings::did_you_mean(scene, names));
    }
    return handle(perp::contact::make_scene(scene, contacts, static_cast<unsigned>(seed)).problem());
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
const double* perp_contact_mu_r(const perp_contact* contact) {
  return contact == nullptr || contact->problem.mu_r.size() == 0 ? nullptr : contact->problem.mu_r.data();
}

const char* perp_contact_name(const perp_contact* contact) {
  return contact == nullptr ? "" : contact->problem.name.c_str();
}

int32_t perp_contact_W(const perp_contact* contact, perp_matrix* W, perp_error* error) {
  return guarded(error, [&] {
    require(contact, "contact");
    require(W, "W");
    *W = matrix_view(contact->problem.W.matrix());
  });
}

int32_t perp_contact_judge(const perp_contact* contact, const double* r, double tolerance, perp_result** result,
                           perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    require(contact, "contact");
    if (!(tolerance > 0)) refuse("tolerance", fmt::format("{} is no number > 0", tolerance));
    const perp::contact::Residual residual =
        perp::contact::residual(contact->problem, vector_of(r, contact->problem.q.size(), "r"));
    Part part = part_of(residual);
    part->add("accepted", perp::contact::accepted(residual, tolerance));
    return part;
  });
}

int32_t perp_contact_existence(perp_solver* solver, const perp_contact* contact, perp_result** result,
                               perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    require(contact, "contact");
    Work work(solver);
    return existence(work, contact->problem);
  });
}

int32_t perp_contact_solve(perp_solver* solver, const perp_contact* contact, const char* variant, const double* r0,
                           perp_result** result, perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    require(contact, "contact");
    Work work(solver);
    return solved(work, contact->problem, variant, r0);
  });
}

int32_t perp_contact_batch_create(int32_t interface_, const perp_solver* solver, int64_t count, const char* variant,
                                  perp_contact_batch** batch, perp_error* error) {
  return guarded_make(batch, "batch", error, [&] {
    require_interface(interface_);
    check_size(count, "count");
    const perp_solver usual;
    const perp::contact::SequenceOptions asked = asked_of(solver != nullptr ? *solver : usual, variant);
    auto made = std::make_unique<perp_contact_batch>();
    for (int64_t k = 0; k < count; ++k) made->simulations.emplace_back(asked);
    return made;
  });
}

void perp_contact_batch_free(perp_contact_batch* batch) { delete batch; }

int32_t perp_contact_batch_step(perp_contact_batch* batch, int32_t dimension, int64_t contacts, const perp_varying* W,
                                const perp_varying* q, const perp_varying* mu, int32_t threads, double* r, double* u,
                                int32_t* status, double* residual, perp_error* error) {
  return guarded(error, [&] {
    require(batch, "batch");
    const Index size = size_of(dimension, contacts);
    const perp::lcp::Varying all_W = varying_of(W, size * size, "W"), all_q = varying_of(q, size, "q"),
                             all_mu = varying_of(mu, contacts, "mu");
    perp::lcp::in_threads(static_cast<Index>(batch->simulations.size()), threads, [&] {
      return [&](Index number) {
        const auto k = static_cast<std::size_t>(number);
        const perp_matrix own_W{PERP_DENSE_ROWS, 0, size, size, nullptr, nullptr, all_W.of(number)};
        const perp::contact::Problem problem = local(dimension, contacts, &own_W, all_q.of(number), all_mu.of(number));
        const perp::contact::Run run = batch->simulations[k].step(problem);
        put(r, k, run.solution.r);
        put(u, k, run.solution.u);
        if (status != nullptr) status[k] = static_cast<int32_t>(run.status);
        if (residual != nullptr) residual[k] = std::isnan(run.own) ? run.residual.largest() : run.own;
      };
    });
  });
}

int32_t perp_contact_sensitivity(perp_solver* solver, const perp_contact* contact, const double* r, int64_t m,
                                 const perp_matrix* dq, const perp_matrix* dmu, const perp_matrix* dW,
                                 const double* direction, perp_result** result, perp_error* error) {
  return guarded_make(result, "result", error, [&] {
    require(contact, "contact");
    const perp::contact::Problem& problem = contact->problem;
    const Vec at = vector_of(r, problem.q.size(), "r");
    const perp::contact::ParameterDerivatives p = derivatives_of(problem, m, dq, dmu, dW);
    const Work work(solver);
    const perp::contact::Sensitivity found =
        direction == nullptr
            ? perp::contact::sensitivity(problem, at, p)
            : perp::contact::sensitivity(problem, at, p, vector_of(direction, m == 0 ? p.dq.cols() : m, "direction"));
    return part_of(found);
  });
}

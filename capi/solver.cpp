// SPDX-License-Identifier: Apache-2.0
/// Solvers of perp.h: options by name, and what goes with them.
#include <algorithm>
#include <string>
#include <vector>

#include "capi/guard.hpp"
#include "capi/handles.hpp"

namespace perp::capi {

namespace {

/// Takes them all, or none of them.
void add(perp_solver& solver, const std::vector<settings::Assignment>& more) {
  std::vector<settings::Assignment> all = solver.given;
  all.insert(all.end(), more.begin(), more.end());
  solver.options = settings::apply_options(all);
  solver.given = std::move(all);
  solver.kept.reset();
}

std::string value_of(const perp_solver& solver, const char* key) {
  settings::Settings settings = solver.options.settings;
  const std::string name = settings::lowercase(key);
  if (name == "method") return settings.method_name;
  const ncp::Fields fields = settings::fields_of(settings);
  if (const ncp::Field* field = fields.find(name)) return settings::value_text(*field);
  const auto known = std::ranges::find(settings::options(), name, &settings::Option::key);
  if (known == settings::options().end()) throw settings::InputError("key: there is no option '" + name + "'");
  return "-";
}

}  // namespace

}  // namespace perp::capi

using namespace perp::capi;  // NOLINT(google-build-using-namespace): what follows is the interface of C

int32_t perp_solver_create(int32_t interface_, perp_solver** solver, perp_error* error) {
  return guarded_make(solver, "solver", error, [&] {
    require_interface(interface_);
    return std::make_unique<perp_solver>();
  });
}

void perp_solver_free(perp_solver* solver) { delete solver; }

int32_t perp_solver_set(perp_solver* solver, const char* key, const char* value, perp_error* error) {
  return guarded(error, [&] {
    require(solver, "solver");
    require(key, "key");
    require(value, "value");
    add(*solver, {{key, value, "option"}});
  });
}

int32_t perp_solver_read_options(perp_solver* solver, const char* path, perp_error* error) {
  return guarded(error, [&] {
    require(solver, "solver");
    require(path, "path");
    std::vector<perp::settings::Assignment> given;
    try {
      given = perp::settings::read_options_file(path);
    } catch (const perp::settings::InputError& unreadable) {
      throw Refusal(PERP_BAD_FILE, unreadable.what());
    }
    add(*solver, given);
  });
}

int32_t perp_solver_clear_options(perp_solver* solver, perp_error* error) {
  return guarded(error, [&] {
    require(solver, "solver");
    solver->options = perp::settings::apply_options({});
    solver->given.clear();
    solver->kept.reset();
  });
}

int32_t perp_solver_get(const perp_solver* solver, const char* key, char* value, int64_t size, perp_error* error) {
  return guarded(error, [&] {
    require(solver, "solver");
    require(key, "key");
    copy_text(value_of(*solver, key), value, size, "value");
  });
}

const char* perp_solver_note(const perp_solver* solver, int64_t i) {
  if (solver == nullptr || i < 0 || i >= static_cast<int64_t>(solver->options.notes.size())) return nullptr;
  return solver->options.notes[static_cast<std::size_t>(i)].c_str();
}

int32_t perp_solver_set_basis(perp_solver* solver, int64_t n, const int8_t* cells, perp_error* error) {
  return guarded(error, [&] {
    require(solver, "solver");
    std::vector<perp::lcp::Cell> basis;
    check_size(n, "n");
    for (int64_t i = 0; cells != nullptr && i < n; ++i) {
      if (cells[i] < PERP_BELOW || cells[i] > PERP_FIXED)
        refuse("cells", "entry [" + std::to_string(i) + "] is " + std::to_string(cells[i]) +
                            ", and must be 0 (below), 1 (inside), 2 (above) or 3 (fixed)");
      basis.push_back(static_cast<perp::lcp::Cell>(cells[i]));
    }
    solver->basis = std::move(basis);
  });
}

int32_t perp_solver_set_log(perp_solver* solver, perp_log log, void* user, perp_error* error) {
  return guarded(error, [&] {
    require(solver, "solver");
    solver->log = log;
    solver->log_user = user;
  });
}

int32_t perp_solver_set_progress(perp_solver* solver, perp_progress progress, void* user, perp_error* error) {
  return guarded(error, [&] {
    require(solver, "solver");
    solver->progress = progress;
    solver->progress_user = user;
  });
}

void perp_solver_interrupt(perp_solver* solver) {
  static_assert(std::atomic<bool>::is_always_lock_free);  // or signal handlers must not
  if (solver != nullptr) solver->stop = true;
}

int32_t perp_solver_heed_sigint(perp_solver* solver, int32_t on, perp_error* error) {
  return guarded(error, [&] {
    require(solver, "solver");
    solver->heeds_sigint = on != 0;
  });
}

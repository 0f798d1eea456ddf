// SPDX-License-Identifier: Apache-2.0
/// Results of perp.h, and the names of what they say.
#include <array>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

#include "capi/guard.hpp"
#include "capi/handles.hpp"

namespace perp::capi {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// The numbers of perp.h are those of Status.
static_assert(static_cast<int>(Status::Solved) == PERP_SOLVED &&
              static_cast<int>(Status::SolvedToRounding) == PERP_SOLVED_TO_ROUNDING &&
              static_cast<int>(Status::Infeasible) == PERP_INFEASIBLE &&
              static_cast<int>(Status::StationaryPoint) == PERP_STATIONARY_POINT &&
              static_cast<int>(Status::NoProgress) == PERP_NO_PROGRESS &&
              static_cast<int>(Status::Stalled) == PERP_STALLED && static_cast<int>(Status::Ray) == PERP_RAY &&
              static_cast<int>(Status::Unbounded) == PERP_UNBOUNDED &&
              static_cast<int>(Status::Singular) == PERP_SINGULAR &&
              static_cast<int>(Status::LinearAlgebraFailed) == PERP_LINEAR_ALGEBRA_FAILED &&
              static_cast<int>(Status::SubproblemFailed) == PERP_SUBPROBLEM_FAILED &&
              static_cast<int>(Status::EvaluationFailed) == PERP_EVALUATION_FAILED &&
              static_cast<int>(Status::NotApplicable) == PERP_NOT_APPLICABLE &&
              static_cast<int>(Status::IterationLimit) == PERP_ITERATION_LIMIT &&
              static_cast<int>(Status::TimeLimit) == PERP_TIME_LIMIT &&
              static_cast<int>(Status::Interrupted) == PERP_INTERRUPTED &&
              static_cast<int>(Status::OutOfMemory) == PERP_NO_MEMORY);

}  // namespace

}  // namespace perp::capi

using namespace perp::capi;  // NOLINT(google-build-using-namespace): what follows is the interface of C

int32_t perp_interface(void) { return PERP_INTERFACE; }
const char* perp_version(void) { return PERP_VERSION; }

const char* perp_code_name(int32_t code) {
  static constexpr std::array names{"ok",           "bad argument",  "bad option",    "bad file",
                                    "bad callback", "out of memory", "bad interface", "internal error"};
  return code >= 0 && static_cast<std::size_t>(code) < names.size() ? names[static_cast<std::size_t>(code)] : "?";
}

const char* perp_status_name(int32_t status) {
  if (status < PERP_SOLVED || status > PERP_NO_MEMORY) return "?";
  return perp::to_string(static_cast<perp::Status>(status)).data();  // of a literal
}

void perp_result_free(perp_result* result) { delete result; }

int32_t perp_result_status(const perp_result* result) {
  return result == nullptr ? -1 : static_cast<int32_t>(result->result.status);
}
int32_t perp_result_solved(const perp_result* result) { return result != nullptr && result->result.solved() ? 1 : 0; }
const char* perp_result_message(const perp_result* result) {
  return result == nullptr ? "" : result->result.message.c_str();
}
const char* perp_result_advice(const perp_result* result) {
  return result == nullptr ? "" : result->result.advice.c_str();
}
int64_t perp_result_size(const perp_result* result) { return result == nullptr ? 0 : result->result.x.size(); }
const double* perp_result_x(const perp_result* result) { return result == nullptr ? nullptr : result->result.x.data(); }
const double* perp_result_F(const perp_result* result) { return result == nullptr ? nullptr : result->result.F.data(); }
double perp_result_residual(const perp_result* result) {
  return result == nullptr ? unknown : result->result.residual.natural;
}
int64_t perp_result_worst(const perp_result* result) { return result == nullptr ? -1 : result->result.residual.worst; }
double perp_result_relative(const perp_result* result) { return result == nullptr ? unknown : result->result.relative; }
int64_t perp_result_relative_row(const perp_result* result) {
  return result == nullptr ? -1 : result->result.relative_row;
}
const char* perp_result_note(const perp_result* result, int64_t i) {
  if (result == nullptr || i < 0 || i >= static_cast<int64_t>(result->result.notes.size())) return nullptr;
  return result->result.notes[static_cast<std::size_t>(i)].c_str();
}
double perp_result_verified_radius(const perp_result* result) {
  if (result == nullptr || !result->verified || !result->verified->unique) return unknown;
  return result->verified->largest_radius();
}
const int8_t* perp_result_basis(const perp_result* result) {
  return result == nullptr || result->basis.empty() ? nullptr : result->basis.data();
}

int32_t perp_result_statistic(const perp_result* result, const char* name, double* value, perp_error* error) {
  return guarded(error, [&] {
    require(result, "result");
    require(name, "name");
    require(value, "value");
    bool found = false;
    perp::ncp::each(result->result.stats, [&](const char* known, auto number) {
      if (std::strcmp(known, name) != 0) return;
      *value = static_cast<double>(number);
      found = true;
    });
    if (!found) refuse("name", std::string("there is no statistic '") + name + "'");
  });
}

const char* perp_statistic_name(int64_t i) {
  const char* found = nullptr;
  int64_t k = 0;
  perp::ncp::each(perp::ncp::Stats{}, [&](const char* name, auto) {
    if (k++ == i) found = name;
  });
  return found;
}

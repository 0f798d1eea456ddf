// SPDX-License-Identifier: Apache-2.0
/// Results of perp.h, and the names of what they say.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "capi/guard.hpp"
#include "capi/record.hpp"
#include "lcp/status.hpp"

namespace perp::capi {

Value value_of(Part part) {
  std::vector<Part> one;
  one.push_back(std::move(part));
  return one;
}

namespace {

static_assert(std::variant_size_v<Value> == PERP_ITERATIONS);

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

const Value* find(const perp_result* result, const char* key) {
  return result == nullptr || key == nullptr ? nullptr : result->find(key);
}

/// The field's value if it is of this type, else null.
template <class T>
const T* get(const perp_result* result, const char* key) {
  const Value* value = find(result, key);
  return value == nullptr ? nullptr : std::get_if<T>(value);
}

/// Entry i of a field that is an array, or null.
template <class T>
const T* entry(const std::vector<T>* array, std::int64_t i) {
  return array == nullptr || i < 0 || i >= static_cast<std::int64_t>(array->size())
             ? nullptr
             : &(*array)[static_cast<std::size_t>(i)];
}

struct Length {
  std::int64_t operator()(const Iterations& log) const { return static_cast<std::int64_t>(log.rows.size()); }
  std::int64_t operator()(const std::string&) const { return 1; }
  std::int64_t operator()(std::int64_t) const { return 1; }
  std::int64_t operator()(double) const { return 1; }
  template <class Array>
  std::int64_t operator()(const Array& array) const {
    return static_cast<std::int64_t>(array.size());
  }
};

}  // namespace

}  // namespace perp::capi

const perp::capi::Value* perp_result::find(std::string_view key) const {
  const auto found = std::ranges::find(fields, key, &Field::key);
  return found == fields.end() ? nullptr : &found->value;
}

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
int32_t perp_result_status(const perp_result* result) { return result == nullptr ? -1 : result->status; }

const char* perp_result_key(const perp_result* result, int64_t i) {
  if (result == nullptr || i < 0 || i >= static_cast<int64_t>(result->fields.size())) return nullptr;
  return result->fields[static_cast<std::size_t>(i)].key.c_str();
}

int32_t perp_result_kind(const perp_result* result, const char* key) {
  const Value* value = find(result, key);
  return value == nullptr ? PERP_NONE : PERP_INTEGER + static_cast<int32_t>(value->index());
}

int64_t perp_result_length(const perp_result* result, const char* key) {
  const Value* value = find(result, key);
  return value == nullptr ? 0 : std::visit(Length{}, *value);
}

int64_t perp_result_integer(const perp_result* result, const char* key) {
  const int64_t* number = get<int64_t>(result, key);
  return number == nullptr ? -1 : *number;
}

double perp_result_real(const perp_result* result, const char* key) {
  if (const double* number = get<double>(result, key)) return *number;
  const int64_t* integer = get<int64_t>(result, key);
  return integer == nullptr ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(*integer);
}

const char* perp_result_text(const perp_result* result, const char* key, int64_t i) {
  if (const std::string* text = get<std::string>(result, key)) return i == 0 ? text->c_str() : nullptr;
  const std::string* text = entry(get<std::vector<std::string>>(result, key), i);
  return text == nullptr ? nullptr : text->c_str();
}

const double* perp_result_reals(const perp_result* result, const char* key) {
  const perp::lcp::Vec* reals = get<perp::lcp::Vec>(result, key);
  return reals == nullptr ? nullptr : reals->data();
}

const int64_t* perp_result_integers(const perp_result* result, const char* key) {
  const auto* integers = get<std::vector<int64_t>>(result, key);
  return integers == nullptr ? nullptr : integers->data();
}

const int8_t* perp_result_cells(const perp_result* result, const char* key) {
  const auto* cells = get<std::vector<int8_t>>(result, key);
  return cells == nullptr ? nullptr : cells->data();
}

const perp_result* perp_result_part(const perp_result* result, const char* key, int64_t i) {
  const Part* part = entry(get<std::vector<Part>>(result, key), i);
  return part == nullptr ? nullptr : part->get();
}

const perp_iteration* perp_result_iterations(const perp_result* result, const char* key) {
  const auto* log = get<Iterations>(result, key);
  return log == nullptr ? nullptr : log->rows.data();
}

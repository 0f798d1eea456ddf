// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A result of perp.h: fields that have a name. What an answer of the library says becomes fields in one place, here
/// below; the accessors of perp.h know kinds and no field.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "capi/perp.h"
#include "lcp/pivoting/lemke.hpp"
#include "lcp/types.hpp"
#include "ncp/run/observe.hpp"

namespace perp::capi {

/// The iterations of a solve, as C sees them; texts are those of the records.
struct Iterations {
  std::vector<ncp::Iteration> records{};
  std::vector<perp_iteration> rows{};
};

using Part = std::unique_ptr<perp_result>;
/// In the order of perp_kind, from PERP_INTEGER on.
using Value = std::variant<std::int64_t, double, std::string, std::vector<std::string>, lcp::Vec,
                           std::vector<std::int64_t>, std::vector<std::int8_t>, std::vector<Part>, Iterations>;

/// Of integers of any type and truth values; other values stay what they are.
template <class T>
Value value_of(T value) {
  if constexpr (std::is_integral_v<T>)
    return static_cast<std::int64_t>(value);
  else
    return value;
}
inline Value value_of(const std::vector<lcp::Cell>& cells) {
  std::vector<std::int8_t> numbers(cells.size());
  std::ranges::transform(cells, numbers.begin(), [](lcp::Cell cell) { return static_cast<std::int8_t>(cell); });
  return numbers;
}
inline Value value_of(const char* text) { return std::string(text); }
inline Value value_of(std::string_view text) { return std::string(text); }
Value value_of(Part part);

}  // namespace perp::capi

struct perp_result {
  struct Field {
    std::string key;
    perp::capi::Value value;
  };
  std::vector<Field> fields{};
  std::int32_t status = -1;  ///< perp_status, of solves

  template <class T>
  perp_result& add(std::string_view key, T value) {
    fields.push_back({std::string(key), perp::capi::value_of(std::move(value))});
    return *this;
  }
  const perp::capi::Value* find(std::string_view key) const;
};

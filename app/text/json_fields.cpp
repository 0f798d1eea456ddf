// SPDX-License-Identifier: Apache-2.0
#include "app/text/json_fields.hpp"

namespace perp::app {

double json_real(const Json& value, std::string_view key) {
  if (value.is_null() || value == "nan") return std::numeric_limits<double>::quiet_NaN();
  if (value == "inf") return std::numeric_limits<double>::infinity();
  if (value == "-inf") return -std::numeric_limits<double>::infinity();
  if (!value.is_number()) throw input_error("'{}' is no number", key);
  return value.get<double>();
}

Json json_object(std::string_view text) {
  try {
    Json json = Json::parse(text);
    if (!json.is_object()) throw InputError("no JSON object");
    return json;
  } catch (const Json::exception& error) {
    throw InputError(error.what());
  }
}

const Json& json_member(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) throw input_error("'{}' is missing", key);
  return *found;
}

std::string line_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string field_text(const Json& value) {
  if (value.is_null()) return "";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  return value.is_string() ? value.get<std::string>() : value.dump();
}

}  // namespace perp::app

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// JSON as other programs read it: the parser is compiled once.
#include <nlohmann/json.hpp>
#include <string_view>

namespace perp::app::test {

using Json = nlohmann::json;

Json parse_json(std::string_view text);
bool is_json(std::string_view text);

}  // namespace perp::app::test

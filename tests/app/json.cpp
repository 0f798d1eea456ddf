// SPDX-License-Identifier: Apache-2.0
#include "app/json.hpp"

namespace perp::app::test {

Json parse_json(std::string_view text) { return Json::parse(text); }
bool is_json(std::string_view text) { return Json::accept(text); }

}  // namespace perp::app::test

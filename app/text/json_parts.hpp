// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What JSON is made of, for the files that write it. Private to app/.
#include <nlohmann/json.hpp>
#include <string>

#include "ncp/problem/residual.hpp"

namespace perp::app {

using Json = nlohmann::ordered_json;

Json json_number(double value);  ///< infinities as "inf" and "-inf", NaN as "nan"
Json json_known(double value);   ///< as json_number(), but null for NaN
Json json_numbers(ncp::In values);
/// The documents for other programs, but for those with a version of their own; docs/schema/ describes them.
enum class Document {
  Solve,
  NoResult,
  Inspect,
  Explain,
  List,
  Problem,
  Contact,
  ContactRuns,
  ContactVariants,
  Judge,
  Methods
};
Json json_header(Document document);  ///< program, version and schema
Json json_header();                   ///< program and version
Json equation_json(const ncp::Mcp& mcp, ncp::Index i);
Json index_json(ncp::Index i);  ///< null if negative
Json residual_json(const ncp::Mcp& mcp, const ncp::Residual& residual);

/// Text, with a newline; bytes that are no UTF-8 are replaced.
std::string json_text(const Json& json);

}  // namespace perp::app

// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Comma-separated numbers on the command line. Private to app/contact.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <set>
#include <string>
#include <vector>

#include "app/program/program.hpp"

namespace perp::app::contacts {

/// Throws InputError naming flag and word: no number, not in [least, most], there twice.
template <class Value>
std::vector<Value> parse_list(const char* flag, const std::string& text, Value least, Value most) {
  std::vector<Value> values;
  std::set<Value> seen;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    Value value{};
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool whole = stop == word.data() + word.size();
    if (word.empty() || (error != std::errc{} && error != std::errc::result_out_of_range) || !whole)
      throw input_error("{} {}: '{}' is no number; a list is like 4,6,8", flag, text, word);
    if (error != std::errc{} || !(value >= least && value <= most))
      throw input_error("{} {}: {} is not in [{}, {}]", flag, text, word, least, most);
    if (!seen.insert(value).second) throw input_error("{} {}: {} stands there twice", flag, text, word);
    values.push_back(value);
    begin = end + 1;
  }
  return values;
}

}  // namespace perp::app::contacts

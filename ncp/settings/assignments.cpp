// SPDX-License-Identifier: Apache-2.0
#include "ncp/settings/assignments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <istream>

#include "lcp/io/file_error.hpp"
#include "lcp/io/file_path.hpp"
#include "ncp/settings/input_error.hpp"

namespace perp::settings {

namespace {

constexpr std::string_view space = " \t\r\n";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(space);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(space) - first + 1);
}

std::vector<std::string> split_words(std::string_view text) {
  std::vector<std::string> words;
  std::string word;
  char quote = 0;
  bool inside = false;  // of a word, which may be empty quotes
  for (const char c : text) {
    if (quote != 0 && c == quote) {
      quote = 0;
    } else if (quote == 0 && (c == '"' || c == '\'')) {
      quote = c;
      inside = true;
    } else if (quote == 0 && space.find(c) != std::string_view::npos) {
      if (inside) words.push_back(std::move(word));
      word.clear();
      inside = false;
    } else {
      word += c;
      inside = true;
    }
  }
  if (inside) words.push_back(std::move(word));
  return words;
}

/// Of the first line.
std::string_view without_mark(std::string_view line, const std::string& name) {
  try {
    return lcp::without_mark(line, name);
  } catch (const lcp::FileError& error) {
    throw InputError(error.what());
  }
}

/// A line of an options file without its comment and its closing semicolon.
std::string_view content(std::string_view line) {
  line = trimmed(line);
  if (line.starts_with('#') || line.starts_with('*')) return {};
  for (std::size_t k = 1; k < line.size(); ++k)
    if (line[k] == '#' && space.find(line[k - 1]) != std::string_view::npos) line = trimmed(line.substr(0, k));
  if (line.ends_with(';')) line = trimmed(line.substr(0, line.size() - 1));
  return line;
}

}  // namespace

Assignment parse_assignment(std::string_view text, std::string source) {
  const std::size_t equals = text.find('=');
  const std::string_view key = trimmed(text.substr(0, equals));
  if (equals == std::string_view::npos || key.empty())
    throw input_error("{}: '{}' is not of the form key=value", source, text);
  return {std::string(key), std::string(trimmed(text.substr(equals + 1))), std::move(source)};
}

std::vector<Assignment> parse_words(std::span<const std::string> words, const std::string& source) {
  std::vector<Assignment> result;
  for (std::size_t k = 0; k < words.size(); ++k) {
    const std::size_t equals = words[k].find('=');
    Assignment given{.key = words[k].substr(0, equals), .value = "", .source = source};
    if (equals != std::string::npos) given.value = words[k].substr(equals + 1);
    const bool more = k + 1 < words.size();
    if (equals == std::string::npos && more && words[k + 1].starts_with('=')) {  // key =value, key = value
      given.value = words[++k].substr(1);
      if (given.value.empty() && k + 1 < words.size()) given.value = words[++k];
    } else if (given.value.empty() && more && words[k + 1].find('=') == std::string::npos) {  // key value, key= value
      given.value = words[++k];
    }
    result.push_back(std::move(given));
  }
  return result;
}

std::vector<Assignment> parse_words(std::string_view text, const std::string& source) {
  return parse_words(split_words(text), source);
}

std::vector<Assignment> parse_options_file(std::istream& in, const std::string& name) {
  std::vector<Assignment> result;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::string_view text = content(number == 1 ? without_mark(line, name) : std::string_view(line));
    if (text.empty()) continue;
    const std::string source = fmt::format("{}:{}", name, number);
    const std::vector<Assignment> given = parse_words(text, source);
    if (given.size() != 1 || given[0].key.empty() || given[0].value.empty())
      throw input_error("{}: '{}' is not one option of the form 'key value' or 'key = value'", source, text);
    result.push_back(given[0]);
  }
  return result;
}

std::vector<Assignment> read_options_file(const std::string& path) {
  const std::filesystem::path file = lcp::file_path(path);
  std::ifstream in(file);
  std::error_code ignored;
  if (!in || std::filesystem::is_directory(file, ignored)) throw input_error("options file '{}' cannot be read", path);
  return parse_options_file(in, path);
}

std::string lowercase(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return result;
}

}  // namespace perp::settings

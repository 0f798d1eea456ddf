// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How options are written: key=value on the command line, AMPL's words, option files.
#include <iosfwd>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace perp::settings {

/// One key=value as it was written.
struct Assignment {
  std::string key;
  std::string value;
  std::string source;  ///< for messages: "--option", "path.opt:3", "environment variable path_options"
};

/// Splits "key=value". Throws InputError if there is no '=' or no key.
Assignment parse_assignment(std::string_view text, std::string source);

/// AMPL's way: key=value, key = value, key value. A key without a value gets an empty one.
std::vector<Assignment> parse_words(std::span<const std::string> words, const std::string& source);
/// The same of one text; double or single quotes keep a value with spaces together.
std::vector<Assignment> parse_words(std::string_view text, const std::string& source);

/// Lines `key value` or `key = value`, with or without a semicolon at the end; lines that are empty or begin with # or
/// * are skipped, # after white space begins a comment. Throws InputError with name and line number.
std::vector<Assignment> parse_options_file(std::istream& in, const std::string& name);
/// Of a file. Throws InputError also if it cannot be read.
std::vector<Assignment> read_options_file(const std::string& path);

/// In small letters, as keys and words are compared.
std::string lowercase(std::string_view text);

}  // namespace perp::settings
